//! Errors of spectra and their files.

#[cfg(feature = "npz")]
use std::path::PathBuf;

use fairing_mesh::BuildError;
use fairing_operators::{LaplacianKind, OperatorError};
use fairing_parameters::OptionError;
use fairing_sparse::SparseError;

/// Error of spectra, heat, geodesic distances and Poisson problems.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SpectralError {
    /// The operators cannot be assembled.
    #[error(transparent)]
    Operator(#[from] OperatorError),
    /// A linear system or the eigenproblem cannot be solved.
    #[error(transparent)]
    Sparse(#[from] SparseError),
    /// The resulting positions do not form a mesh.
    #[error(transparent)]
    Positions(#[from] BuildError),
    /// A Laplacian of this kind cannot be used.
    #[error("a {kind} Laplacian cannot be used here: use a cotangent or a robust one")]
    Kind {
        /// The kind.
        kind: LaplacianKind,
    },
    /// A vertex is fixed twice.
    #[error("vertex {vertex} is fixed twice")]
    Repeated {
        /// The vertex.
        vertex: u32,
    },
    /// More modes were requested than exist.
    #[error("{wanted} modes were requested, but there are {available}")]
    TooManyModes {
        /// Modes requested.
        wanted: usize,
        /// Modes available: the number of vertices that are neither isolated nor fixed.
        available: usize,
    },
    /// The rows of a field do not match the number of vertices or modes.
    #[error("expected {expected} rows, found {found}")]
    Rows {
        /// Rows of the field.
        found: usize,
        /// Rows expected.
        expected: usize,
    },
    /// An option is out of its range.
    #[error(transparent)]
    Option(#[from] OptionError),
    /// Heat underflows before it reaches a vertex.
    #[error("no heat arrives at vertex {vertex}: use a longer time")]
    NoHeat {
        /// The first such vertex.
        vertex: u32,
    },
    /// A vertex that does not exist.
    #[error("vertex {vertex} does not exist: there are {vertices} vertices")]
    NoSuchVertex {
        /// The vertex.
        vertex: u32,
        /// Number of vertices.
        vertices: usize,
    },
}

/// Error of writing or reading a spectrum.
#[cfg(feature = "npz")]
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SpectrumFileError {
    /// The system cannot open, read or write the file.
    #[error("{} cannot be opened, read or written", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The error of the system.
        source: std::io::Error,
    },
    /// The file is not an archive of the arrays of a spectrum.
    #[error("{}: {part} cannot be read or written", path.display())]
    Part {
        /// The file.
        path: PathBuf,
        /// The array that cannot be read or written, or `archive`.
        part: String,
        /// The cause.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
    /// The arrays do not form a spectrum.
    #[error("{}: {problem}", path.display())]
    Contents {
        /// The file.
        path: PathBuf,
        /// The mismatch.
        problem: &'static str,
    },
}
