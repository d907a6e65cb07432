//! Planes and quadrics fitted to weighted points.

use fairing_mesh::vec3::{add, scale, sub};
use fairing_operators::NormalEquations;

use crate::faces::unit_or_zero;

/// The monomials of degrees 0 to 4 in x and y, the heights z times those of
/// degrees 0 to 2, and z²: what weighted fits of planes and quadrics need.
const MOMENTS: usize = 22;

/// Where the monomials of a degree begin.
const DEGREES: [usize; 5] = [0, 1, 3, 6, 10];

/// The powers of x and y of the unknowns of a quadric; the first three are those
/// of a plane.
const POWERS: [[usize; 2]; 6] = [[0, 0], [1, 0], [0, 1], [2, 0], [1, 1], [0, 2]];

/// Sums of weighted moments.
#[derive(Clone, Copy)]
pub(in crate::automatic) struct LocalFit([f64; MOMENTS]);

impl LocalFit {
    pub(in crate::automatic) const EMPTY: Self = Self([0.0; MOMENTS]);

    /// Adds a weighted point.
    #[inline(always)]
    pub(in crate::automatic) fn add(&mut self, point: &[f64; MOMENTS], w: f64) {
        self.0.iter_mut().zip(point).for_each(|(x, p)| *x += w * p);
    }

    /// The normal equations of the first `N` unknowns.
    fn equations<const N: usize>(&self) -> NormalEquations<N> {
        let (mut matrix, mut rhs) = ([[0.0; N]; N], [0.0; N]);
        for i in 0..N {
            for j in 0..=i {
                let [x, y] = [0, 1].map(|k| POWERS[i][k] + POWERS[j][k]);
                matrix[i][j] = self.0[DEGREES[x + y] + y];
            }
            rhs[i] = self.0[15 + i];
        }
        NormalEquations::from_sums(matrix, rhs)
    }

    /// The sum of squared residuals of the fit with `N` unknowns.
    pub(in crate::automatic) fn squares<const N: usize>(&self) -> Option<f64> {
        let equations = self.equations::<N>();
        let solution = equations.factor()?.solve(equations.rhs());
        Some(self.residual(&solution, equations.rhs()).powi(2) * self.0[0])
    }

    /// The root mean square residual of a solution.
    fn residual(&self, solution: &[f64], rhs: &[f64]) -> f64 {
        let explained: f64 = solution.iter().zip(rhs).map(|(c, r)| c * r).sum();
        ((self.0[MOMENTS - 1] - explained).max(0.0) / self.0[0]).sqrt()
    }
}

/// The moments of a point.
#[inline(always)]
pub(in crate::automatic) fn moments([x, y, z]: [f64; 3]) -> [f64; MOMENTS] {
    let (xx, xy, yy) = (x * x, x * y, y * y);
    [
        1.0,
        x,
        y,
        xx,
        xy,
        yy,
        xx * x,
        xx * y,
        x * yy,
        yy * y,
        xx * xx,
        xx * xy,
        xx * yy,
        xy * yy,
        yy * yy,
        z,
        x * z,
        y * z,
        xx * z,
        xy * z,
        yy * z,
        z * z,
    ]
}

/// What a fit says: the normals of its plane and quadric, log₂ of the residual
/// over σ, of the plane's residual over the quadric's, and of the slope's
/// deviation. Last, the height at the origin.
pub(super) fn read_fit(
    fit: &LocalFit,
    n: [f64; 3],
    axes: [[f64; 3]; 2],
    sigma: f64,
) -> ([[f64; 3]; 2], [f64; 3], f64) {
    let normal = |x: f64, y: f64| unit_or_zero(sub(n, add(scale(axes[0], x), scale(axes[1], y))));
    let equations = fit.equations::<3>();
    let Some(plane) = equations.factor() else { return ([n; 2], [0.0, 0.0, 3.0], 0.0) };
    let p = plane.solve(equations.rhs());
    let coarse = fit.residual(&p, equations.rhs());
    let flat = normal(p[1], p[2]);
    let equations = fit.equations::<6>();
    let (curved, fine, variance, height) = match equations.factor() {
        Some(quadric) => {
            let c = quadric.solve(equations.rhs());
            let slopes = [[0.0, 1.0, 0.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0, 0.0, 0.0]];
            let variance: f64 = slopes.iter().map(|s| quadric.variance(s)).sum();
            (normal(c[1], c[2]), fit.residual(&c, equations.rhs()), variance, c[0])
        }
        None => {
            let slopes = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
            (flat, coarse, slopes.iter().map(|s| plane.variance(s)).sum(), p[0])
        }
    };
    let tiny = 1e-3 * sigma + 1e-12;
    let numbers = [
        log2((fine + tiny) / (sigma + tiny)),
        log2((coarse + tiny) / (fine + tiny)),
        log2(sigma * variance.sqrt() + 1e-4),
    ];
    ([flat, curved], numbers, height)
}

/// The logarithm to base 2, from −40 to 40.
pub(super) fn log2(x: f64) -> f64 {
    libm::log2(x.clamp(1e-12, 1e12))
}
