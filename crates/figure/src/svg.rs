//! Drawings as SVG files.

use std::fmt::Write as _;

use base64::Engine as _;

use crate::drawing::{Anchor, Color, Drawing, Element, Path, Stroke, Text};
use crate::error::FigureError;
use crate::outline::{Outline, Step};
use crate::text::Style;

/// The fonts in SVG: the embedded font first, so that pictures made here agree with drawings in a
/// browser that has it.
const FAMILY: &str = "DejaVu Sans, Verdana, sans-serif";

impl Drawing {
    /// A whole SVG file on white.
    ///
    /// # Errors
    ///
    /// [`FigureError::Png`] if an image cannot be embedded.
    pub fn to_svg(&self) -> Result<String, FigureError> {
        let (w, h) = (short(self.width), short(self.height));
        let ink = hex(crate::drawing::INK);
        let mut out = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}\" height=\"{h}\" \
             viewBox=\"0 0 {w} {h}\" font-family=\"{FAMILY}\" fill=\"{ink}\">\
             <rect width=\"{w}\" height=\"{h}\" fill=\"#fff\"/>",
        );
        write_all(&mut out, &self.elements)?;
        out.push_str("</svg>");
        Ok(out)
    }
}

fn write_all(out: &mut String, elements: &[Element]) -> Result<(), FigureError> {
    for element in elements {
        match element {
            Element::Path(path) => write_path(out, path),
            Element::Text(text) => write_text(out, text),
            Element::Data(json) => push(out, format_args!("<metadata>{}</metadata>", escape(json))),
            Element::Image { at: [x, y], size: [w, h], image } => {
                let data = base64::engine::general_purpose::STANDARD.encode(image.to_png()?);
                let [x, y, w, h] = [x, y, w, h].map(|&v| short(v));
                push(
                    out,
                    format_args!(
                        "<image x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\" \
                         href=\"data:image/png;base64,{data}\"/>"
                    ),
                );
            }
            Element::Group { at: [x, y], elements } => {
                push(out, format_args!("<g transform=\"translate({} {})\">", short(*x), short(*y)));
                write_all(out, elements)?;
                out.push_str("</g>");
            }
            Element::Clip { at: [x, y], size: [w, h], elements } => {
                // A nested picture shows nothing of what reaches beyond it.
                let [x, y, w, h] = [x, y, w, h].map(|&v| short(v));
                push(
                    out,
                    format_args!(
                        "<svg x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\" viewBox=\"{x} {y} {w} {h}\">"
                    ),
                );
                write_all(out, elements)?;
                out.push_str("</svg>");
            }
        }
    }
    Ok(())
}

/// Writing to a string cannot fail.
fn push(out: &mut String, words: std::fmt::Arguments<'_>) {
    let _ = out.write_fmt(words);
}

fn write_path(out: &mut String, path: &Path) {
    out.push_str("<path");
    if path.at != [0.0; 2] {
        let [x, y] = path.at.map(short);
        push(out, format_args!(" transform=\"translate({x} {y})\""));
    }
    push(out, format_args!(" d=\"{}\"", data(&path.outline)));
    match path.fill {
        None => out.push_str(" fill=\"none\""),
        Some(fill) => {
            push(out, format_args!(" fill=\"{}\"", hex(fill.color)));
            if fill.opacity < 1.0 {
                push(out, format_args!(" fill-opacity=\"{}\"", short(fill.opacity)));
            }
        }
    }
    if let Some(Stroke { color, width, dashes, round }) = path.stroke {
        push(out, format_args!(" stroke=\"{}\"", hex(color)));
        if width != 1.0 {
            push(out, format_args!(" stroke-width=\"{}\"", short(width)));
        }
        if round {
            out.push_str(" stroke-linejoin=\"round\"");
        }
        if !dashes.is_empty() {
            let lengths: Vec<String> = dashes.iter().map(|&d| short(d)).collect();
            push(out, format_args!(" stroke-dasharray=\"{}\"", lengths.join(" ")));
        }
    }
    out.push_str("/>");
}

fn data(outline: &Outline) -> String {
    let mut out = String::new();
    let point = |p: &[f64; 2]| format!("{} {}", short(p[0]), short(p[1]));
    for step in &outline.0 {
        match step {
            Step::Move(p) => push(&mut out, format_args!("M{}", point(p))),
            Step::Line(p) => push(&mut out, format_args!("L{}", point(p))),
            Step::Cubic(a, b, c) => {
                push(&mut out, format_args!("C{} {} {}", point(a), point(b), point(c)));
            }
            Step::Close => out.push('Z'),
        }
    }
    out
}

fn write_text(out: &mut String, text: &Text) {
    let [x, y] = text.at.map(short);
    if text.upward {
        push(out, format_args!("<text transform=\"translate({x} {y}) rotate(-90)\""));
    } else {
        push(out, format_args!("<text x=\"{x}\" y=\"{y}\""));
    }
    push(out, format_args!(" font-size=\"{}\" fill=\"{}\"", text.size, hex(text.color)));
    out.push_str(match text.anchor {
        Anchor::Start => "",
        Anchor::Middle => " text-anchor=\"middle\"",
        Anchor::End => " text-anchor=\"end\"",
    });
    if text.style == Style::Bold {
        out.push_str(" font-weight=\"bold\"");
    }
    push(out, format_args!(">{}</text>", escape(&text.words)));
}

/// Text for use between tags or in an attribute. Control characters, which XML
/// cannot hold, become replacement characters.
pub(crate) fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\n' | '\t' | '\r' => out.push(' '),
            '\u{fffe}' | '\u{ffff}' => out.push('\u{fffd}'),
            c if c.is_control() => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

/// A coordinate with as many digits as can be seen.
fn short(x: f64) -> String {
    let text = format!("{x:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".into() } else { text.into() }
}

/// `#rrggbb`.
fn hex([r, g, b]: Color) -> String {
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

    #[test]
    fn markup_in_words_is_only_words() {
        let mut drawing = Drawing::new(90.0, 30.0);
        let words = "</text><rect & \u{0} \"'>";
        drawing.text([2.0, 20.0], 12.0, Anchor::Start, Style::Regular, [0; 3], words);
        let svg = drawing.to_svg().unwrap();
        assert!(
            svg.contains("&lt;/text&gt;&lt;rect &amp; \u{fffd} &quot;&#39;&gt;</text>"),
            "{svg}"
        );
        assert_eq!(svg.matches("<text").count(), 1);
    }
}
