//! What training needs of the denoiser: its state between stages, and its networks.
//!
//! For the crate that makes the file of weights; no part of the public interface.

pub use super::features::{CANDIDATES, INPUTS, Sample, Seen};
pub use super::model::Model;
pub use super::network::{
    HIDDEN, LEAK, Layer, Network, OUTPUTS, PARAMETERS, Parts, Trace, combine, turn, weight,
};
pub use super::stage::{advance, samples};
pub use super::state::State;
