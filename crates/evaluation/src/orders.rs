//! Observed orders of convergence.

/// The orders of convergence between neighbouring levels of a refinement:
///
/// ```text
/// pᵢ = log(eᵢ / eᵢ₊₁) / log(hᵢ / hᵢ₊₁)
/// ```
///
/// for sizes `h` and errors `error`, positive both; one order fewer than there
/// are levels, and none where it is not defined: for an error that is zero or
/// not finite, or two levels of the same size.
///
/// # Panics
///
/// If there are not as many errors as sizes.
pub fn observed_orders(h: &[f64], error: &[f64]) -> Vec<f64> {
    assert_eq!(h.len(), error.len(), "every size needs its error");
    let pairs = h.windows(2).zip(error.windows(2));
    pairs
        .filter_map(|(h, e)| {
            let order = libm::log(e[0] / e[1]) / libm::log(h[0] / h[1]);
            (e[0] > 0.0 && e[1] > 0.0 && order.is_finite()).then_some(order)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_have_their_order() {
        let h = [1.0, 0.5, 0.1];
        for order in [1.0, 2.0, 3.5] {
            let error = h.map(|h: f64| 3.0 * h.powf(order));
            // ln and powf are good to an ulp or so, of numbers up to 8.
            assert!(observed_orders(&h, &error).iter().all(|p| (p - order).abs() < 1e-13));
        }
    }

    #[test]
    fn undefined_orders_are_left_out() {
        assert_eq!(observed_orders(&[1.0, 0.5, 0.5, 0.25], &[1.0, 0.25, 0.1, 0.0]), [2.0]);
    }
}
