//! Planes and quadrics fitted to weighted points.

use fairing_operators::{NormalEquations, NormalFactor};
use glam::DVec3;

/// The number of moments in a weighted fit of planes and quadrics: the monomials of degrees 0 to 4
/// in x and y, the height z times the monomials of degrees 0 to 2, and z².
const MOMENTS: usize = 22;

/// The moments of a point, filled up with zeros to three of the widest vectors.
pub(super) type Moments = [f64; 24];

/// The index of the first monomial of each degree.
const DEGREES: [usize; 5] = [0, 1, 3, 6, 10];

/// The powers of x and y of the unknowns of a quadric; the first three are those
/// of a plane.
const POWERS: [[usize; 2]; 6] = [[0, 0], [1, 0], [0, 1], [2, 0], [1, 1], [0, 2]];

/// The moments of the point with the coordinates x, y and z.
#[inline(always)]
pub(super) fn moments([x, y, z]: [f64; 3]) -> Moments {
    let (xx, xy, yy) = (x * x, x * y, y * y);
    let (xxx, xxy, xyy, yyy) = (xx * x, xx * y, x * yy, yy * y);
    let quartic = [xx * xx, xxx * y, xx * yy, x * yyy, yy * yy];
    let [a, b, c, d, e] = quartic;
    let (xz, yz) = (x * z, y * z);
    [
        1.0,
        x,
        y,
        xx,
        xy,
        yy,
        xxx,
        xxy,
        xyy,
        yyy,
        a,
        b,
        c,
        d,
        e,
        z,
        xz,
        yz,
        x * xz,
        x * yz,
        y * yz,
        z * z,
        0.0,
        0.0,
    ]
}

/// Sums of weighted [`moments`].
#[derive(Clone, Copy)]
pub(super) struct LocalFit(Moments);

impl LocalFit {
    pub(super) const EMPTY: Self = Self([0.0; 24]);

    /// Adds a point of the weight `w`, given by its moments.
    #[inline(always)]
    pub(super) fn add(&mut self, moments: &Moments, w: f64) {
        for (sum, moment) in self.0.iter_mut().zip(moments) {
            *sum += w * moment;
        }
    }

    /// The normal equations of the first `N` unknowns.
    #[inline(always)]
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
    pub(super) fn squares<const N: usize>(&self) -> Option<f64> {
        let equations = self.equations::<N>();
        let solution = equations.factor()?.solve(equations.rhs());
        Some(self.residual(&solution, equations.rhs()).powi(2) * self.0[0])
    }

    /// The root mean square residual of a solution.
    #[inline(always)]
    fn residual(&self, solution: &[f64], rhs: &[f64]) -> f64 {
        let explained: f64 = solution.iter().zip(rhs).map(|(c, r)| c * r).sum();
        ((self.0[MOMENTS - 1] - explained).max(0.0) / self.0[0]).sqrt()
    }
}

/// Results of a fit.
pub(super) struct Reading {
    /// The normal of the plane, and that of the quadric at the origin.
    pub(super) normals: [DVec3; 2],
    /// The normal of a flat face with its corners on the quadric, minus the normal of the quadric
    /// at the origin.
    pub(super) turn: DVec3,
    /// log₂ of the residual over σ, of the plane's residual over the quadric's, and of the slope's
    /// deviation.
    pub(super) numbers: [f64; 3],
    /// The height at the origin.
    pub(super) height: f64,
}

/// Reads a fit: n and the axes are those of its points; the corners are those of the face at the
/// origin, along both axes.
#[inline(always)]
pub(super) fn read_fit(
    fit: &LocalFit,
    n: DVec3,
    axes: [DVec3; 2],
    corners: [[f64; 2]; 3],
    sigma: f64,
) -> Reading {
    let normal = |x: f64, y: f64| (n - (x * axes[0] + y * axes[1])).normalize_or_zero();
    let equations = fit.equations::<6>();
    let quadric = equations.factor();
    let leading = quadric.as_ref().map(NormalFactor::leading::<3>);
    let Some(plane) = leading.or_else(|| fit.equations::<3>().factor()) else {
        return Reading {
            normals: [n; 2],
            turn: DVec3::ZERO,
            numbers: [0.0, 0.0, 3.0],
            height: 0.0,
        };
    };
    let rhs = equations.rhs();
    let p = plane.solve(&[rhs[0], rhs[1], rhs[2]]);
    let coarse = fit.residual(&p, rhs);
    let flat = normal(p[1], p[2]);
    let (curved, facet, fine, variance, height) = match quadric {
        Some(quadric) => {
            let c = quadric.solve(rhs);
            let slopes = [[0.0, 1.0, 0.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0, 0.0, 0.0]];
            let variance: f64 = slopes.iter().map(|s| quadric.variance(s)).sum();
            let [x, y] = facet_slope([2.0 * c[3], c[4], 2.0 * c[5]], corners);
            let facet = normal(c[1] + x, c[2] + y);
            (normal(c[1], c[2]), facet, fit.residual(&c, rhs), variance, c[0])
        }
        None => {
            let slopes = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
            (flat, flat, coarse, slopes.iter().map(|s| plane.variance(s)).sum(), p[0])
        }
    };
    let tiny = 1e-3 * sigma + 1e-12;
    let numbers = [
        log2((fine + tiny) / (sigma + tiny)),
        log2((coarse + tiny) / (fine + tiny)),
        log2(sigma * variance.sqrt() + 1e-4),
    ];
    Reading { normals: [flat, curved], turn: facet - curved, numbers, height }
}

