//! Decimal numbers from text, correctly rounded, and to text.

use std::io::Write as _;

/// Powers of ten that `f64` holds exactly.
const POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16,
    1e17, 1e18, 1e19, 1e20, 1e21, 1e22,
];

/// Powers of five that `u64` holds.
const POWERS_OF_FIVE: [u64; 28] = {
    let mut powers = [1; 28];
    let mut k = 1;
    while k < powers.len() {
        powers[k] = 5 * powers[k - 1];
        k += 1;
    }
    powers
};

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

/// The number of the next eight digits, if there are eight.
///
/// Works on all digits in one word: joins pairs of digits, then pairs of
/// these, then the halves.
#[inline]
fn eight_digits(bytes: &[u8]) -> Option<u64> {
    const ZEROS: u64 = 0x3030_3030_3030_3030;
    const HIGH: u64 = 0xf0f0_f0f0_f0f0_f0f0;
    let word = u64::from_le_bytes(*bytes.first_chunk()?);
    // The second sum moves what lies beyond nine out of the row of zeros.
    if word & HIGH != ZEROS || word.wrapping_add(0x0606_0606_0606_0606) & HIGH != ZEROS {
        return None;
    }
    let pairs = word - ZEROS;
    let pairs = pairs.wrapping_mul(10).wrapping_add(pairs >> 8);
    const EVERY_FOURTH: u64 = 0x0000_00ff_0000_00ff;
    let upper = (pairs & EVERY_FOURTH).wrapping_mul(100 + (1_000_000 << 32));
    let lower = ((pairs >> 16) & EVERY_FOURTH).wrapping_mul(1 + (10_000 << 32));
    Some(upper.wrapping_add(lower) >> 32)
}

/// Appends the digits from `at` on to a number, modulo 2⁶⁴. Returns the number
/// and the index of the first byte that is no digit.
#[inline]
fn digits(bytes: &[u8], mut at: usize, mut number: u64) -> (u64, usize) {
    while let Some(eight) = bytes.get(at..).and_then(eight_digits) {
        number = number.wrapping_mul(100_000_000).wrapping_add(eight);
        at += 8;
    }
    while let Some(digit @ b'0'..=b'9') = bytes.get(at) {
        number = number.wrapping_mul(10).wrapping_add(u64::from(digit - b'0'));
        at += 1;
    }
    (number, at)
}

/// `mantissa / 10ᵏ`, correctly rounded, for a mantissa that is not 0 and
/// `k ≤ 27`.
///
/// The quotient by 5ᵏ < 2⁶³ is an integer of 65 bits or more once the mantissa
/// fills 128 bits; with a lowest bit that remembers the remainder it rounds to
/// 53 bits like the quotient itself. The remaining factor is a power of two, and
/// the result is far from the limits of `f64`.
#[inline]
fn quotient(mantissa: u64, k: usize) -> f64 {
    let shift = mantissa.leading_zeros();
    let dividend = u128::from(mantissa << shift) << 64;
    let divisor = u128::from(POWERS_OF_FIVE[k]);
    let (whole, rest) = (dividend / divisor, dividend % divisor);
    let sticky = u128::from(rest != 0);
    (whole | sticky) as f64 * f64::from_bits((1023 - 64 - u64::from(shift) - k as u64) << 52)
}

/// Reads the token at `start` as a decimal number. Returns the number and the end of
/// the token, or `None` if the token is no number.
///
/// The result is the `f64` nearest to the text, ties to even. With a mantissa
/// below 2⁵³ and a power of ten up to 10²² both are exact, and one
/// multiplication or division rounds correctly (Clinger's fast path); longer
/// fractions go through an integer quotient, all other numbers through the
/// standard library. `inf` and `nan` count as numbers, so that the caller can
/// name the vertex in its error.
#[inline]
pub(crate) fn float(bytes: &[u8], start: usize) -> Option<(f64, usize)> {
    let byte = |at: usize| bytes.get(at).copied().unwrap_or(b' ');
    let negative = byte(start) == b'-';
    let first = start + usize::from(negative || byte(start) == b'+');

    let (mut mantissa, mut at) = digits(bytes, first, 0);
    let mut count = at - first;
    let mut exponent = 0i32;
    if byte(at) == b'.' {
        let point = at + 1;
        (mantissa, at) = digits(bytes, point, mantissa);
        count += at - point;
        exponent = -((at - point).min(1000) as i32);
    }
    if matches!(byte(at), b'e' | b'E') {
        let mut next = at + 1;
        let down = byte(next) == b'-';
        next += usize::from(down || byte(next) == b'+');
        let first = next;
        let mut power = 0i32;
        while let digit @ 0..=9 = byte(next).wrapping_sub(b'0') {
            power = (power * 10 + i32::from(digit)).min(100_000);
            next += 1;
        }
        if next > first {
            exponent += if down { -power } else { power };
            at = next;
        }
    }
    // Nineteen digits never overflow the mantissa.
    if (1..=19).contains(&count) && is_delimiter(byte(at)) {
        let small = mantissa <= 1 << 53;
        let value = match exponent {
            -22..=0 if small => Some(mantissa as f64 / POWERS[exponent.unsigned_abs() as usize]),
            1..=22 if small => Some(mantissa as f64 * POWERS[exponent as usize]),
            -27..=0 if mantissa > 0 => Some(quotient(mantissa, exponent.unsigned_abs() as usize)),
            _ => None,
        };
        if let Some(value) = value {
            return Some((if negative { -value } else { value }, at));
        }
    }
    by_the_standard_library(bytes, start)
}

#[cold]
fn by_the_standard_library(bytes: &[u8], start: usize) -> Option<(f64, usize)> {
    let end = token_end(bytes, start);
    let value = std::str::from_utf8(&bytes[start..end]).ok()?.parse().ok()?;
    Some((value, end))
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

        /// Mantissas of up to nineteen digits, near halves of the last bit too.
        #[test]
        fn long_fractions_round_like_the_standard_library(
            mantissa: u64, near in 1u64 << 52..1 << 54, k in 0usize..28,
        ) {
            for n in [mantissa / 10, near, near << 1 | 1, (near << 9) + 256, (near << 9) + 257] {
                let digits = format!("{n:028}");
                let (whole, fraction) = digits.split_at(28 - k);
                let text = format!("{}.{fraction}", whole.trim_start_matches('0'));
                let expected: f64 = text.parse().unwrap();
                prop_assert_eq!(parse(&text).unwrap().to_bits(), expected.to_bits(), "{}", text);
                prop_assert_eq!(parse(&format!("{n}e-{k}")).unwrap().to_bits(), expected.to_bits());
            }
        }

        #[test]
        fn short_decimals_round_like_the_standard_library(n: i64, scale in 0u32..30) {
            let text = format!("{}.{:0width$}", n / 1000, n.unsigned_abs() % 1000, width = scale as usize);
            let expected: f64 = text.parse().unwrap();
            prop_assert_eq!(parse(&text).unwrap().to_bits(), expected.to_bits(), "{}", text);
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
