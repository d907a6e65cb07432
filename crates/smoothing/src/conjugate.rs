//! Conjugate gradients for the step of an implicit flow, three coordinates together.

use rayon::prelude::*;

use crate::constraints::Freedom;
use crate::error::FlowFailure;
use crate::laplacian::{Laplacian, Padded, ROWS, by_chunk, padded};
use crate::parts::{Gauge, Parts, larger};

type Point = [f64; 3];

/// Solves `P (M(1 + w) − t M L) P d = P M (t L x + w (c − x))` for the displacement `d` of one implicit step.
///
/// `P` lets through what constraints allow: nothing at held vertices, the tangent at sliding ones. Conjugate
/// gradients with the diagonal as preconditioner and the displacement of the step before as a first guess. Each
/// coordinate has its own coefficients unless sliding vertices couple them. It ends when the residual of every
/// coordinate in every part of the mesh is below the tolerance relative to its own right-hand side of the step about
/// the centre of the part, or below rounding ([`Gauge`]): a mesh far from the origin is solved as well as one around
/// it, and the thin side of a flat one as well as its width. The residual is then measured from the solution, not
/// taken from the recurrence; parts that move as a whole are put where their weighted mean must lie.
#[derive(Clone, Copy)]
pub(crate) struct ImplicitSolver<'a> {
    pub(crate) laplacian: &'a Laplacian,
    pub(crate) parts: &'a Parts,
    pub(crate) step: f64,
    pub(crate) tolerance: f64,
    pub(crate) most_iterations: usize,
}

/// What a solve took and reached.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Solved {
    pub(crate) iterations: usize,
    pub(crate) residual: f64,
}

/// Times that conjugate gradients begin again where the measured residual is larger than that of the recurrence.
const MOST_RESTARTS: usize = 3;

impl<'a> ImplicitSolver<'a> {
    /// `guess` holds a first guess of `d` and receives the solution.
    pub(crate) fn solve(
        &self,
        x: &[Point],
        freedom: &Freedom,
        guess: &mut [Point],
    ) -> Result<Solved, FlowFailure> {
        let centres = self.parts.centres(self.laplacian.mass(), x, freedom);
        let system = System::new(*self, x, freedom, &centres);
        let mut d = padded(guess);
        by_chunk(&mut d, |i, d| (system.project(i, d), []));
        let mut r = vec![[0.0; 4]; x.len()];
        let mut p = vec![[0.0; 4]; x.len()];
        let mut iterations = 0;
        for restart in 0..=MOST_RESTARTS {
            let sums = system.residual(&d, &mut p, &mut r);
            if restart > 0 && root(&sums) <= self.tolerance {
                break;
            }
            if restart == MOST_RESTARTS {
                return Err(not_converged(system.gauge.reported(&r), iterations, &r));
            }
            system.iterate(sums, &mut d, &mut p, &mut r, &mut iterations)?;
            system.settle(&mut d);
        }
        for (guess, d) in guess.iter_mut().zip(&d) {
            *guess = [d[0], d[1], d[2]];
        }
        Ok(Solved { iterations, residual: system.gauge.reported(&r) })
    }

    /// How residuals of the step at `x` are measured: against `M (x − c̄ + w (c − c̄))` about the centres c̄.
    fn gauge(&self, x: &[Point], freedom: &Freedom, centres: &[Point]) -> Gauge<'a> {
        let sides = self.sides(x, freedom, centres);
        let mut reach = self.parts.largest(|i| {
            let ((w, target), c) = (freedom.pull(i), centres[self.parts.part(i)]);
            [0, 1, 2].map(|k| {
                let pull = if w > 0.0 { (target[k] - c[k]).abs() } else { 0.0 };
                larger((x[i][k] - c[k]).abs(), pull)
            })
        });
        // Held vertices are neighbours of every part that is not free.
        if let Some(&held) = reach.last() {
            for (reach, _) in reach.iter_mut().zip(self.parts.free()).filter(|(_, free)| !free) {
                *reach = [0, 1, 2].map(|k| larger(reach[k], held[k]));
            }
        }
        Gauge::new(self.parts, &sides, &reach, self.tolerance, freedom.sliding.is_some())
    }

    /// What [`Gauge::new`] takes: the squared norms of `M (x − c̄ + w (c − c̄))` and of the coefficients of the rows.
    pub(crate) fn sides(&self, x: &[Point], freedom: &Freedom, centres: &[Point]) -> Vec<[f64; 4]> {
        let (mass, diagonal) = (self.laplacian.mass(), self.laplacian.diagonal());
        self.parts.sums(|i| {
            let ((w, target), c, m) = (freedom.pull(i), centres[self.parts.part(i)], mass[i]);
            let held = freedom.held[i];
            let term = if held { 0.0 } else { m * (1.0 + w) + 2.0 * self.step * diagonal[i] };
            let [a, b, c] = [0, 1, 2].map(|k| {
                let pull = if w > 0.0 { w * (target[k] - c[k]) } else { 0.0 };
                (m * (x[i][k] - c[k] + pull)).powi(2)
            });
            [a, b, c, term * term]
        })
    }
}

