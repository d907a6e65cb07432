//! Figures: pictures and plots side by side, with captions.

use std::sync::Arc;

use crate::colorbar::ColorBar;
use crate::drawing::{Anchor, Drawing, Element, INK};
use crate::error::FigureError;
use crate::image::Image;
use crate::text::{Style, width, wrap};

/// One part of a figure.
#[derive(Debug, Clone)]
pub struct Panel {
    drawing: Drawing,
    caption: String,
    bar: Option<ColorBar>,
}

impl Panel {
    /// A picture, shown `width` CSS pixels wide: two pixels or more for each
    /// look sharp in print.
    pub fn image(image: Image, width: f64) -> Self {
        let height = width * f64::from(image.height()) / f64::from(image.width());
        let mut drawing = Drawing::new(width, height);
        let (at, size, image) = ([0.0; 2], [width, height], Arc::new(image));
        drawing.elements.push(Element::Image { at, size, image });
        Self::drawing(drawing)
    }

    /// A plot or any other drawing.
    pub fn drawing(drawing: Drawing) -> Self {
        Self { drawing, caption: String::new(), bar: None }
    }

    /// A caption, shown below after the letter of the panel.
    pub fn caption(self, caption: impl Into<String>) -> Self {
        Self { caption: caption.into(), ..self }
    }

    /// A colour bar of its own, shown between picture and caption.
    pub fn bar(self, bar: ColorBar) -> Self {
        Self { bar: Some(bar), ..self }
    }
}

/// Panels in rows, lettered (a), (b), …, with shared colour bars and a
/// caption below.
#[derive(Debug, Clone, Default)]
pub struct Figure {
    /// The parts, row by row.
    pub panels: Vec<Panel>,
    /// Panels in a row; 0 counts as 1.
    pub columns: usize,
    /// Headings above the columns; may be empty.
    pub column_titles: Vec<String>,
    /// Headings to the left of the rows, running upward; may be empty.
    pub row_titles: Vec<String>,
    /// Colour bars that hold for all panels, side by side.
    pub bars: Vec<ColorBar>,
    /// The text before the caption, in bold, such as `Figure 3.`
    pub number: String,
    /// The caption below everything.
    pub caption: String,
}

const MARGIN: f64 = 16.0;
const GAP: f64 = 14.0;
const TITLE: f64 = 14.0;
const CAPTION: f64 = 13.5;
const LINE: f64 = 19.0;
const BAR_WIDTH: f64 = 340.0;

impl Figure {
    /// Composes the figure.
    pub fn draw(&self) -> Drawing {
        let columns = self.columns.clamp(1, self.panels.len().max(1));
        let rows: Vec<&[Panel]> = self.panels.chunks(columns).collect();
        let mut widths = vec![0.0f64; columns];
        for row in &rows {
            for (w, panel) in widths.iter_mut().zip(*row) {
                *w = w.max(panel.drawing.width);
            }
        }
        let left = MARGIN + if self.row_titles.is_empty() { 0.0 } else { TITLE + 10.0 };
        let inner: f64 = widths.iter().sum::<f64>() + GAP * (columns - 1) as f64;
        let bars = self.bars.len() as f64;
        let bar_width = if bars > 0.0 { BAR_WIDTH.min((inner - GAP) / bars) } else { 0.0 };
        let mut out = Drawing::new(left + inner + MARGIN, 0.0);
        let column = |c: usize| left + widths[..c].iter().map(|w| w + GAP).sum::<f64>();

        let mut y = MARGIN;
        if !self.column_titles.is_empty() {
            y += TITLE;
            for (c, title) in self.column_titles.iter().enumerate().take(columns) {
                let middle = [column(c) + widths[c] / 2.0, y];
                out.text(middle, TITLE, Anchor::Middle, Style::Bold, INK, title);
            }
            y += 8.0;
        }
        for (r, row) in rows.iter().enumerate() {
            let tallest = row.iter().map(|p| p.drawing.height).fold(0.0, f64::max);
            if let Some(title) = self.row_titles.get(r) {
                out.text_upward([MARGIN + TITLE, y + tallest / 2.0], TITLE, Style::Bold, title);
            }
            let mut lowest = y;
            for (c, panel) in row.iter().enumerate() {
                let letter = (self.panels.len() > 1).then(|| letter(r * columns + c));
                let x = column(c) + (widths[c] - panel.drawing.width) / 2.0;
                out.place([x, y + (tallest - panel.drawing.height) / 2.0], panel.drawing.clone());
                let below = panel.below(&mut out, [column(c), y + tallest], widths[c], letter);
                lowest = lowest.max(below);
            }
            y = lowest + GAP;
        }
        if !self.bars.is_empty() {
            y += 4.0;
            let total = bars * bar_width + GAP * (bars - 1.0);
            let mut tallest = 0.0f64;
            for (i, bar) in self.bars.iter().enumerate() {
                let drawing = bar.draw(bar_width);
                let x = left + (inner - total) / 2.0 + i as f64 * (bar_width + GAP);
                tallest = tallest.max(drawing.height);
                out.place([x, y], drawing);
            }
            y += tallest + GAP;
        }
        y = self.write_caption(&mut out, [left, y], inner);
        out.height = y + MARGIN - GAP;
        out
    }

