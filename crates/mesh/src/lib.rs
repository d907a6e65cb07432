//! Triangle meshes: validity, topology, reading and writing.
//!
//! [`TriMesh`] holds double-precision positions and `u32` faces and is always
//! valid. Vertices, edges and faces are numbered from 0; vertices and faces
//! keep the order of the file they came from.

#![cfg_attr(test, expect(clippy::disallowed_methods, reason = "tests do not need the same bits"))]

mod build;
mod connectivity;
mod diagnosis;
#[cfg(feature = "io")]
pub mod io;
mod measure;
mod named;
mod polygon;
mod subdivide;
mod topology;
mod trimesh;
mod unit_scale;
pub mod vec3;

pub use build::BuildError;
pub use connectivity::{Connectivity, Incidence};
pub use diagnosis::{Diagnosis, Tally};
pub use named::{UnknownName, by_name};
pub use polygon::PolygonMesh;
pub use subdivide::{subdivide_loop, subdivide_midpoint};
pub use topology::{Components, Fan, Orientation, Topology};
pub use trimesh::TriMesh;
