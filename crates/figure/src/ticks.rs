//! Marks of axes, and numbers formatted for labels and captions.

/// A real minus sign; a hyphen is shorter than a plus.
const MINUS: char = '\u{2212}';

/// `value` with at most `digits` significant digits and no trailing zeros:
/// plain from 0.001 to 99 999, otherwise as in `1.2·10⁻⁵`. With a real minus
/// sign; infinities and NaN as `∞` and `–`.
pub(crate) fn number(value: f64, digits: usize) -> String {
    if value.is_nan() {
        return "–".into();
    }
    if value.is_infinite() {
        return if value > 0.0 { "∞".into() } else { format!("{MINUS}∞") };
    }
    if value == 0.0 {
        return "0".into();
    }
    let digits = digits.clamp(1, 17);
    // Rounding first: 9.996 with three digits is 10.0.
    let scientific = format!("{:.*e}", digits - 1, value);
    let (mantissa, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    if (-3..=4).contains(&exponent) {
        let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
        return fixed(value, decimals, true);
    }
    let mantissa = trim(mantissa).replace('-', "\u{2212}");
    match mantissa.as_str() {
        "1" => power_of_ten(exponent),
        _ => format!("{mantissa}·{}", power_of_ten(exponent)),
    }
}

/// `value` with that many decimals, with a real minus sign, and none before a
/// zero.
pub(crate) fn fixed(value: f64, decimals: usize, trimmed: bool) -> String {
    let text = format!("{value:.decimals$}");
    let text = if trimmed { trim(&text) } else { &text };
    match text.strip_prefix('-') {
        Some(rest) if rest.bytes().all(|b| b == b'0' || b == b'.') => rest.into(),
        Some(rest) => format!("{MINUS}{rest}"),
        None => text.into(),
    }
}

fn trim(text: &str) -> &str {
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { text }
}

/// `10⁻³` and so on.
pub(crate) fn power_of_ten(exponent: i32) -> String {
    const RAISED: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let mut text = String::from("10");
    for digit in exponent.to_string().bytes() {
        text.push(match digit {
            b'0'..=b'9' => RAISED[usize::from(digit - b'0')],
            _ => '⁻',
        });
    }
    text
}

/// Marks of an axis.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Ticks {
    /// Labelled values, ascending.
    pub(crate) major: Vec<(f64, String)>,
    /// Values with a short mark and no label.
    pub(crate) minor: Vec<f64>,
    /// Labels are to be multiplied by ten to this power.
    pub(crate) exponent: i32,
}

/// Round values, about `wanted` of them, from `low` to `high`.
pub(crate) fn linear(low: f64, high: f64, wanted: usize) -> Ticks {
    let none = Ticks { major: vec![], minor: vec![], exponent: 0 };
    let raw = (high - low) / wanted.max(1) as f64;
    if !raw.is_normal() || raw < 0.0 {
        return Ticks { major: vec![(low, crate::ticks::number(low, 3))], ..none };
    }
    let decade = libm::pow(10.0, libm::log10(raw).floor());
    let step = [1.0, 2.0, 2.5, 5.0].iter().map(|m| m * decade).find(|&s| s >= raw * 0.75);
    let step = step.unwrap_or(10.0 * decade);
    let first = (low / step - 1e-9).ceil();
    let last = (high / step + 1e-9).floor();
    if !(first.abs() < 1e15 && last.abs() < 1e15) {
        return none;
    }
    let values: Vec<f64> = (first as i64..=last as i64).map(|i| i as f64 * step).collect();
    let exponent = exponent(low, high);
    let unit = 10f64.powi(exponent);
    // As many decimals as tell neighbours apart; 2.5 steps need one more.
    let decimals = (0..=12)
        .find(|&d| {
            let shown = step / unit * 10f64.powi(d);
            (shown - shown.round()).abs() < 1e-6 * shown
        })
        .unwrap_or(12) as usize;
    let label = |x: f64| fixed(x / unit, decimals, false);
    Ticks { major: values.into_iter().map(|x| (x, label(x))).collect(), minor: vec![], exponent }
}

/// The power of ten to take out of the labels: none for magnitudes from 0.01
/// to 99 999.
pub(crate) fn exponent(low: f64, high: f64) -> i32 {
    let largest = low.abs().max(high.abs());
    let magnitude = if largest > 0.0 { libm::log10(largest).floor() as i32 } else { 0 };
    if (-2..=4).contains(&magnitude) { 0 } else { magnitude }
}

