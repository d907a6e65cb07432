//! Internals of the denoiser for the crate that trains it: the state between stages, and the
//! networks; and what tells the noise of depth cameras. Not part of the public interface.

pub use super::features::{CANDIDATES, INPUTS, Sample, Seen};
pub use super::is_correlated;
pub use super::model::Model;
pub use super::network::{
    BATCH, HIDDEN, LAYERS, LEAK, Layer, Network, OUTPUTS, PARAMETERS, Parts, Trace, combine, turn,
    weight,
};
pub use super::stage::{advance, samples};
pub use super::state::State;
pub use crate::noise_scale::{Growth, TERMS};
