//! Curvature at the vertices of a triangle mesh.
//!
//! Positive where the surface bends away from its outward normal: on a sphere of radius r, H = κ₁ =
//! κ₂ = 1/r and K = 1/r². Values are pointwise unless their documentation calls them integrated. A
//! vertex where a value cannot be computed is flagged in a [`VertexStatus`] and its value is zero;
//! NaN is never a result. Boundary vertices have a separate flag, because their values are
//! one-sided.
//!
//! Signs are those of the [oriented](fairing_mesh::TriMesh::oriented) mesh: faces that disagree
//! with the rest of their part count as flipped. On parts that cannot be oriented, such as a Möbius
//! band, curvature has no sign, and values are those of the side from which H ≥ 0. Near the cut
//! along which faces disagree, values that depend on normals of several faces are less accurate, as
//! near a border. [`TriMesh::one_sided_faces`](fairing_mesh::TriMesh::one_sided_faces) finds such
//! parts.
//!
//! [`Estimator`] runs any of the methods and returns one type, the
//! [`CurvatureField`]; [`mean_curvature`] and [`gaussian_curvature`] are the
//! plain operators, and [`laplacian_curvature`] takes a
//! [`Laplacian`](crate::Laplacian) of any kind.

mod adaptive;
mod ball;
mod bending;
mod cell;
mod corrected;
mod cotangent;
mod estimator;
mod face_tensor;
mod field;
mod fit;
mod from_laplacian;
mod gaussian;
mod jet;
mod mean;
mod neighborhood;
mod normal_cycle;
mod oriented;
mod quadric;
mod status;
mod steiner;

pub use adaptive::{AdaptiveOptions, NoiseKind, adaptive_curvature};
pub use corrected::{CorrectedMeasures, CorrectedOptions, corrected_curvature};
pub use cotangent::{CotangentOptions, cotangent_curvature};
pub use estimator::Estimator;
pub use face_tensor::{FaceTensorOptions, face_tensor_curvature};
pub use field::{Accuracy, CurvatureField, principal_values};
pub use fit::PrincipalAxes;
pub use from_laplacian::{laplacian_curvature, laplacian_mean_curvature};
pub use gaussian::{angle_defect, gaussian_curvature};
pub use jet::{JetDegree, JetOptions, JetWeight, jet_curvature};
pub use mean::{
    MeanCurvature, mean_and_gaussian_curvature, mean_curvature, scaled_umbrella_mean_curvature,
    umbrella_mean_curvature,
};
pub use neighborhood::{Length, Neighborhood};
pub use normal_cycle::{NormalCycleOptions, normal_cycle_curvature};
pub use quadric::{QuadricOptions, quadric_curvature};
pub use status::{ScalarCurvature, Undefined, VertexStatus};
pub use steiner::{SteinerOptions, steiner_curvature};
