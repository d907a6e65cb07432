//! The ellipsoid.

use super::{ChartNormal, ClosedForms, ImplicitSurface, ParametricSurface, SurfaceJet};

/// The ellipsoid `p(u,v) = (a cos u sin v, b sin u sin v, c cos v)`, with
/// 0 ≤ u < 2π and 0 ≤ v ≤ π; its poles v = 0 and v = π are singular points of
/// the chart. Formulas: `docs/ellipsoid.md`.
///
/// At (a, 0, 0), where u = 0 and v = π/2, du runs along +y and dv along −z.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ellipsoid {
    /// The half axis along x, positive, in mesh units.
    pub a: f64,
    /// The half axis along y, positive, in mesh units.
    pub b: f64,
    /// The half axis along z, positive, in mesh units.
    pub c: f64,
}

impl Ellipsoid {
    /// `D = b²c² cos²u sin²v + a²c² sin²u sin²v + a²b² cos²v`: the square of
    /// ‖pᵤ × pᵥ‖ / sin v. Positive everywhere, poles included.
    pub fn discriminant(&self, u: f64, v: f64) -> f64 {
        let Self { a, b, c } = *self;
        let ((su, cu), (sv, cv)) = (libm::sincos(u), libm::sincos(v));
        (b * c * cu * sv).powi(2) + (a * c * su * sv).powi(2) + (a * b * cv).powi(2)
    }

    /// κₙ at (a, 0, 0) in the direction `cos θ y + sin θ z`:
    /// `a (cos²θ / b² + sin²θ / c²)`.
    pub fn normal_curvature_at_a(&self, theta: f64) -> f64 {
        let (s, c) = libm::sincos(theta);
        self.a * ((c / self.b).powi(2) + (s / self.c).powi(2))
    }
}

impl ParametricSurface for Ellipsoid {
    fn jet(&self, u: f64, v: f64) -> SurfaceJet {
        let Self { a, b, c } = *self;
        let ((su, cu), (sv, cv)) = (libm::sincos(u), libm::sincos(v));
        let point = [a * cu * sv, b * su * sv, c * cv];
        SurfaceJet {
            point,
            du: [-a * su * sv, b * cu * sv, 0.0],
            dv: [a * cu * cv, b * su * cv, -c * sv],
            duu: [-a * cu * sv, -b * su * sv, 0.0],
            duv: [-a * su * cv, b * cu * cv, 0.0],
            dvv: point.map(|x| -x),
        }
    }

    fn chart_normal(&self) -> ChartNormal {
        ChartNormal::Inward
    }
}

impl ClosedForms for Ellipsoid {
    fn first_form(&self, u: f64, v: f64) -> [f64; 3] {
        let (a2, b2, c2) = (self.a.powi(2), self.b.powi(2), self.c.powi(2));
        let ((su, cu), (sv, cv)) = (libm::sincos(u), libm::sincos(v));
        [
            (a2 * su * su + b2 * cu * cu) * sv * sv,
            (b2 - a2) * su * cu * sv * cv,
            (a2 * cu * cu + b2 * su * su) * cv * cv + c2 * sv * sv,
        ]
    }

    fn second_form(&self, u: f64, v: f64) -> [f64; 3] {
        let n = self.a * self.b * self.c / self.discriminant(u, v).sqrt();
        [n * libm::sin(v).powi(2), 0.0, n]
    }

    fn mean_curvature(&self, u: f64, v: f64) -> f64 {
        let Self { a, b, c } = *self;
        let p = self.jet(u, v).point;
        let square: f64 = p.iter().map(|x| x * x).sum();
        let d = self.discriminant(u, v);
        a * b * c * (a * a + b * b + c * c - square) / (2.0 * d * d.sqrt())
    }

    fn gaussian_curvature(&self, u: f64, v: f64) -> f64 {
        (self.a * self.b * self.c / self.discriminant(u, v)).powi(2)
    }
}

/// `x²/a² + y²/b² + z²/c² = 1`
impl ImplicitSurface for Ellipsoid {
    fn gradient(&self, p: [f64; 3]) -> [f64; 3] {
        let axes = [self.a, self.b, self.c];
        std::array::from_fn(|k| 2.0 * p[k] / (axes[k] * axes[k]))
    }

    fn hessian(&self, _: [f64; 3]) -> [[f64; 3]; 3] {
        let [x, y, z] = [self.a, self.b, self.c].map(|axis| 2.0 / (axis * axis));
        [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]]
    }
}