/// The slope of the plane through three points of `z = ½ pᵀ H p`, H given by its entries xx, xy and
/// yy; the corners are the points' p. It is zero for equilateral triangles around the origin if H
/// is a multiple of the unit matrix, and linear in H times the size otherwise. A sliver whose slope
/// exceeds what the gradient of z changes by from the origin to a corner gets that much.
fn facet_slope([xx, xy, yy]: [f64; 3], corners: [[f64; 2]; 3]) -> [f64; 2] {
    let z = corners.map(|[x, y]| 0.5 * (xx * x * x + 2.0 * xy * x * y + yy * y * y));
    let side =
        |k: usize| [corners[k][0] - corners[0][0], corners[k][1] - corners[0][1], z[k] - z[0]];
    let (u, v) = (side(1), side(2));
    let area = u[0] * v[1] - u[1] * v[0];
    let rise = [u[2] * v[1] - u[1] * v[2], u[0] * v[2] - u[2] * v[0]];
    let far = corners.map(|[x, y]| x * x + y * y).into_iter().fold(0.0, f64::max);
    let most = ((xx * xx + 2.0 * xy * xy + yy * yy) * far).sqrt() * area.abs();
    let length = (rise[0] * rise[0] + rise[1] * rise[1]).sqrt();
    // Of a face without area both are zero.
    if length <= most && area != 0.0 {
        rise.map(|r| r / area)
    } else if length > 0.0 && area != 0.0 {
        rise.map(|r| r / length * (most / area))
    } else {
        [0.0; 2]
    }
}

/// The logarithm to base 2, from −40 to 40.
pub(super) fn log2(x: f64) -> f64 {
    libm::log2(x.clamp(1e-12, 1e12))
}

/// Two unit vectors across `n`.
pub(super) fn tangents(n: DVec3) -> [DVec3; 2] {
    let axis = if n.x.abs() < 0.6 { DVec3::X } else { DVec3::Y };
    let first = n.cross(axis).normalize_or_zero();
    [first, n.cross(first)]
}

#[cfg(test)]
mod tests {
    use super::*;

    const AXES: [DVec3; 2] = [DVec3::X, DVec3::Y];
    const UP: DVec3 = DVec3::Z;

    fn height([x, y]: [f64; 2]) -> f64 {
        0.3 + 0.2 * x - 0.1 * y + 0.15 * x * x + 0.25 * x * y - 0.05 * y * y
    }

    /// The reading of a quadric known at 25 points.
    fn read(corners: [[f64; 2]; 3]) -> Reading {
        let mut fit = LocalFit::EMPTY;
        for i in 0..25u8 {
            let [x, y] = [i / 5, i % 5].map(|k| 0.4 * f64::from(k) - 0.7);
            fit.add(&moments([x, y, height([x, y])]), 1.0);
        }
        read_fit(&fit, UP, AXES, corners, 0.1)
    }

    /// The normal of the quadric with the turn is that of the flat triangle whose corners are on
    /// it.
    #[test]
    fn the_turn_leads_to_the_flat_face() {
        // Around the origin, as a face is around its centroid.
        let corners = [[-0.4, -0.3], [0.5, -0.1], [-0.1, 0.4]];
        let found = read(corners);
        assert!((found.height - 0.3).abs() < 1e-12);
        let [a, b, c] = corners.map(|p| DVec3::new(p[0], p[1], height(p)));
        let flat = (b - a).cross(c - a).normalize_or_zero();
        let turned = (found.normals[1] + found.turn).normalize_or_zero();
        assert!(turned.distance(flat) < 1e-12, "{turned:?}, {flat:?}");
        // Without it: the distance from the centre of the circle to the centroid, times the
        // curvature.
        assert!(found.normals[1].distance(flat) > 0.03);
    }

    /// Zero for an equilateral triangle of a sphere; no more than the gradient changes for a
    /// sliver; zero without area.
    #[test]
    fn turns_are_bounded() {
        let equilateral = [0.0, 1.0, 2.0].map(|k: f64| {
            let (sin, cos) = libm::sincos(k * std::f64::consts::TAU / 3.0);
            [cos, sin]
        });
        let [x, y] = facet_slope([2.0, 0.0, 2.0], equilateral);
        assert!(x.abs() < 1e-15 && y.abs() < 1e-15);
        let sliver = [[-1.0, 0.0], [1.0, 0.0], [0.0, 1e-6]];
        let [x, y] = facet_slope([2.0, 0.0, 2.0], sliver);
        assert!((x * x + y * y - 8.0).abs() < 1e-9, "{x}, {y}");
        assert_eq!(facet_slope([2.0, 1.0, 3.0], [[-1.0, 0.0], [0.5, 0.0], [0.5, 0.0]]), [0.0; 2]);
    }
}
