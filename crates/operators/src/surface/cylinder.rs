//! The cylinder.

use super::{ClosedForms, ImplicitSurface, ParametricSurface, SurfaceJet};

/// The cylinder `(r cos u, r sin u, v)` about the z axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cylinder {
    /// The radius r, positive, in mesh units.
    pub radius: f64,
}

impl ParametricSurface for Cylinder {
    fn jet(&self, u: f64, v: f64) -> SurfaceJet {
        let (su, cu) = libm::sincos(u);
        let r = self.radius;
        SurfaceJet {
            point: [r * cu, r * su, v],
            du: [-r * su, r * cu, 0.0],
            dv: [0.0, 0.0, 1.0],
            duu: [-r * cu, -r * su, 0.0],
            duv: [0.0; 3],
            dvv: [0.0; 3],
        }
    }
}

impl ClosedForms for Cylinder {
    fn first_form(&self, _: f64, _: f64) -> [f64; 3] {
        [self.radius * self.radius, 0.0, 1.0]
    }

    fn second_form(&self, _: f64, _: f64) -> [f64; 3] {
        [self.radius, 0.0, 0.0]
    }

    fn mean_curvature(&self, _: f64, _: f64) -> f64 {
        0.5 / self.radius
    }

    fn gaussian_curvature(&self, _: f64, _: f64) -> f64 {
        0.0
    }
}

/// `x² + y² = r²`
impl ImplicitSurface for Cylinder {
    fn gradient(&self, [x, y, _]: [f64; 3]) -> [f64; 3] {
        [2.0 * x, 2.0 * y, 0.0]
    }

    fn hessian(&self, _: [f64; 3]) -> [[f64; 3]; 3] {
        [[2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0; 3]]
    }
}
