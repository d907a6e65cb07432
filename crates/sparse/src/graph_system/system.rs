//! Systems with the Laplacian of a graph: the choice of a solver.

use std::sync::{Mutex, OnceLock, PoisonError};

use crate::direct::{SymbolicCholesky, Workload};
use crate::error::SparseError;
use crate::graph_laplacian::GraphLaplacian;
use crate::graph_system::equations::{Equations, RightSide};
use crate::graph_system::factored::{Factored, Goal};
use crate::graph_system::iteration::{Projection, Scratch, columns, iterate};
use crate::graph_system::parts::Parts;
use crate::matrix::SparseMatrix;
use crate::order::larger;
use crate::parallel::update;

/// Iterations before a system that cannot be factorised fails.
const MAX_ITERATIONS: usize = 20_000;

/// The condition beyond which systems are always factorised: the smallest eigenvalues, of parts
/// that move nearly as a whole, are then lost to rounding in conjugate gradients.
const ILL_CONDITIONED: f64 = 1e6;

/// The system `(D + tS) x = b` of a diagonal `D ≥ 0` and a graph Laplacian S, with some entries of
/// x given and up to four columns, solved by conjugate gradients or a factorisation.
///
/// S is given by its off-diagonal entries, and its rows act on differences, `(Sx)ᵢ = Σⱼ wᵢⱼ (xᵢ −
/// xⱼ)`. Solutions are refined with residuals in this form, so that they solve the system of the
/// weights, not of a diagonal in which small weights and D are lost to rounding.
///
/// A connected part without given values *floats*: its weighted mean is known, since the sum of
/// `D x` is that of b, but nearly singular systems lose it. Each part is therefore solved about its
/// mean. If D is zero on a floating part, a solution exists only for b of sum zero, up to a
/// constant: the sum of b is subtracted in proportion to the weights, and the weighted mean of x is
/// zero.
///
/// # Examples
///
/// ```
/// use fairing_sparse::{GraphSystem, SparseMatrix};
/// // A path of three vertices: 0 at the first, 1 at the last.
/// let values = vec![1.0, -1.0, -1.0, 2.0, -1.0, -1.0, 1.0];
/// let s = SparseMatrix::new((3, 3), vec![0, 2, 5, 7], vec![0, 1, 0, 1, 2, 1, 2], values);
/// let system = GraphSystem::new(&s, vec![0.0; 3], &[1.0; 3], &[true, false, true], None)?;
/// let mut x = [[0.0], [0.0], [1.0]];
/// system.solve(|_| [0.0], &mut x)?;
/// assert!((x[1][0] - 0.5).abs() < 1e-15 && x[2] == [1.0]);
/// # Ok::<(), fairing_sparse::SparseError>(())
/// ```
#[derive(Debug)]
pub struct GraphSystem {
    equations: Equations,
    goal: Goal,
    /// The number of solves with one operator.
    solves: usize,
    /// True if a factorisation is faster.
    factorises: bool,
    /// Iterations that take as long as a factorisation, which then takes over.
    patience: usize,
    symbolic: Option<SymbolicCholesky>,
    factored: OnceLock<Result<Factored, SparseError>>,
    scratch: Mutex<Scratch>,
}

/// Iterations used and residual reached.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Solved {
    /// Iterations of conjugate gradients; 0 for a factorisation.
    pub iterations: usize,
    /// The largest residual of a column of a connected part, relative to its right-hand side about
    /// the mean, or to the level at which rounding prevents the tolerance if that is larger; 0 for
    /// systems solved to all digits.
    pub residual: f64,
    /// True if the system was factorised in this solve.
    pub factorised: bool,
}

impl GraphSystem {
    /// Factorises D + S for solutions with nearly all digits. Only the off-diagonal entries of `s`
    /// are used; `added` is D, `weights` define the means of parts where D is zero, and x is given
    /// in the rows for which `given` is true. `like` is an existing analysis that is reused if it
    /// fits the pattern of `s`.
    ///
    /// Where the stored matrix has lost too much for refinement, it is replaced by elimination
    /// without subtractions, which is slower by an order of magnitude and, for positive weights,
    /// accurate at any condition number.
    ///
    /// # Errors
    ///
    /// [`SparseError`]; [`IllConditioned`](SparseError::IllConditioned) if no digits would be
    /// correct.
    ///
    /// # Panics
    ///
    /// Panics if `s` is not square and stored by rows, or a length differs from the number of its
    /// rows.
    pub fn new(
        s: &SparseMatrix,
        added: Vec<f64>,
        weights: &[f64],
        given: &[bool],
        like: Option<&SymbolicCholesky>,
    ) -> Result<Self, SparseError> {
        let laplacian = GraphLaplacian::weighted(s, weights.to_vec(), given);
        let mut system = Self::with(laplacian, 1.0, added, given, Goal::Digits);
        system.factorises = true;
        system.factored = Ok(Factored::new(&system.equations, Goal::Digits, like)?).into();
        Ok(system)
    }

