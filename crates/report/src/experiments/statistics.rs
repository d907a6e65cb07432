//! Numbers about a handful of numbers.

use fairing_sparse::{larger, smaller};

/// Errors nearer to each other than this, over the smaller, are equal: rounding
/// does not say which is the least.
const TIE: f64 = 1e-9;

/// The first of the pairs with the least error, and its error.
pub(super) fn least<T: Copy>(pairs: &[(f64, T)]) -> Option<(f64, T)> {
    let least = pairs.iter().map(|p| p.0).fold(f64::INFINITY, smaller);
    pairs.iter().copied().find(|p| p.0 <= least * (1.0 + TIE))
}

/// The least and the largest value; infinities of none.
pub(super) fn extremes(values: impl IntoIterator<Item = f64>) -> [f64; 2] {
    let none = [f64::INFINITY, f64::NEG_INFINITY];
    values.into_iter().fold(none, |[least, most], x| [smaller(least, x), larger(most, x)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_does_not_choose_the_least() {
        let rounded = 1.0 - f64::EPSILON;
        assert_eq!(least(&[(2.0, 'a'), (1.0, 'b'), (rounded, 'c')]), Some((1.0, 'b')));
        assert_eq!(least(&[(2.0, 'a'), (rounded, 'b'), (1.0, 'c')]), Some((rounded, 'b')));
        assert_eq!(least::<char>(&[]), None);
    }
}
