#![doc = include_str!("../README.md")]
//!
//! # Overview
//!
//! Modes are orthonormal in the inner product of the mass, φᵢᵀ M φⱼ = δᵢⱼ, so a field is projected
//! by Φᵀ M f. Using Φᵀ instead is the classic mistake; the types of this crate carry the mass with
//! the modes.
//!
//! One [`Laplacian`](fairing_operators::Laplacian), of any kind, serves for spectra, heat, geodesic
//! distances and [Poisson problems](Poisson).

#![cfg_attr(docsrs, feature(doc_cfg))]
#![cfg_attr(test, expect(clippy::disallowed_methods, reason = "tests do not need the same bits"))]

mod cluster;
mod compute;
mod diffusion;
mod error;
mod filter;
mod geodesic;
mod isoline;
#[cfg(feature = "npz")]
mod npy;
#[cfg(feature = "npz")]
mod npz;
mod path;
mod poisson;
mod reconstruct;
mod signature;
mod spectrum;
mod surface_point;

pub use cluster::Split;
pub use compute::{SpectrumOptions, graph_spectrum, spectrum};
pub use diffusion::HeatDiffusion;
pub use error::SpectralError;
pub use fairing_operators::MassMatrix;
pub use fairing_sparse::{Beyond, EigenOptions};
pub use filter::{Filtered, Rest};
pub use geodesic::HeatGeodesics;
pub use isoline::{Isoline, isolines};
pub use path::{GeodesicPath, geodesic_path};
pub use poisson::Poisson;
pub use reconstruct::{Compressed, Reconstruction, compress, reconstruct, reconstruction_errors};
pub use signature::{
    global_point_signature, heat_kernel_signature, heat_kernel_times, shape_dna,
    wave_kernel_energies, wave_kernel_signature,
};
pub use spectrum::Spectrum;
pub use surface_point::SurfacePoint;
