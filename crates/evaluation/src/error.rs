//! Errors of noise, distances and scores.

use fairing_mesh::BuildError;
use fairing_operators::OperatorError;
use fairing_parameters::ParameterError;

/// The error of a noise, distance or score that is not defined.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EvaluationError {
    /// An option is out of its range, or no distance or angle can meet it.
    #[error(transparent)]
    Option(#[from] ParameterError),
    /// The moved vertices are not a valid mesh.
    #[error("the positions do not form a valid mesh")]
    Positions(#[source] BuildError),
    /// A camera sees only vertices in front of it.
    #[error("vertex {vertex} is not in front of the camera at {camera:?}")]
    NotInFront {
        /// The first such vertex.
        vertex: u32,
        /// The position of the camera.
        camera: [f64; 3],
    },
    /// A camera has no view of the mesh.
    #[error("the camera at {camera:?} {reason}")]
    NoView {
        /// The position of the camera.
        camera: [f64; 3],
        /// The reason, in words that follow the camera.
        reason: &'static str,
    },
    /// A mesh without faces has no surface to measure distances to.
    #[error("the {which} has no faces")]
    NoFaces {
        /// `mesh` or `reference`.
        which: &'static str,
    },
    /// A mesh without vertices on faces has no points to measure from.
    #[error("the {which} has no vertices that a face uses")]
    NoVertices {
        /// `mesh` or `reference`.
        which: &'static str,
    },
    /// A score that compares element by element needs meshes with the same faces.
    #[error(
        "the meshes do not correspond: {vertices} and {reference_vertices} vertices, {faces} and \
         {reference_faces} triangles{}",
        if vertices == reference_vertices && faces == reference_faces { ", which differ" } else { "" }
    )]
    NoCorrespondence {
        /// Vertices of the mesh.
        vertices: usize,
        /// Vertices of the reference.
        reference_vertices: usize,
        /// Triangles of the mesh.
        faces: usize,
        /// Triangles of the reference.
        reference_faces: usize,
    },
    /// A curvature is not defined.
    #[error(transparent)]
    Operator(#[from] OperatorError),
}
