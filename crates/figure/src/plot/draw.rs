//! Plots as drawings.

use super::series::{QUIET, REFERENCE, Series, Shape, Style, slope_ends};
use super::{Axis, AxisScale, Legend, Plot, Range, label};
use crate::drawing::{Anchor, Color, Drawing, Element, Fill, INK, Path, SOFT, Stroke, WHITE};
use crate::error::FigureError;
use crate::outline::Outline;
use crate::text::{Style as Face, width};
use crate::ticks::Ticks;

const TICK_SIZE: f64 = 12.0;
const LABEL_SIZE: f64 = 13.0;
const NAME_SIZE: f64 = 12.5;
/// The distance between lines of text.
const LINE: f64 = 14.0;
const GRID: Color = [0xe8, 0xea, 0xed];

impl Plot {
    /// Draws the plot, `width × height` CSS pixels with all labels.
    ///
    /// # Errors
    ///
    /// [`FigureError`] for the first series that cannot be drawn.
    pub fn draw(&self, width: f64, height: f64) -> Result<Drawing, FigureError> {
        draw(self, width, height)
    }
}

fn draw(plot: &Plot, width: f64, height: f64) -> Result<Drawing, FigureError> {
    let styled = styles(&plot.series);
    let [x, y] = ranges(plot)?;
    let size = [width, height];
    let names = match plot.legend {
        Legend::Lines => widest(&plot.series).map_or(0.0, |widest| widest + 12.0),
        Legend::None => 0.0,
    };
    let frame = Frame::new(plot, [x, y], size, names);
    let mut out = Drawing::new(width, height);
    out.middle = (frame.left + frame.right) / 2.0;
    frame.axes(&mut out, plot);
    let [left, top, right, bottom] = frame.sides();
    let mut inside = Drawing::new(width, height);
    let behind = |s: &Series| matches!(s.shape, Shape::Band(_) | Shape::Bars(_));
    for (series, style) in styled.iter().filter(|(s, _)| behind(s)) {
        frame.series(&mut inside, plot, series, *style);
    }
    for quiet in [true, false] {
        for (series, style) in styled.iter().filter(|(s, _)| !behind(s) && s.quiet == quiet) {
            frame.series(&mut inside, plot, series, *style);
        }
    }
    // Parts beyond given limits are clipped.
    let (at, size) = ([left, top], [right - left, bottom - top]);
    out.elements.push(Element::Clip { at, size, elements: inside.elements });
    let corner = [[left, top], [left, bottom], [right, bottom]];
    out.stroke(Outline::polyline(corner), Stroke::thin(SOFT));
    if plot.legend == Legend::Lines {
        frame.name_lines(&mut out, &styled);
    }
    out.elements.push(Element::Data(frame.data(plot)));
    Ok(out)
}

/// The width of the widest name of a series; `None` without names.
fn widest(series: &[Series]) -> Option<f64> {
    let named = series.iter().filter(|s| !s.name.is_empty());
    named.map(|s| width(&s.name, NAME_SIZE, Face::Regular)).reduce(f64::max)
}

