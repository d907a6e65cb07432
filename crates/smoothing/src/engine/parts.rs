//! The parts of a mesh that move on their own, and how exactly a system is to be solved in each.
//!
//! A system `(M(1 + w) + tS) x' = b` falls apart into one for each connected part of the vertices that move. Parts
//! may differ in size by any factor, and so may coordinates: a tolerance relative to the largest would leave the
//! smallest as they are. So residuals are measured for each coordinate of each part, against its own right-hand side,
//! but never below what rounding leaves of it.

use fairing_sparse::parallel::CHUNK;
use fairing_sparse::{GraphLaplacian, Padded};
use rayon::prelude::*;

use crate::engine::constraints::Freedom;

type Point = [f64; 3];

/// Rounding that a residual may hold, as a multiple of ε times its terms.
const ROUNDING: f64 = 8.0;

/// A residual is reported relative to no less than the rounding of its terms times this: where a right-hand side is
/// rounding itself, the share of it that is left says nothing.
const NOISE: f64 = 1e8;

/// With more parts than this, sums over parts are formed by one thread.
const FEW: usize = 16;

/// Connected parts of the vertices that move.
pub(crate) struct Parts {
    /// The part of each vertex; for vertices that are fixed, one more than there are.
    label: Vec<u32>,
    /// A vertex of each part.
    first: Vec<u32>,
    /// Whether a part has neighbours that are fixed, or vertices that slide, so that it cannot move as a whole.
    anchored: Vec<bool>,
}

impl Parts {
    /// The parts that the pattern of a Laplacian connects.
    pub(crate) fn new(laplacian: &GraphLaplacian, freedom: &Freedom) -> Self {
        const NONE: u32 = u32::MAX;
        let n = laplacian.len();
        let (mut label, mut first, mut anchored) = (vec![NONE; n], Vec::new(), Vec::new());
        let mut open = Vec::new();
        for seed in 0..n {
            if label[seed] != NONE || freedom.fixed[seed] {
                continue;
            }
            let part = first.len() as u32;
            first.push(seed as u32);
            anchored.push(freedom.sliding.is_some());
            label[seed] = part;
            open.push(seed as u32);
            while let Some(i) = open.pop() {
                for &j in laplacian.neighbors(i as usize) {
                    if freedom.fixed[j as usize] {
                        anchored[part as usize] = true;
                    } else if label[j as usize] == NONE {
                        label[j as usize] = part;
                        open.push(j);
                    }
                }
            }
        }
        let count = first.len() as u32;
        for label in &mut label {
            *label = (*label).min(count);
        }
        anchored.push(true);
        Self { label, first, anchored }
    }

    /// The number of parts; vertices that are fixed count as one more.
    pub(crate) fn count(&self) -> usize {
        self.anchored.len()
    }

    /// The part of vertex `i`.
    #[inline(always)]
    pub(crate) fn part(&self, i: usize) -> usize {
        self.label[i] as usize
    }

    /// Whether the part of vertex `i` may move as a whole.
    #[inline]
    pub(crate) fn is_free(&self, i: usize) -> bool {
        !self.anchored[self.label[i] as usize]
    }

