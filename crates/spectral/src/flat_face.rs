//! A face laid out in the plane by the lengths of its sides.

/// The gradients of the three hat functions of a face, and its area.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct FlatFace {
    /// In the plane, in 1/(mesh unit); zero if the lengths form no triangle.
    hats: [[f64; 2]; 3],
    /// In squared mesh units, times the fraction at which the face counts.
    area: f64,
}

impl FlatFace {
    /// Builds the face from the lengths of its sides 0 → 1, 1 → 2 and 2 → 0.
    pub(crate) fn new([a, b, c]: [f64; 3], fraction: f64) -> Self {
        let area = heron([a, b, c]);
        if a == 0.0 || area == 0.0 {
            return Self { hats: [[0.0; 2]; 3], area: 0.0 };
        }
        // Corner 0 in the origin, corner 1 on the x axis, corner 2 above it.
        let x = 0.5 * (a + (c - b) * ((c + b) / a));
        let y = 2.0 * area / a;
        let twice = 2.0 * area;
        let hats = [[-y, x - a], [y, -x], [0.0, a]].map(|hat| hat.map(|v| v / twice));
        Self { hats, area: area * fraction }
    }

    /// ∫ X · ∇φᵢ over the face for the hat function φᵢ of each corner, X = −∇u / |∇u|, from u at
    /// the corners. The scale of u does not matter, down to the smallest normal number.
    pub(crate) fn unit_flux(&self, u: [f64; 3]) -> [f64; 3] {
        let largest = u.iter().fold(0.0, |m: f64, u| m.max(u.abs()));
        if largest == 0.0 {
            return [0.0; 3];
        }
        let scaled = u.map(|u| u / largest);
        // Differences from the first corner: the gradient of a constant is exactly zero.
        let d = [scaled[1] - scaled[0], scaled[2] - scaled[0]];
        let g: [f64; 2] = std::array::from_fn(|k| self.hats[1][k] * d[0] + self.hats[2][k] * d[1]);
        let norm = libm::hypot(g[0], g[1]);
        if norm == 0.0 {
            return [0.0; 3];
        }
        self.hats.map(|hat| -self.area * (hat[0] * (g[0] / norm) + hat[1] * (g[1] / norm)))
    }
}

/// The area from the side lengths by Kahan's form of Heron's formula; zero if they form no
/// triangle.
fn heron(mut sides: [f64; 3]) -> f64 {
    sides.sort_unstable_by(|x, y| y.total_cmp(x));
    let [a, b, c] = sides;
    let product = ((a + (b + c)) * (c - (a - b))) * ((c + (a - b)) * (a + (b - c)));
    0.25 * product.max(0.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Legs of 1 and 2, u = x: X = −e₁, and ∇φ are (−1, −½), (1, 0), (0, ½).
    #[test]
    fn flux_of_a_right_triangle() {
        let face = FlatFace::new([1.0, 5f64.sqrt(), 2.0], 0.5);
        for unit in [1.0, 1e-290, 1e290] {
            let flux = face.unit_flux([0.0, unit, 0.0]);
            let expected = [0.5, -0.5, 0.0];
            assert!((0..3).all(|i| (flux[i] - expected[i]).abs() < 1e-15), "{flux:?}");
        }
        assert_eq!(face.unit_flux([3.0; 3]), [0.0; 3]);
        assert_eq!(FlatFace::new([1.0, 2.0, 3.0], 1.0).unit_flux([0.0, 1.0, 2.0]), [0.0; 3]);
    }
}
