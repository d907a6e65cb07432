//! Conjugate gradients with a pointwise preconditioner, for several right-hand sides at once.

use crate::error::SparseError;
use crate::order::larger;
use crate::parallel::{self, update};

/// A symmetric positive definite system A x = b of `B` columns.
///
/// Each column has its own step lengths, unless A or the preconditioner couples columns; then all
/// share one.
pub(crate) trait CgSystem<const B: usize>: Sync {
    /// Overwrites `q` with A p and returns Σᵢ pᵢ qᵢ of each column. `q` has the length of `p`; its
    /// values are arbitrary.
    fn multiply(&self, p: &[[f64; B]], q: &mut [[f64; B]]) -> [f64; B];

    /// Row `i` of P⁻¹ r for a block-diagonal preconditioner P; `r` is row `i` of the residual.
    fn precondition(&self, i: usize, r: [f64; B]) -> [f64; B];

    /// True if A or the preconditioner couples columns.
    fn is_coupled(&self) -> bool;
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
/// [`SparseError::NotConverged`] where `ends`, given the iterations and the residual, is true, or
/// for a residual that is not finite; [`SparseError::NegativeCurvature`]. `x` and the residual are
/// then those of the last iteration.
pub(crate) fn descend<const B: usize, S: CgSystem<B>>(
    system: &S,
    x: &mut [[f64; B]],
    workspace: &mut CgWorkspace<B>,
    done: impl Fn(&[f64; B]) -> [bool; B],
    iterations: &mut usize,
    ends: impl Fn(usize, f64) -> bool,
) -> Result<(), SparseError> {
    let CgWorkspace { r, p, q } = workspace;
    let [mut rr, mut rz] = update(p, |i, _| {
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
        if !residual.is_finite() || ends(*iterations, residual) {
            let (iterations, row) = (*iterations, worst_row(r));
            return Err(SparseError::NotConverged { iterations, residual, row });
        }
        let curvature = system.multiply(p, q);
        let mut alpha = ratios(system, &rz, &curvature);
        for k in 0..B {
            if finished[k] {
                alpha[k] = 0.0;
            } else if !(alpha[k] >= 0.0 && alpha[k].is_finite()) {
                let curvature = curvature[k];
                return Err(SparseError::NegativeCurvature { iteration: *iterations, curvature });
            }
        }
        let old = rz;
        [rr, rz] = update(r, |i, mut r| {
            let q = &q[i];
            for k in 0..B {
                r[k] -= alpha[k] * q[k];
            }
            (r, squares(&r, &system.precondition(i, r)))
        });
        let mut beta = ratios(system, &rz, &old);
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

/// a/b of each column, or of the sums of all where they are coupled; zero over anything is zero.
fn ratios<const B: usize, S: CgSystem<B>>(system: &S, a: &[f64; B], b: &[f64; B]) -> [f64; B] {
    let ratio = |a: f64, b: f64| if a == 0.0 { 0.0 } else { a / b };
    if system.is_coupled() {
        [ratio(a.iter().sum(), b.iter().sum()); B]
    } else {
        std::array::from_fn(|k| ratio(a[k], b[k]))
    }
}

/// A symmetric positive definite operator without a matrix, applied to each coordinate of a vector
/// field and preconditioned by its diagonal.
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
    fn multiply(&self, p: &[[f64; 3]], q: &mut [[f64; 3]]) -> [f64; 3] {
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
    update(q, |i, _| {
        let value = row(i);
        (value, [p[i][0] * value[0], p[i][1] * value[1], p[i][2] * value[2]])
    })
}

/// Stopping criteria of conjugate gradients.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct CgOptions {
    /// Relative residual ‖b − A x‖ / ‖b‖ to reach, over all coordinates.
    pub tolerance: f64,
    /// The largest number of iterations.
    pub max_iterations: usize,
}

impl Default for CgOptions {
    /// 10⁻¹⁰ within 10 000 iterations.
    fn default() -> Self {
        Self { tolerance: 1e-10, max_iterations: 10_000 }
    }
}

/// A solution, converged or not, with the iterations taken and the residual reached.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct CgSolution {
    /// The solution.
    pub x: Vec<[f64; 3]>,
    /// Iterations taken.
    pub iterations: usize,
    /// ‖b − A x‖ / ‖b‖ over all coordinates, as updated by the iteration: rounding adds some ε ‖A‖
    /// ‖x‖ / ‖b‖, so that the tolerance should be well above it.
    pub residual: f64,
}

/// Solves A x = b from the initial guess `x`. The residual of the solution exceeds the tolerance,
/// or is NaN, if the iteration ended early, as it does where A is not positive definite.
///
/// # Examples
///
/// (1 + i) xᵢ = 1:
///
/// ```
/// use fairing_sparse::{CgOptions, FieldOperator, conjugate_gradients, product_by_rows};
/// let diagonal = [1.0, 2.0, 3.0, 4.0];
/// let operator = FieldOperator::new(&[1.0; 4], |p, q| {
///     product_by_rows(p, q, |i| p[i].map(|p| diagonal[i] * p))
/// });
/// let b = [[1.0, 2.0, 0.0]; 4];
/// let options = CgOptions::default();
/// let found = conjugate_gradients(&operator, &b, b.to_vec(), &options);
/// assert!(found.residual <= options.tolerance && (found.x[3][1] - 0.5).abs() < 1e-9);
/// ```
///
/// Source: [hestenes1952], [saad2003].
///
/// [hestenes1952]: https://doi.org/10.6028/jres.049.044
/// [saad2003]: https://doi.org/10.1137/1.9780898718003
#[doc(alias("cg", "pcg"))]
pub fn conjugate_gradients<A>(
    operator: &FieldOperator<A>,
    b: &[[f64; 3]],
    mut x: Vec<[f64; 3]>,
    options: &CgOptions,
) -> CgSolution
where
    A: Fn(&[[f64; 3]], &mut [[f64; 3]]) -> [f64; 3] + Sync,
{
    let root = |squares: &[f64; 3]| squares.iter().sum::<f64>().sqrt();
    let norm = |v: &[[f64; 3]]| root(&parallel::sum(v.len(), |i| v[i].map(|v| v * v)));
    let size = norm(b);
    if size == 0.0 {
        x.fill([0.0; 3]);
    }
    let mut workspace = CgWorkspace::default();
    workspace.resize(b.len());
    let CgWorkspace { r, q, .. } = &mut workspace;
    // A guess of zero leaves b.
    if x.iter().all(|x| *x == [0.0; 3]) {
        r.copy_from_slice(b);
    } else {
        operator.multiply(&x, q);
        update(r, |i, _| (std::array::from_fn(|k| b[i][k] - q[i][k]), ()));
    }
    let goal = options.tolerance * size;
    let done = |squares: &[f64; 3]| [root(squares) <= goal; 3];
    let mut iterations = 0;
    let ends = |iterations, _| iterations >= options.max_iterations;
    // The residual shows a failure.
    let _ = descend(operator, &mut x, &mut workspace, done, &mut iterations, ends);
    let rest = norm(&workspace.r);
    CgSolution { x, iterations, residual: if size > 0.0 { rest / size } else { rest } }
}
