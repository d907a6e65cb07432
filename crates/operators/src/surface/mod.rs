//! Parametric and implicit surfaces with exact curvature.
//!
//! A [`ParametricSurface`] gives a point and its derivatives; the
//! [`FundamentalForms`] follow, and with them normal and principal
//! curvatures. [`ClosedForms`] are the same by formulas derived by hand
//! (`docs/ellipsoid.md` for the ellipsoid). An [`ImplicitSurface`] gives
//! curvature at a point of space, poles of a chart included.

mod cylinder;
mod ellipsoid;
mod forms;
mod graph;
mod helicoid;
mod implicit;
mod sphere;
mod torus;

pub use cylinder::Cylinder;
pub use ellipsoid::Ellipsoid;
pub use forms::{ChartNormal, FundamentalForms, PrincipalDirections, SurfaceJet};
pub use graph::WavyGraph;
pub use helicoid::Helicoid;
pub use implicit::{ImplicitSurface, PointCurvature};
pub use sphere::Sphere;
pub use torus::Torus;

use crate::error::OperatorError;

/// A surface `p(u, v)` with two continuous derivatives.
pub trait ParametricSurface {
    /// The point at `(u, v)` and its derivatives.
    fn jet(&self, u: f64, v: f64) -> SurfaceJet;

    /// The side to which `∂p/∂u × ∂p/∂v` points.
    fn chart_normal(&self) -> ChartNormal {
        ChartNormal::Outward
    }

    /// The fundamental forms at `(u, v)`, from the derivatives.
    ///
    /// # Errors
    ///
    /// [`OperatorError::SingularChart`] where ∂p/∂u and ∂p/∂v do not span a
    /// plane, as at the poles of a sphere.
    fn forms(&self, u: f64, v: f64) -> Result<FundamentalForms, OperatorError> {
        FundamentalForms::from_jet(self.jet(u, v), self.chart_normal())
            .ok_or(OperatorError::SingularChart { u, v })
    }
}

/// Coefficients and curvatures by formulas derived by hand.
pub trait ClosedForms: ParametricSurface {
    /// `[E, F, G]` at `(u, v)`, in squared mesh units.
    fn first_form(&self, u: f64, v: f64) -> [f64; 3];

    /// `[L, M, N]` at `(u, v)`, in mesh units, with the inward normal: positive
    /// on a sphere.
    fn second_form(&self, u: f64, v: f64) -> [f64; 3];

    /// H at `(u, v)`, in 1 / mesh units, positive on a sphere; limits are
    /// taken where the chart is singular.
    fn mean_curvature(&self, u: f64, v: f64) -> f64;

    /// K at `(u, v)`, in 1 / squared mesh units; limits are taken where the
    /// chart is singular.
    fn gaussian_curvature(&self, u: f64, v: f64) -> f64;
}
