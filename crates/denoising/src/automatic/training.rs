//! Internals of the denoiser for the crate that trains it: the state between stages, the networks,
//! and the tests for the noise of depth cameras and for surfaces of volumes. Feature `training`;
//! not covered by version numbers.

pub use super::correlation::is_open;
pub use super::features::{CANDIDATES, INPUTS, Sample, Seen};
pub use super::merge::without_short_edges;
pub use super::model::Model;
pub use super::network::{
    BATCH, HIDDEN, LAYERS, LEAK, Layer, Network, OUTPUTS, PARAMETERS, Parts, Trace, combine, turn,
    weight,
};
pub use super::stage::{advance, samples};
pub use super::state::State;
pub use crate::noise_scale::{Growth, TERMS};
