//! Largest, least and middle numbers, which never lose a NaN.
//!
//! `f64::max` and `f64::min` drop NaN, so that a maximum over them is no bound.

/// The larger of two numbers; NaN if either is.
#[inline(always)]
pub fn larger(a: f64, b: f64) -> f64 {
    if a > b || a.is_nan() { a } else { b }
}

/// The smaller of two numbers; NaN if either is.
#[inline(always)]
pub fn smaller(a: f64, b: f64) -> f64 {
    if a < b || a.is_nan() { a } else { b }
}

/// The middle of ascending values, the mean of the two middle ones if their number is even; `None`
/// of no values.
pub fn median(ascending: &[f64]) -> Option<f64> {
    let n = ascending.len();
    Some(0.5 * ascending.get(n.checked_sub(1)? / 2)? + 0.5 * ascending[n / 2])
}

/// The middle of values in any order, the larger of the two middle ones if their number is even;
/// `None` of no values. Linear cost.
pub fn upper_median(mut values: Vec<f64>) -> Option<f64> {
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extremes_of_numbers_with_nan_are_nan() {
        for place in 0..3 {
            let mut values = [2.0, -1.0, 3.0];
            assert_eq!(values.into_iter().reduce(larger), Some(3.0));
            assert_eq!(values.into_iter().reduce(smaller), Some(-1.0));
            values[place] = f64::NAN;
            assert!(values.into_iter().fold(0.0, larger).is_nan());
            assert!(values.into_iter().fold(f64::INFINITY, smaller).is_nan());
        }
    }

    #[test]
    fn the_median_of_an_even_number_lies_between() {
        assert_eq!(median(&[1.0, 2.0, 4.0, 9.0]), Some(3.0));
        assert_eq!(median(&[1.0, 2.0, 9.0]), Some(2.0));
        assert_eq!((median(&[7.0]), median(&[])), (Some(7.0), None));
        assert_eq!(upper_median(vec![9.0, 1.0, 4.0, 2.0]), Some(4.0));
        assert_eq!((upper_median(vec![7.0]), upper_median(vec![])), (Some(7.0), None));
    }
}