    /// A system `D + tS` with t = `step` and D = `added` > 0, to be solved `solves` times to a
    /// residual of `tolerance`, relative to the right-hand side of each column of each connected
    /// part about its mean. The rows of `laplacian` for which `given` is true must be zero.
    ///
    /// Chooses the faster solver by the measured rule of [`Workload`]; a system too ill-conditioned
    /// to iterate is factorised.
    ///
    /// # Panics
    ///
    /// Panics if a length differs from the number of rows of the Laplacian.
    pub fn to_tolerance(
        laplacian: GraphLaplacian,
        step: f64,
        added: Vec<f64>,
        given: &[bool],
        tolerance: f64,
        solves: usize,
    ) -> Self {
        let mut system = Self::with(laplacian, step, added, given, Goal::Residual(tolerance));
        system.solves = solves;
        system.choose(tolerance);
        system
    }

    fn with(
        laplacian: GraphLaplacian,
        step: f64,
        added: Vec<f64>,
        given: &[bool],
        goal: Goal,
    ) -> Self {
        let n = laplacian.len();
        assert_eq!((added.len(), given.len()), (n, n), "sizes of the operands");
        let parts = Parts::new(&laplacian, given);
        Self {
            equations: Equations::new(laplacian, step, added, parts),
            goal,
            solves: 1,
            factorises: false,
            patience: MAX_ITERATIONS,
            symbolic: None,
            factored: OnceLock::new(),
            scratch: Mutex::default(),
        }
    }

    /// Chooses the solver.
    ///
    /// After Jacobi scaling the spectrum lies between the least D/(D + tSᵢᵢ) and about 3/2, so the
    /// condition is at most `3/2 max (1 + t Sᵢᵢ/D)`.
    fn choose(&mut self, tolerance: f64) {
        let Equations { laplacian, step, added, parts, .. } = &self.equations;
        let ratio = |_, i: usize| {
            if parts.is_given(i) { [0.0] } else { [step * laplacian.diagonal()[i] / added[i]] }
        };
        let largest = parts.largest(ratio).into_iter().flatten().fold(0.0, larger);
        let work = Workload::new(laplacian, *step, added, tolerance, self.solves);
        self.patience = work.patience() as usize;
        self.factorises = 1.5 * (1.0 + largest) > ILL_CONDITIONED || work.prefers_factorisation();
    }

    /// Changes S and D, and chooses the solver again; the analysis of the pattern is kept. `change`
    /// receives the Laplacian and D. The connected parts must remain.
    ///
    /// # Errors
    ///
    /// The error of `change`, which leaves the values unspecified.
    pub fn update<T, E>(
        &mut self,
        change: impl FnOnce(&mut GraphLaplacian, &mut Vec<f64>) -> Result<T, E>,
    ) -> Result<T, E> {
        if let Some(Ok(factored)) = self.factored.take() {
            self.symbolic = factored.symbolic();
        }
        let changed = change(&mut self.equations.laplacian, &mut self.equations.added)?;
        self.equations.weigh();
        self.scratch.get_mut().unwrap_or_else(PoisonError::into_inner).inverse.clear();
        if let Goal::Residual(tolerance) = self.goal {
            self.choose(tolerance);
        }
        Ok(changed)
    }