    /// Whether each part may move as a whole.
    pub(crate) fn free(&self) -> impl Iterator<Item = bool> + '_ {
        self.anchored.iter().map(|anchored| !anchored)
    }

    /// A vertex of each part that may move as a whole.
    pub(crate) fn representatives(&self) -> impl Iterator<Item = usize> + '_ {
        self.first
            .iter()
            .zip(&self.anchored)
            .filter(|(_, anchored)| !**anchored)
            .map(|(&v, _)| v as usize)
    }

    /// The sum over each part of what `f` gives for the part and each of its vertices.
    pub(crate) fn sums<const K: usize>(
        &self,
        f: impl Fn(usize, usize) -> [f64; K] + Sync,
    ) -> Vec<[f64; K]> {
        self.sums_and_largest(|part, i| (f(part, i), []))
            .into_iter()
            .map(|(sums, [])| sums)
            .collect()
    }

    /// The largest in each part of what `f` gives for the part and each of its vertices, zero at least.
    pub(crate) fn largest<const K: usize>(
        &self,
        f: impl Fn(usize, usize) -> [f64; K] + Sync,
    ) -> Vec<[f64; K]> {
        self.sums_and_largest(|part, i| ([], f(part, i)))
            .into_iter()
            .map(|([], most)| most)
            .collect()
    }

    /// [`Self::sums`] of the first and [`Self::largest`] of the second, in one pass.
    pub(crate) fn sums_and_largest<const A: usize, const B: usize>(
        &self,
        f: impl Fn(usize, usize) -> ([f64; A], [f64; B]) + Sync,
    ) -> Vec<([f64; A], [f64; B])> {
        let add = |to: &mut ([f64; A], [f64; B]), from: ([f64; A], [f64; B])| {
            for (s, x) in to.0.iter_mut().zip(from.0) {
                *s += x;
            }
            for (s, x) in to.1.iter_mut().zip(from.1) {
                *s = larger(*s, x);
            }
        };
        let gather = |(chunk, labels): (usize, &[u32])| {
            let mut all = vec![([0.0; A], [0.0; B]); self.count()];
            let mut i = chunk * CHUNK;
            // Vertices in a row are mostly of one part, whose sums stay in registers.
            for run in labels.chunk_by(|a, b| a == b) {
                let part = run[0] as usize;
                let mut here = all[part];
                for i in i..i + run.len() {
                    add(&mut here, f(part, i));
                }
                all[part] = here;
                i += run.len();
            }
            all
        };
        if self.count() > FEW {
            return gather((0, &self.label));
        }
        let chunks: Vec<_> = self.label.par_chunks(CHUNK).enumerate().map(gather).collect();
        let mut total = vec![([0.0; A], [0.0; B]); self.count()];
        for chunk in chunks {
            for (total, part) in total.iter_mut().zip(chunk) {
                add(total, part);
            }
        }
        total
    }

    /// The points about which each part is solved. For a part that may move as a whole, it is the centre that
    /// `M(1 + w) x' = M (x + w c)` gives it; all other parts share the weighted mean of their centres.
    pub(crate) fn centres(&self, mass: &[f64], x: &[Point], freedom: &Freedom) -> Vec<Point> {
        // About a point of the part, so that coordinates far from the origin lose nothing.
        let origin = |part: usize| x[self.first.get(part).map_or(0, |&v| v as usize)];
        let origins: Vec<Point> = (0..self.count()).map(origin).collect();
        let sums = self.sums(|part, i| {
            let (m, (w, c), o) = (mass[i], freedom.pull(i), origins[part]);
            let moment =
                |k: usize| m * (x[i][k] - o[k] + if w > 0.0 { w * (c[k] - o[k]) } else { 0.0 });
            [moment(0), moment(1), moment(2), m * (1.0 + w)]
        });
        let mut centres: Vec<Point> = sums
            .iter()
            .enumerate()
            .map(|(part, s)| {
                let o = origins[part];
                [0, 1, 2].map(|k| if s[3] > 0.0 { o[k] + s[k] / s[3] } else { 0.0 })
            })
            .collect();
        let (mut common, mut total) = ([0.0; 3], 0.0);
        for (part, s) in sums.iter().enumerate().filter(|(part, _)| self.anchored[*part]) {
            total += s[3];
            for k in 0..3 {
                common[k] += s[3] * centres[part][k];
            }
        }
        for (centre, _) in centres.iter_mut().zip(&self.anchored).filter(|(_, anchored)| **anchored)
        {
            *centre = common.map(|c| if total > 0.0 { c / total } else { 0.0 });
        }
        centres
    }
}

/// How large residuals may be in each coordinate of each part.
pub(crate) struct Gauge<'a> {
    parts: &'a Parts,
    /// The reciprocals of the right-hand sides of parts, raised to rounding, in which an iteration measures.
    pub(crate) measure: Vec<Point>,
    /// The reciprocals of the right-hand sides, in which it reports.
    report: Vec<Point>,
}

