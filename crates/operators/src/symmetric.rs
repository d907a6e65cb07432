//! Eigenvalues of symmetric 2 × 2 matrices.

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
