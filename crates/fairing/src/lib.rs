#![doc = include_str!("../README.md")]
//!
//! # Threads and memory
//!
//! Work is spread over the current pool of threads of rayon; results do not depend on their number.
//! Programs that start many short tasks gain from an allocator that keeps memory, such as mimalloc;
//! the program `fairing` uses it.

#![cfg_attr(docsrs, feature(doc_cfg))]

mod error;
#[cfg(feature = "task")]
pub mod task;

pub use error::{Error, ErrorKind};
pub use fairing_denoising as denoising;
pub use fairing_evaluation as evaluation;
#[cfg(feature = "figure")]
pub use fairing_figure as figure;
pub use fairing_mesh as mesh;
pub use fairing_operators as operators;
pub use fairing_parameters as parameters;
pub use fairing_shapes as shapes;
pub use fairing_smoothing as smoothing;
pub use fairing_sparse as sparse;
pub use fairing_spectral as spectral;
pub use fairing_watch as watch;
