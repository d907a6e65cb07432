//! Errors of flows.

use std::fmt;

use fairing_mesh::{BuildError, TriMesh};
use fairing_operators::OperatorError;
use fairing_parameters::ParameterError;
use fairing_sparse::SparseError;
use fairing_spectral::SpectralError;

/// The failure of a flow, with the last mesh before it.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct FlowError {
    /// The failure.
    pub failure: FlowFailure,
    /// The step that failed, counted from 1; 0 if none was begun.
    pub iteration: usize,
    /// The mesh after the last successful step; the input if there was none.
    pub last_good: Box<TriMesh>,
}

impl fmt::Display for FlowError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.iteration > 0 {
            write!(f, "iteration {}: ", self.iteration)?;
        }
        self.failure.fmt(f)
    }
}

// The failure is part of the message; its source is next in the chain.
impl std::error::Error for FlowError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        self.failure.source()
    }
}

/// Maps nonpositive masses to a separate failure.
impl From<OperatorError> for FlowFailure {
    fn from(error: OperatorError) -> Self {
        match error {
            OperatorError::Mass { vertex, mass } => Self::NonPositiveMass { vertex, mass },
            error => Self::Operator(error),
        }
    }
}

/// Maps a missed tolerance to a separate failure.
impl From<SparseError> for FlowFailure {
    fn from(error: SparseError) -> Self {
        match error {
            SparseError::NotConverged { residual, iterations, row } => {
                Self::NotConverged { residual, iterations, vertex: row as u32 }
            }
            error => Self::NotFactored(error),
        }
    }
}

/// Reason for the failure of a step.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FlowFailure {
    /// An option is out of range.
    #[error(transparent)]
    Option(#[from] ParameterError),
    /// A combination of options that is not supported.
    #[error("{reason}")]
    Unsupported {
        /// The options, and the reason why they exclude each other.
        reason: &'static str,
    },
    /// A constraint names a vertex that does not exist.
    #[error("a constraint names vertex {vertex}, but there are {vertex_count} vertices")]
    NoSuchVertex {
        /// The vertex named.
        vertex: u32,
        /// The number of vertices.
        vertex_count: usize,
    },
    /// An explicit step exceeds the stable limit, and
    /// [`Stability::Refuse`](crate::Stability::Refuse) is set.
    #[error(
        "a step of {step} is beyond the stable limit {limit}: some modes would grow; \
         use a smaller step or an implicit method, or allow unstable steps"
    )]
    Unstable {
        /// The given step, in the unit of the limit.
        step: f64,
        /// The largest step for which no mode grows.
        limit: f64,
    },
    /// Pairs of steps would amplify a mode of the pass band by more than two, and
    /// [`Stability::Refuse`](crate::Stability::Refuse) is set.
    #[error(
        "{pairs} pairs of steps would amplify the modes at half the pass band by {gain} per pair, by more than two in \
         total; use fewer pairs, a smaller λ or pass band, or allow unstable steps"
    )]
    Amplified {
        /// The largest factor of a mode in one pair.
        gain: f64,
        /// The given number of pairs.
        pairs: usize,
    },
    /// A coordinate is not finite.
    #[error("vertex {vertex} would move to ({}, {}, {})", position[0], position[1], position[2])]
    NonFinite {
        /// The vertex.
        vertex: u32,
        /// Its position after the step.
        position: [f64; 3],
    },
    /// The operator of a step cannot be assembled. The robust Laplacian
    /// ([`LaplacianKind::Robust`](fairing_operators::LaplacianKind::Robust)) and uniform weights
    /// are defined on more meshes than cotangents.
    #[error(
        "the operator cannot be assembled; use the robust operator or uniform weights for this mesh"
    )]
    Operator(#[source] OperatorError),
    /// A flow with an updated operator has shrunk the mesh to almost nothing: the exact surface
    /// vanishes within this step.
    #[error(
        "the surface collapses in this step: the area of a face at vertex {vertex} is {area:e}, down from \
         {before:e} in the input; end the flow earlier, or use the robust operator or the conformal \
         flow, which continue"
    )]
    Collapsed {
        /// A corner of the face that has lost the largest fraction of its area.
        vertex: u32,
        /// The area of the face in squared mesh units, after the step if it can be taken, before
        /// the step otherwise.
        area: f64,
        /// Its area in the input.
        before: f64,
    },
    /// The mass of a vertex is not positive, so the step is not defined (Voronoi areas can be
    /// negative).
    #[error("vertex {vertex} has mass {mass:e}, but steps require positive masses")]
    NonPositiveMass {
        /// The vertex.
        vertex: u32,
        /// Its mass: squared mesh units for areas.
        mass: f64,
    },
    /// Two neighbours coincide, but the weights divide by the length of their edge.
    #[error("the edge from vertex {vertex} to vertex {neighbor} has zero length")]
    NoLength {
        /// One end of the edge.
        vertex: u32,
        /// The other end.
        neighbor: u32,
    },
    /// A linear system was not solved to the tolerance.
    #[error(
        "the linear system was not solved: relative residual {residual:e} after {iterations} iterations, \
         largest at vertex {vertex}"
    )]
    NotConverged {
        /// The largest relative residual of the three coordinates.
        residual: f64,
        /// Iterations taken.
        iterations: usize,
        /// The vertex with the largest residual.
        vertex: u32,
    },
    /// A vertex has too many neighbours in a region for its matrix to be sparse.
    #[error(
        "vertex {vertex} joins {neighbors} vertices of the region, which makes its matrix dense: \
         choose fewer, or order 1"
    )]
    Hub {
        /// The vertex.
        vertex: u32,
        /// Its neighbours in the region, itself included if it is one of them.
        neighbors: usize,
    },
    /// A linear system could not be factored.
    #[error("the linear system cannot be factored")]
    NotFactored(#[source] SparseError),
    /// The modes of a filter cannot be computed.
    #[error("the modes cannot be computed")]
    Modes(#[source] Box<SpectralError>),
    /// Most vertices coincide with another one: the faces do not share their corners
    /// ([`TriMesh::is_unwelded`]).
    #[error(
        "{seams} of {vertices} vertices coincide with another vertex: the faces do not share their corners, \
         so each would shrink by itself; weld the mesh first"
    )]
    Unwelded {
        /// Boundary vertices that coincide with another one.
        seams: usize,
        /// All vertices.
        vertices: usize,
    },
    /// The volume cannot be preserved.
    #[error("the volume cannot be preserved: {reason}")]
    Volume {
        /// The reason.
        reason: &'static str,
    },
    /// The positions after a step do not form a valid mesh.
    #[error("{}", reason(.0))]
    Mesh(BuildError),
}

/// The reason why a step gives no mesh.
fn reason(error: &BuildError) -> String {
    match error {
        BuildError::Extent { extent } => format!(
            "the mesh would have an extent of {extent:e}, outside of 1e-30 to 1e30: the flow \
             diverges, or collapses to a point"
        ),
        other => other.to_string(),
    }
}

impl From<BuildError> for FlowFailure {
    fn from(error: BuildError) -> Self {
        match error {
            BuildError::NonFinite { vertex, position } => Self::NonFinite { vertex, position },
            other => Self::Mesh(other),
        }
    }
}

impl FlowFailure {
    /// The error of a flow on `mesh` that fails before its first step.
    pub(crate) fn before(self, mesh: &TriMesh) -> FlowError {
        FlowError { failure: self, iteration: 0, last_good: Box::new(mesh.clone()) }
    }
}
