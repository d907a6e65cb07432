//! Conjugate gradients with the diagonal or another pointwise preconditioner, for several
//! right-hand sides at once.

use crate::error::SparseError;
use crate::matrix::{Rows, SparseMatrix};
use crate::order::larger;
use crate::parallel;

/// A symmetric positive definite system A x = b of `B` columns, to be solved by
/// [`conjugate_gradients`].
///
/// Each column has its own step lengths, unless A or the preconditioner couples columns; then all
/// share one.
pub trait CgSystem<const B: usize>: Sync {
    /// Overwrites `q` with A p and returns Σᵢ pᵢ qᵢ of each column. `q` has the length of `p`; its
    /// values are arbitrary.
    fn multiply(&self, p: &[[f64; B]], q: &mut Vec<[f64; B]>) -> [f64; B];

    /// Row `i` of P⁻¹ r for a block-diagonal preconditioner P; `r` is row `i` of the residual.
    fn precondition(&self, i: usize, r: [f64; B]) -> [f64; B];

    /// True if A or the preconditioner couples columns.
    fn is_coupled(&self) -> bool {
        false
    }

    /// The residual norm that rounding alone may leave in each column of a solution.
    fn attainable(&self, b: &[[f64; B]], x: &[[f64; B]]) -> [f64; B] {
        let _ = (b, x);
        [0.0; B]
    }
}

/// Stopping criteria of conjugate gradients.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct CgOptions {
    /// Relative residual ‖b − A x‖ / ‖b‖ to reach in every column, or over all columns where they
    /// are coupled. A residual within [`CgSystem::attainable`] also counts as converged;
    /// [`CgSolution::residuals`] holds the values reached.
    pub tolerance: f64,
    /// The largest number of iterations.
    pub max_iterations: usize,
    /// Measures the true residual at the end, by one more product, and iterates further where
    /// rounding has made it larger than that of the recurrence. A caller that passes the solution
    /// as the next initial guess can do without, since every solve begins by measuring.
    pub measure: bool,
}

impl Default for CgOptions {
    /// 10⁻¹⁰ within 10 000 iterations, measured.
    fn default() -> Self {
        Self { tolerance: 1e-10, max_iterations: 10_000, measure: true }
    }
}

/// A solution, the iterations taken and the residuals reached.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct CgSolution<X> {
    /// The solution.
    pub x: X,
    /// Iterations taken.
    pub iterations: usize,
    /// ‖b − A x‖ / ‖b‖ of each column, or over all columns where they are coupled; measured at the
    /// end unless [`CgOptions::measure`] is off.
    pub residuals: Vec<f64>,
}

/// Memory of an iteration, reusable by consecutive solves.
#[derive(Debug, Clone, Default)]
pub(crate) struct CgWorkspace<const B: usize> {
    /// The residual b − A x.
    pub(crate) r: Vec<[f64; B]>,
    /// The search direction.
    pub(crate) p: Vec<[f64; B]>,
    /// A p.
    pub(crate) q: Vec<[f64; B]>,
}

impl<const B: usize> CgWorkspace<B> {
    /// Resizes the arrays to `rows`; their values are unspecified.
    pub(crate) fn resize(&mut self, rows: usize) {
        for all in [&mut self.r, &mut self.p, &mut self.q] {
            all.resize(rows, [0.0; B]);
        }
    }
}

