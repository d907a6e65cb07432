//! Errors of assembling and applying operators.

use crate::kind::{LaplacianKind, MassKind};
use fairing_parameters::ParameterError;

/// The least height of a face over its longest edge, relative to that edge, at
/// which its cotangents are used.
///
/// The cross product behind a cotangent carries a rounding error of about
/// 10⁻¹⁶ (longest edge)², so that at this ratio a cotangent still has six
/// correct digits.
pub const MIN_HEIGHT_RATIO: f64 = 1e-10;

/// The error of an operator that cannot be assembled or applied.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum OperatorError {
    /// Twice the area is below [`MIN_HEIGHT_RATIO`] × (longest edge)².
    #[error("face {face} is degenerate: area {area:e}, longest edge {edge:e}")]
    DegenerateFace {
        /// The offending face.
        face: u32,
        /// Its area, in squared mesh units.
        area: f64,
        /// Its longest edge, in mesh units.
        edge: f64,
    },
    /// No edge has a positive length.
    #[error("every edge has zero length")]
    NoLength,
    /// The Laplacian does not have this mass.
    #[error("the {laplacian} Laplacian has no {mass} mass, {}", masses_of(*laplacian))]
    NoSuchMass {
        /// The Laplacian.
        laplacian: LaplacianKind,
        /// The mass.
        mass: MassKind,
    },
    /// A vertex with faces has a mass that is not positive.
    #[error("vertex {vertex} has mass {mass:e}, not a positive one")]
    Mass {
        /// The vertex.
        vertex: u32,
        /// Its mass, in squared mesh units.
        mass: f64,
    },
    /// A vertex that does not exist.
    #[error("vertex {vertex} does not exist: there are {vertices} vertices")]
    NoSuchVertex {
        /// The vertex.
        vertex: u32,
        /// The number of vertices.
        vertices: usize,
    },
    /// The number of values differs from the number of vertices.
    #[error("expected {expected} values, one for each vertex, found {found}")]
    Length {
        /// The number of values given.
        found: usize,
        /// The number of vertices.
        expected: usize,
    },
    /// The mesh has other edges than the one that the pattern was built for.
    #[error("vertex {vertex} has other edges than in the mesh of the Laplacian")]
    Connectivity {
        /// The first such vertex.
        vertex: u32,
    },
    /// ∂p/∂u and ∂p/∂v of a surface do not span a plane.
    #[error("the chart is singular at u = {u}, v = {v}")]
    SingularChart {
        /// The first parameter.
        u: f64,
        /// The second parameter.
        v: f64,
    },
    /// Balls hold far more faces or vertices than their radius in edges suggests.
    #[error(
        "the ball of {edges} mean edges about vertex {vertex} holds {elements} faces or \
         vertices, far more than on an even mesh: choose a smaller radius, or rings"
    )]
    Crowded {
        /// The centre of the fullest of the balls that were examined.
        vertex: u32,
        /// The faces or vertices in it.
        elements: usize,
        /// The radius, in mean edge lengths.
        edges: f64,
    },
    /// An option is out of its range.
    #[error(transparent)]
    Option(#[from] ParameterError),
    /// More entries than 32-bit indices can number.
    #[error("the matrix would have up to {entries} entries, too many for 32-bit indices")]
    TooLarge {
        /// An upper bound of the number of entries.
        entries: usize,
    },
}

/// The masses of a Laplacian that does not have all of them.
fn masses_of(laplacian: LaplacianKind) -> &'static str {
    match laplacian {
        LaplacianKind::Polygon => "only the barycentric and the consistent one",
        _ => "only the barycentric one of its own triangulation",
    }
}
