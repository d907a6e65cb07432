#![doc = include_str!("../README.md")]
//!
//! # Overview
//!
//! [`Laplacian`] is the stiffness and the mass of one mesh, of a [`LaplacianKind`] and a
//! [`MassKind`], or chosen for the mesh ([`Laplacian::auto`]); the free functions that assemble
//! both are public, too. Estimators of curvature are in [`curvature`].
//!
//! Matrices are sparse rows in the vertex order of the mesh. The stiffness `S` is positive
//! semi-definite and Δ ≈ −M⁻¹S; `S u` and angle defects are *integrated* over the cell of a vertex,
//! and become *pointwise* when divided by its mass. Curvature is positive where the surface bends
//! away from its outward normal as a sphere does.

#![cfg_attr(test, expect(clippy::disallowed_methods, reason = "tests do not need the same bits"))]

mod angles;
mod assembly;
mod corners;
pub mod curvature;
mod error;
mod fan;
mod gradient;
pub mod intrinsic;
mod kind;
mod laplacian;
mod mass;
mod normal_equations;
mod normals;
mod polygon;
mod stiffness;
pub mod surface;
mod tangent;

pub use angles::{corner_angles, dihedral_angles, sharp_edges};
pub use corners::check_faces;
pub use curvature::PrincipalAxes;
pub use error::{MIN_HEIGHT_RATIO, OperatorError};
pub use fairing_sparse::SparseMatrix;
pub use gradient::{divergence, face_gradients, gradient};
pub use kind::{LaplacianKind, LumpedArea, MassKind};
pub use laplacian::{
    CotangentPattern, Intrinsic, Laplacian, MassMatrix, Reason, Restricted, ThinFaces, choose,
    positive_lumped_mass,
};
pub use mass::{consistent_mass, lumped_mass};
pub use normal_equations::{NormalEquations, NormalFactor};
pub use normals::{NormalWeight, face_normals, vertex_normals, weighted_vertex_normals};
pub use polygon::{PolygonLaplacian, polygon_laplacian};
pub use stiffness::{combinatorial_laplacian, cotan_stiffness, random_walk_laplacian};
pub use tangent::tangent_frame;
