//! Curvature at the vertices of a triangle mesh.
//!
//! Positive where the surface bends away from its outward normal: on a sphere
//! of radius r, H = κ₁ = κ₂ = 1/r and K = 1/r². Pointwise unless a name says
//! integrated. A vertex where a value cannot be computed is flagged in a
//! [`VertexStatus`] and holds zero; NaN is never a result. Boundary vertices
//! are flagged apart: their values are one-sided.

mod boundary;
mod gaussian;
mod mean;
mod principal;
mod status;

pub use boundary::{VertexLinks, vertex_links};
pub use gaussian::{angle_defect, gaussian_curvature};
pub use mean::{MeanCurvature, MeanOperator, mean_curvature};
pub use principal::principal_values;
pub use status::{ScalarCurvature, Undefined, VertexStatus};