/// The system of one step.
struct System<'a> {
    solver: ImplicitSolver<'a>,
    freedom: &'a Freedom,
    /// Positions about the centres of their parts.
    x: Vec<Padded>,
    centres: &'a [Point],
    gauge: Gauge<'a>,
    /// `M (1 + w)`.
    shifted: Vec<f64>,
    /// The reciprocal of the diagonal of the matrix.
    inverse: Vec<f64>,
}

impl<'a> System<'a> {
    fn new(
        solver: ImplicitSolver<'a>,
        x: &[Point],
        freedom: &'a Freedom,
        centres: &'a [Point],
    ) -> Self {
        let (l, parts) = (solver.laplacian, solver.parts);
        let pulled = |(i, m): (usize, &f64)| m * (1.0 + freedom.pull(i).0);
        let shifted: Vec<f64> = l.mass().iter().enumerate().map(pulled).collect();
        let inverse =
            shifted.iter().zip(l.diagonal()).map(|(m, s)| 1.0 / (m + solver.step * s)).collect();
        let mut about = padded(x);
        by_chunk(&mut about, |i, x| {
            let [a, b, c] = centres[parts.part(i)];
            ([x[0] - a, x[1] - b, x[2] - c, 0.0], [])
        });
        let gauge = solver.gauge(x, freedom, centres);
        Self { solver, freedom, x: about, centres, gauge, shifted, inverse }
    }

    #[inline]
    fn project(&self, i: usize, d: Padded) -> Padded {
        let p = self.freedom.project(i, [d[0], d[1], d[2]]);
        [p[0], p[1], p[2], 0.0]
    }

    #[inline]
    fn precondition(&self, i: usize, r: Padded) -> Padded {
        self.project(i, r.map(|r| r * self.inverse[i]))
    }

    /// `r · r` and `r · z` for each coordinate, as the gauge weighs them.
    #[inline]
    fn six(&self, i: usize, r: Padded) -> [f64; 6] {
        let (g, z) = (self.gauge.at(i), self.precondition(i, r));
        let [a, b, c] = [0, 1, 2].map(|k| g[k] * r[k]);
        [a * a, b * b, c * c, a * (g[0] * z[0]), b * (g[1] * z[1]), c * (g[2] * z[2])]
    }

    /// `r = P (M (t L (x + d) + w (c − x − d)) − M d)`, whose first part is one product at x + d; `p` is the first
    /// direction.
    fn residual(&self, d: &[Padded], p: &mut [Padded], r: &mut [Padded]) -> [f64; 6] {
        let (l, t, x) = (self.solver.laplacian, self.solver.step, &self.x);
        let mass = l.mass();
        by_chunk(p, |i, _| (std::array::from_fn(|k| x[i][k] + d[i][k]), []));
        let sums = l.sweep_summing(p, r, |i, lx, y, _| {
            let (w, target) = self.freedom.pull(i);
            let c = self.centres[self.solver.parts.part(i)];
            let r = std::array::from_fn(|k| {
                let pull = if w > 0.0 && k < 3 { w * (target[k] - c[k] - y[k]) } else { 0.0 };
                mass[i] * (t * lx[k] + pull - d[i][k])
            });
            let r = self.project(i, r);
            (r, self.six(i, r))
        });
        by_chunk(p, |i, _| (self.precondition(i, r[i]), []));
        sums
    }