/// Iterates `x`, whose residual is `workspace.r`, until `done`, given the squared residual norm of
/// each column, is true for all of them. Columns that are done do not change any more.
///
/// The residual is that of the recurrence, which departs from b − A x by rounding: callers measure
/// it at the end and call again if it is too large. `iterations` continues to count.
///
/// # Errors
///
/// [`SparseError::NotConverged`] after `max_iterations` iterations or for a residual that is not
/// finite; [`SparseError::NegativeCurvature`]. `x` and the residual are then those of the last
/// iteration.
pub(crate) fn descend<const B: usize, S: CgSystem<B>>(
    system: &S,
    x: &mut [[f64; B]],
    workspace: &mut CgWorkspace<B>,
    done: impl Fn(&[f64; B]) -> [bool; B],
    iterations: &mut usize,
    max_iterations: usize,
) -> Result<(), SparseError> {
    let CgWorkspace { r, p, q } = workspace;
    let [mut rr, mut rz] = parallel::update(p, |i, _| {
        let (r, z) = (&r[i], system.precondition(i, r[i]));
        (z, squares(r, &z))
    });
    loop {
        let finished = done(&rr);
        if finished.iter().all(|finished| *finished) {
            return Ok(());
        }
        fairing_watch::check();
        let residual = rr.iter().map(|rr| rr.sqrt()).fold(0.0, larger);
        if *iterations == max_iterations || !residual.is_finite() {
            let (iterations, row) = (*iterations, worst_row(r));
            return Err(SparseError::NotConverged { iterations, residual, row });
        }
        let curvature = system.multiply(p, q);
        let ratios = |above: &[f64; B], below: &[f64; B]| {
            if system.is_coupled() {
                [ratio(above.iter().sum(), below.iter().sum()); B]
            } else {
                std::array::from_fn(|k| ratio(above[k], below[k]))
            }
        };
        let mut alpha = ratios(&rz, &curvature);
        for k in 0..B {
            if finished[k] {
                alpha[k] = 0.0;
            } else if !(alpha[k] >= 0.0 && alpha[k].is_finite()) {
                let curvature = curvature[k];
                return Err(SparseError::NegativeCurvature { iteration: *iterations, curvature });
            }
        }
        let old = rz;
        [rr, rz] = parallel::update(r, |i, mut r| {
            let q = &q[i];
            for k in 0..B {
                r[k] -= alpha[k] * q[k];
            }
            (r, squares(&r, &system.precondition(i, r)))
        });
        let mut beta = ratios(&rz, &old);
        for k in (0..B).filter(|&k| finished[k]) {
            beta[k] = 0.0;
        }
        parallel::update_both(x, p, |i, x, p| {
            let z = system.precondition(i, r[i]);
            for k in 0..B {
                x[k] += alpha[k] * p[k];
                p[k] = z[k] + beta[k] * p[k];
            }
        });
        *iterations += 1;
    }
}

/// The row of the largest entry.
pub(crate) fn worst_row<const B: usize>(r: &[[f64; B]]) -> usize {
    let size = |r: &[f64; B]| r.iter().map(|r| r.abs()).fold(0.0, larger);
    (0..r.len()).max_by(|&a, &b| size(&r[a]).total_cmp(&size(&r[b]))).unwrap_or(0)
}

/// Row i of r² and of r z, for each column.
#[inline(always)]
fn squares<const B: usize>(r: &[f64; B], z: &[f64; B]) -> [[f64; B]; 2] {
    let mut sums = [[0.0; B]; 2];
    for k in 0..B {
        sums[0][k] = r[k] * r[k];
        sums[1][k] = r[k] * z[k];
    }
    sums
}

/// a/b, where zero over anything is zero.
fn ratio(a: f64, b: f64) -> f64 {
    if a == 0.0 { 0.0 } else { a / b }
}

/// Solves A x = b from the initial guess `x`. Returns the solution found with its residuals, and
/// the failure if it misses the tolerance.
///
/// # Examples
///
/// Without a matrix, (1 + i) xᵢ = 1:
///
/// ```
/// use fairing_sparse::{CgOptions, CgSystem, conjugate_gradients};
/// struct Diagonal;
/// impl CgSystem<1> for Diagonal {
///     fn multiply(&self, p: &[[f64; 1]], q: &mut Vec<[f64; 1]>) -> [f64; 1] {
///         *q = p.iter().enumerate().map(|(i, [p])| [(1 + i) as f64 * p]).collect();
///         [p.iter().zip(q).map(|([p], [q])| p * *q).sum()]
///     }
///     fn precondition(&self, _: usize, r: [f64; 1]) -> [f64; 1] {
///         r
///     }
/// }
/// let b = [[1.0]; 4];
/// let (found, failure) = conjugate_gradients(&Diagonal, &b, b.to_vec(), &CgOptions::default());
/// assert!(failure.is_none() && (found.x[3][0] - 0.25).abs() < 1e-9);
/// ```
///
/// Source: [hestenes1952], [saad2003].
///
/// [hestenes1952]: https://doi.org/10.6028/jres.049.044
/// [saad2003]: https://doi.org/10.1137/1.9780898718003
pub fn conjugate_gradients<const B: usize, S: CgSystem<B>>(
    system: &S,
    b: &[[f64; B]],
    x: Vec<[f64; B]>,
    options: &CgOptions,
) -> (CgSolution<Vec<[f64; B]>>, Option<SparseError>) {
    let squared = |v: &[[f64; B]]| {
        let sums: [f64; B] = parallel::sum(v.len(), |i| v[i].map(|v| v * v));
        if system.is_coupled() { [sums.iter().sum(); B] } else { sums }
    };
    let size = squared(b).map(f64::sqrt);
    let goal = size.map(|b| options.tolerance * b);
    let together =
        |rr: &[f64; B]| if system.is_coupled() { [rr.iter().sum::<f64>(); B] } else { *rr };
    let small = |rr: &[f64; B]| {
        let rr = together(rr);
        std::array::from_fn(|k| rr[k].sqrt() <= goal[k])
    };
    let mut workspace = CgWorkspace::default();
    workspace.resize(b.len());
    let (mut x, mut iterations, mut last) = (x, 0, [f64::INFINITY; B]);
    if size == [0.0; B] {
        x.fill([0.0; B]);
    }
    // A guess of zero leaves b.
    let zero = x.iter().all(|x| *x == [0.0; B]);
    let mut found = if zero {
        workspace.r.copy_from_slice(b);
        size
    } else {
        residual(system, b, &x, &mut workspace, squared)
    };
    let failure = loop {
        let most = options.max_iterations;
        let end = descend(system, &mut x, &mut workspace, small, &mut iterations, most);
        if !options.measure {
            found = squared(&workspace.r).map(f64::sqrt);
        }
        // The residual of the recurrence departs from the true one, which decides.
        if options.measure && iterations > 0 {
            found = residual(system, b, &x, &mut workspace, squared);
        }
        let worst = || relative(&found, &size).into_iter().fold(0.0, larger);
        match end {
            Ok(()) => {}
            Err(SparseError::NotConverged { .. }) => {
                let (residual, row) = (worst(), worst_row(&workspace.r));
                break Some(SparseError::NotConverged { iterations, residual, row });
            }
            other => break other.err(),
        }
        let missed = (0..B).any(|k| found[k] > goal[k]);
        let floor = if missed { system.attainable(b, &x) } else { [0.0; B] };
        if !options.measure || (0..B).all(|k| found[k] <= goal[k] + floor[k]) {
            break None;
        }
        if (0..B).all(|k| found[k].is_nan() || found[k] > 0.5 * last[k]) {
            let (residual, row) = (worst(), worst_row(&workspace.r));
            break Some(SparseError::NotConverged { iterations, residual, row });
        }
        last = found;
    };
    (CgSolution { x, iterations, residuals: relative(&found, &size) }, failure)
}

