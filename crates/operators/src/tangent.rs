//! Frames of tangent planes, and eigenvalues of symmetric 2 × 2 matrices in them.

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

/// The symmetric matrix `[[a, b], [b, c]]` of a form on a tangent plane.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Symmetric2 {
    pub(crate) a: f64,
    pub(crate) b: f64,
    pub(crate) c: f64,
}

impl Symmetric2 {
    /// The eigenvalues, the larger first, and the unit eigenvector of the
    /// larger; the other is its quarter turn. Any direction is one where both
    /// are equal: the first axis is returned there. Finite for finite entries.
    #[inline]
    pub(crate) fn eigen(self) -> ([f64; 2], [f64; 2]) {
        let (mean, half) = (0.5 * (self.a + self.c), 0.5 * (self.a - self.c));
        let radius = length(half, self.b);
        if radius == 0.0 {
            return ([mean; 2], [1.0, 0.0]);
        }
        // The column of A − κ₂ I that does not cancel.
        let (x, y) = if half >= 0.0 { (half + radius, self.b) } else { (self.b, radius - half) };
        let unit = 1.0 / length(x, y);
        ([mean + radius, mean - radius], [x * unit, y * unit])
    }
}

/// √(x² + y²), also where the squares leave the range of numbers.
#[inline]
fn length(x: f64, y: f64) -> f64 {
    let square = x * x + y * y;
    if (1e-280..1e280).contains(&square) { square.sqrt() } else { libm::hypot(x, y) }
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

    #[test]
    fn eigenvectors_of_rotated_diagonals() {
        for i in 0..40 {
            let t = f64::from(i) * 0.1 - 2.0;
            let (s, c) = t.sin_cos();
            let (k1, k2) = (3.0, -0.5);
            let m = Symmetric2 {
                a: k1 * c * c + k2 * s * s,
                b: (k1 - k2) * s * c,
                c: k1 * s * s + k2 * c * c,
            };
            let ([x, y], d) = m.eigen();
            assert!((x - k1).abs() < 1e-14 && (y - k2).abs() < 1e-14);
            assert!((d[0] * s - d[1] * c).abs() < 1e-14, "{t} {d:?}");
        }
    }

    #[test]
    fn an_umbilic_has_the_first_axis() {
        assert_eq!(Symmetric2 { a: 2.0, b: 0.0, c: 2.0 }.eigen(), ([2.0; 2], [1.0, 0.0]));
    }
}
