//! The data of plots.

use super::AxisScale;
use crate::drawing::Color;
use crate::error::FigureError;
use crate::outline::Outline;

/// Points that belong together.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// The name in the legend; none if empty.
    pub name: String,
    /// Points and how they are shown.
    pub shape: Shape,
    /// The colour, mark and dashes by number; series that belong together share one. By default the
    /// position among the series without a number.
    pub style: Option<usize>,
    /// True for a series behind the others, thin and grey.
    pub quiet: bool,
}

/// Points and how they are shown.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Shape {
    /// Points joined by straight lines in their order, with a mark each.
    MarkedLine(Vec<[f64; 2]>),
    /// Points joined by straight lines in their order.
    Line(Vec<[f64; 2]>),
    /// Points alone.
    Points(Vec<[f64; 2]>),
    /// The area between a lower and an upper value over x, as `[x, low, high]`:
    /// the spread over seeds, for example.
    Band(Vec<[f64; 3]>),
    /// One bar per category.
    Bars(Vec<f64>),
    /// A grey dashed line y ∝ xᵖ through a point, over a span of x; straight
    /// on logarithmic axes, where it shows an order of convergence.
    Slope {
        /// The exponent p.
        order: f64,
        /// The point it goes through.
        through: [f64; 2],
        /// Where it begins and ends.
        span: [f64; 2],
    },
    /// A grey dashed line through points: a reference for the others.
    Reference(Vec<[f64; 2]>),
    /// A grey horizontal line at a value, over the whole width.
    Level(f64),
}

impl Series {
    /// The number of colours. Styles that differ by it share one, and have other marks.
    pub const COLORS: usize = COLORS.len();

    /// A line with marks.
    pub fn marked(name: impl Into<String>, points: Vec<[f64; 2]>) -> Self {
        Self::new(name, Shape::MarkedLine(points))
    }

    /// A line.
    pub fn line(name: impl Into<String>, points: Vec<[f64; 2]>) -> Self {
        Self::new(name, Shape::Line(points))
    }

    /// Points alone.
    pub fn points(name: impl Into<String>, points: Vec<[f64; 2]>) -> Self {
        Self::new(name, Shape::Points(points))
    }

    /// Bars, one per category.
    pub fn bars(name: impl Into<String>, values: Vec<f64>) -> Self {
        Self::new(name, Shape::Bars(values))
    }

    /// The area between two values, in the style of series `style`, without a
    /// name of its own.
    pub fn band(points: Vec<[f64; 3]>, style: usize) -> Self {
        Self { style: Some(style), ..Self::new("", Shape::Band(points)) }
    }

    /// A reference slope of that order.
    pub fn slope(name: impl Into<String>, order: f64, through: [f64; 2], span: [f64; 2]) -> Self {
        Self::new(name, Shape::Slope { order, through, span })
    }

    /// A grey dashed line through points.
    pub fn reference(name: impl Into<String>, points: Vec<[f64; 2]>) -> Self {
        Self::new(name, Shape::Reference(points))
    }

    /// Any shape.
    pub fn new(name: impl Into<String>, shape: Shape) -> Self {
        Self { name: name.into(), shape, style: None, quiet: false }
    }

    /// The same series, thin and grey behind the others.
    #[must_use]
    pub fn quiet(self) -> Self {
        Self { quiet: true, ..self }
    }

    /// Returns true if the series has a colour of its own.
    pub(super) fn is_styled(&self) -> bool {
        let grey =
            matches!(self.shape, Shape::Slope { .. } | Shape::Reference(_) | Shape::Level(_));
        !grey && !self.quiet
    }

    /// The points that a reader can ask for.
    pub(super) fn points_of(&self) -> &[[f64; 2]] {
        match &self.shape {
            Shape::MarkedLine(p) | Shape::Line(p) | Shape::Points(p) | Shape::Reference(p) => p,
            _ => &[],
        }
    }

    /// All points that must lie in the frame, bars apart.
    pub(super) fn extent(&self) -> Vec<[f64; 2]> {
        match &self.shape {
            Shape::MarkedLine(p) | Shape::Line(p) | Shape::Points(p) | Shape::Reference(p) => {
                p.clone()
            }
            Shape::Band(p) => p.iter().flat_map(|&[x, a, b]| [[x, a], [x, b]]).collect(),
            Shape::Bars(_) | Shape::Level(_) => vec![],
            &Shape::Slope { order, through, span } => slope_ends(order, through, span).to_vec(),
        }
    }

