//! Lengths raised where triangles have no area.
//!
//! [sharp2020] adds one ε to all lengths, enough for the worst triangle. The theory only requires
//! lengths that are the same on both sides of an edge and with which every triangle has area. Any
//! such lengths are a metric, with its own Delaunay triangulation and positive semi-definite
//! operators. But with a single ε, one triangle without area lengthens every edge, and a much
//! smaller part of the mesh changes its shape.
//!
//! Here ε is therefore common to a *patch* only: a triangle that lacks slack raises its own three
//! sides by the missing amount, and every neighbour that lacks slack as a result joins the patch.
//! Patches end at the first triangles with enough slack, and no side beyond them is raised. If all
//! triangles lack slack, the patch is the mesh, and the lengths are those of the source.
//!
//! [sharp2020]: https://doi.org/10.1111/cgf.14069

use super::delaunay::{BORDER, Triangulation};

/// Result of mollification.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Mollified {
    /// The most that was added to a length.
    pub(super) added: f64,
    /// Triangles with a side that was raised.
    pub(super) triangles: usize,
}

impl Triangulation {
    /// Raises lengths until in every triangle two sides are longer than the
    /// third by `slack` times its longest side, or times the mean length in its
    /// part of the mesh where that is less. `part_of_vertex` gives the parts
    /// and is called only if a triangle needs mending.
    ///
    /// Triangles without any length follow their neighbours; where those have
    /// none either, they get `slack` times the shortest length that there is.
    pub(super) fn mollify(
        &mut self,
        slack: f64,
        part_of_vertex: impl FnOnce() -> Vec<usize>,
    ) -> Mollified {
        let none = Mollified { added: 0.0, triangles: 0 };
        let triangles = 0..self.triangle_count() as u32;
        let lacking = |&t: &u32| {
            let longest = longest(self.sides(t));
            longest == 0.0 || lack(self.sides(t), slack * longest) > 0.0
        };
        let suspects: Vec<u32> = triangles.clone().filter(lacking).collect();
        if suspects.is_empty() {
            return none;
        }
        let mut patches = Patches::new(self, slack, &part_of_vertex());
        patches.raise_all(&suspects);
        let added = patches.added;
        for (length, add) in self.length.iter_mut().zip(&added) {
            *length += add;
        }
        let (sides, _) = added.as_chunks::<3>();
        Mollified {
            added: added.iter().copied().fold(0.0, f64::max),
            triangles: sides.iter().filter(|sides| **sides != [0.0; 3]).count(),
        }
    }

    fn sides(&self, t: u32) -> [f64; 3] {
        let first = 3 * t as usize;
        [0, 1, 2].map(|k| self.length[first + k])
    }
}

fn longest(sides: [f64; 3]) -> f64 {
    sides.into_iter().fold(0.0, f64::max)
}

/// The length to add to all sides so that any two exceed the third by `needed`;
/// zero or less if they already do.
fn lack([a, b, c]: [f64; 3], needed: f64) -> f64 {
    needed - (b + c - a).min(c + a - b).min(a + b - c)
}

/// The fraction of the needed slack that a mended triangle may lack. Triangles are
/// mended to what they need up to rounding, which is far below this fraction;
/// without it rounding would decide whether a patch grows.
const MENDED: f64 = 1e-6;

/// Raised lengths in the making.
struct Patches<'a> {
    triangulation: &'a Triangulation,
    slack: f64,
    /// The mean length in the part of each triangle.
    mean: Vec<f64>,
    /// The length added to each side.
    added: Vec<f64>,
    stack: Vec<u32>,
}

impl<'a> Patches<'a> {
    fn new(triangulation: &'a Triangulation, slack: f64, part_of_vertex: &[usize]) -> Self {
        let parts = part_of_vertex.iter().max().map_or(0, |last| last + 1);
        let part = |t: u32| part_of_vertex[triangulation.start[3 * t as usize] as usize];
        let mut sums = vec![(0.0, 0usize); parts];
        let triangles = 0..triangulation.triangle_count() as u32;
        for t in triangles.clone() {
            let (sum, count) = &mut sums[part(t)];
            *sum += triangulation.sides(t).iter().sum::<f64>();
            *count += 3;
        }
        let mean = triangles.map(|t| sums[part(t)].0 / sums[part(t)].1 as f64).collect();
        let added = vec![0.0; triangulation.length.len()];
        Self { triangulation, slack, mean, added, stack: vec![] }
    }

    /// The length that a triangle lacks with the original sides.
    fn lack(&self, t: u32) -> f64 {
        let sides = self.triangulation.sides(t);
        lack(sides, self.slack * longest(sides).min(self.mean[t as usize]))
    }

    fn raise_all(&mut self, suspects: &[u32]) {
        let mut lacking: Vec<(f64, u32)> =
            suspects.iter().map(|&t| (self.lack(t), t)).filter(|&(lack, _)| lack > 0.0).collect();
        // The worst first: its patch takes in all that would join later.
        lacking.sort_unstable_by(|x, y| y.0.total_cmp(&x.0).then(x.1.cmp(&y.1)));
        for (lack, t) in lacking {
            self.raise_from(t, lack);
        }
        let lengths = self.triangulation.length.iter().copied();
        let shortest = lengths.filter(|&l| l > 0.0).fold(f64::INFINITY, f64::min);
        if shortest.is_finite() {
            for &t in suspects {
                let first = 3 * t as usize;
                let point = longest(self.triangulation.sides(t)) == 0.0;
                if point && self.added[first..first + 3] == [0.0; 3] {
                    self.raise_sides(t, self.slack * shortest);
                    self.grow();
                }
            }
        }
    }

