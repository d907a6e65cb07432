//! Plots: lines, points, bands and bars on linear or logarithmic axes.
//!
//! Drawn here and not by a plotting crate: of those that need no fonts on the
//! machine, `kuva` came closest, but it pads logarithmic axes to whole decades,
//! mixes labels like `1e-2` and `0.020` on one axis, sets a heavy legend
//! outside of the frame and lets wide labels run into the axis title; the
//! report needs so few kinds of plots that they are drawn here.

mod draw;
mod series;

pub use series::{Series, Shape};

use crate::error::FigureError;
use crate::ticks::{self, Ticks, power_of_ten};

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

/// The mapping of values to positions along an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum AxisScale {
    /// In proportion.
    #[default]
    Linear,
    /// In proportion to the logarithm; values must be positive.
    Log,
}

/// An axis of a plot.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Axis {
    /// Quantity and unit.
    pub label: String,
    /// The mapping of values to positions.
    pub scale: AxisScale,
    /// The ends; those of the data, with some air, if not given.
    pub limits: Option<[f64; 2]>,
}

impl Axis {
    /// A linear axis that fits the data.
    pub fn linear(label: impl Into<String>) -> Self {
        Self { label: label.into(), ..Self::default() }
    }

    /// A logarithmic axis that fits the data.
    pub fn log(label: impl Into<String>) -> Self {
        Self { label: label.into(), scale: AxisScale::Log, limits: None }
    }

    /// The same axis with given ends.
    pub fn from_to(self, low: f64, high: f64) -> Self {
        Self { limits: Some([low, high]), ..self }
    }
}

/// An axis whose ends are known.
#[derive(Debug, Clone, Copy)]
pub(super) struct Range {
    pub(super) low: f64,
    pub(super) high: f64,
    scale: AxisScale,
}

impl Range {
    /// Fits the axis to the extremes of the data, with some air.
    pub(super) fn fit(axis: &Axis, data: [f64; 2]) -> Result<Self, FigureError> {
        let scale = axis.scale;
        if let Some([low, high]) = axis.limits {
            let positive = scale == AxisScale::Linear || low > 0.0;
            return if low < high && (high - low).is_finite() && positive {
                Ok(Self { low, high, scale })
            } else {
                Err(FigureError::Limits { what: "an axis", low, high })
            };
        }
        let [low, high] = data;
        Ok(match scale {
            AxisScale::Linear => {
                let span = high - low;
                // A single value is in the middle of an axis of its size.
                let air = if span > 0.0 { 0.05 * span } else { low.abs().max(1.0) * 0.5 };
                Self { low: low - air, high: high + air, scale }
            }
            AxisScale::Log => {
                let air = if high > low { libm::pow(high / low, 0.06) } else { 3.0 };
                Self { low: low / air, high: high * air, scale }
            }
        })
    }

    /// 0 at the lower end, 1 at the upper; beyond for values outside.
    pub(super) fn position(&self, value: f64) -> f64 {
        match self.scale {
            AxisScale::Linear => (value - self.low) / (self.high - self.low),
            AxisScale::Log => libm::log(value / self.low) / libm::log(self.high / self.low),
        }
    }

    pub(super) fn ticks(&self, wanted: usize) -> Ticks {
        match self.scale {
            AxisScale::Linear => ticks::linear(self.low, self.high, wanted),
            AxisScale::Log => ticks::logarithmic(self.low, self.high, wanted),
        }
    }
}

/// The label of an axis with the power of ten taken out of its numbers.
pub(super) fn label(axis: &Axis, exponent: i32) -> String {
    match exponent {
        0 => axis.label.clone(),
        _ => format!("{} (×{})", axis.label, power_of_ten(exponent)),
    }
}
