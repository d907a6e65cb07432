#![doc = include_str!("../README.md")]
//!
//! # Overview
//!
//! [`automatic`] estimates its parameters from the mesh. The other denoisers are published methods,
//! each a function with an options struct; [`Denoiser`] has all of them by name. All denoisers keep
//! the faces and the order of vertices. Faces that disagree with the rest of their part count as
//! flipped ([`TriMesh::oriented`](fairing_mesh::TriMesh::oriented)); the result has the faces of
//! the input. A mesh whose faces do not share their corners is refused. [`Masked`] fixes vertices
//! of a mesh.

#![cfg_attr(test, expect(clippy::disallowed_methods, reason = "tests do not need the same bits"))]

#[cfg_attr(
    not(feature = "training"),
    expect(dead_code, unreachable_pub, reason = "the feature makes the networks public")
)]
mod automatic;
mod bilateral;
mod bilateral_normal;
mod denoiser;
mod disjoint;
mod error;
mod faces;
mod fast_effective;
mod guided_normal;
mod jump_tree;
mod jumps;
mod l0;
mod masked;
mod noise_level;
#[cfg_attr(
    not(feature = "training"),
    expect(unreachable_pub, reason = "the feature makes growth over scales public")
)]
mod noise_scale;
mod non_iterative;
mod total_generalised_variation;
mod total_variation;
mod vertex_update;

#[cfg(feature = "training")]
pub use automatic::training;
pub use automatic::{Approach, Automatic, AutomaticOptions, FaceKind, SurfaceKind, automatic};
pub use bilateral::{BilateralOptions, bilateral};
pub use bilateral_normal::{
    BilateralNormalGlobalOptions, BilateralNormalOptions, bilateral_normal, bilateral_normal_global,
};
pub use denoiser::Denoiser;
pub use error::DenoiseError;
pub use fast_effective::{FastEffectiveOptions, fast_effective};
pub use guided_normal::{GuidedNormalOptions, guided_normal};
pub use l0::{L0Options, l0};
pub use masked::Masked;
pub use noise_level::{NoiseEstimate, NoisyParts, noise_level, noisy_parts};
pub use non_iterative::{NonIterativeOptions, non_iterative};
pub use total_generalised_variation::{
    TotalGeneralisedVariationOptions, total_generalised_variation,
};
pub use total_variation::{TotalVariationOptions, total_variation};
pub use vertex_update::update_vertices;
