//! Connected parts of a mesh, and the accuracy to which a system is solved in each.
//!
//! A system `(M(1 + w) + tS) x' = b` decouples into one for each connected part of the vertices
//! that move. Parts may differ in size by any factor, and so may coordinates; with a tolerance
//! relative to the largest, the smallest would not be solved at all. Residuals are therefore
//! measured for each coordinate of each part relative to its own right-hand side, but not below the
//! level of rounding.

use fairing_sparse::larger;
use fairing_sparse::parallel::CHUNK;
use fairing_sparse::{GraphLaplacian, Padded};
use rayon::prelude::*;

use crate::engine::constraints::Freedom;

type Point = [f64; 3];

/// The rounding error allowed in a residual, as a multiple of ε times its terms.
const ROUNDING: f64 = 8.0;

/// A residual is reported relative to at least this multiple of the rounding error of its terms:
/// relative to a right-hand side that consists of rounding errors it would be meaningless.
const NOISE: f64 = 1e8;

/// The largest number of parts over which sums are formed in parallel.
const FEW: usize = 16;

/// Connected parts of the vertices that move.
pub(crate) struct Parts {
    /// The part of each vertex; the number of parts for fixed vertices.
    label: Vec<u32>,
    /// A vertex of each part.
    first: Vec<u32>,
    /// True for parts with fixed neighbours or sliding vertices, which cannot move as a whole.
    anchored: Vec<bool>,
}

impl Parts {
    /// The connected parts of the pattern of a Laplacian, without fixed vertices.
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

    /// The number of parts; the fixed vertices count as one more.
    pub(crate) fn count(&self) -> usize {
        self.anchored.len()
    }

    /// The part of vertex `i`.
    #[inline(always)]
    pub(crate) fn part(&self, i: usize) -> usize {
        self.label[i] as usize
    }

    /// Returns true if the part of vertex `i` may move as a whole.
    #[inline]
    pub(crate) fn is_free(&self, i: usize) -> bool {
        !self.anchored[self.label[i] as usize]
    }

    /// For each part, true if it may move as a whole.
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

    /// The sum over each part of `f(part, vertex)`.
    pub(crate) fn sums<const K: usize>(
        &self,
        f: impl Fn(usize, usize) -> [f64; K] + Sync,
    ) -> Vec<[f64; K]> {
        self.sums_and_largest(|part, i| (f(part, i), []))
            .into_iter()
            .map(|(sums, [])| sums)
            .collect()
    }

    /// The largest value of `f(part, vertex)` in each part, at least zero.
    pub(crate) fn largest<const K: usize>(
        &self,
        f: impl Fn(usize, usize) -> [f64; K] + Sync,
    ) -> Vec<[f64; K]> {
        self.sums_and_largest(|part, i| ([], f(part, i)))
            .into_iter()
            .map(|([], most)| most)
            .collect()
    }

    /// [`Self::sums`] of the first values and [`Self::largest`] of the second ones, in one pass.
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
            // Consecutive vertices are mostly of one part, whose sums stay in registers.
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

