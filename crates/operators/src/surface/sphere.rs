//! The sphere.

use super::{ChartNormal, ClosedForms, Ellipsoid, ImplicitSurface, ParametricSurface, SurfaceJet};

/// The sphere `r (cos u sin v, sin u sin v, cos v)`; its poles v = 0 and
/// v = π are singular points of the chart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sphere {
    /// The radius r, positive, in mesh units.
    pub radius: f64,
}

impl ParametricSurface for Sphere {
    fn jet(&self, u: f64, v: f64) -> SurfaceJet {
        Ellipsoid { a: self.radius, b: self.radius, c: self.radius }.jet(u, v)
    }

    fn chart_normal(&self) -> ChartNormal {
        ChartNormal::Inward
    }
}

impl ClosedForms for Sphere {
    fn first_form(&self, _: f64, v: f64) -> [f64; 3] {
        [(self.radius * libm::sin(v)).powi(2), 0.0, self.radius * self.radius]
    }

    fn second_form(&self, _: f64, v: f64) -> [f64; 3] {
        [self.radius * libm::sin(v).powi(2), 0.0, self.radius]
    }

    fn mean_curvature(&self, _: f64, _: f64) -> f64 {
        1.0 / self.radius
    }

    fn gaussian_curvature(&self, _: f64, _: f64) -> f64 {
        1.0 / (self.radius * self.radius)
    }
}

/// `x² + y² + z² = r²`
impl ImplicitSurface for Sphere {
    fn gradient(&self, p: [f64; 3]) -> [f64; 3] {
        p.map(|x| 2.0 * x)
    }

    fn hessian(&self, _: [f64; 3]) -> [[f64; 3]; 3] {
        [[2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]]
    }
}
