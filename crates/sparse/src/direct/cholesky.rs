//! Sparse Cholesky factorisation A = L D Lᵀ of symmetric positive definite matrices.

use std::sync::Arc;

use ndarray::ArrayView2;

use crate::direct::backend::{self, TooLarge};
use crate::direct::dissection;
use crate::direct::factor::Analysis;
use crate::direct::factor::Factor;
use crate::direct::ldlt::Ldlt;
use crate::direct::multifrontal;
use crate::direct::ordering::{self, Ordering, Postordered};
use crate::direct::symmetry;
use crate::error::SparseError;
use crate::matrix::{Rows, SparseMatrix};
use crate::order::larger;

/// A symbolic factorisation: the ordering of a matrix and the pattern of its factor, independent of
/// its values.
///
/// Analyse once, factorise whenever the values change. Clones share the analysis.
///
/// # Examples
///
/// ```
/// use fairing_sparse::{Mass, Ordering, SparseMatrix, SymbolicCholesky, combine};
/// let s = SparseMatrix::new((2, 2), vec![0, 2, 4], vec![0, 1, 0, 1], vec![1.0, -1.0, -1.0, 1.0]);
/// let mass = Mass::Lumped(&[1.0, 1.0]);
/// let symbolic = SymbolicCholesky::new(&combine(1.0, mass, 1.0, &s), Ordering::default())?;
/// for t in [0.1, 1.0] {
///     let a = combine(1.0, mass, t, &s);
///     let x = symbolic.factorize(&a)?.solve(&[1.0, 1.0]);
///     assert!((x[0] - 1.0).abs() < 1e-15);
/// }
/// # Ok::<(), fairing_sparse::SparseError>(())
/// ```
#[derive(Debug, Clone)]
pub struct SymbolicCholesky {
    analysis: Arc<Analysis>,
}

impl SymbolicCholesky {
    /// Orders the matrix and finds the pattern of its factor. Values must be finite and symmetric,
    /// but are not used.
    ///
    /// # Errors
    ///
    /// [`SparseError`]: not square, not finite, not symmetric, not an ordering, too large.
    pub fn new(matrix: &SparseMatrix, ordering: Ordering) -> Result<Self, SparseError> {
        fairing_watch::check();
        symmetry::check(matrix)?;
        let rows = Rows::new(matrix);
        let n = rows.count();
        let too_large = |_| SparseError::TooLarge { rows: n };
        let order = match ordering {
            Ordering::LeastFill => {
                let found = ordering::least_fill(rows).map_err(too_large)?;
                return Self::from_order(rows, found);
            }
            Ordering::MinimumDegree => backend::minimum_degree(rows).map_err(too_large)?,
            Ordering::NestedDissection => {
                dissection::dissected(rows, &false.into()).map_err(too_large)?
            }
            Ordering::Natural => (0..n as u32).collect(),
            Ordering::Custom(order) => order,
        };
        let bad = |entry| SparseError::NotAnOrdering { length: order.len(), rows: n, entry };
        let inverse = ordering::invert(&order).map_err(bad)?;
        if order.len() != n {
            return Err(bad(n as u32));
        }
        Self::from_order(rows, Postordered::new(rows, &order, &inverse))
    }

    fn from_order(rows: Rows<'_>, found: Postordered) -> Result<Self, SparseError> {
        let Postordered { order, inverse, .. } = found;
        let nodes = backend::supernodes(rows, &order, &inverse)
            .map_err(|TooLarge| SparseError::TooLarge { rows: rows.count() })?;
        let (starts, columns) = (rows.starts.to_vec(), rows.columns.to_vec());
        Ok(Self { analysis: Arc::new(Analysis { nodes, order, inverse, starts, columns }) })
    }

    /// The number of rows of the matrix.
    pub fn rows(&self) -> usize {
        self.analysis.order.len()
    }

    /// The elimination order: row `order[k]` is eliminated k-th.
    pub fn order(&self) -> &[u32] {
        &self.analysis.order
    }