    /// Conjugate gradients from the residual `r` and the direction `p` at `d`, until the recurrence is below the
    /// tolerance.
    fn iterate(
        &self,
        mut sums: [f64; 6],
        d: &mut [Padded],
        p: &mut [Padded],
        r: &mut [Padded],
        iterations: &mut usize,
    ) -> Result<(), FlowFailure> {
        let ImplicitSolver { laplacian: l, step: t, most_iterations, .. } = self.solver;
        let mass = l.mass();
        let coupled = self.freedom.sliding.is_some();
        let mut q = vec![[0.0; 4]; p.len()];
        loop {
            let residual = root(&sums);
            if residual <= self.solver.tolerance {
                return Ok(());
            }
            if *iterations == most_iterations || !residual.is_finite() {
                return Err(not_converged(self.gauge.reported(r), *iterations, r));
            }
            let curvature = l.sweep_summing(p, &mut q, |i, lp, p, _| {
                let (m, tm) = (self.shifted[i], t * mass[i]);
                let q = self.project(i, std::array::from_fn(|k| m * p[k] - tm * lp[k]));
                let g = self.gauge.at(i);
                (q, [0, 1, 2].map(|k| (g[k] * p[k]) * (g[k] * q[k])))
            });
            let old = [sums[3], sums[4], sums[5]];
            let alpha = quotients(old, curvature, coupled);
            sums = by_chunk(r, |i, r| {
                let q = &q[i];
                let r = std::array::from_fn(|k| r[k] - alpha[k] * q[k]);
                (r, self.six(i, r))
            });
            let beta = quotients([sums[3], sums[4], sums[5]], old, coupled);
            advance(d, p, r, alpha, beta, |i, r| self.precondition(i, r));
            *iterations += 1;
        }
    }

    /// Puts the weighted mean of each part that may move as a whole where the equations have it: at its centre. They
    /// determine it by the masses alone, which a residual of long steps hardly shows.
    fn settle(&self, d: &mut [Padded]) {
        let parts = self.solver.parts;
        let mass = self.solver.laplacian.mass();
        let sums = parts.sums(|i| {
            let (q, x, d) = (self.shifted[i], self.x[i], d[i]);
            let ((w, target), c) = (self.freedom.pull(i), self.centres[parts.part(i)]);
            // The left side less the right, which the rounding of a centre leaves a little off zero.
            let [a, b, c] = [0, 1, 2].map(|k| {
                let pull = if w > 0.0 { w * (target[k] - c[k]) } else { 0.0 };
                q * (x[k] + d[k]) - mass[i] * (x[k] + pull)
            });
            [a, b, c, q]
        });
        by_chunk(d, |i, d| {
            let s = sums[parts.part(i)];
            let off = |k: usize| if parts.is_free(i) && s[3] > 0.0 { s[k] / s[3] } else { 0.0 };
            ([d[0] - off(0), d[1] - off(1), d[2] - off(2), 0.0], [])
        });
    }
}

/// The largest root of the first three sums; NaN if one is.
fn root(sums: &[f64; 6]) -> f64 {
    sums[..3].iter().map(|s| s.sqrt()).fold(0.0, larger)
}

/// The failure with the vertex of the largest residual.
pub(crate) fn not_converged<const N: usize>(
    residual: f64,
    iterations: usize,
    r: &[[f64; N]],
) -> FlowFailure {
    let size = |r: &[f64; N]| r.iter().map(|x| x.abs()).fold(0.0, larger);
    let worst = (0..r.len()).max_by(|&a, &b| size(&r[a]).total_cmp(&size(&r[b])));
    FlowFailure::NotConverged { residual, iterations, vertex: worst.unwrap_or(0) as u32 }
}

/// `d ← d + α p`, then `p ← z + β p`, in one pass.
fn advance(
    d: &mut [Padded],
    p: &mut [Padded],
    r: &[Padded],
    alpha: Padded,
    beta: Padded,
    precondition: impl Fn(usize, Padded) -> Padded + Sync,
) {
    d.par_chunks_mut(ROWS).zip(p.par_chunks_mut(ROWS)).enumerate().for_each(|(chunk, (d, p))| {
        for (k, (d, p)) in d.iter_mut().zip(p).enumerate() {
            let i = chunk * ROWS + k;
            let z = precondition(i, r[i]);
            for k in 0..4 {
                d[k] += alpha[k] * p[k];
                p[k] = z[k] + beta[k] * p[k];
            }
        }
    });
}

/// The quotients of the coordinates, or of their sums where they are coupled; zero over zero is zero.
fn quotients(above: Point, below: Point, coupled: bool) -> Padded {
    let quotient = |a: f64, b: f64| if a == 0.0 { 0.0 } else { a / b };
    if coupled {
        return [quotient(above.iter().sum(), below.iter().sum()); 4];
    }
    let [a, b, c] = [0, 1, 2].map(|k| quotient(above[k], below[k]));
    [a, b, c, 0.0]
}
