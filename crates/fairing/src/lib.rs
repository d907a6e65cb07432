//! Geometry processing on triangle meshes with the Laplacian.
//!
//! This crate re-exports the crates of the workspace under one name.

pub use fairing_denoising as denoising;
pub use fairing_evaluation as evaluation;
pub use fairing_figure as figure;
pub use fairing_mesh as mesh;
pub use fairing_operators as operators;
pub use fairing_shapes as shapes;
pub use fairing_smoothing as smoothing;
pub use fairing_sparse as sparse;
pub use fairing_spectral as spectral;
pub use fairing_watch as watch;

/// The examples of the README, compiled and run with the tests.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
pub struct Readme;
