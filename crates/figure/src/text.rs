//! Words in pictures: the embedded font, their width and their outlines.

use std::sync::OnceLock;

use ttf_parser::{Face, GlyphId, OutlineBuilder};

/// Weight.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Style {
    Regular,
    Bold,
}

/// The embedded fonts: DejaVu Sans, cut down to Latin, Greek, sub- and
/// superscripts, arrows and mathematical signs. Nothing is looked for on the
/// machine, so that pictures are the same on all of them.
struct Fonts {
    regular: Face<'static>,
    bold: Face<'static>,
}

impl Fonts {
    fn get() -> &'static Self {
        static FONTS: OnceLock<Fonts> = OnceLock::new();
        FONTS.get_or_init(|| {
            let parse = |bytes| Face::parse(bytes, 0).expect("the embedded fonts are valid");
            Self {
                regular: parse(include_bytes!("../fonts/DejaVuSans.ttf")),
                bold: parse(include_bytes!("../fonts/DejaVuSans-Bold.ttf")),
            }
        })
    }

    /// The glyph of a character: in the font of the style, else in the regular
    /// one, else the sign for a missing glyph.
    fn glyph(&self, c: char, style: Style) -> (&Face<'static>, GlyphId) {
        let own = if style == Style::Bold { &self.bold } else { &self.regular };
        // A control character shows as a missing glyph, other spaces as a space.
        let c = if c.is_whitespace() { ' ' } else { c };
        [own, &self.regular]
            .into_iter()
            .find_map(|face| Some((face, face.glyph_index(c)?)))
            .unwrap_or((own, GlyphId(0)))
    }
}

/// The width of a line of text in the embedded font: the sum of the advances.
pub(crate) fn width(text: &str, size: f64, style: Style) -> f64 {
    text.chars().map(|c| advance(Fonts::get().glyph(c, style), size)).sum()
}

fn advance((face, glyph): (&Face<'_>, GlyphId), size: f64) -> f64 {
    let units = face.glyph_hor_advance(glyph).unwrap_or(face.units_per_em());
    size * f64::from(units) / f64::from(face.units_per_em())
}

/// Calls `visit` with each glyph's outline in font units (y upward), its size
/// in CSS pixels for one font unit, and its distance from the start of the
/// line.
pub(crate) fn glyphs<B: OutlineBuilder>(
    text: &str,
    size: f64,
    style: Style,
    mut visit: impl FnMut(f64, f64) -> B,
    mut done: impl FnMut(B),
) {
    let mut x = 0.0;
    for c in text.chars() {
        let (face, glyph) = Fonts::get().glyph(c, style);
        let mut builder = visit(x, size / f64::from(face.units_per_em()));
        if face.outline_glyph(glyph, &mut builder).is_some() {
            done(builder);
        }
        x += advance((face, glyph), size);
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A missing glyph shows as a box: all that the report's words need must
    /// be there, in each style.
    #[test]
    fn every_sign_of_the_report_has_a_glyph() {
        let signs = "κλσφθτχμεαβγΔπΣ₀₁₂₃₄₅ₙₖᵢⱼ\
                     −×°²³⁻¹⁴⁵√∞≈≤≥±→…–—‖·½∇⟨⟩ℓ←↑▲ŁéüßÅ";
        for style in [Style::Regular, Style::Bold] {
            assert_eq!(Fonts::get().glyph('\u{4e00}', style).1, GlyphId(0));
            for sign in signs.chars() {
                let found = Fonts::get().glyph(sign, style);
                assert!(found.1 != GlyphId(0), "{sign} in {style:?}");
                assert!(advance(found, 10.0) > 0.0, "{sign} in {style:?}");
            }
        }
    }

    #[test]
    fn widths_add_up() {
        let one = width("m", 20.0, Style::Regular);
        assert!((width("mmmm", 20.0, Style::Regular) - 4.0 * one).abs() < 1e-9);
        assert!((width("m", 40.0, Style::Regular) - 2.0 * one).abs() < 1e-9);
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
}
