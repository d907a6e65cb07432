//! Errors of pictures and plots.

/// The reason why a picture or a plot cannot be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FigureError {
    /// There is no face to draw.
    #[error("a mesh of {vertices} vertices has no face to draw")]
    NoFaces {
        /// The number of vertices of the meshes given.
        vertices: usize,
    },
    /// All corners coincide, so no camera can frame the mesh.
    #[error("all faces lie in one point, ({}, {}, {})", point[0], point[1], point[2])]
    NoExtent {
        /// The point.
        point: [f64; 3],
    },
    /// A vertex is so far from the camera that squared distances overflow.
    #[error("vertex {vertex} at ({:e}, {:e}, {:e}) is too far away to draw", position[0], position[1], position[2])]
    TooFar {
        /// The vertex.
        vertex: usize,
        /// Its position, in mesh units.
        position: [f64; 3],
    },
    /// The number of values differs from the number of elements they belong to.
    #[error("{found} {what} were given, but {expected} are needed")]
    Count {
        /// The kind of values, such as `colours` or `flags`.
        what: &'static str,
        /// The number of vertices, faces or values that need one each.
        expected: usize,
        /// The number of values given.
        found: usize,
    },
    /// A picture without pixels, or one larger than [`MAX_SIDE`](crate::MAX_SIDE).
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
    /// A defined value of a field is infinite or not a number.
    #[error("value {index} is {value}, which is not finite")]
    NonFinite {
        /// Its vertex or face.
        index: usize,
        /// The value.
        value: f64,
    },
    /// No value counts for the range of colours: all are undefined.
    #[error("the field is undefined everywhere: there is no range of colours")]
    NoValues,
    /// No mesh of a page has the field that is to colour it.
    #[error("there is no field {name}")]
    NoField {
        /// The name asked for.
        name: String,
    },
    /// The ends of a range of colours or of an axis do not ascend, or are not
    /// possible: percentages outside 0 to 100, or a logarithmic axis from zero.
    #[error("{what} cannot go from {low} to {high}")]
    Limits {
        /// `a colour range` or `an axis`.
        what: &'static str,
        /// The lower end.
        low: f64,
        /// The upper end.
        high: f64,
    },
    /// No series of a plot has a point.
    #[error("there is nothing to plot")]
    NoPoints,
    /// A point of a plot cannot be placed on its axes.
    #[error("{series}: point {index} is ({x}, {y}), {problem}")]
    Point {
        /// The name of the series.
        series: String,
        /// The point.
        index: usize,
        /// Its horizontal coordinate.
        x: f64,
        /// Its vertical coordinate.
        y: f64,
        /// The reason, such as `which is not finite`.
        problem: &'static str,
    },
    /// Bars do not match the categories of a plot.
    #[error("{series}: {found} bars for {expected} categories")]
    Bars {
        /// The name of the series.
        series: String,
        /// The number of categories.
        expected: usize,
        /// The number of bars.
        found: usize,
    },
    /// Modules of a page do not fit together.
    #[error("{0}")]
    Script(String),
    /// The PNG encoder refused.
    #[error("the picture cannot be written as PNG: {0}")]
    Png(String),
}
