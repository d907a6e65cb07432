//! All eigenpairs of a small problem by a dense decomposition of M^(−1/2) S M^(−1/2).

use ndarray::{Array2, ArrayView1};

use crate::components;
use crate::direct::backend;
use crate::error::SparseError;
use crate::mass::Mass;
use crate::matrix::{Rows, SparseMatrix};

/// The M-normalised constants that S maps to zero.
fn constants(stiffness: &SparseMatrix, mass: Mass<'_>) -> Vec<Vec<f64>> {
    let (count, component) = components::constant_components(Rows::new(stiffness));
    (0..count as u32)
        .map(|c| {
            let indicator: Vec<f64> =
                component.iter().map(|&k| f64::from(u8::from(k == Some(c)))).collect();
            let square: f64 =
                mass.times(&indicator).iter().zip(&indicator).map(|(m, x)| m * x).sum();
            indicator.iter().map(|x| x / square.sqrt()).collect()
        })
        .collect()
}

/// Ascending eigenvalues, and M-orthonormal eigenvectors in the columns of an `n × n` array.
pub(crate) fn all_eigenpairs(
    stiffness: &SparseMatrix,
    mass: Mass<'_>,
) -> Result<(Vec<f64>, Array2<f64>), SparseError> {
    let constants = constants(stiffness, mass);
    let (n, count) = (stiffness.rows(), constants.len());
    let root = inverse_root(mass)?;
    let t = root.multiply(&stiffness.to_dense());
    let mut t = root.multiply(&t.t().to_owned());
    t = (&t + &t.t()) * 0.5;

    // The constants are moved to the upper end of the spectrum and put back as exact zeros.
    let lift = match 2.0 * t.diag().iter().map(|d| d.abs()).sum::<f64>() {
        lift if lift > 0.0 => lift,
        _ => 1.0,
    };
    for constant in &constants {
        // M^(1/2) c = M^(−1/2) M c.
        let u = root.multiply_vector(&mass.times(constant));
        for i in 0..n {
            for j in 0..n {
                t[[i, j]] += lift * u[i] * u[j];
            }
        }
    }
    let (mut values, vectors) = decompose(&t)?;
    values.truncate(n - count);
    values.splice(0..0, std::iter::repeat_n(0.0, count));
    let mut modes = Array2::zeros((n, n));
    for (k, constant) in constants.iter().enumerate() {
        modes.column_mut(k).assign(&ArrayView1::from(constant));
    }
    let rest = root.multiply(&vectors);
    for k in count..n {
        modes.column_mut(k).assign(&rest.column(k - count));
    }
    Ok((values, modes))
}

/// M^(−1/2).
enum InverseRoot {
    Diagonal(Vec<f64>),
    Full(Array2<f64>),
}

fn inverse_root(mass: Mass<'_>) -> Result<InverseRoot, SparseError> {
    match mass {
        Mass::Lumped(d) => Ok(InverseRoot::Diagonal(d.iter().map(|m| 1.0 / m.sqrt()).collect())),
        Mass::Consistent(matrix) => {
            let (values, vectors) = decompose(&matrix.to_dense())?;
            if let Some((row, &value)) = values.iter().enumerate().find(|(_, v)| **v <= 0.0) {
                let diagonal = Rows::new(matrix).diagonal()[row];
                let source = SparseError::Indefinite { row, pivot: value, diagonal };
                return Err(SparseError::ConsistentMass(Box::new(source)));
            }
            let mut scaled = vectors.clone();
            for (mut column, value) in scaled.columns_mut().into_iter().zip(&values) {
                column /= value.sqrt();
            }
            Ok(InverseRoot::Full(scaled.dot(&vectors.t())))
        }
    }
}

impl InverseRoot {
    fn multiply(&self, a: &Array2<f64>) -> Array2<f64> {
        match self {
            Self::Diagonal(d) => {
                let mut a = a.clone();
                for (mut row, d) in a.rows_mut().into_iter().zip(d) {
                    row *= *d;
                }
                a
            }
            Self::Full(root) => root.dot(a),
        }
    }

    fn multiply_vector(&self, x: &[f64]) -> Vec<f64> {
        match self {
            Self::Diagonal(d) => d.iter().zip(x).map(|(d, x)| d * x).collect(),
            Self::Full(root) => root.dot(&ArrayView1::from(x)).to_vec(),
        }
    }
}

/// Ascending eigenvalues, and eigenvectors in columns.
fn decompose(matrix: &Array2<f64>) -> Result<(Vec<f64>, Array2<f64>), SparseError> {
    let n = matrix.nrows();
    let standard = matrix.as_standard_layout();
    let failed = || SparseError::Dense { rows: n };
    let slice = standard.as_slice().ok_or_else(failed)?;
    let (values, vectors) = backend::symmetric_eigen(n, slice).map_err(|_| failed())?;
    let rows = Array2::from_shape_vec((n, n), vectors).map_err(|_| failed())?;
    Ok((values, rows.reversed_axes()))
}
