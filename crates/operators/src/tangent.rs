//! Frames of tangent planes.

use fairing_mesh::vec3::{cross, dot, scale};

/// Two unit tangents that form a right-handed frame with the unit normal; any
/// such frame, but continuous in the normal except across z = 0.
///
/// Without a branch on the smallest coordinate and without a root.
/// Source: \[duff2017\].
#[inline]
pub fn tangent_frame(normal: [f64; 3]) -> [[f64; 3]; 2] {
    let [x, y, z] = normal;
    let sign = 1.0f64.copysign(z);
    let a = -1.0 / (sign + z);
    let b = x * y * a;
    [[1.0 + sign * x * x * a, sign * b, -sign * x], [b, sign + y * y * a, -y]]
}

/// The vector `v` turned by the smallest rotation that takes the unit vector
/// `from` to the unit vector `to`; unchanged where they are opposite.
#[inline]
pub(crate) fn turn_between(from: [f64; 3], to: [f64; 3], v: [f64; 3]) -> [f64; 3] {
    let axis = cross(from, to);
    let c = dot(from, to);
    if 1.0 + c < 1e-12 {
        return v;
    }
    let (across, along) = (cross(axis, v), scale(axis, dot(axis, v) / (1.0 + c)));
    std::array::from_fn(|k| c * v[k] + across[k] + along[k])
}

#[cfg(test)]
mod tests {
    use super::*;
    use fairing_mesh::vec3::{norm, normalize, sub};

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

    #[test]
    fn a_turn_takes_one_direction_to_the_other_and_keeps_the_axis() {
        for a in directions() {
            for b in directions() {
                if dot(a, b) < -0.999 {
                    continue;
                }
                assert!(norm(sub(turn_between(a, b, a), b)) < 1e-14);
                let axis = cross(a, b);
                assert!(norm(sub(turn_between(a, b, axis), axis)) < 1e-14);
            }
        }
    }
}
