//! Frames of tangent planes.

use glam::DVec3;

/// Two unit tangents that form a right-handed frame with the unit normal; any
/// such frame, but continuous in the normal except across z = 0.
///
/// Without a branch on the smallest coordinate and without a root.
/// Source: [duff2017].
///
/// [duff2017]: https://jcgt.org/published/0006/01/01/
#[inline]
pub fn tangent_frame(normal: DVec3) -> [DVec3; 2] {
    let DVec3 { x, y, z } = normal;
    let sign = 1.0f64.copysign(z);
    let a = -1.0 / (sign + z);
    let b = x * y * a;
    [DVec3::new(1.0 + sign * x * x * a, sign * b, -sign * x), DVec3::new(b, sign + y * y * a, -y)]
}

/// The vector `v` turned by the smallest rotation that takes the unit vector
/// `from` to the unit vector `to`; unchanged where they are opposite.
#[inline]
pub(crate) fn turn_between(from: DVec3, to: DVec3, v: DVec3) -> DVec3 {
    let axis = from.cross(to);
    let c = from.dot(to);
    if 1.0 + c < 1e-12 {
        return v;
    }
    let (across, along) = (axis.cross(v), axis * (axis.dot(v) / (1.0 + c)));
    c * v + across + along
}

#[cfg(test)]
mod tests {
    use super::*;

    fn directions() -> Vec<DVec3> {
        let grid = -2..=2;
        grid.clone()
            .flat_map(|x| grid.clone().map(move |y| (x, y)))
            .flat_map(|(x, y)| grid.clone().map(move |z| DVec3::from([x, y, z].map(f64::from))))
            .filter_map(DVec3::try_normalize)
            .collect()
    }

    #[test]
    fn frames_are_orthonormal_and_right_handed() {
        for n in directions() {
            let [x, y] = tangent_frame(n);
            assert!((x.cross(y) - n).length() < 1e-15, "{n:?}");
            assert!((x.length() - 1.0).abs() < 1e-15 && x.dot(y).abs() < 1e-15);
        }
    }

    #[test]
    fn a_turn_takes_one_direction_to_the_other_and_keeps_the_axis() {
        for a in directions() {
            for b in directions() {
                if a.dot(b) < -0.999 {
                    continue;
                }
                assert!((turn_between(a, b, a) - b).length() < 1e-14);
                let axis = a.cross(b);
                assert!((turn_between(a, b, axis) - axis).length() < 1e-14);
            }
        }
    }
}
