//! Triangles glued along sides of given lengths.

/// No side is glued here.
pub(super) const BORDER: u32 = u32::MAX;

/// Triangles glued along sides. Side `3t + k` runs from corner k to corner
/// k + 1 of triangle t; glued sides run in opposite directions.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Triangulation {
    /// The vertex that each side starts in.
    pub(super) start: Vec<u32>,
    /// The side that each side is glued to, or [`BORDER`].
    pub(super) twin: Vec<u32>,
    /// The length of each side, equal for glued ones.
    pub(super) length: Vec<f64>,
}

/// The side after `s` in its triangle.
#[inline]
pub(super) fn after(s: u32) -> u32 {
    crate::corners::next(s)
}

/// The side before `s` in its triangle.
#[inline]
pub(super) fn before(s: u32) -> u32 {
    crate::corners::previous(s)
}

impl Triangulation {
    pub(super) fn triangle_count(&self) -> usize {
        self.start.len() / 3
    }

    /// The area of the triangle of side `s`, by Kahan's form of
    /// Heron's formula; zero where the lengths make no triangle.
    #[inline]
    pub(super) fn area(&self, s: u32) -> f64 {
        area([s, after(s), before(s)].map(|s| self.length[s as usize]))
    }

    /// The cotangent of the angle opposite side `s`.
    #[inline]
    pub(super) fn opposite_cotangent(&self, s: u32) -> f64 {
        let [a, b, c] = [s, after(s), before(s)].map(|s| self.length[s as usize]);
        (b * b + c * c - a * a) / (4.0 * area([a, b, c]))
    }
}

/// The area of a triangle of these sides, in squared units.
pub(super) fn area(mut sides: [f64; 3]) -> f64 {
    sides.sort_unstable_by(|x, y| y.total_cmp(x));
    let [a, b, c] = sides;
    let product = (a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c));
    if product > 1e-280 || c <= a - b {
        return 0.25 * product.max(0.0).sqrt();
    }
    // Fourth powers of small lengths underflow, where roots do not.
    let factors = [a + (b + c), c - (a - b), c + (a - b), a + (b - c)];
    0.25 * factors.map(f64::sqrt).iter().product::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn areas_from_sides() {
        assert_eq!(area([3.0, 5.0, 4.0]), 6.0);
        assert_eq!(area([1.0, 2.0, 3.0]), 0.0);
        assert_eq!(area([1.0, 1.0, 9.0]), 0.0);
        // A needle of width 1e-10 and length one.
        assert!((area([1.0, 1.0, 1e-10]) - 0.5e-10).abs() < 1e-25);
        let small = area([3.0, 5.0, 4.0].map(|l| l * 2f64.powi(-400)));
        assert!((small * 2f64.powi(800) - 6.0).abs() < 1e-14);
        assert!((area([1.0, 1.0, 1e-200]) - 0.5e-200).abs() < 1e-214);
        assert_eq!(area([0.0; 3]), 0.0);
    }
}
