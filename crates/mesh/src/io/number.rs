//! Decimal numbers from text, correctly rounded, and to text.

use std::io::Write as _;

/// Returns true if a token ends before this byte.
#[inline]
pub(crate) fn is_delimiter(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\n' | b'\r' | b'\x0b' | b'\x0c')
}

/// The end of the token that begins at `start`.
#[inline]
pub(crate) fn token_end(bytes: &[u8], start: usize) -> usize {
    bytes[start..].iter().position(|&b| is_delimiter(b)).map_or(bytes.len(), |n| start + n)
}

/// Reads the token at `start` as a decimal number. Returns the number and the end of
/// the token, or `None` if the token is no number.
///
/// The result is the `f64` nearest to the text, ties to even. `inf` and `nan` count as numbers,
/// so that the caller can name the vertex in its error.
#[inline]
pub(crate) fn float(bytes: &[u8], start: usize) -> Option<(f64, usize)> {
    let (value, length) = fast_float2::parse_partial(&bytes[start..]).ok()?;
    let end = start + length;
    bytes.get(end).is_none_or(|&b| is_delimiter(b)).then_some((value, end))
}

/// Reads the integer at `start`. Returns the integer and the index of the first byte
/// that is no digit, or `None` if there are no digits or more than eighteen. The
/// caller checks the byte that follows.
#[inline]
pub(crate) fn integer(bytes: &[u8], start: usize) -> Option<(i64, usize)> {
    let byte = |at: usize| bytes.get(at).copied().unwrap_or(b' ');
    let negative = byte(start) == b'-';
    let first = start + usize::from(negative || byte(start) == b'+');
    let mut at = first;
    let mut value = 0i64;
    while let digit @ 0..=9 = byte(at).wrapping_sub(b'0') {
        value = value.wrapping_mul(10).wrapping_add(i64::from(digit));
        at += 1;
    }
    (1..=18).contains(&(at - first)).then_some((if negative { -value } else { value }, at))
}

/// Appends the shortest decimal that reads back as the same `f64`, in
/// exponent notation below 10⁻⁵ and from 10¹⁶.
pub(crate) fn put_float(text: &mut Vec<u8>, x: f64) {
    let plain = x == 0.0 || (1e-5..1e16).contains(&x.abs());
    let written = if plain { write!(text, "{x}") } else { write!(text, "{x:e}") };
    // Writing to a vector cannot fail.
    debug_assert!(written.is_ok());
}

/// Appends an integer.
#[inline]
pub(crate) fn put_integer(text: &mut Vec<u8>, mut n: u64) {
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
pub(crate) fn put_triple(text: &mut Vec<u8>, numbers: [f64; 3]) {
    for x in numbers {
        text.push(b' ');
        put_float(text, x);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn parse(text: &str) -> Option<f64> {
        float(text.as_bytes(), 0).filter(|&(_, end)| end == text.len()).map(|(x, _)| x)
    }

    #[test]
    fn odd_spellings_agree_with_the_standard_library() {
        for text in [
            "0",
            "-0",
            "+1",
            "1.",
            ".5",
            "-.5e1",
            "1e5",
            "1E+05",
            "1e-400",
            "1e400",
            "1e22",
            "1e23",
            "9007199254740993",
            "9007199254740992e22",
            "0.1",
            "123456789012345678901234",
            "0000000000000000000000000000001.5",
            "4649776.161000000",
            "nan",
            "inf",
            "-Infinity",
            "17.00000000000000000000",
            "2.2250738585072011e-308",
            "5e-324",
        ] {
            let expected: f64 = text.parse().unwrap();
            assert_eq!(parse(text).unwrap().to_bits(), expected.to_bits(), "{text}");
        }
        for text in ["", ".", "-", "e5", "1e", "1e+", "1.2.3", "0x10", "1,5", "--1", "1f"] {
            assert_eq!(parse(text), None, "{text}");
        }
    }

    #[test]
    fn integers_stop_at_what_is_no_digit() {
        assert_eq!(integer(b"-12/3", 0), Some((-12, 3)));
        assert_eq!(integer(b"7", 0), Some((7, 1)));
        assert_eq!(integer(b"x", 0), None);
        assert_eq!(integer(b"1234567890123456789", 0), None);
    }

    proptest! {
        /// Shortest texts of any bit pattern read back bit by bit, and fixed
        /// and exponent notations agree with the standard library.
        #[test]
        fn rounds_like_the_standard_library(bits: u64, decimals in 0usize..25) {
            let x = f64::from_bits(bits);
            prop_assume!(x.is_finite());
            for text in [format!("{x}"), format!("{x:e}"), format!("{x:.decimals$e}")] {
                let expected: f64 = text.parse().unwrap();
                prop_assert_eq!(parse(&text).unwrap().to_bits(), expected.to_bits(), "{}", text);
            }
        }
    }

    #[test]
    fn written_extremes_read_back() {
        for x in [0.0, -0.0, 1.0, -0.1, 1e-5, 9e-6, 5e-324, f64::MAX, 1e16, 123456.789e3] {
            let mut text = Vec::new();
            put_float(&mut text, x);
            let text = String::from_utf8(text).unwrap();
            assert_eq!(text.parse::<f64>().unwrap().to_bits(), x.to_bits());
            assert!(text.len() < 26, "{text}");
        }
        let mut text = Vec::new();
        put_integer(&mut text, 0);
        put_integer(&mut text, u64::MAX);
        assert_eq!(text, b"018446744073709551615");
    }
}
