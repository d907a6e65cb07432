//! The torus.

use super::{ClosedForms, ImplicitSurface, ParametricSurface, SurfaceJet};

/// The torus `((R + r cos v) cos u, (R + r cos v) sin u, r sin v)` about the z
/// axis, with R > r > 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Torus {
    /// The radius R of the centre circle, in mesh units.
    pub major: f64,
    /// The radius r of the tube, in mesh units.
    pub minor: f64,
}

impl ParametricSurface for Torus {
    fn jet(&self, u: f64, v: f64) -> SurfaceJet {
        let ((su, cu), (sv, cv)) = (libm::sincos(u), libm::sincos(v));
        let (r, rho) = (self.minor, self.major + self.minor * cv);
        SurfaceJet {
            point: [rho * cu, rho * su, r * sv],
            du: [-rho * su, rho * cu, 0.0],
            dv: [-r * sv * cu, -r * sv * su, r * cv],
            duu: [-rho * cu, -rho * su, 0.0],
            duv: [r * sv * su, -r * sv * cu, 0.0],
            dvv: [-r * cv * cu, -r * cv * su, -r * sv],
        }
    }
}

impl ClosedForms for Torus {
    fn first_form(&self, _: f64, v: f64) -> [f64; 3] {
        [(self.major + self.minor * libm::cos(v)).powi(2), 0.0, self.minor * self.minor]
    }

    fn second_form(&self, _: f64, v: f64) -> [f64; 3] {
        [(self.major + self.minor * libm::cos(v)) * libm::cos(v), 0.0, self.minor]
    }

    fn mean_curvature(&self, _: f64, v: f64) -> f64 {
        let rho = self.major + self.minor * libm::cos(v);
        (self.major + 2.0 * self.minor * libm::cos(v)) / (2.0 * self.minor * rho)
    }

    fn gaussian_curvature(&self, _: f64, v: f64) -> f64 {
        libm::cos(v) / (self.minor * (self.major + self.minor * libm::cos(v)))
    }
}

/// `(ρ − R)² + z² = r²` with ρ = √(x² + y²); not differentiable on the axis.
impl ImplicitSurface for Torus {
    fn gradient(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let s = 2.0 * (1.0 - self.major / libm::hypot(x, y));
        [s * x, s * y, 2.0 * z]
    }

    fn hessian(&self, [x, y, _]: [f64; 3]) -> [[f64; 3]; 3] {
        let rho = libm::hypot(x, y);
        let (s, t) = (2.0 * (1.0 - self.major / rho), 2.0 * self.major / rho.powi(3));
        [[s + t * x * x, t * x * y, 0.0], [t * x * y, s + t * y * y, 0.0], [0.0, 0.0, 2.0]]
    }
}