/// Writes b − A x into the workspace and returns its norm in each column.
fn residual<const B: usize, S: CgSystem<B>>(
    system: &S,
    b: &[[f64; B]],
    x: &[[f64; B]],
    workspace: &mut CgWorkspace<B>,
    squared: impl Fn(&[[f64; B]]) -> [f64; B],
) -> [f64; B] {
    system.multiply(x, &mut workspace.q);
    let q = &workspace.q;
    parallel::update(&mut workspace.r, |i, _| (std::array::from_fn(|k| b[i][k] - q[i][k]), ()));
    squared(&workspace.r).map(f64::sqrt)
}

/// ‖r‖ / ‖b‖ of each column; ‖r‖ where b is zero.
fn relative<const B: usize>(r: &[f64; B], b: &[f64; B]) -> Vec<f64> {
    (0..B).map(|k| if b[k] > 0.0 { r[k] / b[k] } else { r[k] }).collect()
}

/// A conjugate gradient solver for a symmetric positive definite matrix, preconditioned by its
/// diagonal.
///
/// [`Workload`](crate::Workload) decides whether a factorisation is faster.
///
/// # Examples
///
/// ```
/// use fairing_sparse::{CgOptions, ConjugateGradient, SparseMatrix};
/// let a = SparseMatrix::new((2, 2), vec![0, 2, 4], vec![0, 1, 0, 1], vec![2.0, -1.0, -1.0, 2.0]);
/// let cg = ConjugateGradient::new(&a)?;
/// let solution = cg.solve(&[1.0, 1.0], None, &CgOptions::default())?;
/// assert!((solution.x[0] - 1.0).abs() < 1e-12);
/// # Ok::<(), fairing_sparse::SparseError>(())
/// ```
///
/// Source: [hestenes1952], [saad2003].
///
/// [hestenes1952]: https://doi.org/10.6028/jres.049.044
/// [saad2003]: https://doi.org/10.1137/1.9780898718003
#[doc(alias("cg", "pcg"))]
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
    /// [`SparseError::Size`] if the matrix is not square, [`SparseError::Diagonal`] for the first
    /// diagonal entry that is not positive and finite. Symmetry is not checked.
    pub fn new(matrix: &'a SparseMatrix) -> Result<Self, SparseError> {
        let (rows, columns) = (matrix.rows(), matrix.cols());
        if rows != columns {
            return Err(SparseError::Size { rows, columns, length: rows });
        }
        let diagonal = Rows::new(matrix).diagonal();
        let bad = |d: &f64| !(*d > 0.0 && d.is_finite());
        match diagonal.iter().position(bad) {
            Some(row) => Err(SparseError::Diagonal { row, value: diagonal[row] }),
            None => {
                let inverse_diagonal = diagonal.into_iter().map(|d| 1.0 / d).collect();
                Ok(Self { matrix, inverse_diagonal })
            }
        }
    }

    /// The solution x of A x = b, iterated from `guess` or from zero.
    ///
    /// # Errors
    ///
    /// [`SparseError`]: sizes, numbers that are not finite, an indefinite matrix, no convergence.
    pub fn solve(
        &self,
        b: &[f64],
        guess: Option<&[f64]>,
        options: &CgOptions,
    ) -> Result<CgSolution<Vec<f64>>, SparseError> {
        let wrap = |v: &[f64]| v.iter().map(|&v| [v]).collect::<Vec<_>>();
        let solution = self.solve_lanes(&wrap(b), guess.map(wrap), options)?;
        Ok(CgSolution {
            x: solution.x.into_iter().map(|[x]| x).collect(),
            iterations: solution.iterations,
            residuals: solution.residuals,
        })
    }

    /// The solution X of A X = B for points, one per row. The three columns share every pass over
    /// the matrix; each has its own step lengths and stops changing once it has converged.
    ///
    /// # Errors
    ///
    /// [`SparseError`]: sizes, numbers that are not finite, an indefinite matrix, no convergence.
    pub fn solve_points(
        &self,
        b: &[[f64; 3]],
        guess: Option<&[[f64; 3]]>,
        options: &CgOptions,
    ) -> Result<CgSolution<Vec<[f64; 3]>>, SparseError> {
        self.solve_lanes(b, guess.map(<[_]>::to_vec), options)
    }

    fn solve_lanes<const B: usize>(
        &self,
        b: &[[f64; B]],
        guess: Option<Vec<[f64; B]>>,
        options: &CgOptions,
    ) -> Result<CgSolution<Vec<[f64; B]>>, SparseError> {
        self.check(b)?;
        if let Some(guess) = &guess {
            self.check(guess)?;
        }
        let guess = guess.unwrap_or_else(|| vec![[0.0; B]; b.len()]);
        match conjugate_gradients(self, b, guess, options) {
            (solution, None) => Ok(solution),
            (_, Some(error)) => Err(error),
        }
    }

    fn check<const B: usize>(&self, v: &[[f64; B]]) -> Result<(), SparseError> {
        let rows = self.matrix.rows();
        if v.len() != rows {
            return Err(SparseError::Size { rows, columns: rows, length: v.len() });
        }
        match v.iter().position(|v| v.iter().any(|v| !v.is_finite())) {
            Some(row) => Err(SparseError::VectorNotFinite { row }),
            None => Ok(()),
        }
    }
}

