//! Pieces of pictures with a size.

use std::sync::Arc;

use crate::image::Image;
use crate::outline::Outline;
use crate::text::Style;

/// Red, green and blue, each from 0 to 255.
pub(crate) type Color = [u8; 3];

/// The colour of words and axes.
pub(crate) const INK: Color = [0x1d, 0x1f, 0x23];
/// The colour of secondary text: tick labels, notes.
pub(crate) const SOFT: Color = [0x56, 0x5b, 0x63];
pub(crate) const WHITE: Color = [0xff; 3];

/// A piece of a picture: lines, areas, words and images in a box of known
/// size, in CSS pixels, with the origin at the top left and y downward.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawing {
    pub(crate) width: f64,
    pub(crate) height: f64,
    /// The centre for text below: the middle of the width, or of the frame of a plot.
    pub(crate) middle: f64,
    pub(crate) elements: Vec<Element>,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Element {
    Path(Path),
    Text(Text),
    /// An image, stretched over a box.
    Image {
        at: [f64; 2],
        size: [f64; 2],
        image: Arc<Image>,
    },
    /// Data about the picture for a page, as JSON; not drawn.
    Data(String),
    /// Elements moved by an offset.
    Group {
        at: [f64; 2],
        elements: Vec<Element>,
    },
    /// Elements clipped to a box.
    Clip {
        at: [f64; 2],
        size: [f64; 2],
        elements: Vec<Element>,
    },
}

/// An outline with its look, moved by an offset.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Path {
    pub(crate) at: [f64; 2],
    pub(crate) outline: Outline,
    pub(crate) fill: Option<Fill>,
    pub(crate) stroke: Option<Stroke>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Fill {
    pub(crate) color: Color,
    /// From 0 to 1.
    pub(crate) opacity: f64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Stroke {
    pub(crate) color: Color,
    pub(crate) width: f64,
    /// Lengths of dashes and gaps in turn; none for a solid line.
    pub(crate) dashes: &'static [f64],
    /// True for round corners.
    pub(crate) round: bool,
}

/// A line of words.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Text {
    /// Where the anchor is on the baseline.
    pub(crate) at: [f64; 2],
    pub(crate) size: f64,
    pub(crate) anchor: Anchor,
    pub(crate) style: Style,
    pub(crate) color: Color,
    pub(crate) words: String,
    /// True for text that runs upward instead of to the right.
    pub(crate) upward: bool,
}

/// The point of a line of text that lies at its position.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

impl Stroke {
    /// A thin solid line.
    pub(crate) fn thin(color: Color) -> Self {
        Self { color, width: 1.0, dashes: &[], round: false }
    }

    /// A line of a plot, with dashes or without.
    pub(crate) fn line(color: Color, dashes: &'static [f64]) -> Self {
        Self { color, width: 1.8, dashes, round: true }
    }
}

impl Drawing {
    pub(crate) fn new(width: f64, height: f64) -> Self {
        Self { width, height, middle: width / 2.0, elements: Vec::new() }
    }

    /// Width in CSS pixels.
    pub fn width(&self) -> f64 {
        self.width
    }

    /// Height in CSS pixels.
    pub fn height(&self) -> f64 {
        self.height
    }

    /// Fills an area.
    pub(crate) fn fill(&mut self, outline: Outline, color: Color, opacity: f64) {
        let fill = Some(Fill { color, opacity });
        self.elements.push(Element::Path(Path { at: [0.0; 2], outline, fill, stroke: None }));
    }

    /// Draws a line.
    pub(crate) fn stroke(&mut self, outline: Outline, stroke: Stroke) {
        let stroke = Some(stroke);
        self.elements.push(Element::Path(Path { at: [0.0; 2], outline, fill: None, stroke }));
    }

    /// A straight thin line.
    pub(crate) fn segment(&mut self, from: [f64; 2], to: [f64; 2], color: Color) {
        self.stroke(Outline::polyline([from, to]), Stroke::thin(color));
    }

    pub(crate) fn text(
        &mut self,
        at: [f64; 2],
        size: f64,
        anchor: Anchor,
        style: Style,
        color: Color,
        words: &str,
    ) {
        if !words.is_empty() {
            let words = words.into();
            let text = Text { at, size, anchor, style, color, words, upward: false };
            self.elements.push(Element::Text(text));
        }
    }

    /// Text that runs upward, its middle at `at`.
    pub(crate) fn text_upward(&mut self, at: [f64; 2], size: f64, style: Style, words: &str) {
        if !words.is_empty() {
            let (anchor, words) = (Anchor::Middle, words.into());
            let text = Text { at, size, anchor, style, color: INK, words, upward: true };
            self.elements.push(Element::Text(text));
        }
    }

    /// Places another drawing with its top left corner at `at`.
    pub(crate) fn place(&mut self, at: [f64; 2], other: Self) {
        self.elements.push(Element::Group { at, elements: other.elements });
    }
}
