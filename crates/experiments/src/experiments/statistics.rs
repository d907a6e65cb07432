//! Numbers about a handful of numbers.

/// The middle of the sorted values, the mean of the two middle ones where their
/// number is even; `None` of no values.
pub(super) fn median(sorted: &[f64]) -> Option<f64> {
    let n = sorted.len();
    Some((sorted.get(n.checked_sub(1)? / 2)? + sorted[n / 2]) / 2.0)
}

/// Errors nearer to each other than this, over the smaller, are equal: rounding
/// does not say which is the least.
const TIE: f64 = 1e-9;

/// The first of the pairs with the least error, and its error.
pub(super) fn least<T: Copy>(pairs: &[(f64, T)]) -> Option<(f64, T)> {
    let least = pairs.iter().map(|p| p.0).fold(f64::INFINITY, f64::min);
    pairs.iter().copied().find(|p| p.0 <= least * (1.0 + TIE))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_of_an_even_number_lies_between() {
        assert_eq!(median(&[1.0, 2.0, 4.0, 9.0]), Some(3.0));
        assert_eq!(median(&[1.0, 2.0, 9.0]), Some(2.0));
        assert_eq!(median(&[7.0]), Some(7.0));
        assert_eq!(median(&[]), None);
    }

    #[test]
    fn rounding_does_not_choose_the_least() {
        let rounded = 1.0 - f64::EPSILON;
        assert_eq!(least(&[(2.0, 'a'), (1.0, 'b'), (rounded, 'c')]), Some((1.0, 'b')));
        assert_eq!(least(&[(2.0, 'a'), (rounded, 'b'), (1.0, 'c')]), Some((rounded, 'b')));
        assert_eq!(least::<char>(&[]), None);
    }
}
