//! Vectors in space as plain arrays.

/// The sum `a + b`.
#[inline]
pub(crate) fn add(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// The difference `a − b`.
#[inline]
pub(crate) fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// The multiple `s a`.
#[inline]
pub(crate) fn scale(a: [f64; 3], s: f64) -> [f64; 3] {
    [a[0] * s, a[1] * s, a[2] * s]
}

/// The inner product `a · b`.
#[inline]
pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The cross product `a × b`.
#[inline]
pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The length `‖a‖`, for squares of components in the range of floats.
#[inline]
pub(crate) fn norm(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

/// The distance `‖a − b‖`.
#[inline]
pub(crate) fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    norm(sub(a, b))
}

/// The direction of `a`, or `None` if its square is zero, subnormal or not finite.
#[inline]
pub(crate) fn normalize(a: [f64; 3]) -> Option<[f64; 3]> {
    let square = dot(a, a);
    square.is_normal().then(|| scale(a, 1.0 / square.sqrt()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_and_directions() {
        let a = [3.0, -4.0, 12.0];
        for exponent in [-480, -1, 0, 70, 480] {
            let b = scale(a, 2f64.powi(exponent));
            assert_eq!(norm(b), 13.0 * 2f64.powi(exponent), "2^{exponent}");
            let n = normalize(b).unwrap();
            assert!((0..3).all(|k| (n[k] - a[k] / 13.0).abs() < 1e-15), "2^{exponent} {n:?}");
        }
        assert_eq!((norm([0.0; 3]), normalize([0.0; 3])), (0.0, None));
        assert!(norm([f64::NAN, 0.0, 0.0]).is_nan());
        assert_eq!((normalize([f64::NAN, 1.0, 0.0]), normalize([f64::INFINITY; 3])), (None, None));
    }
}
