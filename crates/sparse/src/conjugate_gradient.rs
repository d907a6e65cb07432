//! Conjugate gradients for a matrix.

use crate::cg::{CgError, CgOptions, CgSolution, CgSystem, conjugate_gradients};
use crate::matrix::{Rows, SparseMatrix};
use crate::passes;

/// A symmetric positive definite matrix, ready to solve with the inverse of its diagonal as preconditioner.
///
/// [`SolverChoice`](crate::SolverChoice) tells when a factorisation is faster.
///
/// # Examples
///
/// ```
/// use fairing_sparse::{CgOptions, ConjugateGradient, SparseMatrix};
/// let a = SparseMatrix::new((2, 2), vec![0, 2, 4], vec![0, 1, 0, 1], vec![2.0, -1.0, -1.0, 2.0]);
/// let cg = ConjugateGradient::new(&a)?;
/// let solution = cg.solve(&[1.0, 1.0], None, &CgOptions::default())?;
/// assert!((solution.x[0] - 1.0).abs() < 1e-12);
/// # Ok::<(), fairing_sparse::CgError>(())
/// ```
///
/// Source: \[hestenes1952\], \[saad2003\].
#[derive(Debug)]
pub struct ConjugateGradient<'a> {
    matrix: &'a SparseMatrix,
    inverse_diagonal: Vec<f64>,
}

impl<'a> ConjugateGradient<'a> {
    /// Inverts the diagonal.
    ///
    /// # Errors
    ///
    /// [`CgError::Size`] for a matrix that is not square, [`CgError::Diagonal`] for a diagonal entry that is
    /// not positive. Symmetry is not checked.
    pub fn new(matrix: &'a SparseMatrix) -> Result<Self, CgError> {
        let (rows, columns) = (matrix.rows(), matrix.cols());
        if rows != columns {
            return Err(CgError::Size { rows, columns, length: rows });
        }
        let diagonal = Rows::new(matrix).diagonal();
        let bad = |d: &f64| !(*d > 0.0 && d.is_finite());
        match diagonal.iter().position(bad) {
            Some(row) => Err(CgError::Diagonal { row, value: diagonal[row] }),
            None => {
                let inverse_diagonal = diagonal.into_iter().map(|d| 1.0 / d).collect();
                Ok(Self { matrix, inverse_diagonal })
            }
        }
    }

    /// x with A x = b, from a first guess (zero without one).
    ///
    /// # Errors
    ///
    /// [`CgError`]: sizes, numbers that are not finite, an indefinite matrix, no convergence.
    pub fn solve(
        &self,
        b: &[f64],
        guess: Option<&[f64]>,
        options: &CgOptions,
    ) -> Result<CgSolution<Vec<f64>>, CgError> {
        let wrap = |v: &[f64]| v.iter().map(|&v| [v]).collect::<Vec<_>>();
        let solution = self.solve_lanes(&wrap(b), guess.map(wrap), options)?;
        Ok(CgSolution {
            x: solution.x.into_iter().map(|[x]| x).collect(),
            iterations: solution.iterations,
            residuals: solution.residuals,
        })
    }

    /// X with A X = B for points, one in a row. The three columns share every pass over the matrix; each has
    /// its own step lengths, and no longer changes once it has converged.
    ///
    /// # Errors
    ///
    /// [`CgError`]: sizes, numbers that are not finite, an indefinite matrix, no convergence.
    pub fn solve_points(
        &self,
        b: &[[f64; 3]],
        guess: Option<&[[f64; 3]]>,
        options: &CgOptions,
    ) -> Result<CgSolution<Vec<[f64; 3]>>, CgError> {
        self.solve_lanes(b, guess.map(<[_]>::to_vec), options)
    }

    fn solve_lanes<const B: usize>(
        &self,
        b: &[[f64; B]],
        guess: Option<Vec<[f64; B]>>,
        options: &CgOptions,
    ) -> Result<CgSolution<Vec<[f64; B]>>, CgError> {
        self.check(b)?;
        if let Some(guess) = &guess {
            self.check(guess)?;
        }
        let guess = guess.unwrap_or_else(|| vec![[0.0; B]; b.len()]);
        let done = |(solution, failure)| match failure {
            None => Ok(solution),
            Some(error) => Err(error),
        };
        let Some(scale) = to_safe_range(b) else {
            return done(conjugate_gradients(self, b, guess, options));
        };
        // Powers of two: exact but for what underflows beside the largest entry.
        let times = |v: &[f64; B]| std::array::from_fn(|lane| v[lane] * scale[lane]);
        let scaled: Vec<[f64; B]> = b.iter().map(times).collect();
        let guess = guess.iter().map(times).collect();
        let mut solution = done(conjugate_gradients(self, &scaled, guess, options))?;
        for x in &mut solution.x {
            for lane in 0..B {
                x[lane] /= scale[lane];
            }
        }
        Ok(solution)
    }

    fn check<const B: usize>(&self, v: &[[f64; B]]) -> Result<(), CgError> {
        let rows = self.matrix.rows();
        if v.len() != rows {
            return Err(CgError::Size { rows, columns: rows, length: v.len() });
        }
        match v.iter().position(|v| v.iter().any(|v| !v.is_finite())) {
            Some(row) => Err(CgError::NotFinite { row }),
            None => Ok(()),
        }
    }
}

impl<const B: usize> CgSystem<B> for ConjugateGradient<'_> {
    fn multiply(&self, p: &[[f64; B]], q: &mut Vec<[f64; B]>) -> [f64; B] {
        let rows = Rows::new(self.matrix);
        passes::update(q, |i, _| {
            let (columns, values) = rows.row(i);
            let mut sum = [0.0; B];
            for (&j, &a) in columns.iter().zip(values) {
                let p = &p[j as usize];
                for lane in 0..B {
                    sum[lane] += a * p[lane];
                }
            }
            (sum, std::array::from_fn(|lane| sum[lane] * p[i][lane]))
        })
    }

    fn precondition(&self, i: usize, r: [f64; B]) -> [f64; B] {
        r.map(|r| r * self.inverse_diagonal[i])
    }

    /// 4 ε ‖|A| |x| + |b|‖ in each column.
    fn attainable(&self, b: &[[f64; B]], x: &[[f64; B]]) -> [f64; B] {
        let rows = Rows::new(self.matrix);
        let squares: [f64; B] = passes::sum(b.len(), |i| {
            let mut sum = b[i].map(f64::abs);
            let (columns, values) = rows.row(i);
            for (&j, &a) in columns.iter().zip(values) {
                for lane in 0..B {
                    sum[lane] += (a * x[j as usize][lane]).abs();
                }
            }
            sum.map(|s| s * s)
        });
        squares.map(|s| 4.0 * f64::EPSILON * s.sqrt())
    }
}

/// Numbers whose squares add up without loss.
const SAFE: std::ops::Range<f64> = 1e-100..1e100;

/// The powers of two that bring the largest entry of each lane near 1, or `None` where all are near enough.
fn to_safe_range<const B: usize>(b: &[[f64; B]]) -> Option<[f64; B]> {
    let mut largest = [0.0_f64; B];
    for b in b {
        for lane in 0..B {
            largest[lane] = largest[lane].max(b[lane].abs());
        }
    }
    if largest.iter().all(|l| *l == 0.0 || SAFE.contains(l)) {
        return None;
    }
    // Down to 2⁻¹⁰²²: the inverse must be finite.
    Some(largest.map(|l| {
        if l > 0.0 { libm::exp2((-libm::log2(l).round()).clamp(-1022.0, 1022.0)) } else { 1.0 }
    }))
}
