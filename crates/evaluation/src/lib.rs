#![doc = include_str!("../README.md")]
//!
//! # Overview
//!
//! Noise is seeded, and its type names its unit. Distances are between surfaces, in double
//! precision. Scores that compare element by element need meshes with the same faces, and return an
//! error otherwise.

#![cfg_attr(test, expect(clippy::disallowed_methods, reason = "tests do not need the same bits"))]

mod correspondence;
mod distance;
mod drift;
mod error;
mod features;
mod hausdorff;
mod hub;
mod inside;
mod intersections;
mod noise;
mod normal;
mod normal_error;
mod orders;
mod scan;
mod scores;
mod surface_tree;
mod triangle;

pub use distance::{
    SurfaceDistance, VertexDisplacement, VertexDistance, at_closest_points, surface_distance,
    vertex_displacement, vertex_distance,
};
pub use drift::{Drift, drift, flipped_faces};
pub use error::EvaluationError;
pub use features::{FeatureEdges, feature_edges};
pub use hausdorff::{Hausdorff, hausdorff};
pub use inside::inside;
pub use intersections::self_intersections;
pub use noise::{NoiseKind, NoiseLevel, add_noise};
pub use normal_error::{NormalAngles, curvature_error, normal_error};
pub use orders::observed_orders;
pub use scan::{Scan, ScanOptions, scan};
pub use scores::{Score, ScoreOptions, ScoreUnit, Scores};
pub use surface_tree::{Closest, SurfaceTree};
