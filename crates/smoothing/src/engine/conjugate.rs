//! Conjugate gradients for one implicit step, all three coordinates together.

use std::borrow::Cow;

use fairing_sparse::parallel::{CHUNK, sum, update, update_both};
use fairing_sparse::{CgSystem, CgWorkspace, GraphLaplacian, Padded, descend, larger};
use rayon::prelude::*;

use crate::engine::constraints::Freedom;
use crate::engine::error::FlowFailure;
use crate::engine::parts::{Gauge, Parts, reciprocal};

type Point = [f64; 3];

/// The system `P (M(1 + w) + t S) P d = P (M w (c − x) − t S x)` for the displacement `d` of one
/// implicit step.
///
/// `P` projects displacements onto those that constraints allow: zero at fixed vertices, the
/// tangent at sliding vertices. The solver is conjugate gradients, preconditioned by the diagonal
/// and started at the displacement of the previous step. Each coordinate has its own coefficients
/// unless sliding vertices couple them.
///
/// A solution is accepted when the residual of each coordinate in each part of the mesh is below
/// the tolerance relative to its own right-hand side about the centre of the part, or at the level
/// of rounding ([`Gauge`]). Accuracy thus does not suffer far from the origin, nor in the thin
/// direction of a flat mesh. The accepted residual is computed from the solution, not taken from
/// the recurrence. Parts that move as a whole are shifted to their known weighted mean.
#[derive(Clone, Copy)]
pub(crate) struct ImplicitSolver<'a> {
    pub(crate) laplacian: &'a GraphLaplacian,
    pub(crate) parts: &'a Parts,
    pub(crate) step: f64,
    pub(crate) tolerance: f64,
    pub(crate) max_iterations: usize,
}

/// Iterations used and residual reached.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Solved {
    pub(crate) iterations: usize,
    pub(crate) residual: f64,
}

/// Memory shared by the steps of a run; clearing it in every step would take longer than an
/// iteration.
#[derive(Default)]
pub(crate) struct Workspace {
    d: Vec<Padded>,
    cg: CgWorkspace<4>,
    inverse: Vec<f64>,
}

/// Largest number of restarts after the measured residual turned out larger than that of the
/// recurrence.
const MAX_RESTARTS: usize = 3;

impl<'a> ImplicitSolver<'a> {
    /// Solves for `d`, starting from `guess`, which receives the solution.
    pub(crate) fn solve(
        &self,
        x: &[Point],
        freedom: &Freedom,
        guess: &mut [Point],
        workspace: &mut Workspace,
    ) -> Result<Solved, FlowFailure> {
        let centres = self.parts.centres(self.laplacian.mass(), x, freedom);
        workspace.d.resize(x.len(), [0.0; 4]);
        workspace.cg.resize(x.len());
        let Workspace { d, cg, inverse } = workspace;
        let system = System::new(*self, x, freedom, &centres, inverse);
        system.begin(guess, d, &mut cg.p);
        let (mut iterations, limit) = (0, self.max_iterations);
        let done = |squares: &Padded| [root(squares) <= self.tolerance; 4];
        for restart in 0..=MAX_RESTARTS {
            let squares = system.residual(d, &cg.p, &mut cg.r);
            if restart > 0 && root(&squares) <= self.tolerance {
                system.end(d, guess);
                let residual = system.gauge.reported_in_units(&cg.r, &squares);
                return Ok(Solved { iterations, residual });
            }
            if restart < MAX_RESTARTS {
                descend(&system, d, cg, done, &mut iterations, limit)
                    .map_err(|_| system.not_converged(iterations, &cg.r))?;
                system.settle(d, &mut cg.p);
            }
        }
        Err(system.not_converged(iterations, &cg.r))
    }

