//! Numbers as text.

use std::io::Write;

/// Appends the shortest decimal that reads back as the same `f64`, in
/// exponent notation where that is shorter to read (below 10⁻⁵ and from 10¹⁶).
pub(super) fn float(text: &mut Vec<u8>, x: f64) {
    let plain = x == 0.0 || (1e-5..1e16).contains(&x.abs());
    let written = if plain { write!(text, "{x}") } else { write!(text, "{x:e}") };
    // A vector takes any number of bytes.
    debug_assert!(written.is_ok());
}

/// Appends an integer.
#[inline]
pub(super) fn integer(text: &mut Vec<u8>, mut n: u64) {
    let mut digits = [0u8; 20];
    let mut at = digits.len();
    loop {
        at -= 1;
        digits[at] = b'0' + (n % 10) as u8;
        n /= 10;
        if n == 0 {
            break;
        }
    }
    text.extend_from_slice(&digits[at..]);
}

/// Appends three numbers with a space before each.
pub(super) fn triple(text: &mut Vec<u8>, numbers: [f64; 3]) {
    for x in numbers {
        text.push(b' ');
        float(text, x);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extremes_read_back() {
        for x in [0.0, -0.0, 1.0, -0.1, 1e-5, 9e-6, 5e-324, f64::MAX, 1e16, 123456.789e3] {
            let mut text = Vec::new();
            float(&mut text, x);
            let text = String::from_utf8(text).unwrap();
            assert_eq!(text.parse::<f64>().unwrap().to_bits(), x.to_bits());
            assert!(text.len() < 26, "{text}");
        }
        let mut text = Vec::new();
        integer(&mut text, 0);
        integer(&mut text, u64::MAX);
        assert_eq!(text, b"018446744073709551615");
    }
}