impl<'a> Gauge<'a> {
    /// From the squared norms of the right-hand sides of parts and, as a fourth, of the coefficients of their terms;
    /// and the largest coordinates in each. Coordinates that are coupled are measured together.
    pub(crate) fn new(
        parts: &'a Parts,
        sides: &[[f64; 4]],
        reach: &[Point],
        tolerance: f64,
        coupled: bool,
    ) -> Self {
        let together = |p: Point, f: fn(f64, f64) -> f64| match coupled {
            true => [p.into_iter().fold(0.0, f); 3],
            false => p,
        };
        let (mut measure, mut report) = (Vec::new(), Vec::new());
        for (&[a, b, c, square], reach) in sides.iter().zip(reach) {
            let side = together([a, b, c], |a, b| a + b).map(f64::sqrt);
            let reach = together(*reach, f64::max);
            let floor = reach.map(|r| ROUNDING * f64::EPSILON * square.sqrt() * r);
            measure.push([0, 1, 2].map(|k| reciprocal(side[k].max(floor[k] / tolerance))));
            report.push([0, 1, 2].map(|k| reciprocal(side[k].max(NOISE * floor[k]))));
        }
        Self { parts, measure, report }
    }

    /// The residual of each coordinate of each part as an iteration measures it: the largest.
    pub(crate) fn measured(&self, r: &[Point]) -> f64 {
        self.relative(r, &self.measure)
    }

    /// The residual as it is reported, of each coordinate of each part relative to its right-hand side: the largest.
    pub(crate) fn reported(&self, r: &[Point]) -> f64 {
        self.relative(r, &self.report)
    }

    /// [`Self::reported`] of a residual in units of [`Self::measure`]; `sums` are the sums of its squares.
    pub(crate) fn reported_in_units(&self, r: &[Padded], sums: &[f64]) -> f64 {
        let units = self.measure.iter().zip(&self.report);
        let shares: Vec<Point> =
            units.map(|(m, r)| [0, 1, 2].map(|k| r[k] * reciprocal(m[k]))).collect();
        match self.parts.first[..] {
            [_] => (0..3).map(|k| sums[k].sqrt() * shares[0][k]).fold(0.0, larger),
            _ => self.relative(r, &shares),
        }
    }

    fn relative<const N: usize>(&self, r: &[[f64; N]], to: &[Point]) -> f64 {
        let sums = self.parts.sums(|part, i| [0, 1, 2].map(|k| (r[i][k] * to[part][k]).powi(2)));
        sums.into_iter().flatten().map(f64::sqrt).fold(0.0, larger)
    }
}

/// `1/x`, zero for zero.
pub(crate) fn reciprocal(x: f64) -> f64 {
    if x > 0.0 { 1.0 / x } else { 0.0 }
}

/// The larger of two numbers; NaN if one is.
#[inline(always)]
pub(crate) fn larger(a: f64, b: f64) -> f64 {
    if a > b || a.is_nan() { a } else { b }
}

#[cfg(test)]
mod tests {
    use fairing_mesh::TriMesh;

    use super::*;
    use crate::engine::arrangement::Arrangement;
    use crate::engine::assemble::uniform;
    use crate::engine::constraints::{Constraints, SoftConstraint};

