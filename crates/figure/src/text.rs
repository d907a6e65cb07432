//! Words in pictures: the embedded font, their width, and SVG into pixels.

use std::sync::OnceLock;

use resvg::{tiny_skia, usvg};

use crate::error::EncodeError;
use crate::image::Image;

/// What SVG asks for: the embedded font first, so that pictures made here
/// and drawings shown by a browser that has it agree.
pub(crate) const FAMILY: &str = "DejaVu Sans, Verdana, sans-serif";

/// Weight and slope.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Style {
    Regular,
    Bold,
}

/// The embedded fonts: DejaVu Sans, cut down to Latin, Greek, sub- and
/// superscripts, arrows and mathematical signs. Nothing is looked for on the
/// machine, so that pictures are the same on all of them.
fn options() -> &'static usvg::Options<'static> {
    static OPTIONS: OnceLock<usvg::Options<'static>> = OnceLock::new();
    OPTIONS.get_or_init(|| {
        let mut options = usvg::Options { font_family: "DejaVu Sans".into(), ..Default::default() };
        let fonts = options.fontdb_mut();
        for font in [
            &include_bytes!("../fonts/DejaVuSans.ttf")[..],
            include_bytes!("../fonts/DejaVuSans-Bold.ttf"),
            include_bytes!("../fonts/DejaVuSans-Oblique.ttf"),
        ] {
            fonts.load_font_data(font.to_vec());
        }
        fonts.set_sans_serif_family("DejaVu Sans");
        fonts.set_serif_family("DejaVu Sans");
        fonts.set_monospace_family("DejaVu Sans");
        options
    })
}

/// Text for use between tags or in an attribute. Control characters, which
/// XML cannot hold, become replacement characters.
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

/// The width of a line of text in the embedded font.
pub(crate) fn width(text: &str, size: f64, style: Style) -> f64 {
    if text.trim().is_empty() {
        return 0.0;
    }
    let weight = if style == Style::Bold { "bold" } else { "normal" };
    let svg = format!(
        "<svg xmlns='http://www.w3.org/2000/svg' width='1' height='1'><text x='0' y='0' \
         font-family='{FAMILY}' font-size='{size}' font-weight='{weight}'>{}</text></svg>",
        escape(text)
    );
    match usvg::Tree::from_str(&svg, options()) {
        Ok(tree) => f64::from(tree.root().abs_bounding_box().right()),
        // Cannot happen with escaped text; a guess keeps the layout sane.
        Err(_) => 0.6 * size * text.chars().count() as f64,
    }
}

/// Breaks text at spaces into lines no wider than `limit`; a longer word gets
/// a line of its own.
pub(crate) fn wrap(text: &str, size: f64, limit: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        if let Some(line) = lines.last_mut() {
            let longer = format!("{line} {word}");
            if width(&longer, size, Style::Regular) <= limit {
                *line = longer;
                continue;
            }
        }
        lines.push(word.into());
    }
    lines
}

/// Draws SVG as pixels, `zoom` of them for each unit of its size. Text uses
/// the embedded fonts only, and nothing is loaded from files or the network.
///
/// # Errors
///
/// [`EncodeError::Svg`] if the text is not SVG, [`EncodeError::Size`] if the
/// picture would be empty or larger than [`MAX_SIDE`](crate::MAX_SIDE).
pub fn draw_svg(svg: &str, zoom: f64) -> Result<Image, EncodeError> {
    let tree = usvg::Tree::from_str(svg, options()).map_err(|e| EncodeError::Svg(e.to_string()))?;
    let pixels =
        |side: f32| (f64::from(side) * zoom).round().clamp(0.0, f64::from(u32::MAX)) as u32;
    let (width, height) = (pixels(tree.size().width()), pixels(tree.size().height()));
    let largest = crate::MAX_SIDE;
    if width == 0 || height == 0 || width > largest || height > largest {
        return Err(EncodeError::Size { width, height });
    }
    let mut map =
        tiny_skia::Pixmap::new(width, height).ok_or(EncodeError::Size { width, height })?;
    let transform = tiny_skia::Transform::from_scale(zoom as f32, zoom as f32);
    resvg::render(&tree, transform, &mut map.as_mut());
    let straight = |p: &tiny_skia::PremultipliedColorU8| {
        let c = p.demultiply();
        [c.red(), c.green(), c.blue(), c.alpha()]
    };
    Ok(Image::new(width, height, map.pixels().iter().map(straight).collect()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A glyph that the font lacks has no width of its own; all that the
    /// report's words need must be there, in each style.
    #[test]
    fn every_sign_of_the_report_has_a_glyph() {
        let signs = "κλσφθτχμεαβγΔπΣ₀₁₂₃₄₅ₙₖᵢⱼ−×°²³⁻¹⁴⁵√∞≈≤≥±→…–—‖·½∇⟨⟩ℓ←↑▲ŁéüßÅ";
        for style in [Style::Regular, Style::Bold] {
            let missing = width("\u{4e00}", 100.0, style);
            for sign in signs.chars() {
                let found = width(&sign.to_string(), 100.0, style);
                assert!(found > 0.0 && found != missing, "{sign} in {style:?}");
            }
        }
    }

    #[test]
    fn widths_add_up() {
        let one = width("m", 20.0, Style::Regular);
        assert!((width("mmmm", 20.0, Style::Regular) - 4.0 * one).abs() < 0.5);
        assert!((width("m", 40.0, Style::Regular) - 2.0 * one).abs() < 0.1);
        assert!(width("m", 20.0, Style::Bold) > one);
    }

    #[test]
    fn lines_stay_within_the_limit() {
        let text = "the quick brown fox jumps over the lazy dog and on and on";
        let lines = wrap(text, 14.0, 120.0);
        assert!(lines.len() > 2);
        assert!(lines.iter().all(|l| width(l, 14.0, Style::Regular) <= 120.0));
        assert_eq!(lines.join(" "), text);
    }

    #[test]
    fn markup_in_words_is_only_words() {
        let svg = format!(
            "<svg xmlns='http://www.w3.org/2000/svg' width='90' height='30'>\
             <text x='2' y='20'>{}</text></svg>",
            escape("</text><rect & \u{0} \"'>")
        );
        assert!(draw_svg(&svg, 1.0).is_ok());
        assert!(matches!(draw_svg("<svg", 1.0), Err(EncodeError::Svg(_))));
        assert!(matches!(draw_svg(&svg, 1e6), Err(EncodeError::Size { .. })));
    }
}
