//! Why positions and faces do not make a mesh.

/// Why positions and faces cannot become a [`TriMesh`](crate::TriMesh).
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
    /// The longest side of the box around the vertices is neither zero nor within
    /// [`EXTENTS`](crate::EXTENTS).
    #[error("the mesh has an extent of {extent:e}, outside of 1e-30 to 1e30: rescale it")]
    Extent {
        /// The longest side, in mesh units.
        extent: f64,
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
    /// A face names one vertex twice, so that it has no area whatever the
    /// positions.
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
        /// How many there are.
        count: usize,
    },
    /// Numbers in a row do not come in threes.
    #[error("{count} {what} cannot be split into threes")]
    NotInThrees {
        /// `coordinates` or `indices`.
        what: &'static str,
        /// How many there are.
        count: usize,
    },
    /// A face has a corner that is no 32-bit index, such as −1.
    #[error("a corner of face {face} is no index")]
    NotAnIndex {
        /// The offending face.
        face: usize,
    },
    /// New positions do not match the vertices of the mesh they are meant for.
    #[error("{found} positions were given for a mesh of {expected} vertices")]
    PositionCount {
        /// The number of vertices.
        expected: usize,
        /// The number of positions given.
        found: usize,
    },
}
