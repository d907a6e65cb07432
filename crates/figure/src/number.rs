//! Numbers formatted for labels and captions.

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
}