    /// The scale of residuals of the step at `x`: `M (x − c̄ + w (c − c̄))` about the centres c̄.
    fn gauge(&self, x: &[Point], freedom: &Freedom, centres: &[Point]) -> Gauge<'a> {
        let both = self.parts.sums_and_largest(|part, i| {
            let ((w, target), c) = (freedom.pull(i), centres[part]);
            let reach = |k: usize| {
                let pull = if w > 0.0 { (target[k] - c[k]).abs() } else { 0.0 };
                larger((x[i][k] - c[k]).abs(), pull)
            };
            (self.side(x, freedom, c, i), [reach(0), reach(1), reach(2)])
        });
        let (sides, mut reach): (Vec<_>, Vec<_>) = both.into_iter().unzip();
        // Fixed vertices are neighbours of every part that is not free.
        if let Some(&fixed) = reach.last() {
            for (reach, _) in reach.iter_mut().zip(self.parts.free()).filter(|(_, free)| !free) {
                *reach = [0, 1, 2].map(|k| larger(reach[k], fixed[k]));
            }
        }
        Gauge::new(self.parts, &sides, &reach, self.tolerance, freedom.sliding.is_some())
    }

    /// The squared norms of `M (x − c̄ + w (c − c̄))` and of the coefficients of the rows, for
    /// [`Gauge::new`].
    pub(crate) fn sides(&self, x: &[Point], freedom: &Freedom, centres: &[Point]) -> Vec<[f64; 4]> {
        self.parts.sums(|part, i| self.side(x, freedom, centres[part], i))
    }

    /// The contribution of vertex `i` to [`Self::sides`].
    #[inline(always)]
    fn side(&self, x: &[Point], freedom: &Freedom, centre: Point, i: usize) -> [f64; 4] {
        let ((w, target), m) = (freedom.pull(i), self.laplacian.mass()[i]);
        let term = if freedom.fixed[i] {
            0.0
        } else {
            m * (1.0 + w) + 2.0 * self.step * self.laplacian.diagonal()[i]
        };
        let side = |k: usize| {
            let pull = if w > 0.0 { w * (target[k] - centre[k]) } else { 0.0 };
            let side = m * (x[i][k] - centre[k] + pull);
            side * side
        };
        [side(0), side(1), side(2), term * term]
    }
}

/// The system of one step. Displacements and residuals of each coordinate of each part are in units
/// of the gauge, in which its right-hand side has norm one; each is a linear system of its own, so
/// scaling does not change it. Positions remain in mesh units, since fixed vertices may be
/// neighbours of several parts.
struct System<'a> {
    solver: ImplicitSolver<'a>,
    freedom: &'a Freedom,
    x: &'a [Point],
    centres: &'a [Point],
    gauge: Gauge<'a>,
    /// The units of each part, in mesh units.
    units: Vec<Point>,
    /// `M (1 + w)`.
    shifted: Cow<'a, [f64]>,
    /// The reciprocal of the diagonal of the matrix.
    inverse: &'a [f64],
}

impl<'a> System<'a> {
    fn new(
        solver: ImplicitSolver<'a>,
        x: &'a [Point],
        freedom: &'a Freedom,
        centres: &'a [Point],
        inverse: &'a mut Vec<f64>,
    ) -> Self {
        let (mass, diagonal) = (solver.laplacian.mass(), solver.laplacian.diagonal());
        let shifted = match &freedom.soft {
            None => Cow::Borrowed(mass),
            Some((w, _)) => mass.iter().zip(w).map(|(m, w)| m * (1.0 + w)).collect(),
        };
        let pairs = shifted.par_iter().zip(diagonal).with_min_len(CHUNK);
        pairs.map(|(m, s)| 1.0 / (m + solver.step * s)).collect_into_vec(inverse);
        let gauge = solver.gauge(x, freedom, centres);
        let units = gauge.measure.iter().map(|g| g.map(reciprocal)).collect();
        Self { solver, freedom, x, centres, gauge, units, shifted, inverse }
    }

    /// The position of vertex `i` about the centre of its part, displaced by `d` in units of the
    /// gauge.
    #[inline(always)]
    fn position(&self, i: usize, d: Padded) -> Padded {
        let part = self.solver.parts.part(i);
        let (u, x, c) = (&self.units[part], &self.x[i], &self.centres[part]);
        [x[0] - c[0] + u[0] * d[0], x[1] - c[1] + u[1] * d[1], x[2] - c[2] + u[2] * d[2], 0.0]
    }

    /// The soft constraint of vertex `i`: its weight, and that times its target about the centre of
    /// its part.
    #[inline(always)]
    fn pull(&self, i: usize) -> (f64, Point) {
        let (w, target) = self.freedom.pull(i);
        if w == 0.0 {
            return (0.0, [0.0; 3]);
        }
        let c = &self.centres[self.solver.parts.part(i)];
        (w, [0, 1, 2].map(|k| w * (target[k] - c[k])))
    }

    #[inline(always)]
    fn project(&self, i: usize, d: Padded) -> Padded {
        let p = self.freedom.project(i, [d[0], d[1], d[2]]);
        [p[0], p[1], p[2], 0.0]
    }

    /// Sets `d` from an initial guess in mesh units, and `p = x + d`.
    fn begin(&self, guess: &[Point], d: &mut [Padded], p: &mut [Padded]) {
        update_both(d, p, |i, d, p| {
            let g = &self.gauge.measure[self.solver.parts.part(i)];
            let [a, b, c] = guess[i];
            *d = self.project(i, [g[0] * a, g[1] * b, g[2] * c, 0.0]);
            *p = self.position(i, *d);
        });
    }