    /// The number of entries of a factor, including explicit zeros of its supernodes.
    pub fn factor_entries(&self) -> usize {
        self.analysis.nodes.entries()
    }

    /// Factorises a positive definite matrix with the pattern of the analysed one.
    ///
    /// # Errors
    ///
    /// [`SparseError::Indefinite`] or [`SparseError::Singular`] with the pivot; the input
    /// errors of [`SymbolicCholesky::new`]; [`SparseError::PatternChanged`].
    pub fn factorize(&self, matrix: &SparseMatrix) -> Result<Cholesky, SparseError> {
        self.check_pattern(matrix)?;
        let (rows, nodes) = (Rows::new(matrix), &self.analysis.nodes);
        let diagonal = rows.diagonal();
        let largest = diagonal.iter().fold(0.0, |m, d| larger(m, d.abs()));
        let exponent = if largest > 0.0 { HEADROOM - libm::log2(largest) as i32 } else { 0 };
        let scale = 2f64.powi(exponent.clamp(-1000, 1000));
        let mut values = vec![0.0; nodes.value_count()];
        let done = multifrontal::factorize(nodes, rows.values, scale, true, &mut values);
        // The size of a pivot that would be zero without rounding, relative to its diagonal entry.
        // Errors accumulate like a random walk: 2 to 5 ε √n were measured on grids.
        let noise = 64.0 * f64::EPSILON * (self.rows() as f64).sqrt();
        let order = &self.analysis.order;
        let failed = match done {
            Ok(()) => {
                nodes.diagonal_mut(&mut values, |pivot| pivot / scale);
                let tiny = |(k, pivot): &(usize, f64)| {
                    pivot.is_nan() || *pivot <= noise * diagonal[order[*k] as usize].abs()
                };
                nodes.diagonal(&values).enumerate().find(tiny)
            }
            Err((k, pivot)) => Some((k, pivot / scale)),
        };
        let Some((k, pivot)) = failed else {
            let analysis = Arc::clone(&self.analysis);
            return Ok(Cholesky { factor: Factor { analysis, values } });
        };
        let row = order[k] as usize;
        let diagonal = diagonal[row];
        Err(if pivot < -noise * diagonal.abs() || diagonal < 0.0 {
            SparseError::Indefinite { row, pivot, diagonal }
        } else {
            SparseError::Singular { row, pivot, diagonal }
        })
    }

    /// Factorises a matrix that may be indefinite, without pivoting.
    ///
    /// Exists if no leading block, in the order of elimination, is singular; near-singular leading
    /// blocks cost accuracy, which [`Ldlt::growth`] measures.
    ///
    /// # Errors
    ///
    /// [`SparseError::Singular`] with the pivot; the input errors of [`SymbolicCholesky::new`];
    /// [`SparseError::PatternChanged`].
    pub fn factorize_indefinite(&self, matrix: &SparseMatrix) -> Result<Ldlt, SparseError> {
        self.check_pattern(matrix)?;
        let (rows, nodes) = (Rows::new(matrix), &self.analysis.nodes);
        let mut values = vec![0.0; nodes.value_count()];
        let done = multifrontal::factorize(nodes, rows.values, 1.0, false, &mut values);
        let bad = |pivot: &f64| *pivot == 0.0 || !pivot.is_finite();
        let failed = match done {
            Ok(()) => nodes.diagonal(&values).enumerate().find(|(_, pivot)| bad(pivot)),
            Err(stop) => Some(stop),
        };
        if let Some((k, pivot)) = failed {
            let row = self.analysis.order[k] as usize;
            return Err(SparseError::Singular { row, pivot, diagonal: rows.diagonal()[row] });
        }
        let largest: Vec<f64> = (0..rows.count())
            .map(|i| rows.row(i).1.iter().fold(0.0, |m, v| larger(m, v.abs())))
            .collect();
        let analysis = Arc::clone(&self.analysis);
        Ok(Ldlt::new(Factor { analysis, values }, &largest))
    }

