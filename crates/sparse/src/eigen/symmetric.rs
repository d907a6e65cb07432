//! Eigenpairs of symmetric matrices that may be indefinite, by a shift below the spectrum.

use crate::direct::cholesky::SymbolicCholesky;
use crate::direct::ordering::Ordering;
use crate::eigen::components::smallest_eigenpairs;
use crate::eigen::{EigenOptions, EigenPairs};
use crate::error::SparseError;
use crate::mass::{Mass, combine};
use crate::matrix::{Rows, SparseMatrix};

/// A matrix whose lowest eigenvalue is above minus this, relative to its size, counts as positive
/// semi-definite.
const ROUNDING: f64 = 1e-9;
/// Bisections of the factor of four within which the bound below the spectrum is first known: down
/// to a half percent, since pairs are told apart by their distance from the bound.
const BISECTIONS: usize = 8;

/// The `count` smallest eigenpairs of A φ = λ M φ, from the most negative eigenvalue on.
///
/// A must be symmetric, M positive definite. If a factorisation shows that A is positive
/// semi-definite, the pairs are those of [`smallest_eigenpairs`]. Otherwise factorisations of A −
/// cM find a bound c below the spectrum, within a percent of the lowest eigenvalue, and the pairs
/// are those of A − cM; tolerances are then relative to λ − c.
///
/// # Errors
///
/// Those of [`smallest_eigenpairs`], and those of [`SymbolicCholesky::new`] for a matrix that is
/// not square, not symmetric or not finite.
///
/// # Examples
///
/// ```
/// use fairing_sparse::{EigenOptions, Mass, SparseMatrix, smallest_symmetric_eigenpairs};
/// // Eigenvalues −1 and 3.
/// let a = SparseMatrix::new((2, 2), vec![0, 2, 4], vec![0, 1, 0, 1], vec![1.0, 2.0, 2.0, 1.0]);
/// let options = EigenOptions::default();
/// let pairs = smallest_symmetric_eigenpairs(&a, Mass::Lumped(&[1.0, 1.0]), 2, &options)?;
/// assert!((pairs.values[0] + 1.0).abs() < 1e-14 && (pairs.values[1] - 3.0).abs() < 1e-14);
/// # Ok::<(), fairing_sparse::SparseError>(())
/// ```
#[doc(alias("eigs", "eigsh"))]
pub fn smallest_symmetric_eigenpairs(
    matrix: &SparseMatrix,
    mass: Mass<'_>,
    count: usize,
    options: &EigenOptions,
) -> Result<EigenPairs, SparseError> {
    let (rows, columns) = matrix.shape();
    if rows != columns {
        return Err(SparseError::NotSquare { rows, columns });
    }
    mass.check(rows)?;
    let pattern = combine(1.0, mass, 1.0, matrix);
    let symbolic = SymbolicCholesky::new(&pattern, Ordering::LeastFill)?;
    let is_above = |c: f64| match symbolic.factorize(&combine(-c, mass, 1.0, matrix)) {
        Ok(_) => Ok(true),
        Err(SparseError::Indefinite { .. } | SparseError::Singular { .. }) => Ok(false),
        Err(error) => Err(error),
    };
    let size = size(matrix, mass);
    if is_above(-ROUNDING * size)? {
        match smallest_eigenpairs(matrix, mass, count, options) {
            // An eigenvalue that is negative by more than the solver takes for rounding.
            Err(SparseError::Factor { .. }) => {}
            done => return done,
        }
    }
    let mut below = -size;
    while !is_above(below)? {
        below *= 4.0;
    }
    while below < -ROUNDING * size && is_above(0.25 * below)? {
        below *= 0.25;
    }
    let mut factor = 0.25f64;
    for _ in 0..BISECTIONS {
        factor = factor.sqrt();
        if is_above(factor * below)? {
            below *= factor;
        }
    }
    let shifted = combine(-below, mass, 1.0, matrix);
    let solved = smallest_eigenpairs(&shifted, mass, count, options);
    let mut pairs = solved.map_err(|error| match error {
        SparseError::Crowded { wanted, value } => {
            SparseError::Crowded { wanted, value: value + below }
        }
        error => error,
    })?;
    let values = pairs.values.iter_mut().chain(&mut pairs.beyond.values);
    values.for_each(|value| *value += below);
    pairs.beyond.clear_below += below;
    Ok(pairs)
}

/// The mean sum of the absolute entries of a row over the mean mass; 1 for a matrix of zeros.
fn size(matrix: &SparseMatrix, mass: Mass<'_>) -> f64 {
    let entries: f64 = Rows::new(matrix).values.iter().map(|v| v.abs()).sum();
    let size = entries / mass.diagonal().iter().sum::<f64>();
    if size > 0.0 { size } else { 1.0 }
}