    /// Replaces `x` by the solution for the right-hand side whose row i is `right(i)`. Rows of
    /// given values are kept; the others hold an initial guess, for which conjugate gradients have
    /// to reduce the residual.
    ///
    /// # Errors
    ///
    /// [`SparseError::NotConverged`] if the tolerance is missed,
    /// [`SparseError::IllConditioned`] if fewer than half of the digits would be correct; errors of
    /// the factorisation.
    ///
    /// # Panics
    ///
    /// Panics if the length of `x` differs from the number of rows.
    pub fn solve<const N: usize>(
        &self,
        right: impl Fn(usize) -> [f64; N] + Sync,
        x: &mut [[f64; N]],
    ) -> Result<Solved, SparseError> {
        assert_eq!(x.len(), self.equations.len(), "sizes of the operands");
        if !self.factorises && self.factored.get().is_none() {
            let solved = self.iterate(&right, x, None, self.patience);
            if solved.is_ok() {
                return solved;
            }
        }
        let factorised = self.factored.get().is_none();
        let like = self.symbolic.as_ref();
        let factored =
            self.factored.get_or_init(|| Factored::new(&self.equations, self.goal, like));
        let factored = factored.as_ref().map_err(SparseError::clone)?;
        let centred = self.equations.centred(&right, x);
        let (y, residual) = factored.solve(&centred, self.goal)?;
        let origins = centred.into_origins();
        self.write(&origins, |i| y[i], x);
        Ok(Solved { iterations: 0, residual, factorised })
    }

    /// [`solve`](Self::solve) for a system whose rows change only in the directions that
    /// `project(row, change)` leaves: `P (D + tS) P d = P (b − (D + tS) x)` for the change d of the
    /// initial guess `x` and the orthogonal projection P of each row. P couples columns, so the
    /// system is solved by conjugate gradients.
    ///
    /// # Errors
    ///
    /// [`SparseError::NotConverged`] if the tolerance is missed.
    ///
    /// # Panics
    ///
    /// Panics if the length of `x` differs from the number of rows.
    pub fn solve_along<const N: usize>(
        &self,
        right: impl Fn(usize) -> [f64; N] + Sync,
        x: &mut [[f64; N]],
        project: impl Fn(usize, [f64; N]) -> [f64; N] + Sync,
    ) -> Result<Solved, SparseError> {
        assert_eq!(x.len(), self.equations.len(), "sizes of the operands");
        self.iterate(&right, x, Some(&project), MAX_ITERATIONS)
    }

    fn iterate<const N: usize>(
        &self,
        right: RightSide<'_, N>,
        x: &mut [[f64; N]],
        project: Option<Projection<'_, N>>,
        limit: usize,
    ) -> Result<Solved, SparseError> {
        let tolerance = match self.goal {
            Goal::Residual(tolerance) => tolerance,
            Goal::Digits => f64::EPSILON,
        };
        let scratch = || self.scratch.lock().unwrap_or_else(PoisonError::into_inner);
        let mut own = std::mem::take(&mut *scratch());
        let centred = self.equations.centred(right, x);
        let (iterations, residual) = iterate(&centred, project, (tolerance, limit), &mut own)?;
        let origins = centred.into_origins();
        self.write(&origins, |i| columns(own.y[i]), x);
        *scratch() = own;
        Ok(Solved { iterations, residual, factorised: false })
    }

    /// Writes solutions about the origins of the parts to the rows that are not given.
    fn write<const N: usize>(
        &self,
        origins: &[[f64; N]],
        y: impl Fn(usize) -> [f64; N] + Sync,
        x: &mut [[f64; N]],
    ) {
        let parts = &self.equations.parts;
        update(x, |i, x| {
            let (y, origin) = (y(i), &origins[parts.part(i)]);
            if parts.is_given(i) {
                (x, ())
            } else {
                (std::array::from_fn(|k| origin[k] + y[k]), ())
            }
        });
    }

    /// S, zero in the rows of given values.
    pub fn laplacian(&self) -> &GraphLaplacian {
        &self.equations.laplacian
    }

