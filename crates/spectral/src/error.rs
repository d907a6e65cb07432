//! Errors of spectra.

use fairing_mesh::BuildError;
use fairing_operators::{LaplacianKind, OperatorError};
use fairing_parameters::ParameterError;
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
    Option(#[from] ParameterError),
    /// The time is too short for heat to reach a vertex.
    #[error("no heat arrives at vertex {vertex}: use a longer time")]
    NoHeat {
        /// The first such vertex.
        vertex: u32,
    },
    /// A vertex without a distance: its component has no source.
    #[error("vertex {vertex} has no distance: no source is on its component")]
    Unreached {
        /// The vertex.
        vertex: u32,
    },
    /// A face that does not exist.
    #[error("face {face} does not exist: there are {faces} faces")]
    NoSuchFace {
        /// The face.
        face: u32,
        /// Number of faces.
        faces: usize,
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