impl<const B: usize> CgSystem<B> for ConjugateGradient<'_> {
    fn multiply(&self, p: &[[f64; B]], q: &mut Vec<[f64; B]>) -> [f64; B] {
        let rows = Rows::new(self.matrix);
        parallel::update(q, |i, _| {
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
        let squares: [f64; B] = parallel::sum(b.len(), |i| {
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

/// A matrix-free scalar operator applied to each coordinate of a vector field, preconditioned by
/// its diagonal.
///
/// Coordinates share their step lengths, so that rotating the field rotates the solution.
#[derive(Debug)]
pub struct FieldOperator<A> {
    apply: A,
    inverse_diagonal: Vec<f64>,
}

impl<A: Fn(&[[f64; 3]], &mut [[f64; 3]]) -> [f64; 3] + Sync> FieldOperator<A> {
    /// The operator of `apply(p, q)`, which writes A p into `q` and returns Σ p q of each
    /// coordinate ([`product_by_rows`]), and of the positive diagonal of A.
    pub fn new(diagonal: &[f64], apply: A) -> Self {
        Self { apply, inverse_diagonal: diagonal.iter().map(|d| 1.0 / d).collect() }
    }
}

impl<A: Fn(&[[f64; 3]], &mut [[f64; 3]]) -> [f64; 3] + Sync> CgSystem<3> for FieldOperator<A> {
    fn multiply(&self, p: &[[f64; 3]], q: &mut Vec<[f64; 3]>) -> [f64; 3] {
        (self.apply)(p, q)
    }

    #[inline]
    fn precondition(&self, i: usize, r: [f64; 3]) -> [f64; 3] {
        r.map(|r| r * self.inverse_diagonal[i])
    }

    fn is_coupled(&self) -> bool {
        true
    }
}

/// Overwrites `q` with A p, given the rows of A p, and returns Σ p q of each coordinate.
pub fn product_by_rows(
    p: &[[f64; 3]],
    q: &mut [[f64; 3]],
    row: impl Fn(usize) -> [f64; 3] + Sync,
) -> [f64; 3] {
    parallel::update(q, |i, _| {
        let value = row(i);
        (value, [p[i][0] * value[0], p[i][1] * value[1], p[i][2] * value[2]])
    })
}