    fn check_pattern(&self, matrix: &SparseMatrix) -> Result<(), SparseError> {
        let rows = Rows::new(matrix);
        if rows.starts != self.analysis.starts || rows.columns != self.analysis.columns {
            let analysed = Rows {
                starts: &self.analysis.starts,
                columns: &self.analysis.columns,
                values: &[],
            };
            let common = rows.count().min(analysed.count());
            let row = (0..common)
                .find(|&i| rows.columns[rows.range(i)] != analysed.columns[analysed.range(i)])
                .unwrap_or(common);
            return Err(SparseError::PatternChanged { row });
        }
        symmetry::check(matrix)
    }
}

/// The binary exponent to which the largest diagonal entry is scaled. Entries of L decay
/// geometrically with the distance from the diagonal; for small time steps their products become
/// subnormal, where arithmetic is slower by an order of magnitude. Scaling, which is exact, allows
/// a longer decay.
const HEADROOM: i32 = 600;

/// A factorised symmetric positive definite matrix, A = L D Lᵀ.
#[doc(alias("SimplicialLLT", "llt"))]
#[derive(Debug, Clone)]
pub struct Cholesky {
    factor: Factor,
}

impl Cholesky {
    /// Analyses and factorises a matrix.
    ///
    /// # Errors
    ///
    /// As [`SymbolicCholesky::new`] and [`SymbolicCholesky::factorize`].
    pub fn new(matrix: &SparseMatrix) -> Result<Self, SparseError> {
        SymbolicCholesky::new(matrix, Ordering::default())?.factorize(matrix)
    }

    /// The analysis that this factor was computed with.
    pub fn symbolic(&self) -> SymbolicCholesky {
        SymbolicCholesky { analysis: Arc::clone(&self.factor.analysis) }
    }

    pub(crate) fn into_factor(self) -> Factor {
        self.factor
    }

    /// The number of rows of the matrix.
    pub fn rows(&self) -> usize {
        self.factor.rows()
    }

    /// ln det A, the sum of the logarithms of the pivots; the determinant itself may overflow.
    pub fn log_determinant(&self) -> f64 {
        let nodes = &self.factor.analysis.nodes;
        nodes.diagonal(&self.factor.values).map(libm::log).fold(0.0, |sum, log| sum + log)
    }

    /// x with A x = b.
    ///
    /// # Panics
    ///
    /// Panics if `b` has another length than A has rows.
    pub fn solve(&self, b: &[f64]) -> Vec<f64> {
        let mut x = b.to_vec();
        self.solve_in_place(&mut x);
        x
    }

    /// `b` ← A⁻¹ b.
    ///
    /// # Panics
    ///
    /// Panics if `b` has another length than A has rows.
    pub fn solve_in_place(&self, b: &mut [f64]) {
        self.factor.solve_vector(b);
    }

    /// X with A X = B for points, one in a row: `n × 3`.
    ///
    /// # Panics
    ///
    /// Panics if `b` has another length than A has rows.
    pub fn solve_points(&self, b: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let mut x = b.to_vec();
        self.solve_points_in_place(&mut x);
        x
    }

    /// `b` ← A⁻¹ b for points.
    ///
    /// # Panics
    ///
    /// Panics if `b` has another length than A has rows.
    pub fn solve_points_in_place(&self, b: &mut [[f64; 3]]) {
        self.factor.solve_points(b);
    }

    /// `b` ← A⁻¹ b for some columns.
    pub(crate) fn solve_columns<const N: usize>(&self, b: &mut [[f64; N]]) {
        match N {
            1 => self.solve_in_place(b.as_flattened_mut()),
            3 => self.solve_points_in_place(b.as_flattened_mut().as_chunks_mut().0),
            _ => self.factor.solve_rows::<_, N>(b, |b| *b, |b, x| *b = *x),
        }
    }

    /// X with A X = B for an `n × k` block.
    ///
    /// # Panics
    ///
    /// Panics if `b` has another number of rows than A.
    pub fn solve_block(&self, b: ArrayView2<'_, f64>) -> ndarray::Array2<f64> {
        let mut x = b.to_owned();
        self.factor.solve_block(x.view_mut());
        x
    }
}
