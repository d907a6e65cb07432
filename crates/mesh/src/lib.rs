#![doc = include_str!("../README.md")]
//!
//! # Overview
//!
//! [`TriMesh`] holds double-precision positions and `u32` faces and is always valid. Vertices,
//! edges and faces are numbered from 0; vertices and faces keep the order of their file.
//!
//! Functions run in parallel on rayon's current thread pool; results do not depend on the number of
//! threads. `rayon::ThreadPool::install` selects another pool.

#![cfg_attr(docsrs, feature(doc_cfg))]
#![cfg_attr(test, expect(clippy::disallowed_methods, reason = "tests do not need the same bits"))]

mod build;
mod connectivity;
mod convert;
mod diagnosis;
mod hilbert;
mod incidence;
#[cfg(feature = "io")]
pub mod io;
mod measure;
mod moments;
mod oriented;
mod polygon;
mod repair;
mod subdivide;
mod topology;
mod trimesh;
mod weld;

pub use build::{BuildError, EXTENTS};
pub use connectivity::Connectivity;
pub use diagnosis::{Diagnosis, Tally};
pub use hilbert::hilbert;
pub use incidence::Incidence;
pub use moments::Moments;
#[cfg(feature = "ndarray")]
pub use ndarray;
pub use polygon::{PolygonFaces, PolygonMesh};
pub use repair::{
    OpenHole, OpenReason, RepairError, RepairOptions, RepairStep, Repaired, Tolerance, repair,
    repair_with,
};
pub use subdivide::{subdivide_loop, subdivide_midpoint};
pub use topology::{Components, Fan, Orientation, Topology};
pub use trimesh::TriMesh;
pub use weld::Welded;
