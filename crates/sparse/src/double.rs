//! Numbers of twice the digits of `f64`: the unevaluated sum of two.
//!
//! The rounding error of a sum or product of two numbers is itself a number, which a few operations
//! give exactly. Source: [dekker1971].
//!
//! [dekker1971]: https://doi.org/10.1007/BF01397083

/// The sum of both, the second below half a unit in the last place of the first.
pub(crate) type Double = (f64, f64);

/// `a + b` and its rounding error.
fn two_sum(a: f64, b: f64) -> Double {
    let sum = a + b;
    let part = sum - a;
    (sum, (a - (sum - part)) + (b - part))
}

/// `a + b`.
pub(crate) fn sum(a: Double, b: Double) -> Double {
    let (high, error) = two_sum(a.0, b.0);
    let (low, rest) = two_sum(a.1, b.1);
    let (high, error) = two_sum(high, error + low);
    two_sum(high, error + rest)
}

/// `−a`.
pub(crate) fn negative(a: Double) -> Double {
    (-a.0, -a.1)
}

/// `a b`.
pub(crate) fn times(a: Double, b: f64) -> Double {
    let product = a.0 * b;
    two_sum(product, a.0.mul_add(b, -product) + a.1 * b)
}

/// `a/b`.
pub(crate) fn over(a: Double, b: f64) -> Double {
    let quotient = a.0 / b;
    let rest = (-quotient).mul_add(b, a.0) + a.1;
    two_sum(quotient, rest / b)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Errors of 1e-31 where single numbers have 1e-16.
    #[test]
    fn twice_the_digits() {
        let third = over((1.0, 0.0), 3.0);
        let (high, low) = sum(times(third, 3.0), (-1.0, 0.0));
        assert!((high + low).abs() < 1e-31);
        let tiny = sum(sum((1.0, 0.0), (1e-25, 0.0)), negative((1.0, 0.0)));
        assert!((tiny.0 + tiny.1 - 1e-25).abs() < 1e-40);
        let product = sum(times(third, 0.1), negative(over((0.1, 0.0), 3.0)));
        assert!((product.0 + product.1).abs() < 1e-32);
    }
}