    /// The point about which each part is solved: for a part that may move as a whole the centre
    /// determined by `M(1 + w) x' = M (x + w c)`, for all other parts the common weighted mean of
    /// their centres.
    pub(crate) fn centres(&self, mass: &[f64], x: &[Point], freedom: &Freedom) -> Vec<Point> {
        // Sums are formed about a point of the part, so that coordinates far from the origin lose
        // no digits.
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

/// Scales of the residual in each coordinate of each part.
pub(crate) struct Gauge<'a> {
    parts: &'a Parts,
    /// Reciprocals of the right-hand sides of the parts, raised to the level of rounding, for
    /// convergence tests.
    pub(crate) measure: Vec<Point>,
    /// Reciprocals of the right-hand sides, for reported residuals.
    report: Vec<Point>,
}

impl<'a> Gauge<'a> {
    /// The scales for the squared norms of the right-hand sides of the parts and, as fourth
    /// entries, of the coefficients of their terms, with the largest coordinates of each part in
    /// `reach`. Coupled coordinates share one scale.
    pub(crate) fn new(
        parts: &'a Parts,
        sides: &[[f64; 4]],
        reach: &[Point],
        tolerance: f64,
        coupled: bool,
    ) -> Self {
        let together = |p: Point, f: fn(f64, f64) -> f64| {
            if coupled { [p.into_iter().fold(0.0, f); 3] } else { p }
        };
        let (mut measure, mut report) = (Vec::new(), Vec::new());
        for (&[a, b, c, square], reach) in sides.iter().zip(reach) {
            let side = together([a, b, c], |a, b| a + b).map(f64::sqrt);
            let reach = together(*reach, larger);
            let floor = reach.map(|r| ROUNDING * f64::EPSILON * square.sqrt() * r);
            measure.push([0, 1, 2].map(|k| reciprocal(side[k].max(floor[k] / tolerance))));
            report.push([0, 1, 2].map(|k| reciprocal(side[k].max(NOISE * floor[k]))));
        }
        Self { parts, measure, report }
    }

    /// The largest residual of a coordinate of a part, on the scale of the convergence test.
    pub(crate) fn measured(&self, r: &[Point]) -> f64 {
        self.relative(r, &self.measure)
    }

    /// The largest residual of a coordinate of a part relative to its right-hand side, as reported.
    pub(crate) fn reported(&self, r: &[Point]) -> f64 {
        self.relative(r, &self.report)
    }

    /// [`Self::reported`] for a residual in units of [`Self::measure`]; `sums` are the sums of its
    /// squares.
    pub(crate) fn reported_in_units(&self, r: &[Padded], sums: &[f64]) -> f64 {
        let units = self.measure.iter().zip(&self.report);
        let factors: Vec<Point> =
            units.map(|(m, r)| [0, 1, 2].map(|k| r[k] * reciprocal(m[k]))).collect();
        match self.parts.first[..] {
            [_] => (0..3).map(|k| sums[k].sqrt() * factors[0][k]).fold(0.0, larger),
            _ => self.relative(r, &factors),
        }
    }

    fn relative<const N: usize>(&self, r: &[[f64; N]], to: &[Point]) -> f64 {
        let sums = self.parts.sums(|part, i| [0, 1, 2].map(|k| (r[i][k] * to[part][k]).powi(2)));
        sums.into_iter().flatten().map(f64::sqrt).fold(0.0, larger)
    }
}

/// `1/x`; zero for zero.
pub(crate) fn reciprocal(x: f64) -> f64 {
    if x > 0.0 { 1.0 / x } else { 0.0 }
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

    /// A free part is solved about the mean determined by its masses and soft constraints; all
    /// others, and the fixed vertices, about one common mean.
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
        // Parts that cannot move as a whole have the same centre, to the last bit.
        assert!(found[0] == found[1] && found[1] == found[3]);
    }

    /// Few parts are summed by chunks of vertices, many parts by one thread.
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

    /// Each coordinate of each part has its own scale, unless coordinates are coupled.
    #[test]
    fn residuals_are_relative_to_their_own_part() {
        let (mesh, _) = three();
        let freedom = Freedom::new(&Arrangement::as_given(&mesh), &Constraints::default()).unwrap();
        let laplacian = uniform(&mesh, &freedom.fixed);
        let parts = Parts::new(&laplacian, &freedom);
        assert_eq!(parts.count(), 4);
        // Right-hand sides of 1, 10⁻⁶ and 10³ in x, half of these in y, and a hundredth in z.
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
        // Sliding vertices couple coordinates: residuals are relative to the length of the
        // right-hand side.
        let coupled = Gauge::new(&parts, &sides, &reach, 1e-8, true);
        let found = coupled.reported(&at(7, [0.0, 0.0, 3e-11]));
        assert!((found / (3e-5 / 1.2501f64.sqrt()) - 1.0).abs() < 1e-12, "{found}");
    }
}
