//! Intrinsic Delaunay triangulations by flipping edges.
//!
//! An edge is Delaunay if the angles opposite it sum to at most π, that is, if cot α + cot β ≥ 0.
//! Flipping edges that are not Delaunay ends in a triangulation in which all edges are. Source:
//! [fisher2006].
//!
//! [fisher2006]: https://doi.org/10.1007/s00607-007-0249-8

/// Sums of cotangents down to minus this count as Delaunay: rounding would
/// otherwise flip cocircular edges back and forth.
const TOLERANCE: f64 = 1e-10;

/// Counts of flipped and of stuck edges.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Flips {
    pub(super) count: usize,
    /// Edges that are not Delaunay and could not be flipped, because the flip
    /// would have made a triangle without area.
    pub(super) stuck: usize,
}

impl Triangulation {
    /// Flips edges until all are Delaunay.
    pub(super) fn flip_to_delaunay(&mut self) -> Flips {
        let sides = self.start.len() as u32;
        let mut waiting: Vec<u32> = (0..sides).filter(|&s| s < self.twin_or_self(s)).collect();
        let mut is_waiting = vec![false; sides as usize];
        for &s in &waiting {
            is_waiting[s as usize] = true;
        }
        let mut flips = Flips { count: 0, stuck: 0 };
        // Finite in exact arithmetic; the bound is far above what any mesh
        // needs and guards against rounding.
        let bound = 200 * sides as usize;
        let watch = fairing_watch::current();
        while let Some(s) = waiting.pop() {
            watch.check();
            is_waiting[s as usize] = false;
            if self.is_delaunay(s) {
                continue;
            }
            if flips.count >= bound || !self.flip(s) {
                flips.stuck += 1;
                continue;
            }
            flips.count += 1;
            let t = self.twin[s as usize];
            for side in [after(s), before(s), after(t), before(t)] {
                let edge = side.min(self.twin_or_self(side));
                if edge != self.twin_or_self(edge) && !is_waiting[edge as usize] {
                    is_waiting[edge as usize] = true;
                    waiting.push(edge);
                }
            }
        }
        flips
    }

    fn twin_or_self(&self, s: u32) -> u32 {
        match self.twin[s as usize] {
            BORDER => s,
            t => t,
        }
    }

    fn is_delaunay(&self, s: u32) -> bool {
        let t = self.twin[s as usize];
        // A triangle glued to itself has no diagonal to flip.
        if t == BORDER || s / 3 == t / 3 {
            return true;
        }
        self.opposite_cotangent(s) + self.opposite_cotangent(t) >= -TOLERANCE
    }

    /// Replaces the edge of side `s` by the other diagonal of its two triangles.
    /// Does nothing and returns false if a triangle would lose its area. The sides
    /// of the new edge keep the numbers of the old one.
    fn flip(&mut self, s: u32) -> bool {
        let t = self.twin[s as usize];
        // The triangles are s = (i → j), j → k, k → i and t = (j → i), i → m,
        // m → j; the new ones have k → m and m → k.
        let [jk, ki, im, mj] = [after(s), before(s), after(t), before(t)];
        let at = |side: u32| self.length[side as usize];
        let (ij, ljk, lki, lim, lmj) = (at(s), at(jk), at(ki), at(im), at(mj));
        let (above, below) = (self.area(s), self.area(t));
        // In the plane: i in 0, j on the x axis, k above and m below.
        let (kx, ky) = ((ij * ij + lki * lki - ljk * ljk) / (2.0 * ij), 2.0 * above / ij);
        let (mx, my) = ((ij * ij + lim * lim - lmj * lmj) / (2.0 * ij), -2.0 * below / ij);
        let diagonal = libm::hypot(kx - mx, ky - my);
        let floor = 1e-14 * diagonal * diagonal;
        let sound = |sides: [f64; 3]| area(sides) > floor;
        if !diagonal.is_finite() || !sound([diagonal, lmj, ljk]) || !sound([diagonal, lki, lim]) {
            return false;
        }
        let (k, m) = (self.start[ki as usize], self.start[mj as usize]);
        let (i, j) = (self.start[s as usize], self.start[t as usize]);
        // Triangle of s becomes k → m (s), m → j, j → k; that of t becomes
        // m → k (t), k → i, i → m.
        let outer = [(mj, m, lmj), (jk, j, ljk), (ki, k, lki), (im, i, lim)]
            .map(|(side, start, length)| (side, self.twin[side as usize], start, length));
        let places = [after(s), before(s), after(t), before(t)];
        for ((old, twin, start, length), place) in outer.into_iter().zip(places) {
            // A twin may be one of the four itself, and move as well.
            let twin = match outer.iter().position(|o| o.0 == twin) {
                Some(moved) => places[moved],
                None => twin,
            };
            debug_assert!(old != s && old != t);
            self.start[place as usize] = start;
            self.length[place as usize] = length;
            self.twin[place as usize] = twin;
            if twin != BORDER {
                self.twin[twin as usize] = place;
            }
        }
        for (side, start) in [(s, k), (t, m)] {
            self.start[side as usize] = start;
            self.length[side as usize] = diagonal;
        }
        true
    }
}

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

    /// A kite whose long diagonal is not Delaunay.
    fn kite() -> Triangulation {
        let (long, side) = (4.0, 5f64.sqrt());
        Triangulation {
            start: vec![0, 1, 2, 1, 0, 3],
            twin: vec![3, BORDER, BORDER, 0, BORDER, BORDER],
            length: vec![long, side, side, long, side, side],
        }
    }

    #[test]
    fn a_kite_gets_its_short_diagonal() {
        let mut t = kite();
        let flips = t.flip_to_delaunay();
        assert_eq!(flips, Flips { count: 1, stuck: 0 });
        // Height 1 above and below the long diagonal.
        assert!((t.length[0] - 2.0).abs() < 1e-15 && t.length[0] == t.length[3]);
        assert_eq!(t.start, [2, 3, 1, 3, 2, 0]);
        assert_eq!(t.twin, [3, BORDER, BORDER, 0, BORDER, BORDER]);
        assert!((t.area(0) - 2.0).abs() < 1e-15 && (t.area(3) - 2.0).abs() < 1e-15);
    }

    #[test]
    fn flipping_twice_comes_back() {
        let (mut t, original) = (kite(), kite());
        assert!(t.flip(0) && t.flip(0));
        // The diagonal runs the other way round now.
        assert_eq!(t.start[0], original.start[3]);
        assert!((t.length[0] - 4.0).abs() < 1e-15);
    }

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