    /// The displacement in mesh units.
    fn end(&self, d: &[Padded], displacement: &mut [Point]) {
        update(displacement, |i, _| {
            let (d, unit) = (&d[i], &self.units[self.solver.parts.part(i)]);
            ([d[0] * unit[0], d[1] * unit[1], d[2] * unit[2]], ())
        });
    }

    /// Computes `r = P (M (w (c − x − d) − d) − t S (x + d))`, with one product at `p = x + d`, and
    /// returns the squared norm of each coordinate.
    fn residual(&self, d: &[Padded], p: &[Padded], r: &mut [Padded]) -> Padded {
        let (l, t) = (self.solver.laplacian, self.solver.step);
        let mass = l.mass();
        l.sweep_summing(p, r, |i, s, y, _| {
            let (w, [a, b, c]) = self.pull(i);
            let (m, d, target) = (mass[i], d[i], [a, b, c]);
            let g = &self.gauge.measure[self.solver.parts.part(i)];
            let mut r = [0.0; 4];
            for k in 0..3 {
                r[k] = g[k] * (t * s[k] + m * (target[k] - w * y[k])) - m * d[k];
            }
            let r = self.project(i, r);
            (r, r.map(|r| r * r))
        })
    }

    /// Shifts each part that may move as a whole so that its weighted mean is at its centre, as the
    /// equations require. Only the masses determine this mean, so residuals of long steps hardly
    /// show its error. `p` receives `x + d`.
    fn settle(&self, d: &mut [Padded], p: &mut [Padded]) {
        let parts = self.solver.parts;
        let mass = self.solver.laplacian.mass();
        let sums = parts.sums(|_, i| {
            let (q, m, (_, pull)) = (self.shifted[i], mass[i], self.pull(i));
            let (before, after) = (self.position(i, [0.0; 4]), self.position(i, d[i]));
            // Left side minus right side: zero but for the rounding of the centre.
            let off = |k: usize| q * after[k] - m * (before[k] + pull[k]);
            [off(0), off(1), off(2), q]
        });
        let off = |(s, free): (&[f64; 4], bool)| {
            if free && s[3] > 0.0 { [s[0] / s[3], s[1] / s[3], s[2] / s[3], 0.0] } else { [0.0; 4] }
        };
        let off: Vec<Padded> = sums.iter().zip(parts.free()).map(off).collect();
        update_both(d, p, |i, d, p| {
            let (off, g) = (&off[parts.part(i)], &self.gauge.measure[parts.part(i)]);
            for k in 0..3 {
                d[k] -= g[k] * off[k];
            }
            *p = self.position(i, *d);
        });
    }

    fn not_converged(&self, iterations: usize, r: &[Padded]) -> FlowFailure {
        let squares: Padded = sum(r.len(), |i| r[i].map(|r| r * r));
        not_converged(self.gauge.reported_in_units(r, &squares), iterations, r)
    }
}

impl CgSystem<4> for System<'_> {
    fn multiply(&self, p: &[Padded], q: &mut Vec<Padded>) -> Padded {
        let ImplicitSolver { laplacian, step: t, .. } = self.solver;
        laplacian.sweep_summing(p, q, |i, s, p, _| {
            let m = self.shifted[i];
            let mut q = [0.0; 4];
            for k in 0..4 {
                q[k] = m * p[k] - t * s[k];
            }
            let q = self.project(i, q);
            (q, [p[0] * q[0], p[1] * q[1], p[2] * q[2], 0.0])
        })
    }

    #[inline(always)]
    fn precondition(&self, i: usize, r: Padded) -> Padded {
        let s = self.inverse[i];
        self.project(i, [s * r[0], s * r[1], s * r[2], 0.0])
    }

    fn is_coupled(&self) -> bool {
        self.freedom.sliding.is_some()
    }
}

/// The largest square root of three coordinates; NaN if one is NaN.
fn root(squares: &Padded) -> f64 {
    squares[..3].iter().map(|s| s.sqrt()).fold(0.0, larger)
}

/// The failure to converge, with the vertex of the largest residual.
pub(crate) fn not_converged<const N: usize>(
    residual: f64,
    iterations: usize,
    r: &[[f64; N]],
) -> FlowFailure {
    let size = |r: &[f64; N]| r.iter().map(|x| x.abs()).fold(0.0, larger);
    let worst = (0..r.len()).max_by(|&a, &b| size(&r[a]).total_cmp(&size(&r[b])));
    FlowFailure::NotConverged { residual, iterations, vertex: worst.unwrap_or(0) as u32 }
}
