//! Geometry processing on triangle meshes with the Laplacian.
//!
//! This crate re-exports the crates of Fairing under one name. Ten typical programs are in its
//! folder `examples`.
//!
//! ```
//! use fairing::operators::Laplacian;
//! use fairing::spectral::{HeatGeodesics, SpectrumOptions, spectrum};
//!
//! // Or a file: fairing::mesh::io::read("bunny.ply")?.mesh
//! let mesh = fairing::shapes::icosphere(3);
//! let modes = spectrum(&Laplacian::auto(&mesh)?, 10, &SpectrumOptions::default())?;
//! // On the unit sphere the eigenvalues are l (l + 1).
//! assert!((modes.values[1] - 2.0).abs() < 0.05);
//!
//! let distances = HeatGeodesics::new(&mesh)?.distance(&[0])?;
//! assert_eq!(distances[0], Some(0.0));
//! # Ok::<(), fairing::spectral::SpectralError>(())
//! ```
//!
//! # Features
//!
//! - `figure`, on by default: pictures, the module `figure`.
//! - `cli`: the program `fairing`.
//! - `serde`: options, reports and scores can be serialized and deserialized.
//!   A choice that has a name is its name; options may be left out.
//! - `lapack`: dense eigenproblems by the LAPACK of the system, where
//!   [`EigenOptions`](spectral::EigenOptions) asks for it.
//!
//! # Threads and memory
//!
//! Work is spread over the current pool of threads of rayon; results do not
//! depend on their number. Programs that start many short tasks gain from an
//! allocator that keeps memory, such as mimalloc; the program `fairing` uses it.

mod error;

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
