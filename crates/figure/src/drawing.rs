//! Pieces of SVG with a size.

use std::fmt::Write;

use crate::text::{FAMILY, Style, escape};

/// The colour of words and axes.
pub(crate) const INK: &str = "#1d1f23";
/// The colour of what should stay behind: tick labels, notes.
pub(crate) const SOFT: &str = "#565b63";

/// A piece of a picture: SVG elements in a box of known size, in CSS pixels,
/// with the origin at the top left.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawing {
    pub(crate) width: f64,
    pub(crate) height: f64,
    pub(crate) body: String,
}

/// Where text stands relative to its position.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

impl Drawing {
    pub(crate) fn new(width: f64, height: f64) -> Self {
        Self { width, height, body: String::new() }
    }

    /// Width in CSS pixels.
    pub fn width(&self) -> f64 {
        self.width
    }

    /// Height in CSS pixels.
    pub fn height(&self) -> f64 {
        self.height
    }

    /// A whole SVG file on white.
    pub fn to_svg(&self) -> String {
        let (w, h) = (short(self.width), short(self.height));
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}\" height=\"{h}\" \
             viewBox=\"0 0 {w} {h}\" font-family=\"{FAMILY}\" fill=\"{INK}\">\
             <rect width=\"{w}\" height=\"{h}\" fill=\"#fff\"/>{}</svg>",
            self.body
        )
    }

    /// Adds elements as they are.
    pub(crate) fn push(&mut self, elements: std::fmt::Arguments<'_>) {
        // Writing to a string cannot fail.
        let _ = self.body.write_fmt(elements);
    }

    pub(crate) fn text(
        &mut self,
        [x, y]: [f64; 2],
        size: f64,
        anchor: Anchor,
        style: Style,
        color: &str,
        words: &str,
    ) {
        if words.is_empty() {
            return;
        }
        let anchor = match anchor {
            Anchor::Start => "",
            Anchor::Middle => " text-anchor=\"middle\"",
            Anchor::End => " text-anchor=\"end\"",
        };
        let weight = if style == Style::Bold { " font-weight=\"bold\"" } else { "" };
        let (x, y, words) = (short(x), short(y), escape(words));
        self.push(format_args!(
            "<text x=\"{x}\" y=\"{y}\" font-size=\"{size}\" fill=\"{color}\"{anchor}{weight}>{words}</text>"
        ));
    }

    /// Text that runs upward, its middle at (x, y).
    pub(crate) fn text_upward(&mut self, [x, y]: [f64; 2], size: f64, style: Style, words: &str) {
        let (x, y) = (short(x), short(y));
        self.push(format_args!("<g transform=\"translate({x} {y}) rotate(-90)\">"));
        self.text([0.0, 0.0], size, Anchor::Middle, style, INK, words);
        self.push(format_args!("</g>"));
    }

    /// Places another drawing with its top left corner at (x, y).
    pub(crate) fn place(&mut self, [x, y]: [f64; 2], other: &Self) {
        let (x, y) = (short(x), short(y));
        self.push(format_args!("<g transform=\"translate({x} {y})\">{}</g>", other.body));
    }
}

/// A coordinate with as many digits as can be seen.
pub(crate) fn short(x: f64) -> String {
    let text = format!("{x:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".into() } else { text.into() }
}

/// `#rrggbb`.
pub(crate) fn hex([r, g, b]: [u8; 3]) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_are_short() {
        assert_eq!(short(1.0), "1");
        assert_eq!(short(-0.001), "0");
        assert_eq!(short(2.456), "2.46");
        assert_eq!(short(100.0), "100");
        assert_eq!(hex([1, 171, 255]), "#01abff");
    }
}
