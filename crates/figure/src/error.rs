//! Why a picture cannot be made.

/// Why a mesh cannot be drawn.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RenderError {
    /// There is no face to draw.
    #[error("a mesh of {vertices} vertices has no face to draw")]
    Empty {
        /// The number of vertices of the meshes given.
        vertices: usize,
    },
    /// All vertices of the faces coincide, so that no distance shows them.
    #[error("all faces lie in one point, ({}, {}, {})", point[0], point[1], point[2])]
    NoExtent {
        /// Where they lie.
        point: [f64; 3],
    },
    /// The mesh is so large, or so far from the camera's frame, that squared
    /// distances overflow.
    #[error("vertex {vertex} at ({:e}, {:e}, {:e}) is too far away to draw", position[0], position[1], position[2])]
    TooFar {
        /// The offending vertex.
        vertex: usize,
        /// Its position, in mesh units.
        position: [f64; 3],
    },
    /// Per-vertex values do not match the mesh.
    #[error("{found} {what} were given for a mesh of {expected} vertices")]
    Count {
        /// The kind of values: `colours`, `occlusion values` or `values`.
        what: &'static str,
        /// The number of vertices.
        expected: usize,
        /// The number of values given.
        found: usize,
    },
    /// The picture would be empty or larger than [`MAX_SIDE`](crate::MAX_SIDE).
    #[error(
        "a picture of {width} × {height} pixels with {samples} × {samples} samples each cannot be drawn"
    )]
    Size {
        /// Width in pixels.
        width: u32,
        /// Height in pixels.
        height: u32,
        /// Samples along each side of a pixel.
        samples: u32,
    },
}

/// Why values cannot be turned into colours.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ScaleError {
    /// A defined value is infinite or not a number.
    #[error("value {index} is {value}, which is not finite")]
    NonFinite {
        /// Its vertex or face.
        index: usize,
        /// The value.
        value: f64,
    },
    /// No value counts for the range: all are undefined.
    #[error("the field is undefined everywhere: there is no range of colours")]
    NoValues,
    /// The ends of the range are not ascending, or not percentages.
    #[error("a colour range cannot go from {low} to {high}")]
    Limits {
        /// The lower end.
        low: f64,
        /// The upper end.
        high: f64,
    },
    /// Values do not match the vertices.
    #[error("the field has {found} values for {expected} vertices")]
    Length {
        /// The number of vertices.
        expected: usize,
        /// The number of values.
        found: usize,
    },
    /// Flags do not match the values.
    #[error("{found} flags were given for {expected} values")]
    Count {
        /// The number of values.
        expected: usize,
        /// The number of flags.
        found: usize,
    },
}

/// Why a picture cannot be encoded.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EncodeError {
    /// The PNG encoder refused.
    #[error("the picture cannot be written as PNG")]
    Png(#[source] Box<dyn std::error::Error + Send + Sync>),
    /// The picture has no pixel or too many.
    #[error("a figure of {width} × {height} pixels cannot be drawn")]
    Size {
        /// Width in pixels.
        width: u32,
        /// Height in pixels.
        height: u32,
    },
}