    /// Raises the patch that begins with triangle `t`, unless another patch has
    /// mended it.
    fn raise_from(&mut self, t: u32, amount: f64) {
        if self.lacks_still(t) {
            self.raise_sides(t, amount);
            self.grow();
        }
    }

    /// Raises triangles that raised neighbours made lack slack, until none is
    /// left. What a side gains is what some triangle lacked at first, and only
    /// grows, so that this ends.
    fn grow(&mut self) {
        let watch = fairing_watch::current();
        while let Some(t) = self.stack.pop() {
            watch.check();
            if self.lacks_still(t) {
                let first = 3 * t as usize;
                let most = longest([0, 1, 2].map(|k| self.added[first + k]));
                self.raise_sides(t, most.max(self.lack(t)));
            }
        }
    }

    fn lacks_still(&self, t: u32) -> bool {
        let (first, sides) = (3 * t as usize, self.triangulation.sides(t));
        let raised = [0, 1, 2].map(|k| sides[k] + self.added[first + k]);
        // A triangle that is small beside what its neighbours add is as large as
        // that: a point with two raised sides would be a segment.
        let added = longest([0, 1, 2].map(|k| self.added[first + k]));
        let needed = self.slack * longest(sides).max(added).min(self.mean[t as usize]);
        lack(raised, needed) > MENDED * needed
    }

    /// Raises the sides of a triangle to an amount, and notes the neighbours.
    fn raise_sides(&mut self, t: u32, amount: f64) {
        for s in 3 * t..3 * t + 3 {
            if self.added[s as usize] < amount {
                self.added[s as usize] = amount;
                let twin = self.triangulation.twin[s as usize];
                if twin != BORDER {
                    self.added[twin as usize] = amount;
                    self.stack.push(twin / 3);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle(length: [f64; 3]) -> Triangulation {
        Triangulation { start: vec![0, 1, 2], twin: vec![BORDER; 3], length: length.to_vec() }
    }

    /// A strip of points behind a flat triangle: whatever neighbours add to
    /// their sides, every triangle ends with area.
    #[test]
    fn points_beside_raised_sides_have_area() {
        for count in 1..6u32 {
            // Triangle t has the corners t, t + 1, t + 2 and shares the side
            // from t + 1 to t + 2 with the next one.
            let start = (0..count).flat_map(|t| [t, t + 1, t + 2]).collect();
            let mut twin = vec![BORDER; 3 * count as usize];
            for t in 1..count {
                twin[3 * t as usize - 2] = 3 * t;
                twin[3 * t as usize] = 3 * t - 2;
            }
            let mut length = vec![0.0; 3 * count as usize];
            // The first is flat, and has no length at the side it shares.
            (length[0], length[2]) = (1.0, 1.0);
            let mut triangles = Triangulation { start, twin, length };
            triangles.mollify(1e-5, || vec![0; count as usize + 2]);
            assert!((0..count).all(|t| triangles.area(3 * t) > 0.0), "{count}");
        }
    }

    #[test]
    fn mollified_lengths_make_triangles() {
        let mut t = triangle([1.0, 2.0, 3.0]);
        let done = t.mollify(1e-3, || vec![0; 3]);
        // The mean is less than the longest side.
        assert!((done.added - 2e-3).abs() < 1e-15 && done.triangles == 1);
        assert!(t.area(0) > 0.0);
        let kept = t.mollify(1e-4, || unreachable!("nothing is to be mended"));
        assert_eq!(kept, Mollified { added: 0.0, triangles: 0 });
    }

    /// A fan of triangles about vertex 0 in the plane, of which one is flat.
    /// Only its sides, and those of no sound neighbour, are raised.
    #[test]
    fn sound_neighbours_share_one_raised_side() {
        // Triangles (0, i, i + 1), sides 0i, i i+1, i+1 0; 1 and 2 on one ray.
        let start = vec![0, 1, 2, 0, 2, 3, 0, 3, 4];
        let twin = vec![BORDER, BORDER, 3, 2, BORDER, 6, 5, BORDER, BORDER];
        let mut length = vec![1.0, 1.0, 2.0, 2.0, 1.5, 1.2, 1.2, 1.0, 0.9];
        let mut t = Triangulation { start, twin, length: length.clone() };
        let done = t.mollify(1e-4, || vec![0; 5]);
        assert_eq!(done.triangles, 2);
        length[..4].iter_mut().for_each(|l| *l += done.added);
        assert_eq!(t.length, length);
        assert!(t.area(0) > 0.0 && t.length[2] == t.length[3]);
    }

    /// A strip of flat triangles on a line is one patch, with the ε of the
    /// source; points follow their neighbours, and points alone the shortest.
    #[test]
    fn patches_of_flat_triangles_share_one_amount() {
        let start = vec![0, 1, 2, 2, 1, 3, 3, 1, 4, 5, 6, 7];
        let twin = vec![BORDER, 3, BORDER, 1, 6, BORDER, 4, BORDER, BORDER, BORDER, BORDER, BORDER];
        // 0-1-2 flat with a long side, 2-1-3 flat, 3-1-4 and 5-6-7 points.
        let length = vec![1.0, 1.0, 2.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        let mut t = Triangulation { start, twin, length: length.clone() };
        let done = t.mollify(1e-3, || vec![0, 0, 0, 0, 0, 1, 1, 1]);
        assert_eq!((done.triangles, done.added), (4, 1e-3));
        // The mean of the part is 6/9.
        for s in 0..9 {
            assert!((t.length[s] - length[s] - 1e-3 * 6.0 / 9.0).abs() < 1e-15, "{s}");
        }
        assert_eq!(t.length[9..], [1e-3; 3]);
        for f in 0..4 {
            assert!(t.area(3 * f) > 0.0, "{f}");
        }
    }
}
