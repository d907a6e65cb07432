//! Plots: lines, points, bands and bars on linear or logarithmic axes.
//!
//! Drawn here and not by a plotting crate: of those that need no fonts on the
//! machine, `kuva` came closest, but it pads logarithmic axes to whole decades,
//! mixes labels like `1e-2` and `0.020` on one axis, sets a heavy legend
//! outside of the frame and lets wide labels run into the axis title; the
//! report needs so few kinds of plots that they are drawn here.

mod axis;
mod draw;
mod series;

pub use axis::{Axis, AxisScale};
pub use series::{Series, Shape};

/// Series over two axes.
#[derive(Debug, Clone, Default)]
pub struct Plot {
    /// Stands above the frame; may be empty.
    pub title: String,
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// Drawn in this order, except that bands and bars come first.
    pub series: Vec<Series>,
    /// Names of the groups of bars, from left to right, perhaps of several
    /// lines; the horizontal axis then has no numbers.
    pub categories: Vec<String>,
    /// The position of the names of the series.
    pub legend: Legend,
}

/// The position of the names of the series.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Legend {
    /// At the ends of their lines, to the right of the frame, in the colours of the lines.
    #[default]
    Lines,
    /// Nowhere.
    None,
}
