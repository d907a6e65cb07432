//! What can go wrong with spectra.

#[cfg(feature = "npz")]
use std::path::PathBuf;

use fairing_mesh::BuildError;
use fairing_operators::{LaplacianKind, OperatorError};
use fairing_parameters::OptionError;
use fairing_sparse::{CholeskyError, EigenError};

/// Why a spectrum, or something made from it, is not available.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SpectralError {
    /// The operators cannot be assembled.
    #[error(transparent)]
    Operator(#[from] OperatorError),
    /// The eigenproblem cannot be solved.
    #[error(transparent)]
    Eigen(#[from] EigenError),
    /// A linear system cannot be solved.
    #[error(transparent)]
    Solve(#[from] CholeskyError),
    /// The positions of the result are not those of a mesh.
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
    /// More modes were asked for than there are.
    #[error("{wanted} modes were requested, but there are {available}")]
    TooManyModes {
        /// Modes wanted.
        wanted: usize,
        /// Modes there are: as many as vertices that are not isolated or pinned.
        available: usize,
    },
    /// A field has another number of rows than there are vertices or modes.
    #[error("expected {expected} rows, found {found}")]
    Rows {
        /// Rows of the field.
        found: usize,
        /// Rows it should have.
        expected: usize,
    },
    /// An option is out of its range.
    #[error(transparent)]
    Option(#[from] OptionError),
    /// Heat does not arrive at a vertex within the range of the numbers.
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
        /// How many there are.
        vertices: usize,
    },
}

/// Why a spectrum cannot be written to a file or read from it.
#[cfg(feature = "npz")]
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SpectrumFileError {
    /// The system cannot open, read or write the file.
    #[error("{} cannot be opened, read or written", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// The file is no archive of arrays, or not of those that a spectrum has.
    #[error("{}: {part} cannot be read or written", path.display())]
    Part {
        /// The file.
        path: PathBuf,
        /// The array that cannot be read or written, or `archive`.
        part: String,
        /// What is wrong with it.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
    /// The arrays do not make a spectrum.
    #[error("{}: {problem}", path.display())]
    Contents {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        problem: &'static str,
    },
}
