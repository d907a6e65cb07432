//! Conjugate gradients with a preconditioner, for one right-hand side or three together.

use crate::incomplete::IncompleteCholesky;
use crate::matrix::{Rows, SparseMatrix};
use crate::{product, reduce};

/// What approximates A⁻¹ in conjugate gradients.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Preconditioner {
    /// The inverse of the diagonal: nothing to build, runs in parallel. The choice for well conditioned
    /// systems (M + tS with t up to some h²).
    #[default]
    Jacobi,
    /// Incomplete Cholesky on the pattern of A: a third of the iterations, each of which costs twice as much
    /// on one thread and does not run in parallel.
    IncompleteCholesky,
}

/// When to stop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CgOptions {
    /// Relative residual ‖b − A x‖ / ‖b‖ to reach in every column, measured. Where rounding leaves more,
    /// a residual within 4 ε ‖|A| |x| + |b|‖ / ‖b‖ is as good, and [`CgSolution::residuals`] tells.
    pub tolerance: f64,
    /// Iterations after which to give up.
    pub max_iterations: usize,
}

impl Default for CgOptions {
    /// 10⁻¹⁰ within 10 000 iterations.
    fn default() -> Self {
        Self { tolerance: 1e-10, max_iterations: 10_000 }
    }
}

/// A solution and how it was reached.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct CgSolution<X> {
    /// The solution.
    pub x: X,
    /// Iterations taken.
    pub iterations: usize,
    /// ‖b − A x‖ / ‖b‖ of each column, measured at the end, not carried along.
    pub residuals: Vec<f64>,
}

/// Why conjugate gradients failed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CgError {
    /// A diagonal entry is not positive, so the matrix is not positive definite.
    #[error("diagonal entry {value:e} of row {row} is not positive")]
    Diagonal {
        /// The row.
        row: usize,
        /// Its diagonal entry.
        value: f64,
    },
    /// The matrix is not square or a vector has another length than it has rows.
    #[error("{rows} × {columns} matrix, {length} rows in the vector")]
    Size {
        /// Rows of the matrix.
        rows: usize,
        /// Columns of the matrix.
        columns: usize,
        /// Rows of the vector.
        length: usize,
    },
    /// A right-hand side or first guess holds an infinite number or NaN.
    #[error("the right-hand side or first guess is not finite in row {row}")]
    NotFinite {
        /// The first such row.
        row: usize,
    },
    /// A search direction p has pᵀ A p ≤ 0: the matrix is not positive definite.
    #[error("indefinite: pᵀAp = {curvature:e} in iteration {iteration}")]
    Indefinite {
        /// The iteration.
        iteration: usize,
        /// pᵀ A p.
        curvature: f64,
    },
    /// The tolerance was not reached.
    #[error("relative residual {residual:e} after {iterations} iterations")]
    NotConverged {
        /// Iterations taken.
        iterations: usize,
        /// The largest relative residual.
        residual: f64,
    },
}

/// A symmetric positive definite matrix with its preconditioner, ready to solve.
///
/// [`Method`](crate::Method) tells when a factorisation is faster.
///
/// # Examples
///
/// ```
/// use fairing_sparse::{CgOptions, ConjugateGradient, Preconditioner, SparseMatrix};
/// let a = SparseMatrix::new((2, 2), vec![0, 2, 4], vec![0, 1, 0, 1], vec![2.0, -1.0, -1.0, 2.0]);
/// let cg = ConjugateGradient::new(&a, Preconditioner::Jacobi)?;
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
    incomplete: Option<IncompleteCholesky>,
}

