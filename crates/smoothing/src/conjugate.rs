//! Conjugate gradients for the step of an implicit flow, three coordinates together.

use rayon::prelude::*;

use crate::constraints::Freedom;
use crate::error::FlowFailure;
use crate::laplacian::{Laplacian, Padded, ROWS, by_chunk, padded};

type Point = [f64; 3];

/// Solves `P (M(1 + w) − t M L) P d = P M (t L x + w (c − x))` for the displacement `d` of one implicit step.
///
/// `P` lets through what constraints allow: nothing at held vertices, the tangent at sliding ones. Conjugate
/// gradients with the diagonal as preconditioner and the displacement of the step before as a first guess. Each
/// coordinate has its own coefficients unless sliding vertices couple them. It ends when the residual of every
/// coordinate is below the tolerance relative to `‖M (x − x̄)‖`, the right-hand side of the step about the mean,
/// so that a mesh far from the origin is solved as well as one around it.
#[derive(Clone, Copy)]
pub(crate) struct ImplicitSolver<'a> {
    pub(crate) laplacian: &'a Laplacian,
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

impl ImplicitSolver<'_> {
    /// `guess` holds a first guess of `d` and receives the solution.
    pub(crate) fn solve(
        &self,
        x: &[Point],
        freedom: &Freedom,
        guess: &mut [Point],
    ) -> Result<Solved, FlowFailure> {
        let (l, t) = (self.laplacian, self.step);
        let mass = l.mass();
        let scale = self.right_hand_side_norm(x, freedom);
        let coupled = freedom.sliding.is_some();
        let project = |i: usize, d: Padded| -> Padded {
            let p = freedom.project(i, [d[0], d[1], d[2]]);
            [p[0], p[1], p[2], 0.0]
        };
        // M (1 + w), and the reciprocal of the diagonal of the matrix.
        let shifted: Vec<f64> =
            mass.iter().enumerate().map(|(i, m)| m * (1.0 + freedom.pull(i).0)).collect();
        let inverse: Vec<f64> =
            shifted.iter().zip(l.diagonal()).map(|(m, s)| 1.0 / (m + t * s)).collect();
        let precondition = |i: usize, r: Padded| project(i, r.map(|r| r * inverse[i]));
        let mut d = padded(guess);
        by_chunk(&mut d, |i, d| (project(i, d), []));
        // r = P (M (t L (x + d) + w (c − x − d)) − M d), whose first part is one product at x + d.
        let mut p = padded(x);
        by_chunk(&mut p, |i, x| (std::array::from_fn(|k| x[k] + d[i][k]), []));
        let mut r = vec![[0.0; 4]; x.len()];
        let mut sums = l.sweep_summing(&p, &mut r, |i, lx, y, _| {
            let (w, [a, b, c]) = freedom.pull(i);
            let target = [a, b, c, 0.0];
            let d = d[i];
            let r = std::array::from_fn(|k| mass[i] * (t * lx[k] + w * (target[k] - y[k]) - d[k]));
            let r = project(i, r);
            (r, six(r, precondition(i, r)))
        });
        by_chunk(&mut p, |i, _| (precondition(i, r[i]), []));
        let mut q = vec![[0.0; 4]; x.len()];
        let mut iterations = 0;
        loop {
            let residual = relative(&sums[..3], scale);
            if residual <= self.tolerance {
                for (guess, d) in guess.iter_mut().zip(&d) {
                    *guess = [d[0], d[1], d[2]];
                }
                return Ok(Solved { iterations, residual });
            }
            if iterations == self.most_iterations || !residual.is_finite() {
                return Err(not_converged(residual, iterations, &r));
            }
            let curvature = l.sweep_summing(&p, &mut q, |i, lp, p, _| {
                let (m, tm) = (shifted[i], t * mass[i]);
                let q = project(i, std::array::from_fn(|k| m * p[k] - tm * lp[k]));
                (q, [p[0] * q[0], p[1] * q[1], p[2] * q[2]])
            });
            let old = [sums[3], sums[4], sums[5]];
            let alpha = quotients(old, curvature, coupled);
            sums = by_chunk(&mut r, |i, r| {
                let q = &q[i];
                let r = std::array::from_fn(|k| r[k] - alpha[k] * q[k]);
                (r, six(r, precondition(i, r)))
            });
            let beta = quotients([sums[3], sums[4], sums[5]], old, coupled);
            advance(&mut d, &mut p, &r, alpha, beta, precondition);
            iterations += 1;
        }
    }

    /// `‖M (x − x̄)‖` for each coordinate, x̄ the mean weighted by mass; where that vanishes (a plane), the largest
    /// of the three.
    pub(crate) fn right_hand_side_norm(&self, x: &[Point], freedom: &Freedom) -> Point {
        let mass = self.laplacian.mass();
        let total: f64 = mass.iter().sum();
        let mut centre = [0.0; 3];
        for (p, m) in x.iter().zip(mass) {
            for k in 0..3 {
                centre[k] += m / total * p[k];
            }
        }
        let mut squares = [0.0; 3];
        for (i, (p, m)) in x.iter().zip(mass).enumerate() {
            let (w, target) = freedom.pull(i);
            for k in 0..3 {
                squares[k] += (m * (p[k] - centre[k] + w * (target[k] - centre[k]))).powi(2);
            }
        }
        let norms = squares.map(f64::sqrt);
        let largest = norms.into_iter().fold(0.0, f64::max);
        // Below this a coordinate is rounding noise of the others.
        norms.map(|n| if n > 1e-8 * largest { n } else { largest })
    }
}

/// The failure with the vertex of the largest residual.
pub(crate) fn not_converged<const N: usize>(
    residual: f64,
    iterations: usize,
    r: &[[f64; N]],
) -> FlowFailure {
    let size = |r: &[f64; N]| r.iter().map(|x| x.abs()).fold(0.0, f64::max);
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

/// `r · r` and `r · z` for each coordinate.
fn six(r: Padded, z: Padded) -> [f64; 6] {
    [r[0] * r[0], r[1] * r[1], r[2] * r[2], r[0] * z[0], r[1] * z[1], r[2] * z[2]]
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

/// The largest relative residual of the coordinates.
pub(crate) fn relative(sums: &[f64], scale: Point) -> f64 {
    (0..3)
        .map(|k| if sums[k] == 0.0 { 0.0 } else { sums[k].sqrt() / scale[k] })
        .fold(0.0, |a: f64, b| if b.is_nan() { b } else { a.max(b) })
}
