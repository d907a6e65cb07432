//! Noise models, distances, drift and scores for triangle meshes.
//!
//! Noise is seeded and says its unit in its type. Distances are those between
//! surfaces, in double precision; measures that compare element by element
//! need meshes with the same faces, and say so otherwise.

mod error;
mod noise;
mod orders;

pub use error::EvaluationError;
pub use noise::{NoiseKind, NoiseLevel, add_noise};
pub use orders::{observed_order_steps, observed_orders};
