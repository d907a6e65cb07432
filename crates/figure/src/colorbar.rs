//! The key to the colours.

use crate::drawing::{Anchor, Drawing, INK, SOFT};
use crate::outline::Outline;
use crate::scale::{Scale, Spread};
use crate::text::Style;
use crate::ticks;
use crate::ticks::{number, power_of_ten};

/// A colour bar with ticks.
///
/// An equalised scale is shown with its colours evenly spaced and the true
/// values below the quarters; where only a few values occur, with a block of
/// one colour for each of them. An arrow at an end says that some values lie
/// beyond it.
#[derive(Debug, Clone)]
pub struct ColorBar {
    /// Values and colours.
    pub scale: Scale,
    /// The quantity, such as `mean curvature H`.
    pub quantity: String,
    /// The unit, such as `1/m`; empty for pure numbers.
    pub unit: String,
}

const THICKNESS: f64 = 13.0;
const ARROW: f64 = 9.0;
const TICK_SIZE: f64 = 12.0;
const LABEL_SIZE: f64 = 13.0;

impl ColorBar {
    /// Draws the bar `width` CSS pixels wide: colours, ticks, and below them
    /// quantity and unit.
    pub fn draw(&self, width: f64) -> Drawing {
        let mut out = Drawing::new(width, THICKNESS + 19.0 + 22.0);
        // Labels of the end ticks reach beyond the bar.
        let margin = ARROW + 14.0;
        let length = (width - 2.0 * margin).max(20.0);
        let at = |t: f64| margin + length * t;
        let (map, scale) = (self.scale.map(), &self.scale);
        let steps = 120;
        let few = scale.few();
        for (i, &value) in few.iter().enumerate() {
            let each = length / few.len() as f64;
            let left = margin + each * i as f64;
            out.fill(Outline::rectangle([left, 0.0], [each, THICKNESS]), scale.color(value), 1.0);
        }
        for i in 0..if few.is_empty() { steps } else { 0 } {
            let t = (f64::from(i) + 0.5) / f64::from(steps);
            let left = at(f64::from(i) / f64::from(steps));
            // A little overlap hides the seams.
            let overlap = if i + 1 == steps { 0.0 } else { 0.5 };
            let size = [length / f64::from(steps) + overlap, THICKNESS];
            out.fill(Outline::rectangle([left, 0.0], size), map.at(t), 1.0);
        }
        let mut arrow = |from: f64, to: f64, t: f64| {
            let corners = [[from, 0.0], [to, THICKNESS / 2.0], [from, THICKNESS]];
            out.fill(Outline::polygon(corners), map.at(t), 1.0);
        };
        if scale.has_below() {
            arrow(at(0.0), at(0.0) - ARROW, 0.0);
        }
        if scale.has_above() {
            arrow(at(1.0), at(1.0) + ARROW, 1.0);
        }
        let (marks, exponent) = self.marks(length);
        for (t, label) in &marks {
            out.segment([at(*t), THICKNESS], [at(*t), THICKNESS + 4.0], SOFT);
            let below = [at(*t), THICKNESS + 16.0];
            out.text(below, TICK_SIZE, Anchor::Middle, Style::Regular, SOFT, label);
        }
        let below = [width / 2.0, THICKNESS + 35.0];
        out.text(below, LABEL_SIZE, Anchor::Middle, Style::Regular, INK, &self.label(exponent));
        out
    }

    /// Positions on the bar and their labels.
    fn marks(&self, length: f64) -> (Vec<(f64, String)>, i32) {
        let scale = &self.scale;
        if scale.high() <= scale.low() {
            return (vec![(0.5, number(scale.low(), 3))], 0);
        }
        match scale.spread() {
            Spread::Linear => {
                let wanted = (length / 60.0).clamp(2.0, 6.0) as usize;
                let ticks = ticks::linear(scale.low(), scale.high(), wanted);
                let marks = ticks.major.into_iter().map(|(x, l)| (scale.position(x), l));
                (marks.collect(), ticks.exponent)
            }
            Spread::Equalized if !scale.few().is_empty() => {
                let few = scale.few();
                let exponent = ticks::exponent(scale.low(), scale.high());
                let middle = |i: usize| (i as f64 + 0.5) / few.len() as f64;
                let shown = |x: f64| number(x / 10f64.powi(exponent), 3);
                (few.iter().enumerate().map(|(i, &x)| (middle(i), shown(x))).collect(), exponent)
            }
            Spread::Equalized => {
                let parts = if length < 220.0 { 2 } else { 4 };
                let (low, high) = (scale.low(), scale.high());
                let exponent = ticks::exponent(low, high);
                let shown = |x: f64| number(x / 10f64.powi(exponent), 2);
                let marks = (0..=parts).map(|i| {
                    let t = f64::from(i) / f64::from(parts);
                    let value = match i {
                        0 => low,
                        _ if i == parts => high,
                        _ => scale.value(t),
                    };
                    (t, shown(value))
                });
                (marks.collect(), exponent)
            }
        }
    }

    fn label(&self, exponent: i32) -> String {
        let factor = (exponent != 0).then(|| power_of_ten(exponent));
        let unit = match (factor, self.unit.is_empty()) {
            (None, true) => String::new(),
            (None, false) => format!(" ({})", self.unit),
            (Some(factor), true) => format!(" (×{factor})"),
            (Some(factor), false) => format!(" ({factor} {})", self.unit),
        };
        let spread = match self.scale.spread() {
            Spread::Linear => "",
            Spread::Equalized => ", equalised",
        };
        format!("{}{unit}{spread}", self.quantity)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::Element;
    use crate::field::Field;
    use crate::scale::ScaleOptions;

    /// A block and a tick for each of the three values, in the colours of the mesh, and none in
    /// between.
    #[test]
    fn a_bar_of_few_values_shows_them_and_no_others() {
        let values: Vec<f64> = (0..30).map(|i| [0.0, 382.0, 763.0][i % 3]).collect();
        let scale = Scale::new(&[&Field::new(&values)], &ScaleOptions::EQUALIZED_HUE).unwrap();
        let colors = [0.0, 382.0, 763.0].map(|x| scale.color(x));
        let bar = ColorBar { scale, quantity: "K".into(), unit: String::new() };
        let drawn = bar.draw(300.0);
        let filled: Vec<_> = drawn
            .elements
            .iter()
            .filter_map(|e| if let Element::Path(path) = e { path.fill } else { None })
            .map(|fill| fill.color)
            .collect();
        assert_eq!(filled, colors);
        let words: Vec<_> = drawn
            .elements
            .iter()
            .filter_map(
                |e| if let Element::Text(text) = e { Some(text.words.as_str()) } else { None },
            )
            .collect();
        assert_eq!(words, ["0", "382", "763", "K, equalised"]);
    }
}
