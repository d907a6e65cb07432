//! Errors of plots.

/// The reason why a plot cannot be drawn.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlotError {
    /// No series has a point.
    #[error("there is nothing to plot")]
    Empty,
    /// A coordinate is infinite or not a number.
    #[error("{series}: point {index} is ({x}, {y}), which is not finite")]
    NonFinite {
        /// The name of the series.
        series: String,
        /// The point.
        index: usize,
        /// Its horizontal coordinate.
        x: f64,
        /// Its vertical coordinate.
        y: f64,
    },
    /// A coordinate on a logarithmic axis is not positive.
    #[error("{series}: point {index} is ({x}, {y}), which has no place on a logarithmic axis")]
    NotPositive {
        /// The name of the series.
        series: String,
        /// The point.
        index: usize,
        /// Its horizontal coordinate.
        x: f64,
        /// Its vertical coordinate.
        y: f64,
    },
    /// Bars do not match the categories.
    #[error("{series}: {found} bars for {expected} categories")]
    Bars {
        /// The name of the series.
        series: String,
        /// The number of categories.
        expected: usize,
        /// The number of bars.
        found: usize,
    },
    /// The limits of an axis are not ascending, not finite, or not positive on
    /// a logarithmic axis.
    #[error("an axis cannot go from {low} to {high}")]
    Limits {
        /// The lower end.
        low: f64,
        /// The upper end.
        high: f64,
    },
}
