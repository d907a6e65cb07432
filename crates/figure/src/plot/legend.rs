//! The legend of a plot.

use super::series::{REFERENCE, Series, Shape, Style};
use crate::drawing::{Anchor, Color, Drawing, Element, Fill, INK, Path, SOFT, Stroke, WHITE};
use crate::outline::Outline;
use crate::text::{Style as Face, width};

pub(super) const SIZE: f64 = 12.5;
const LINE: f64 = 18.0;
const SWATCH: f64 = 26.0;
const PAD: f64 = 7.0;
const BORDER: Color = [0xd5, 0xd8, 0xdd];

/// The width of the widest name; 0 without names.
pub(super) fn widest(series: &[(&Series, Style)]) -> f64 {
    series.iter().map(|(s, _)| width(&s.name, SIZE, Face::Regular)).fold(0.0, f64::max)
}

/// The names and looks of all series that have a name; `None` if there is
/// none.
pub(super) fn draw(series: &[(&Series, Style)]) -> Option<Drawing> {
    let named: Vec<_> = series.iter().filter(|(s, _)| !s.name.is_empty()).collect();
    let widest = named.iter().map(|(s, _)| width(&s.name, SIZE, Face::Regular)).reduce(f64::max)?;
    let size = [widest + SWATCH + 3.0 * PAD, LINE * named.len() as f64 + 1.5 * PAD];
    let mut out = Drawing::new(size[0], size[1]);
    out.elements.push(Element::Path(Path {
        at: [0.0; 2],
        outline: Outline::rounded([0.0; 2], size, 3.0),
        fill: Some(Fill { color: WHITE, opacity: 0.85 }),
        stroke: Some(Stroke::thin(BORDER)),
    }));
    for (i, (series, style)) in named.iter().enumerate() {
        let y = PAD * 0.75 + LINE * (i as f64 + 0.5);
        swatch(&mut out, series, *style, [PAD, y]);
        let start = [SWATCH + 2.0 * PAD, y + 4.4];
        out.text(start, SIZE, Anchor::Start, Face::Regular, INK, &series.name);
    }
    Some(out)
}

/// The same in rows no wider than `limit`, without a box, for below the frame.
pub(super) fn rows(series: &[(&Series, Style)], limit: f64) -> Drawing {
    let mut out = Drawing::new(limit, LINE);
    let (mut x, mut y) = (0.0, 0.5 * LINE);
    for (series, style) in series.iter().filter(|(s, _)| !s.name.is_empty()) {
        let item = SWATCH + PAD + width(&series.name, SIZE, Face::Regular);
        if x > 0.0 && x + item > limit {
            (x, y) = (0.0, y + LINE);
            out.height += LINE;
        }
        swatch(&mut out, series, *style, [x, y]);
        let start = [x + SWATCH + PAD, y + 4.4];
        out.text(start, SIZE, Anchor::Start, Face::Regular, INK, &series.name);
        x += item + 2.5 * PAD;
    }
    out
}

fn swatch(out: &mut Drawing, series: &Series, style: Style, [left, y]: [f64; 2]) {
    let color = style.color();
    let line = |out: &mut Drawing, color, dashes| {
        let ends = [[left, y], [left + SWATCH, y]];
        out.stroke(Outline::polyline(ends), Stroke::line(color, dashes));
    };
    match series.shape {
        Shape::Line(_) => line(out, color, style.dashes()),
        Shape::Slope { .. } | Shape::Reference(_) | Shape::Level(_) => line(out, SOFT, REFERENCE),
        Shape::MarkedLine(_) => line(out, color, &[]),
        Shape::Band(_) | Shape::Bars(_) => {
            let opacity = if matches!(series.shape, Shape::Band(_)) { 0.2 } else { 1.0 };
            out.fill(Outline::rectangle([left, y - 4.5], [SWATCH, 9.0]), color, opacity);
        }
        Shape::Points(_) => {}
    }
    if matches!(series.shape, Shape::MarkedLine(_) | Shape::Points(_)) {
        out.elements.push(Element::Path(Path {
            at: [left + SWATCH / 2.0, y],
            outline: style.mark(),
            fill: Some(Fill { color, opacity: 1.0 }),
            stroke: None,
        }));
    }
}

/// The corner of the frame, as the top left of the legend, in which the
/// fewest of `taken` lie; `None` if none is nearly free.
pub(super) fn corner(legend: &Drawing, frame: [f64; 4], taken: &[[f64; 2]]) -> Option<[f64; 2]> {
    let [left, top, right, bottom] = frame;
    let gap = 8.0;
    let (w, h) = (legend.width, legend.height);
    if w + 2.0 * gap > 0.7 * (right - left) || h + 2.0 * gap > 0.7 * (bottom - top) {
        return None;
    }
    let [x0, x1] = [left + gap, right - gap - w];
    let [y0, y1] = [top + gap, bottom - gap - h];
    let hidden = |&[x, y]: &[f64; 2]| {
        let inside = |p: &&[f64; 2]| {
            p[0] > x - 4.0 && p[0] < x + w + 4.0 && p[1] > y - 4.0 && p[1] < y + h + 4.0
        };
        taken.iter().filter(inside).count()
    };
    [[x1, y0], [x0, y0], [x1, y1], [x0, y1]].into_iter().find(|c| hidden(c) == 0)
}