/// Powers of ten, with 2 and 5 times those where there are few.
pub(crate) fn logarithmic(low: f64, high: f64, wanted: usize) -> Ticks {
    let (first, last) = (libm::log10(low), libm::log10(high));
    let decades = last - first;
    let within = |x: f64| x >= low * (1.0 - 1e-9) && x <= high * (1.0 + 1e-9);
    let range = first.floor() as i32..=last.ceil() as i32;
    let multiples = |factors: &[f64]| -> Vec<f64> {
        let all = range.clone().flat_map(|e| factors.iter().map(move |f| f * 10f64.powi(e)));
        all.filter(|&x| within(x)).collect()
    };
    if decades < 0.6 {
        // Too little of a decade for powers of ten: as on a linear axis.
        return Ticks { minor: vec![], ..linear(low, high, wanted) };
    }
    let plain = |x: f64| crate::ticks::number(x, 1);
    let round = multiples(&[1.0, 2.0, 5.0]);
    // More labels than this would run into each other; they span two powers of ten.
    if decades < 2.2 && round.len() <= 3 * wanted {
        let major = round.into_iter().map(|x| (x, plain(x))).collect();
        let minor = multiples(&[3.0, 4.0, 6.0, 7.0, 8.0, 9.0]);
        return Ticks { major, minor, exponent: 0 };
    }
    // One more than wanted, so that two decades do not end up with one label.
    let step = (decades / (wanted + 1) as f64).ceil().max(1.0) as i32;
    let major = range
        .clone()
        .filter(|e| e % step == 0 && within(10f64.powi(*e)))
        .map(|e| (10f64.powi(e), power_of_ten(e)))
        .collect();
    let minor = match step {
        1 if decades < 8.0 => multiples(&[2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]),
        1 => vec![],
        _ => {
            range.filter(|e| e % step != 0).map(|e| 10f64.powi(e)).filter(|&x| within(x)).collect()
        }
    };
    Ticks { major, minor, exponent: 0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_well() {
        let expected = [
            (0.0, "0"),
            (-0.0, "0"),
            (1.0, "1"),
            (-0.25, "−0.25"),
            (0.001234, "0.00123"),
            (12_345.0, "12345"),
            (9.996, "10"),
            (1e-5, "10⁻⁵"),
            (-1.25e-7, "−1.25·10⁻⁷"),
            (6.02e23, "6.02·10²³"),
            (123_456.0, "1.23·10⁵"),
            (f64::INFINITY, "∞"),
            (f64::NAN, "–"),
        ];
        for (value, text) in expected {
            assert_eq!(number(value, 3), text);
        }
        assert_eq!(power_of_ten(-1_234_567_890), "10⁻¹²³⁴⁵⁶⁷⁸⁹⁰");
        assert_eq!(fixed(-0.001, 2, false), "0.00");
    }

    fn labels(ticks: &Ticks) -> Vec<&str> {
        ticks.major.iter().map(|(_, label)| label.as_str()).collect()
    }

    #[test]
    fn linear_ticks_are_round() {
        assert_eq!(labels(&linear(-1.3, 1.4, 4)), ["−1", "0", "1"]);
        assert_eq!(labels(&linear(0.0, 0.1, 4)), ["0.00", "0.02", "0.04", "0.06", "0.08", "0.10"]);
        let small = linear(0.0, 3.1e-5, 3);
        assert_eq!((labels(&small), small.exponent), (vec!["0", "1", "2", "3"], -5));
        assert_eq!(labels(&linear(5e5, 5e5 + 3.0, 3)).len(), 4);
        assert_eq!(labels(&linear(2.0, 2.0, 4)), ["2"]);
    }

    #[test]
    fn logarithmic_ticks_follow_the_span() {
        assert_eq!(labels(&logarithmic(0.04, 0.6, 5)), ["0.05", "0.1", "0.2", "0.5"]);
        assert_eq!(labels(&logarithmic(1e-5, 2e-2, 5)), ["10⁻⁵", "10⁻⁴", "10⁻³", "10⁻²"]);
        assert_eq!(labels(&logarithmic(1e-12, 1.0, 4)), ["10⁻¹²", "10⁻⁹", "10⁻⁶", "10⁻³", "10⁰"]);
        assert_eq!(labels(&logarithmic(0.05, 15.0, 2)), ["10⁻¹", "10⁰", "10¹"]);
        assert_eq!(labels(&logarithmic(1.0, 3.0, 4)), ["1.0", "1.5", "2.0", "2.5", "3.0"]);
        assert_eq!(labels(&logarithmic(80.0, 12_000.0, 2)), ["10²", "10³", "10⁴"]);
    }
}
