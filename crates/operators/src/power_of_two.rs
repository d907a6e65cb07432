//! Units that rounding does not see.

/// The largest power of two that is a normal number and at most `x`, or the smallest normal number.
/// Multiplication and division by it do not round.
///
/// `x` must be positive and finite.
#[inline]
pub fn power_of_two(x: f64) -> f64 {
    const EXPONENT: u64 = 0x7ff << 52;
    f64::from_bits(x.to_bits() & EXPONENT).max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_of_two_are_below() {
        for (x, unit) in [(1.0, 1.0), (1.99, 1.0), (0.3, 0.25), (1e-320, f64::MIN_POSITIVE)] {
            assert_eq!(power_of_two(x), unit);
        }
        assert_eq!(power_of_two(f64::MAX), 2f64.powi(1023));
    }
}
