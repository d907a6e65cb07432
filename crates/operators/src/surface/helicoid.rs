//! The helicoid.

use super::{ClosedForms, ParametricSurface, SurfaceJet};

/// The helicoid `(v cos u, v sin u, c u)`: minimal, H = 0. It has no inside;
/// `∂p/∂u × ∂p/∂v` counts as the outer side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Helicoid {
    /// The rise c per radian, not zero, in mesh units.
    pub rise: f64,
}

impl ParametricSurface for Helicoid {
    fn jet(&self, u: f64, v: f64) -> SurfaceJet {
        let (su, cu) = libm::sincos(u);
        SurfaceJet {
            point: [v * cu, v * su, self.rise * u],
            du: [-v * su, v * cu, self.rise],
            dv: [cu, su, 0.0],
            duu: [-v * cu, -v * su, 0.0],
            duv: [-su, cu, 0.0],
            dvv: [0.0; 3],
        }
    }
}

impl ClosedForms for Helicoid {
    fn first_form(&self, _: f64, v: f64) -> [f64; 3] {
        [v * v + self.rise * self.rise, 0.0, 1.0]
    }

    fn second_form(&self, _: f64, v: f64) -> [f64; 3] {
        [0.0, -self.rise / libm::hypot(v, self.rise), 0.0]
    }

    fn mean_curvature(&self, _: f64, _: f64) -> f64 {
        0.0
    }

    fn gaussian_curvature(&self, _: f64, v: f64) -> f64 {
        -(self.rise / (v * v + self.rise * self.rise)).powi(2)
    }
}