impl<'a> ConjugateGradient<'a> {
    /// Builds the preconditioner.
    ///
    /// # Errors
    ///
    /// [`CgError::Size`] for a matrix that is not square, [`CgError::Diagonal`] for a diagonal entry that is
    /// not positive. Symmetry is not checked.
    pub fn new(matrix: &'a SparseMatrix, preconditioner: Preconditioner) -> Result<Self, CgError> {
        let (rows, columns) = (matrix.rows(), matrix.cols());
        if rows != columns {
            return Err(CgError::Size { rows, columns, length: rows });
        }
        let rows = Rows::of(matrix);
        let diagonal = rows.diagonal();
        if let Some((row, &value)) =
            diagonal.iter().enumerate().find(|(_, d)| !(**d > 0.0 && d.is_finite()))
        {
            return Err(CgError::Diagonal { row, value });
        }
        let incomplete = match preconditioner {
            Preconditioner::Jacobi => None,
            // With a positive diagonal some shift always succeeds; if not, Jacobi serves.
            Preconditioner::IncompleteCholesky => IncompleteCholesky::new(rows),
        };
        let inverse_diagonal = diagonal.into_iter().map(|d| 1.0 / d).collect();
        Ok(Self { matrix, inverse_diagonal, incomplete })
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
    /// its own step lengths, and rests once it has converged.
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
        let Some(scale) = to_safe_range(b) else {
            return self.solve_scaled(b, guess, options);
        };
        // Powers of two: exact but for what underflows beside the largest entry.
        let times = |v: &[f64; B]| std::array::from_fn(|lane| v[lane] * scale[lane]);
        let scaled: Vec<[f64; B]> = b.iter().map(times).collect();
        let guess = guess.map(|x| x.iter().map(times).collect());
        let mut solution = self.solve_scaled(&scaled, guess, options)?;
        for x in &mut solution.x {
            for lane in 0..B {
                x[lane] /= scale[lane];
            }
        }
        Ok(solution)
    }

    /// Squares of `b` neither overflow nor underflow.
    fn solve_scaled<const B: usize>(
        &self,
        b: &[[f64; B]],
        guess: Option<Vec<[f64; B]>>,
        options: &CgOptions,
    ) -> Result<CgSolution<Vec<[f64; B]>>, CgError> {
        let rows = Rows::of(self.matrix);
        let mut q = vec![[0.0; B]; b.len()];
        let (mut x, mut r) = match guess {
            None => (vec![[0.0; B]; b.len()], b.to_vec()),
            Some(x) => {
                product::multiply_lanes(rows, &x, &mut q);
                let r = b.iter().zip(&q).map(|(b, q)| sub(b, q)).collect();
                (x, r)
            }
        };
        let goal = reduce::dot(b, b).map(|bb| options.tolerance * bb.sqrt());
        let mut iterations = 0;
        let mut last = [f64::INFINITY; B];
        loop {
            let end = self.descend([&mut x, &mut r, &mut q], &goal, &mut iterations, options);
            // The residual that is carried along departs from the true one: what counts is measured.
            product::multiply_lanes(rows, &x, &mut q);
            for ((r, b), q) in r.iter_mut().zip(b).zip(&q) {
                *r = sub(b, q);
            }
            let found = reduce::dot(&r, &r).map(f64::sqrt);
            let residuals = || relative(&found, b);
            match end {
                Ok(()) => {}
                Err(CgError::NotConverged { .. }) => {
                    let residual = residuals().into_iter().fold(0.0, f64::max);
                    return Err(CgError::NotConverged { iterations, residual });
                }
                Err(error) => return Err(error),
            }
            let floor = if (0..B).any(|lane| found[lane] > goal[lane]) {
                self.attainable(b, &x)
            } else {
                [0.0; B]
            };
            if (0..B).all(|lane| found[lane] <= goal[lane] + floor[lane]) {
                let residuals = residuals();
                return Ok(CgSolution { x, iterations, residuals });
            }
            if (0..B).all(|lane| found[lane].is_nan() || found[lane] > 0.5 * last[lane]) {
                let residual = residuals().into_iter().fold(0.0, f64::max);
                return Err(CgError::NotConverged { iterations, residual });
            }
            last = found;
        }
    }

