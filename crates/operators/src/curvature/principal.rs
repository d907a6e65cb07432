//! Principal curvatures from mean and Gaussian curvature.

/// κ₁ ≥ κ₂ with κ₁ + κ₂ = 2H and κ₁ κ₂ = K.
///
/// ```text
/// κ = H ± √(H² − K)
/// ```
///
/// On a smooth surface H² ≥ K. Estimates made apart may break that; then both
/// values are H (the surface is taken as umbilic there), so that their mean
/// is still H and only K is changed: the second value returned, `K − H² > 0`,
/// says by how much; it is zero otherwise. Finite for finite input.
pub fn principal_values(mean: f64, gaussian: f64) -> ([f64; 2], f64) {
    let discriminant = mean * mean - gaussian;
    if discriminant >= 0.0 {
        let root = discriminant.sqrt();
        return ([mean + root, mean - root], 0.0);
    }
    ([mean, mean], if discriminant.is_finite() { -discriminant } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_values_come_back() {
        assert_eq!(principal_values(0.5, -2.0), ([2.0, -1.0], 0.0));
        assert_eq!(principal_values(-1.5, 2.0), ([-1.0, -2.0], 0.0));
    }

    #[test]
    fn an_impossible_pair_is_umbilic_and_says_so() {
        assert_eq!(principal_values(1.0, 1.25), ([1.0, 1.0], 0.25));
    }
}
