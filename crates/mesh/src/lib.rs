//! Triangle meshes: validity, topology, reading and writing.
//!
//! [`TriMesh`] holds double-precision positions and `u32` faces and is always
//! valid. Vertices, edges and faces are numbered from 0; vertices and faces
//! keep the order of their file.
//!
//! ```
//! use fairing_mesh::TriMesh;
//!
//! let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
//! let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
//! let tetrahedron = TriMesh::new(corners, faces)?;
//! assert_eq!(tetrahedron.topology().edges().len(), 6);
//! assert_eq!(tetrahedron.topology().neighbors(0).len(), 3);
//! assert!((tetrahedron.signed_volume() - 1.0 / 6.0).abs() < 1e-15);
//!
//! // Bad input is an error that names the element.
//! let error = TriMesh::new(vec![[0.0; 3]; 3], vec![[0, 1, 7]]).unwrap_err();
//! assert!(error.to_string().contains('7'));
//! # Ok::<(), fairing_mesh::BuildError>(())
//! ```
//!
//! # Features
//!
//! - `files` (default): writing files, whole or not at all; includes `gzip`.
//! - `gzip`: reading compressed files; includes `io`.
//! - `io`: reading files and streams, writing to streams and memory.
//! - `ndarray`: views of positions and faces as arrays.
//!
//! Functions run in parallel on rayon's current thread pool; results do not
//! depend on the number of threads. `rayon::ThreadPool::install` selects another pool.

#![cfg_attr(test, expect(clippy::disallowed_methods, reason = "tests do not need the same bits"))]

mod build;
mod connectivity;
mod diagnosis;
mod incidence;
#[cfg(feature = "io")]
pub mod io;
mod measure;
mod oriented;
mod polygon;
mod repair;
mod subdivide;
mod topology;
mod trimesh;
#[doc(hidden)]
mod weld;

pub use build::{BuildError, EXTENTS};
pub use connectivity::Connectivity;
pub use diagnosis::{Diagnosis, Tally};
pub use incidence::Incidence;
#[doc(hidden)]
#[cfg(feature = "ndarray")]
pub use ndarray;
pub use polygon::PolygonMesh;
pub use repair::{RepairOptions, RepairStep, Repaired, repair};
pub use subdivide::{subdivide_loop, subdivide_midpoint};
pub use topology::{Components, Fan, Orientation, Topology};
pub use trimesh::TriMesh;
pub use weld::Welded;
