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

    /// Adds the same to all lengths, so that in every triangle two sides are
    /// longer than the third by `slack` mean lengths. Returns what was added.
    pub(super) fn mollify(&mut self, slack: f64) -> f64 {
        let count = self.length.len();
        if count == 0 {
            return 0.0;
        }
        let slack = slack * self.length.iter().sum::<f64>() / count as f64;
        let lacking = (0..count as u32)
            .map(|s| {
                let [a, b, c] = [s, after(s), before(s)].map(|s| self.length[s as usize]);
                slack - (b + c - a)
            })
            .fold(0.0, f64::max);
        for length in &mut self.length {
            *length += lacking;
        }
        lacking
    }
}

/// The area of a triangle of these sides, in squared units.
pub(super) fn area(mut sides: [f64; 3]) -> f64 {
    sides.sort_unstable_by(|x, y| y.total_cmp(x));
    let [a, b, c] = sides;
    let product = (a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c));
    0.25 * product.max(0.0).sqrt()
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
    }

    #[test]
    fn mollified_lengths_make_triangles() {
        let mut t = Triangulation {
            start: vec![0, 1, 2],
            twin: vec![BORDER; 3],
            length: vec![1.0, 2.0, 3.0],
        };
        let added = t.mollify(1e-3);
        assert!((added - 2e-3).abs() < 1e-15);
        assert!(t.area(0) > 0.0);
        let kept = t.mollify(1e-4);
        assert_eq!(kept, 0.0);
    }
}
