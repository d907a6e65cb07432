//! Errors of building a mesh.

/// The reason why positions and faces are not a valid mesh.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BuildError {
    /// A coordinate is infinite or not a number.
    #[error("vertex {vertex} has the coordinates ({}, {}, {}), which are not all finite", position[0], position[1], position[2])]
    NonFinite {
        /// The offending vertex.
        vertex: u32,
        /// Its coordinates.
        position: [f64; 3],
    },
    /// A face names a vertex that does not exist.
    #[error("face {face} names vertex {index}, but there are {vertex_count} vertices")]
    IndexOutOfRange {
        /// The offending face.
        face: usize,
        /// The index it names.
        index: u32,
        /// The number of vertices.
        vertex_count: usize,
    },
    /// A face names one vertex twice, so its area is zero for any positions.
    #[error("face {face} repeats a corner: vertices {}, {}, {}", corners[0], corners[1], corners[2])]
    RepeatedCorner {
        /// The offending face.
        face: usize,
        /// Its corners.
        corners: [u32; 3],
    },
    /// A polygon has fewer than three corners.
    #[error("face {face} has {count} corners, which is fewer than three")]
    TooFewCorners {
        /// The offending face.
        face: usize,
        /// The number of its corners.
        count: usize,
    },
    /// A polygon names one vertex twice.
    #[error("face {face} repeats a vertex among its {count} corners")]
    RepeatedPolygonCorner {
        /// The offending face.
        face: usize,
        /// The number of its corners.
        count: usize,
    },
    /// More vertices or corners than `u32` can number.
    #[error("{count} {what} are more than 32-bit indices can number")]
    TooLarge {
        /// `vertices` or `corners`.
        what: &'static str,
        /// Their number.
        count: usize,
    },
    /// The length of a flat list is not a multiple of three.
    #[error("{count} {what} are not a multiple of three")]
    NotInThrees {
        /// `coordinates` or `indices`.
        what: &'static str,
        /// Their number.
        count: usize,
    },
    /// A corner of a face does not fit into `u32`, such as −1.
    #[error("a corner of face {face} is not a 32-bit index")]
    NotAnIndex {
        /// The offending face.
        face: usize,
    },
    /// The number of new positions is not the number of vertices.
    #[error("{found} positions for a mesh of {expected} vertices")]
    PositionCount {
        /// The number of vertices.
        expected: usize,
        /// The number of positions given.
        found: usize,
    },
}