    /// Three tetrahedra of sizes 1, 2 and 1/8 apart from each other, and masses without a pattern.
    fn three() -> (TriMesh, Vec<f64>) {
        let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let placed = [(1.0, -3.0), (2.0, 5.0), (0.125, 40.0)].into_iter();
        let positions = placed
            .flat_map(|(size, x)| corners.map(|p| [size * p[0] + x, size * p[1] - x, size * p[2]]));
        let faces = [0u32, 4, 8]
            .into_iter()
            .flat_map(|v| [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]].map(|f| f.map(|k| k + v)));
        let mesh = TriMesh::new(positions.collect(), faces.collect()).unwrap();
        (mesh, (0..12).map(|v| 1.0 + f64::from(v * v % 7)).collect())
    }

    /// A free part is solved about the mean that its masses and pulls have; all others, and what holds them, about one
    /// mean of theirs.
    #[test]
    fn anchored_parts_have_one_centre() {
        let (mesh, mass) = three();
        let pull = SoftConstraint { vertex: 10, target: Some([50.0, -7.0, 3.0]), weight: 2.5 };
        let constraints =
            Constraints { pinned: vec![1, 6], soft: vec![pull], ..Constraints::default() };
        let freedom = Freedom::new(&Arrangement::as_given(&mesh), &constraints).unwrap();
        let laplacian = uniform(&mesh, &freedom.fixed);
        let parts = Parts::new(&laplacian, &freedom);
        assert_eq!(parts.free().collect::<Vec<_>>(), [false, false, true, false]);
        let x = mesh.positions();
        let mean = |of: std::ops::Range<usize>| {
            let (mut sum, mut total) = ([0.0; 3], 0.0);
            for v in of {
                let (w, target) = freedom.pull(v);
                total += mass[v] * (1.0 + w);
                for k in 0..3 {
                    sum[k] += mass[v] * (x[v][k] + w * target[k]);
                }
            }
            sum.map(|s| s / total)
        };
        let expected = [mean(0..8), mean(0..8), mean(8..12), mean(0..8)];
        let found = parts.centres(&mass, x, &freedom);
        for (found, expected) in found.iter().zip(&expected) {
            for k in 0..3 {
                assert!((found[k] - expected[k]).abs() < 1e-13, "{found:?} {expected:?}");
            }
        }
        // Parts that cannot move as a whole stay next to each other, to the last bit.
        assert!(found[0] == found[1] && found[1] == found[3]);
    }

    /// Few parts are summed by chunks of vertices, many at once.
    #[test]
    fn parts_are_summed_over_all_chunks() {
        let n = 2 * CHUNK + 77;
        for count in [3, 2 * FEW as u32] {
            let label: Vec<u32> = (0..n as u32).map(|i| (i / 200 + i % 2) % count).collect();
            let anchored = vec![true; count as usize];
            let parts = Parts { label: label.clone(), first: vec![], anchored };
            let found = parts.sums_and_largest(|part, i| ([i as f64, 1.0], [(part + i) as f64]));
            for (part, (sums, [largest])) in found.into_iter().enumerate() {
                let own = || (0..n).filter(|&i| label[i] as usize == part);
                // Whole numbers: the order of a sum does not matter.
                assert_eq!(sums, [own().sum::<usize>() as f64, own().count() as f64]);
                assert_eq!(Some(largest), own().next_back().map(|i| (part + i) as f64));
            }
        }
    }

    /// Each part has its own measure, and each of its coordinates unless they are coupled.
    #[test]
    fn residuals_are_relative_to_their_own_part() {
        let (mesh, _) = three();
        let freedom = Freedom::new(&Arrangement::as_given(&mesh), &Constraints::default()).unwrap();
        let laplacian = uniform(&mesh, &freedom.fixed);
        let parts = Parts::new(&laplacian, &freedom);
        assert_eq!(parts.count(), 4);
        // Right-hand sides of 1, 10⁻⁶ and 10³ in x, half of that in y, and a hundredth in z.
        let sides = [1.0, 1e-6, 1e3, 0.0].map(|s: f64| [s * s, 0.25 * s * s, 1e-4 * s * s, s * s]);
        let reach = [1.0, 1e-6, 1e3, 0.0].map(|s| [s; 3]);
        let at = |v: usize, r: Point| -> Vec<Point> {
            (0..12).map(|i| if i == v { r } else { [0.0; 3] }).collect()
        };
        let gauge = Gauge::new(&parts, &sides, &reach, 1e-8, false);
        for (v, size) in [(2, 1.0), (7, 1e-6), (11, 1e3)] {
            for (r, relative) in
                [([3e-5, 0.0, 0.0], 3e-5), ([0.0, 3e-5, 0.0], 6e-5), ([0.0, 0.0, 3e-5], 3e-3)]
            {
                let r = at(v, r.map(|r| r * size));
                for found in [gauge.measured(&r), gauge.reported(&r)] {
                    assert!((found / relative - 1.0).abs() < 1e-12, "{v}: {found} {relative}");
                }
            }
        }
        // Sliding vertices couple coordinates: relative to the length of the right-hand side.
        let coupled = Gauge::new(&parts, &sides, &reach, 1e-8, true);
        let found = coupled.reported(&at(7, [0.0, 0.0, 3e-11]));
        assert!((found / (3e-5 / 1.2501f64.sqrt()) - 1.0).abs() < 1e-12, "{found}");
    }
}
