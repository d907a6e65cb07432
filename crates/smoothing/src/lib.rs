//! Smoothing flows and denoisers for triangle meshes.

pub mod denoise;