    /// An estimate of the condition of the matrix scaled to a unit diagonal, in the maximum norm,
    /// with one vertex of each floating part grounded: twice the norm of `A⁻¹ diag A`, for systems
    /// made by [`new`](Self::new).
    ///
    /// It bounds the effect of perturbing the entries. Solutions are more accurate, because they
    /// are refined with residuals of the weights.
    pub fn condition(&self) -> f64 {
        match self.factored.get() {
            Some(Ok(factored)) => factored.condition(),
            _ => f64::INFINITY,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::matrix::from_triplets;

    /// The stiffness of weighted edges.
    fn laplacian(n: usize, edges: &[(usize, usize, f64)]) -> SparseMatrix {
        let entries = |&(i, j, w): &(usize, usize, f64)| {
            let (i, j) = (i as u32, j as u32);
            [(i, i, w), (j, j, w), (i, j, -w), (j, i, -w)]
        };
        let entries: Vec<(u32, u32, f64)> = edges.iter().flat_map(entries).collect();
        from_triplets((n, n), &entries).unwrap()
    }

    /// A ladder of stiff rungs and weak rails with 0 at its foot and 1 at its head has a linear
    /// solution, whatever the ratio of stiffnesses.
    #[test]
    fn ratios_cost_no_digits() {
        for rail in [1.0, 1e-6, 1e-10, 1e-14, 1e-20, 1e-100] {
            let n = 500;
            let mut edges: Vec<_> = (0..n).map(|i| (2 * i, 2 * i + 1, 1.0)).collect();
            edges.extend((0..2 * n - 2).map(|v| (v, v + 2, rail)));
            let mut given = vec![false; 2 * n];
            given[0] = true;
            given[2 * n - 1] = true;
            let s = laplacian(2 * n, &edges);
            let system = GraphSystem::new(&s, vec![0.0; 2 * n], &vec![1.0; 2 * n], &given, None);
            let mut x = vec![[0.0]; 2 * n];
            x[2 * n - 1] = [1.0];
            system.unwrap().solve(|_| [0.0], &mut x).unwrap();
            let x = x.as_flattened();
            for (v, x) in x.iter().enumerate().filter(|_| rail < 1e-5) {
                // The rungs at the ends carry the current of one rail.
                let exact = (v / 2) as f64 / (n - 1) as f64;
                assert!((x - exact).abs() < 1e-5, "{rail:e} {v}: {x} {exact}");
            }
            // Symmetry of the ladder.
            for v in 0..2 * n {
                assert!((x[v] + x[2 * n - 1 - v] - 1.0).abs() < 1e-9, "{rail:e} {v}");
            }
        }
    }

    /// The negative weight of an edge cancels the conductance of a detour of two edges up to
    /// rounding.
    #[test]
    fn lost_digits_are_an_error() {
        let edges = [(0, 1, 0.3), (1, 2, 0.7), (0, 2, -0.21 * (1.0 - 4e-16)), (2, 3, 1.0)];
        let s = laplacian(4, &edges);
        let given = [true, false, false, false];
        let system = GraphSystem::new(&s, vec![0.0; 4], &[1.0; 4], &given, None);
        let right = |i: usize| [if i == 3 { 1.0 } else { 0.0 }];
        let found = system.and_then(|system| system.solve(right, &mut [[0.0]; 4]));
        assert!(found.is_err(), "{found:?}");
    }

    /// Of two triangles, one has no given value. Without D its mean is zero, and the sum of b is
    /// subtracted in proportion to the weights.
    #[test]
    fn parts_float_about_their_means() {
        let triangle = |v: usize| [(v, v + 1, 1.0), (v + 1, v + 2, 2.0), (v, v + 2, 3.0)];
        let s = laplacian(6, &[triangle(0), triangle(3)].concat());
        let given = [true, false, false, false, false, false];
        let weights = [1.0, 1.0, 1.0, 1.0, 2.0, 1.0];
        for added in [0.0, 1e-3, 10.0] {
            let added = [0.0, 0.0, 0.0, added, 2.0 * added, added];
            let system = GraphSystem::new(&s, added.to_vec(), &weights, &given, None).unwrap();
            let b = [0.0, 1.0, 2.0, 4.0, 0.0, 0.0];
            let mut x = [[5.0], [0.0], [0.0], [0.0], [0.0], [0.0]];
            system.solve(|i| [b[i]], &mut x).unwrap();
            let x = x.as_flattened();
            assert_eq!(x[0], 5.0);
            let (mean, mass) = (x[3] + 2.0 * x[4] + x[5], added[3]);
            let expected = if mass > 0.0 { 4.0 / mass } else { 0.0 };
            assert!((mean - expected).abs() <= 1e-14 * expected.max(1.0), "{mean} {expected}");
            let image = crate::multiply(&s, x);
            for v in [1, 2, 3, 4, 5] {
                let balance = if v < 3 || mass > 0.0 { 0.0 } else { weights[v] };
                let found = image[v] + added[v] * x[v];
                // A few roundings of numbers of the size of x.
                let size = x.iter().fold(10.0, |m: f64, x| m.max(x.abs()));
                assert!((found - (b[v] - balance)).abs() < 1e-14 * size, "{v}: {found}");
            }
        }
    }

    /// Two grids of very different weights, a billion apart, one with given values, and columns of
    /// very different sizes: iterated for short and factorised for long times, each column of each
    /// part is as accurate as if alone.
    #[test]
    fn both_solvers_meet_the_tolerance_in_every_part_and_column() {
        let (side, n) = (12, 144);
        let mut edges = vec![];
        for part in 0..2 {
            let weight = [1.0, 1e-6][part];
            for (y, x) in (0..side).flat_map(|y| (0..side).map(move |x| (y, x))) {
                let v = part * n + y * side + x;
                let w = weight * (1.0 + (v % 5) as f64);
                edges.extend((x + 1 < side).then_some((v, v + 1, w)));
                edges.extend((y + 1 < side).then_some((v, v + side, w)));
            }
        }
        let s = laplacian(2 * n, &edges);
        let mut given = vec![false; 2 * n];
        given[3] = true;
        given[100] = true;
        let mass: Vec<f64> =
            (0..2 * n).map(|v| [1.0, 1e-6][v / n] * (1.0 + (v % 3) as f64)).collect();
        let sizes = [1.0, 1e-8, 1e30];
        let start = |v: usize| {
            let far = [0.0, 1e9][v / n];
            let noise = [1.3, 2.9, 7.7].map(|f: f64| (f * v as f64).sin());
            std::array::from_fn::<f64, 3, _>(|k| sizes[k] * (far + noise[k]))
        };
        for (t, factorised) in [(0.5, false), (1e5, true)] {
            let weighted = GraphLaplacian::weighted(&s, mass.clone(), &given);
            let system = GraphSystem::to_tolerance(weighted, t, mass.clone(), &given, 1e-10, 1);
            let mut x: Vec<[f64; 3]> = (0..2 * n).map(start).collect();
            let right = |v: usize| start(v).map(|x| mass[v] * x);
            let solved = system.solve(right, &mut x).unwrap();
            assert_eq!((solved.factorised, solved.iterations == 0), (factorised, factorised));
            assert!(solved.residual <= 1e-10);
            let exact =
                GraphSystem::new(&s.map(|s| t * s), mass.clone(), &mass, &given, None).unwrap();
            for k in 0..3 {
                let mut column: Vec<[f64; 1]> = (0..2 * n).map(|v| [start(v)[k]]).collect();
                exact.solve(|v| [mass[v] * start(v)[k]], &mut column).unwrap();
                for (v, (x, [y])) in x.iter().zip(&column).enumerate() {
                    // The tolerance and, far from zero, the rounding of values near a billion.
                    let most = sizes[k] * [1e-8, 1e-6][v / n];
                    assert!((x[k] - y).abs() < most, "t = {t}, row {v}, column {k}: {x:?} {y}");
                }
            }
            // A factor serves all later solves.
            assert!(!system.solve(right, &mut x).unwrap().factorised);
        }
    }

    /// Rows that move along a line only: the change is along the line, and the residual is
    /// perpendicular to it.
    #[test]
    fn projected_changes_solve_the_projected_system() {
        let n = 30;
        let edges: Vec<_> = (0..n - 1).map(|v| (v, v + 1, 1.0 + (v % 4) as f64)).collect();
        let s = laplacian(n, &edges);
        let (mass, given) = (vec![0.5; n], vec![false; n]);
        let weighted = GraphLaplacian::weighted(&s, mass.clone(), &given);
        let system = GraphSystem::to_tolerance(weighted, 1.0, mass, &given, 1e-12, 1);
        let start = |v: usize| [(3.1 * v as f64).sin(), (1.7 * v as f64).cos(), v as f64];
        let project = |v: usize, d: [f64; 3]| match v % 3 {
            0 => [0.6, 0.0, 0.8].map(|t| t * (0.6 * d[0] + 0.8 * d[2])),
            _ => d,
        };
        let mut x: Vec<[f64; 3]> = (0..n).map(start).collect();
        system.solve_along(|v| start(v).map(|x| 0.5 * x), &mut x, project).unwrap();
        let images: Vec<Vec<f64>> = (0..3)
            .map(|k| crate::multiply(&s, &x.iter().map(|x| x[k]).collect::<Vec<f64>>()))
            .collect();
        for v in 0..n {
            let d = std::array::from_fn(|k| x[v][k] - start(v)[k]);
            let r = project(v, std::array::from_fn(|k| 0.5 * d[k] + images[k][v]));
            let along = project(v, d);
            for k in 0..3 {
                assert!((d[k] - along[k]).abs() < 1e-13 && r[k].abs() < 1e-10, "{v}: {d:?} {r:?}");
            }
        }
    }
}
