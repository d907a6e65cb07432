//! A wavy height field.

use super::{ImplicitSurface, ParametricSurface, SurfaceJet};

/// The graph `z = A sin(kx) cos(ky)` over the plane; up is outside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WavyGraph {
    /// The amplitude A, in mesh units.
    pub amplitude: f64,
    /// The wave number k, in radians per mesh unit.
    pub wave_number: f64,
}

impl WavyGraph {
    /// The height, its gradient, and its second derivatives xx, xy, yy.
    fn height(&self, x: f64, y: f64) -> (f64, [f64; 2], [f64; 3]) {
        let (a, k) = (self.amplitude, self.wave_number);
        let ((sx, cx), (sy, cy)) = (libm::sincos(k * x), libm::sincos(k * y));
        let z = a * sx * cy;
        let bend = -k * k * z;
        (z, [a * k * cx * cy, -a * k * sx * sy], [bend, -a * k * k * cx * sy, bend])
    }
}

impl ParametricSurface for WavyGraph {
    fn jet(&self, u: f64, v: f64) -> SurfaceJet {
        let (z, [zu, zv], [zuu, zuv, zvv]) = self.height(u, v);
        SurfaceJet {
            point: [u, v, z],
            du: [1.0, 0.0, zu],
            dv: [0.0, 1.0, zv],
            duu: [0.0, 0.0, zuu],
            duv: [0.0, 0.0, zuv],
            dvv: [0.0, 0.0, zvv],
        }
    }
}

/// `z − A sin(kx) cos(ky) = 0`
impl ImplicitSurface for WavyGraph {
    fn gradient(&self, [x, y, _]: [f64; 3]) -> [f64; 3] {
        let (_, [zx, zy], _) = self.height(x, y);
        [-zx, -zy, 1.0]
    }

    fn hessian(&self, [x, y, _]: [f64; 3]) -> [[f64; 3]; 3] {
        let (_, _, [xx, xy, yy]) = self.height(x, y);
        [[-xx, -xy, 0.0], [-xy, -yy, 0.0], [0.0; 3]]
    }
}