    /// Iterates until the residual `r` that is carried along meets the goal in every lane.
    fn descend<const B: usize>(
        &self,
        [x, r, q]: [&mut [[f64; B]]; 3],
        goal: &[f64; B],
        iterations: &mut usize,
        options: &CgOptions,
    ) -> Result<(), CgError> {
        let rows = Rows::of(self.matrix);
        let mut z = self.incomplete.as_ref().map(|_| vec![[0.0; B]; r.len()]);
        let mut rz = self.precondition(r, &mut z);
        let mut p: Vec<[f64; B]> = (0..r.len()).map(|i| self.direction(i, r, &z)).collect();
        let mut rr = reduce::dot(r, r);
        while (0..B).any(|lane| rr[lane].sqrt() > goal[lane]) {
            fairing_watch::check();
            if *iterations == options.max_iterations {
                return Err(CgError::NotConverged { iterations: *iterations, residual: 0.0 });
            }
            let pq = reduce::sum1(q, |first, q| multiply_dot(rows, first, &p, q));
            let mut alpha = [0.0; B];
            for lane in (0..B).filter(|&lane| rr[lane].sqrt() > goal[lane]) {
                if pq[lane].is_nan() || pq[lane] <= 0.0 {
                    return Err(CgError::Indefinite {
                        iteration: *iterations,
                        curvature: pq[lane],
                    });
                }
                alpha[lane] = rz[lane] / pq[lane];
            }
            rr = reduce::sum2(x, r, |first, x, r| {
                let mut sum = [0.0; B];
                for (i, (x, r)) in x.iter_mut().zip(r).enumerate() {
                    let (p, q) = (&p[first + i], &q[first + i]);
                    for lane in 0..B {
                        x[lane] += alpha[lane] * p[lane];
                        r[lane] -= alpha[lane] * q[lane];
                        sum[lane] += r[lane] * r[lane];
                    }
                }
                sum
            });
            let next = self.precondition(r, &mut z);
            let beta: [f64; B] = std::array::from_fn(|lane| {
                if rr[lane].sqrt() > goal[lane] { next[lane] / rz[lane] } else { 0.0 }
            });
            rz = next;
            reduce::sum1::<_, 0>(&mut p, |first, p| {
                for (i, p) in p.iter_mut().enumerate() {
                    let z = self.direction(first + i, r, &z);
                    for lane in 0..B {
                        p[lane] = z[lane] + beta[lane] * p[lane];
                    }
                }
                []
            });
            *iterations += 1;
        }
        Ok(())
    }

    /// The residual that rounding alone may leave: 4 ε ‖|A| |x| + |b|‖ in each lane.
    fn attainable<const B: usize>(&self, b: &[[f64; B]], x: &[[f64; B]]) -> [f64; B] {
        let rows = Rows::of(self.matrix);
        let mut squares = [0.0; B];
        for (i, b) in b.iter().enumerate() {
            let mut sum = b.map(f64::abs);
            let (columns, values) = rows.row(i);
            for (&j, &a) in columns.iter().zip(values) {
                for lane in 0..B {
                    sum[lane] += (a * x[j as usize][lane]).abs();
                }
            }
            for lane in 0..B {
                squares[lane] += sum[lane] * sum[lane];
            }
        }
        squares.map(|s| 4.0 * f64::EPSILON * s.sqrt())
    }

    /// rᵀ P⁻¹ r, with P⁻¹ r left in `z` where it is not cheaper to compute it again.
    fn precondition<const B: usize>(
        &self,
        r: &[[f64; B]],
        z: &mut Option<Vec<[f64; B]>>,
    ) -> [f64; B] {
        match (z, &self.incomplete) {
            (Some(z), Some(factor)) => {
                z.copy_from_slice(r);
                factor.solve_in_place(z);
                reduce::dot(r, z)
            }
            _ => reduce::weighted_square(r, &self.inverse_diagonal),
        }
    }

    fn direction<const B: usize>(
        &self,
        i: usize,
        r: &[[f64; B]],
        z: &Option<Vec<[f64; B]>>,
    ) -> [f64; B] {
        match z {
            Some(z) => z[i],
            None => r[i].map(|r| r * self.inverse_diagonal[i]),
        }
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

/// `q` ← rows of A p from `first` on, and Σ p q over them.
fn multiply_dot<const B: usize>(
    rows: Rows<'_>,
    first: usize,
    p: &[[f64; B]],
    q: &mut [[f64; B]],
) -> [f64; B] {
    let mut dot = [0.0; B];
    for (i, q) in q.iter_mut().enumerate() {
        let (columns, values) = rows.row(first + i);
        let mut sum = [0.0; B];
        for (&j, &a) in columns.iter().zip(values) {
            let p = &p[j as usize];
            for lane in 0..B {
                sum[lane] += a * p[lane];
            }
        }
        for lane in 0..B {
            dot[lane] += sum[lane] * p[first + i][lane];
        }
        *q = sum;
    }
    dot
}

/// ‖r‖ / ‖b‖ in each lane; ‖r‖ where b is zero.
fn relative<const B: usize>(r: &[f64; B], b: &[[f64; B]]) -> Vec<f64> {
    let bb = reduce::dot(b, b).map(f64::sqrt);
    (0..B).map(|lane| if bb[lane] > 0.0 { r[lane] / bb[lane] } else { r[lane] }).collect()
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

fn sub<const B: usize>(a: &[f64; B], b: &[f64; B]) -> [f64; B] {
    std::array::from_fn(|lane| a[lane] - b[lane])
}
