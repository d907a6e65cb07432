//! Discrete differential operators and curvature of triangle meshes.

mod noise_level;
mod normal_equations;

pub use noise_level::{NoiseLevel, noise_level};
pub use normal_equations::{NormalEquations, NormalFactor};
