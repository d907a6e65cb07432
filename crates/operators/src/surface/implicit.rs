//! Curvature of level sets.

use glam::DVec3;

use crate::tangent::{Symmetric2, tangent_frame};

/// A surface `f(p) = 0` with f growing outward.
pub trait ImplicitSurface {
    /// ∇f at `p`.
    fn gradient(&self, p: [f64; 3]) -> [f64; 3];

    /// The matrix of second derivatives of f at `p`, symmetric.
    fn hessian(&self, p: [f64; 3]) -> [[f64; 3]; 3];

    /// The curvature at `p` of the level set through `p`:
    ///
    /// ```text
    /// II(x, y) = xᵀ (∇²f) y / ‖∇f‖    for tangents x, y
    /// ```
    ///
    /// `None` where the gradient vanishes. Source: [goldman2005].
    ///
    /// [goldman2005]: https://doi.org/10.1016/j.cagd.2005.06.005
    fn curvature(&self, p: [f64; 3]) -> Option<PointCurvature> {
        let gradient = DVec3::from(self.gradient(p));
        let length = gradient.length();
        if !(length > 0.0 && length.is_finite()) {
            return None;
        }
        let normal = gradient * (1.0 / length);
        let [x, y] = tangent_frame(normal);
        let h = self.hessian(p).map(DVec3::from);
        let apply = |t: DVec3| DVec3::from(h.map(|row| row.dot(t) / length));
        let (hx, hy) = (apply(x), apply(y));
        let form = Symmetric2 { a: x.dot(hx), b: x.dot(hy), c: y.dot(hy) };
        let (values, [c, s]) = form.eigen();
        let first = c * x + s * y;
        let directions = [first, normal.cross(first)].map(Into::into);
        Some(PointCurvature { values, directions, normal: normal.to_array() })
    }
}

/// Exact curvature at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct PointCurvature {
    /// κ₁ ≥ κ₂, in 1 / mesh units, positive on a sphere.
    pub values: [f64; 2],
    /// Their unit tangents; arbitrary at an umbilic.
    pub directions: [[f64; 3]; 2],
    /// The outward unit normal.
    pub normal: [f64; 3],
}

impl PointCurvature {
    /// `H = (κ₁ + κ₂) / 2`
    pub fn mean(&self) -> f64 {
        0.5 * (self.values[0] + self.values[1])
    }

    /// `K = κ₁ κ₂`
    pub fn gaussian(&self) -> f64 {
        self.values[0] * self.values[1]
    }
}
