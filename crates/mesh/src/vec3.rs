//! Vectors in space as plain arrays.

/// The sum `a + b`.
#[inline]
pub fn add(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// The difference `a − b`.
#[inline]
pub fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// The multiple `s a`.
#[inline]
pub fn scale(a: [f64; 3], s: f64) -> [f64; 3] {
    [a[0] * s, a[1] * s, a[2] * s]
}

/// The inner product `a · b`.
#[inline]
pub fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The cross product `a × b`.
#[inline]
pub fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Sums of squares in this range have lost nothing to under- or overflow.
const SQUARES: std::ops::Range<f64> = 1e-280..1e300;

/// The length `‖a‖`, to rounding wherever it is a float, however small or large.
#[inline]
pub fn norm(a: [f64; 3]) -> f64 {
    let square = dot(a, a);
    if SQUARES.contains(&square) { square.sqrt() } else { norm_out_of_range(a) }
}

/// In units of a power of two near the largest component, which rounds nothing.
#[cold]
fn norm_out_of_range(a: [f64; 3]) -> f64 {
    let largest = a.iter().fold(0.0f64, |m, x| m.max(x.abs()));
    if largest == 0.0 || !a.iter().all(|x| x.is_finite()) {
        return dot(a, a).sqrt();
    }
    let unit = power_of_two(largest);
    let scaled = a.map(|x| x / unit);
    dot(scaled, scaled).sqrt() * unit
}

/// The largest power of two that is a normal number and at most `x`; the
/// smallest normal number where none is. Multiplying and dividing by it rounds
/// nothing.
///
/// `x` must be positive and finite.
#[inline]
pub fn power_of_two(x: f64) -> f64 {
    const EXPONENT: u64 = 0x7ff << 52;
    f64::from_bits(x.to_bits() & EXPONENT).max(f64::MIN_POSITIVE)
}

/// The distance `‖a − b‖`.
#[inline]
pub fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    norm(sub(a, b))
}

/// The direction of `a`, or `None` where it is zero or not finite.
#[inline]
pub fn normalize(a: [f64; 3]) -> Option<[f64; 3]> {
    let square = dot(a, a);
    if SQUARES.contains(&square) {
        return Some(scale(a, 1.0 / square.sqrt()));
    }
    direction_out_of_range(a)
}

#[cold]
fn direction_out_of_range(a: [f64; 3]) -> Option<[f64; 3]> {
    let largest = a.iter().fold(0.0f64, |m, x| m.max(x.abs()));
    if largest == 0.0 || !a.iter().all(|x| x.is_finite()) {
        return None;
    }
    // By the largest component itself, which subnormal ones need.
    let scaled = a.map(|x| x / largest);
    Some(scale(scaled, 1.0 / norm(scaled)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_and_directions_of_any_size() {
        let a = [3.0, -4.0, 12.0];
        for exponent in [-1060, -1000, -600, -470, -300, -1, 0, 70, 480, 511, 700, 1010] {
            let unit = 2f64.powi(exponent / 2) * 2f64.powi(exponent - exponent / 2);
            let b = scale(a, unit);
            assert_eq!(norm(b), 13.0 * unit, "2^{exponent}");
            let n = normalize(b).unwrap();
            assert!((0..3).all(|k| (n[k] - a[k] / 13.0).abs() < 1e-15), "2^{exponent} {n:?}");
        }
        let huge = [f64::MAX, f64::MAX, -f64::MAX];
        assert_eq!(norm(huge), f64::INFINITY);
        assert!((normalize(huge).unwrap()[2] + 3f64.sqrt().recip()).abs() < 1e-15);
        let least = [0.0, f64::from_bits(1), 0.0];
        assert_eq!((norm(least), normalize(least)), (least[1], Some([0.0, 1.0, 0.0])));
        assert_eq!((norm([0.0; 3]), normalize([0.0; 3])), (0.0, None));
        assert!(norm([f64::NAN, 0.0, 0.0]).is_nan());
        assert_eq!(norm([f64::INFINITY, 0.0, 0.0]), f64::INFINITY);
        assert_eq!((normalize([f64::NAN, 1.0, 0.0]), normalize([f64::INFINITY; 3])), (None, None));
    }

    #[test]
    fn powers_of_two_are_below() {
        for (x, unit) in [(1.0, 1.0), (1.99, 1.0), (0.3, 0.25), (1e-320, f64::MIN_POSITIVE)] {
            assert_eq!(power_of_two(x), unit);
        }
        assert_eq!(power_of_two(f64::MAX), 2f64.powi(1023));
    }
}