/// A JSON string.
fn quoted(text: &str) -> String {
    let mut out = String::from('"');
    for c in text.chars() {
        match c {
            '"' | '\\' => out.extend(['\\', c]),
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out + "\""
}

/// Each series with its style: the one requested, or the next.
fn styles(series: &[Series]) -> Vec<(&Series, Style)> {
    let mut next = 0;
    let mut style = |s: &Series| match s.style {
        Some(style) => style,
        None if s.is_styled() => {
            next += 1;
            next - 1
        }
        None => 0,
    };
    series.iter().map(|s| (s, Style(style(s)))).collect()
}

fn ranges(plot: &Plot) -> Result<[Range; 2], FigureError> {
    for series in &plot.series {
        series.check(plot.x.scale, plot.y.scale, plot.categories.len())?;
    }
    let mut points: Vec<[f64; 2]> = plot.series.iter().flat_map(Series::extent).collect();
    let mut bars = false;
    for series in &plot.series {
        match &series.shape {
            Shape::Bars(values) => {
                bars = true;
                points.extend(values.iter().enumerate().map(|(i, &y)| [i as f64 + 1.0, y]));
            }
            Shape::Level(y) => points.extend(points.first().map(|p| [p[0], *y])),
            _ => {}
        }
    }
    if points.is_empty() {
        return Err(FigureError::NoPoints);
    }
    let extremes = |k: usize| {
        let start = [f64::INFINITY, f64::NEG_INFINITY];
        points.iter().fold(start, |[lo, hi], p| [lo.min(p[k]), hi.max(p[k])])
    };
    let [low, high] = extremes(1);
    if !bars {
        return Ok([Range::fit(&plot.x, extremes(0))?, Range::fit(&plot.y, [low, high])?]);
    }
    let groups = Axis::default().from_to(0.5, plot.categories.len() as f64 + 0.5);
    let mut y = Range::fit(&plot.y, [low, high])?;
    if plot.y.limits.is_none() && plot.y.scale == AxisScale::Linear {
        // Bars are lengths: they begin at zero.
        y.low = if low >= 0.0 { 0.0 } else { y.low };
        y.high = if high <= 0.0 { 0.0 } else { y.high };
    }
    Ok([Range::fit(&groups, [0.0; 2])?, y])
}

/// The height of the lines of the categories after the first.
fn further(plot: &Plot) -> f64 {
    let lines = plot.categories.iter().map(|words| words.lines().count()).max().unwrap_or(1);
    LINE * lines.saturating_sub(1) as f64
}

/// The rectangle of the data, and how values are placed in it.
struct Frame {
    left: f64,
    top: f64,
    right: f64,
    bottom: f64,
    x: Range,
    y: Range,
    x_ticks: Ticks,
    y_ticks: Ticks,
}

impl Frame {
    /// Leaves room for labels, and for names on the right.
    fn new(plot: &Plot, [x, y]: [Range; 2], size: [f64; 2], names: f64) -> Self {
        let title = if plot.title.is_empty() { 0.0 } else { 24.0 };
        let below = further(plot) + if plot.x.label.is_empty() { 26.0 } else { 48.0 };
        let y_ticks = y.ticks(((size[1] - title - below) / 45.0).clamp(2.0, 8.0) as usize);
        let widest = y_ticks.major.iter().map(|(_, l)| width(l, TICK_SIZE, Face::Regular));
        let beside_y = if plot.y.label.is_empty() && y_ticks.exponent == 0 { 6.0 } else { 26.0 };
        let left = beside_y + widest.fold(0.0, f64::max) + 9.0;
        let right = size[0] - 14.0 - names;
        let x_ticks = x.ticks(((right - left) / 70.0).clamp(2.0, 8.0) as usize);
        let (top, bottom) = (title + 8.0, size[1] - below);
        Self { left, top, right, bottom, x, y, x_ticks, y_ticks }
    }

    fn sides(&self) -> [f64; 4] {
        [self.left, self.top, self.right, self.bottom]
    }

    fn at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        // Limited, because SVG readers mishandle huge numbers.
        let place = |t: f64, from: f64, to: f64| from + (to - from) * t.clamp(-50.0, 50.0);
        [
            place(self.x.position(x), self.left, self.right),
            place(self.y.position(y), self.bottom, self.top),
        ]
    }

    fn axes(&self, out: &mut Drawing, plot: &Plot) {
        let (left, top, right, bottom) = (self.left, self.top, self.right, self.bottom);
        let middle = (left + right) / 2.0;
        out.text([middle, 16.0], 14.0, Anchor::Middle, Face::Bold, INK, &plot.title);
        for (y, words) in &self.y_ticks.major {
            let [_, y] = self.at([self.x.low, *y]);
            out.segment([left, y], [right, y], GRID);
            out.segment([left, y], [left - 4.0, y], SOFT);
            out.text([left - 7.0, y + 4.3], TICK_SIZE, Anchor::End, Face::Regular, SOFT, words);
        }
        for y in &self.y_ticks.minor {
            let [_, y] = self.at([self.x.low, *y]);
            out.segment([left, y], [left - 2.5, y], SOFT);
        }
        if plot.categories.is_empty() {
            for (x, words) in &self.x_ticks.major {
                let [x, _] = self.at([*x, self.y.low]);
                out.segment([x, top], [x, bottom], GRID);
                out.segment([x, bottom], [x, bottom + 4.0], SOFT);
                let below = [x, bottom + 17.0];
                out.text(below, TICK_SIZE, Anchor::Middle, Face::Regular, SOFT, words);
            }
            for x in &self.x_ticks.minor {
                let [x, _] = self.at([*x, self.y.low]);
                out.segment([x, bottom], [x, bottom + 2.5], SOFT);
            }
        } else {
            for (i, words) in plot.categories.iter().enumerate() {
                let [x, _] = self.at([i as f64 + 1.0, self.y.low]);
                for (line, words) in words.lines().enumerate() {
                    let below = [x, bottom + 17.0 + LINE * line as f64];
                    out.text(below, TICK_SIZE, Anchor::Middle, Face::Regular, INK, words);
                }
            }
        }
        let exponent = if plot.categories.is_empty() { self.x_ticks.exponent } else { 0 };
        let below = [middle, bottom + 38.0 + further(plot)];
        let words = label(&plot.x, exponent);
        out.text(below, LABEL_SIZE, Anchor::Middle, Face::Regular, INK, &words);
        let words = label(&plot.y, self.y_ticks.exponent);
        out.text_upward([15.0, (top + bottom) / 2.0], LABEL_SIZE, Face::Regular, &words);
    }

    /// Names at the right ends of the lines, moved apart where they would cover one another.
    fn name_lines(&self, out: &mut Drawing, styled: &[(&Series, Style)]) {
        let mut ends: Vec<(f64, Color, &str)> = styled
            .iter()
            .filter_map(|(series, style)| {
                let last = match &series.shape {
                    // The last group is beside the names.
                    Shape::Bars(values) => [1.0, *values.last()?],
                    _ => series.extent().into_iter().max_by(|a, b| a[0].total_cmp(&b[0]))?,
                };
                let [_, y] = self.at(last);
                let color = if series.is_styled() { style.color() } else { SOFT };
                (!series.name.is_empty()).then_some((y, color, series.name.as_str()))
            })
            .collect();
        ends.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut lowest = self.top;
        for end in &mut ends {
            end.0 = end.0.max(lowest);
            lowest = end.0 + LINE;
        }
        let mut highest = self.bottom;
        for end in ends.iter_mut().rev() {
            end.0 = end.0.min(highest);
            highest = end.0 - LINE;
        }
        for (y, color, name) in ends {
            let at = [self.right + 7.0, y + 4.3];
            out.text(at, NAME_SIZE, Anchor::Start, Face::Regular, color, name);
        }
    }

    /// The title of the plot, and the positions and values of its points, as JSON.
    fn data(&self, plot: &Plot) -> String {
        /// A line of more points is described at this many of them.
        const MAX_POINTS: usize = 100;
        let brief = |x: f64| format!("{:.4e}", x).parse::<f64>().unwrap_or(x);
        let series = plot.series.iter().filter(|s| !s.name.is_empty() && !s.points_of().is_empty());
        let series = series.map(|s| {
            let points = s.points_of();
            let step = points.len().div_ceil(MAX_POINTS);
            let points = points.iter().step_by(step).map(|&p| {
                let [x, y] = self.at(p);
                format!("[{x:.1},{y:.1},{},{}]", brief(p[0]), brief(p[1]))
            });
            let points: Vec<String> = points.collect();
            format!("{{\"name\":{},\"points\":[{}]}}", quoted(&s.name), points.join(","))
        });
        let series: Vec<String> = series.collect();
        let (title, x, y) = (quoted(&plot.title), quoted(&plot.x.label), quoted(&plot.y.label));
        let series = series.join(",");
        format!("{{\"title\":{title},\"x\":{x},\"y\":{y},\"series\":[{series}]}}")
    }

    fn series(&self, out: &mut Drawing, plot: &Plot, series: &Series, style: Style) {
        let color = style.color();
        match &series.shape {
            Shape::Line(points) | Shape::MarkedLine(points) if series.quiet => {
                let path = Outline::polyline(points.iter().map(|&p| self.at(p)));
                out.stroke(path, Stroke { width: 1.2, ..Stroke::line(QUIET, &[]) });
            }
            Shape::Line(points) => self.path(out, points, color, style.dashes()),
            Shape::MarkedLine(points) => {
                self.path(out, points, color, &[]);
                self.marks(out, points, style);
            }
            Shape::Points(points) => self.marks(out, points, style),
            Shape::Band(points) => {
                let upper = points.iter().map(|&[x, _, high]| [x, high]);
                let lower = points.iter().rev().map(|&[x, low, _]| [x, low]);
                let corners = upper.chain(lower).map(|p| self.at(p));
                out.fill(Outline::polygon(corners), color, 0.18);
            }
            Shape::Bars(values) => self.bars(out, plot, series, values, color),
            Shape::Reference(points) => {
                self.path(out, points, SOFT, REFERENCE);
            }
            &Shape::Slope { order, through, span } => {
                let ends = slope_ends(order, through, span);
                self.path(out, &ends, SOFT, REFERENCE);
            }
            Shape::Level(y) => {
                let ends = [[self.x.low, *y], [self.x.high, *y]];
                self.path(out, &ends, SOFT, REFERENCE);
            }
        }
    }

    fn path(&self, out: &mut Drawing, points: &[[f64; 2]], color: Color, dashes: &'static [f64]) {
        let path = Outline::polyline(points.iter().map(|&p| self.at(p)));
        out.stroke(path, Stroke::line(color, dashes));
    }

    fn marks(&self, out: &mut Drawing, points: &[[f64; 2]], style: Style) {
        for &p in points {
            out.elements.push(Element::Path(Path {
                at: self.at(p),
                outline: style.mark(),
                fill: Some(Fill { color: style.color(), opacity: 1.0 }),
                stroke: Some(Stroke { width: 0.8, ..Stroke::thin(WHITE) }),
            }));
        }
    }

    /// The bars of one series stand side by side with those of the others.
    fn bars(&self, out: &mut Drawing, plot: &Plot, own: &Series, values: &[f64], color: Color) {
        let all = plot.series.iter().filter(|s| matches!(s.shape, Shape::Bars(_)));
        let count = all.clone().count() as f64;
        let place = all.clone().position(|s| std::ptr::eq(s, own)).unwrap_or(0) as f64;
        let each = 0.76 / count;
        let base = if self.y.low > 0.0 { self.y.low } else { 0f64.min(self.y.high) };
        for (i, &value) in values.iter().enumerate() {
            let middle = i as f64 + 1.0 - 0.38 + each * (place + 0.5);
            let [x0, y0] = self.at([middle - 0.45 * each, base]);
            let [x1, y1] = self.at([middle + 0.45 * each, value]);
            let (low, high) = (y0.max(y1), y0.min(y1));
            out.fill(Outline::rectangle([x0, high], [x1 - x0, low - high]), color, 1.0);
        }
    }
}
