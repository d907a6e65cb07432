//! Frames of tangent planes.

/// Two unit tangents that form a right-handed frame with the unit normal; any
/// such frame, but continuous in the normal except across z = 0.
///
/// Without a branch on the smallest coordinate and without a root.
/// Source: \[duff2017\].
#[inline]
pub(crate) fn tangent_frame(normal: [f64; 3]) -> [[f64; 3]; 2] {
    let [x, y, z] = normal;
    let sign = 1.0f64.copysign(z);
    let a = -1.0 / (sign + z);
    let b = x * y * a;
    [[1.0 + sign * x * x * a, sign * b, -sign * x], [b, sign + y * y * a, -y]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use fairing_mesh::vec3::{cross, dot, norm, normalize, sub};

    fn directions() -> Vec<[f64; 3]> {
        let grid = -2..=2;
        grid.clone()
            .flat_map(|x| grid.clone().map(move |y| (x, y)))
            .flat_map(|(x, y)| grid.clone().map(move |z| [x, y, z].map(f64::from)))
            .filter_map(normalize)
            .collect()
    }

    #[test]
    fn frames_are_orthonormal_and_right_handed() {
        for n in directions() {
            let [x, y] = tangent_frame(n);
            assert!(norm(sub(cross(x, y), n)) < 1e-15, "{n:?}");
            assert!((norm(x) - 1.0).abs() < 1e-15 && dot(x, y).abs() < 1e-15);
        }
    }
}