    /// The figure as an SVG file.
    ///
    /// # Errors
    ///
    /// [`FigureError::Png`] if an image cannot be embedded.
    pub fn to_svg(&self) -> Result<String, FigureError> {
        self.draw().to_svg()
    }

    /// The figure as a PNG file, `zoom` pixels for each CSS pixel.
    ///
    /// # Errors
    ///
    /// [`FigureError`] if the figure is empty or too large.
    pub fn to_png(&self, zoom: f64) -> Result<Vec<u8>, FigureError> {
        self.draw().to_image(zoom)?.to_png()
    }

    fn write_caption(&self, out: &mut Drawing, [x, mut y]: [f64; 2], limit: f64) -> f64 {
        if self.number.is_empty() && self.caption.is_empty() {
            return y;
        }
        // The number is set in bold, which is wider: its lines are broken
        // with no-break spaces in its place.
        let lead = if self.number.is_empty() {
            0.0
        } else {
            width(&format!("{} ", self.number), CAPTION, Style::Bold) + 0.35 * CAPTION
        };
        let mut words = self.caption.split_whitespace().peekable();
        let mut first = String::new();
        while let Some(word) = words.peek() {
            let longer = if first.is_empty() { (*word).into() } else { format!("{first} {word}") };
            if !first.is_empty() && lead + width(&longer, CAPTION, Style::Regular) > limit {
                break;
            }
            first = longer;
            words.next();
        }
        y += CAPTION;
        out.text([x, y], CAPTION, Anchor::Start, Style::Bold, INK, &self.number);
        out.text([x + lead, y], CAPTION, Anchor::Start, Style::Regular, INK, &first);
        let rest: Vec<&str> = words.collect();
        for line in wrap(&rest.join(" "), CAPTION, limit) {
            y += LINE;
            out.text([x, y], CAPTION, Anchor::Start, Style::Regular, INK, &line);
        }
        y + GAP
    }
}

impl Panel {
    /// Bar and caption below the picture; returns where they end.
    fn below(
        &self,
        out: &mut Drawing,
        [x, mut y]: [f64; 2],
        width: f64,
        letter: Option<String>,
    ) -> f64 {
        if let Some(bar) = &self.bar {
            y += 6.0;
            let drawing = bar.draw(width.min(BAR_WIDTH));
            let height = drawing.height;
            out.place([x + (width - drawing.width) / 2.0, y], drawing);
            y += height;
        }
        let words = match letter {
            Some(letter) if self.caption.is_empty() => format!("({letter})"),
            Some(letter) => format!("({letter}) {}", self.caption),
            None => self.caption.clone(),
        };
        y += 2.0;
        let beside = (width - self.drawing.width) / 2.0;
        for line in wrap(&words, CAPTION, width) {
            y += LINE;
            let half = self::width(&line, CAPTION, Style::Regular) / 2.0;
            let middle = (beside + self.drawing.middle).clamp(half, (width - half).max(half));
            let middle = [x + middle, y - 4.0];
            out.text(middle, CAPTION, Anchor::Middle, Style::Regular, INK, &line);
        }
        y
    }
}

/// a, b, …, z, aa, ab, …
fn letter(mut i: usize) -> String {
    let mut letters = Vec::new();
    loop {
        letters.push(char::from(b'a' + (i % 26) as u8));
        if i < 26 {
            return letters.iter().rev().collect();
        }
        i = i / 26 - 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_go_on_after_z() {
        assert_eq!(
            [0, 25, 26, 27, 51, 52, 701, 702].map(letter),
            ["a", "z", "aa", "ab", "az", "ba", "zz", "aaa"]
        );
    }
}
