//! Why a flow stops before its end.

use std::fmt;

use fairing_mesh::{BuildError, TriMesh};
use fairing_operators::OperatorError;
use fairing_parameters::OptionError;
use fairing_sparse::CholeskyError;
use fairing_spectral::SpectralError;

/// A flow that failed, and the last mesh before that.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct FlowError {
    /// Why.
    pub failure: FlowFailure,
    /// The step that could not be taken, from 1; 0 if none was begun.
    pub iteration: usize,
    /// The mesh after the last step that succeeded; the input if none did.
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

// The failure is part of the message: what lies behind it is the next in the chain.
impl std::error::Error for FlowError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        self.failure.source()
    }
}

/// A mass that is not positive is a failure of its own.
impl From<OperatorError> for FlowFailure {
    fn from(error: OperatorError) -> Self {
        match error {
            OperatorError::Mass { vertex, mass } => Self::NonPositiveMass { vertex, mass },
            error => Self::Operator(error),
        }
    }
}

/// Why a step cannot be taken.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FlowFailure {
    /// An option is outside of its range.
    #[error(transparent)]
    Option(#[from] OptionError),
    /// Options that contradict each other.
    #[error("{reason}")]
    Unsupported {
        /// Which options, and why not together.
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
    /// An explicit step is beyond the stable limit, and
    /// [`Stability::Refuse`](crate::Stability::Refuse) is set.
    #[error(
        "a step of {step} is beyond the stable limit {limit}: some modes would grow; \
         take a smaller step, an implicit method, or allow unstable steps"
    )]
    Unstable {
        /// The step asked for, in the unit of the limit.
        step: f64,
        /// The largest step for which no mode grows.
        limit: f64,
    },
    /// Pairs of steps would amplify a mode of the pass band by more than two, and
    /// [`Stability::Refuse`](crate::Stability::Refuse) is set.
    #[error(
        "{pairs} pairs of steps would multiply the modes at half the pass band by {gain} each, by more than two in all; \
         take fewer pairs, a smaller λ or pass band, or allow unstable steps"
    )]
    Amplified {
        /// The largest factor of a mode in one pair.
        gain: f64,
        /// The pairs asked for.
        pairs: usize,
    },
    /// A coordinate is too large for a number.
    #[error("vertex {vertex} would move to ({}, {}, {})", position[0], position[1], position[2])]
    NonFinite {
        /// The vertex.
        vertex: u32,
        /// Where it would go.
        position: [f64; 3],
    },
    /// The operator of a step cannot be assembled. [`LaplacianKind::Robust`](fairing_operators::LaplacianKind::Robust)
    /// and uniform weights are defined on meshes where the plain operator is not.
    #[error(
        "the operator cannot be assembled; use the robust operator or uniform weights for such a mesh"
    )]
    Operator(#[source] OperatorError),
    /// A flow that takes its operator again in each step has shrunk the mesh to almost nothing: the surface that it
    /// follows has vanished within this step.
    #[error(
        "the surface collapses in this step: a face at vertex {vertex} has an area of {area:e}, of {before:e} at the \
         beginning; end the flow earlier, or use the robust operator or the conformal flow, which continue"
    )]
    Collapsed {
        /// A corner of the face that has lost the largest share of its area.
        vertex: u32,
        /// What is left of the area of the face, in squared mesh units: after the step if it can be taken, before it
        /// if not.
        area: f64,
        /// Its area in the input.
        before: f64,
    },
    /// The mass of a vertex is not positive, so that the step is not defined (Voronoi areas can be negative).
    #[error("vertex {vertex} has the mass {mass:e}, but a step needs positive masses")]
    NonPositiveMass {
        /// The vertex.
        vertex: u32,
        /// Its mass: squared mesh units for areas.
        mass: f64,
    },
    /// Two neighbours coincide, where weights divide by the length of their edge.
    #[error("the edge from vertex {vertex} to {neighbor} has no length")]
    NoLength {
        /// One end.
        vertex: u32,
        /// The other.
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
    /// A linear system could not be factored.
    #[error("the linear system cannot be factored")]
    NotFactored(#[source] CholeskyError),
    /// The modes of a filter cannot be computed.
    #[error("the modes cannot be computed")]
    Modes(#[source] Box<SpectralError>),
    /// Most vertices lie where another one does: the faces do not share their corners
    /// ([`TriMesh::is_unwelded`]).
    #[error(
        "{seams} of {vertices} vertices lie exactly where another one does: the faces do not share \
         their corners, so that each would shrink by itself; weld the mesh first"
    )]
    Unwelded {
        /// Boundary vertices that coincide with another one.
        seams: usize,
        /// All vertices.
        vertices: usize,
    },
    /// Volume can be kept only where it is defined.
    #[error("the volume cannot be kept: {reason}")]
    Volume {
        /// Why not.
        reason: &'static str,
    },
    /// Positions do not make a mesh.
    #[error(transparent)]
    Mesh(BuildError),
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
    /// The failure before the first step of a flow on `mesh`.
    pub(crate) fn before(self, mesh: &TriMesh) -> FlowError {
        FlowError { failure: self, iteration: 0, last_good: Box::new(mesh.clone()) }
    }
}