    pub(super) fn check(
        &self,
        x_scale: AxisScale,
        y_scale: AxisScale,
        categories: usize,
    ) -> Result<(), FigureError> {
        let series = || self.name.clone();
        let mut points = self.extent();
        match &self.shape {
            Shape::Bars(values) => {
                if values.len() != categories {
                    let found = values.len();
                    return Err(FigureError::Bars {
                        series: series(),
                        expected: categories,
                        found,
                    });
                }
                points = values.iter().map(|&y| [1.0, y]).collect();
            }
            Shape::Level(y) => points.push([1.0, *y]),
            _ => {}
        }
        for (index, &[x, y]) in points.iter().enumerate() {
            if !x.is_finite() || !y.is_finite() {
                return Err(FigureError::Point {
                    series: series(),
                    index,
                    x,
                    y,
                    problem: "which is not finite",
                });
            }
            let log = |scale, value| scale == AxisScale::Log && value <= 0.0;
            if log(x_scale, x) || log(y_scale, y) {
                return Err(FigureError::Point {
                    series: series(),
                    index,
                    x,
                    y,
                    problem: "which has no place on a logarithmic axis",
                });
            }
        }
        Ok(())
    }
}

/// The ends of y = y₀ (x / x₀)ᵖ over a span of x.
pub(super) fn slope_ends(order: f64, [x0, y0]: [f64; 2], span: [f64; 2]) -> [[f64; 2]; 2] {
    span.map(|x| [x, y0 * libm::pow(x / x0, order)])
}

/// Colours that stay apart for colour-blind people and in grey
/// ([okabe2008], without the yellow, and with orange and sky blue darker: lines
/// have a contrast of at least 3 to a white ground, and all but the last to a
/// dark one, [wcag22]).
///
/// [okabe2008]: https://jfly.uni-koeln.de/color/
/// [wcag22]: https://www.w3.org/TR/WCAG22/
const COLORS: [Color; 7] = [
    [0x00, 0x72, 0xb2],
    [0xd5, 0x5e, 0x00],
    [0x00, 0x9e, 0x73],
    [0xcc, 0x79, 0xa7],
    [0xb8, 0x7f, 0x00],
    [0x3d, 0x94, 0xcf],
    [0x3b, 0x3b, 0x3b],
];

/// The dashes of reference lines.
pub(super) const REFERENCE: &[f64] = &[4.0, 3.0];

/// The colour of series in the background.
pub(super) const QUIET: Color = [0x87, 0x8d, 0x96];

/// The look of one series.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Style(pub(super) usize);

impl Style {
    pub(super) fn color(self) -> Color {
        COLORS[self.0 % COLORS.len()]
    }

    /// Dashes for lines without marks, so that they do not differ by colour alone.
    pub(super) fn dashes(self) -> &'static [f64] {
        [&[][..], &[7.0, 3.0], &[2.0, 3.0], &[9.0, 3.0, 2.0, 3.0]][self.0 % 4]
    }

    /// The outline of a mark about the origin.
    pub(super) fn mark(self) -> Outline {
        let cross = |a: f64, b: f64| {
            let quarter = [[-a, -b], [-b, -b], [-b, -a], [b, -a], [b, -b], [a, -b]];
            quarter.into_iter().chain(quarter.map(|[x, y]| [-x, -y]))
        };
        match self.0 % 6 {
            0 => Outline::circle(3.6),
            1 => Outline::rectangle([-3.3; 2], [6.6; 2]),
            2 => Outline::polygon([[0.0, -4.4], [4.2, 3.3], [-4.2, 3.3]]),
            3 => Outline::polygon([[0.0, -4.7], [4.2, 0.0], [0.0, 4.7], [-4.2, 0.0]]),
            4 => Outline::polygon([[0.0, 4.4], [4.2, -3.3], [-4.2, -3.3]]),
            _ => Outline::polygon(cross(4.2, 1.5)),
        }
    }
}
