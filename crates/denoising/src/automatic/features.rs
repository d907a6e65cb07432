//! The inputs of the networks: candidates for the normal of a face, and numbers that describe its
//! surroundings.

use glam::DVec3;
use pulp::NullaryFnOnce;

use super::fits::{LocalFit, log2, moments, read_fit, tangents};
use super::state::{QUANTILES, RANGES, State, similarities};
use crate::faces::{Marks, NO_HINGE};

/// The radii of neighbourhoods, in local scales.
const RADII: [f64; 3] = [1.5, 3.0, 5.0];

/// The most hinges on the way to a face of a neighbourhood. On a regular mesh the largest
/// radius is ten hinges wide; the rest is for stretched faces. Noise of several mean
/// edge lengths makes areas, and with them radii, so large that a ball alone would hold
/// thousands of faces.
const DEPTH: usize = 15;

/// The radius and the range of each local fit.
const FITS: [(usize, usize); 5] = [(1, 1), (2, 1), (2, 0), (1, 3), (2, 3)];

/// The widest fit for each range of differences between normals.
const FIT_OF_RANGE: [usize; RANGES] = [2, 1, 1, 4];

/// The fits whose residuals are compared over the mesh.
const SEEN_FITS: [usize; 2] = [0, 3];

const MEANS: usize = RADII.len() * RANGES;

/// The range of each mean over a wide region.
pub(super) const WIDE_RANGES: [usize; WIDE] = [0, 1, 0, 1, 0, 1];

/// The number of means over wide regions.
pub(super) const WIDE: usize = 6;

/// Means of noisy and of present normals, planes and quadrics, wide means, and six single
/// normals.
pub const CANDIDATES: usize = 2 * MEANS + 2 * FITS.len() + WIDE + 6;

const SCALARS: usize = 28 + QUANTILES + 4 * RADII.len() + 3 * FITS.len();

/// Three components of each candidate, and numbers.
pub const INPUTS: usize = 3 * CANDIDATES + SCALARS;

/// The least spread of candidates: 10⁻⁴ radians.
const MIN_SPREAD: f64 = 1e-4;

/// The inputs of the network at one face.
#[derive(Debug, Clone)]
pub struct Sample {
    /// Three components of each candidate in the frame of the face, then the scalars.
    pub inputs: [f32; INPUTS],
    /// The root mean square tangential part of the candidates.
    pub spread: f32,
}

impl Sample {
    /// A candidate in the frame of the face.
    #[inline]
    pub fn candidate(&self, k: usize) -> [f32; 3] {
        let c = &self.inputs[3 * k..3 * k + 3];
        [c[0] * self.spread, c[1] * self.spread, c[2]]
    }
}

/// A sample, its frame, and the local fit at its face.
pub struct Seen {
    /// The inputs of the network.
    pub sample: Sample,
    /// The axes of the sample.
    pub frame: [DVec3; 3],
    /// The point of the surface at the face.
    pub(super) anchor: DVec3,
    /// log₂ of the residuals of two fits over σ: that of similar normals and that of all.
    pub(super) residuals: [f64; 2],
}

/// Sums over the neighbourhood of a face.
struct Sums {
    /// Weighted sums of noisy area vectors, of present normals times areas, and
    /// of areas.
    means: [[f64; 8]; MEANS],
    tensors: [[f64; 6]; 2],
    fits: [LocalFit; FITS.len()],
    /// Weight, and agreement of noisy with present normals.
    near: [f64; 2],
    /// Squared displacements.
    displacement: f64,
    /// Signed displacements along normals, over each radius.
    offsets: [f64; RADII.len()],
}

impl Sums {
    fn weight(&self, radius: usize, range: usize) -> f64 {
        self.means[radius * RANGES + range][6]
    }

    fn noisy(&self, k: usize) -> DVec3 {
        DVec3::new(self.means[k][0], self.means[k][1], self.means[k][2])
    }

    fn present(&self, k: usize) -> DVec3 {
        DVec3::new(self.means[k][3], self.means[k][4], self.means[k][5])
    }
}

/// Finds the faces around one, and sums over them.
pub(super) struct Gatherer<'a> {
    state: &'a State<'a>,
    wide: &'a [Vec<DVec3>; WIDE],
    marks: Marks,
    queue: Vec<u32>,
}

impl<'a> Gatherer<'a> {
    pub(super) fn new(state: &'a State<'a>, wide: &'a [Vec<DVec3>; WIDE]) -> Self {
        Self { state, wide, marks: Marks::new(state.normals.len()), queue: vec![] }
    }

    /// The inputs at face `f`; `None` for a face without a present normal.
    pub(super) fn sample(&mut self, f: usize) -> Option<Seen> {
        if self.state.normals[f] == DVec3::ZERO {
            return None;
        }
        self.gather(f);
        let sums = pulp::Arch::new().dispatch(Summing { gatherer: self, face: f });
        Some(sample(self.state, self.wide, f, &sums))
    }

    /// The faces around `f` up to the largest radius and at most [`DEPTH`] hinges away, itself
    /// first. The set does not depend on the numbering of the faces.
    fn gather(&mut self, f: usize) {
        let state = self.state;
        self.marks.clear();
        self.queue.clear();
        self.marks.insert(f as u32);
        self.queue.push(f as u32);
        let centre = state.current.centroids[f];
        let reach = RADII[RADII.len() - 1] * state.scales[f];
        let mut begin = 0;
        for _ in 0..DEPTH {
            let end = self.queue.len();
            for i in begin..end {
                for k in state.hinges.across(self.queue[i] as usize) {
                    if self.marks.contains(k as u32) {
                        continue;
                    }
                    if state.current.centroids[k].distance(centre) < reach {
                        self.marks.insert(k as u32);
                        self.queue.push(k as u32);
                    }
                }
            }
            begin = end;
        }
    }

    #[inline(always)]
    fn sums(&self, f: usize) -> Sums {
        let state = self.state;
        let mut sums = Sums {
            means: [[0.0; 8]; MEANS],
            tensors: [[0.0; 6]; 2],
            fits: [LocalFit::EMPTY; FITS.len()],
            near: [0.0; 2],
            displacement: 0.0,
            offsets: [0.0; RADII.len()],
        };
        let n = state.normals[f];
        let axes = tangents(n);
        let centre = state.current.centroids[f];
        let inverse = 1.0 / state.scales[f];
        let ranges = state.factors();
        let squares = RADII.map(|r| 1.0 / (r * r));
        for &g in &self.queue {
            let g = g as usize;
            let offset = inverse * (state.current.centroids[g] - centre);
            let d = offset.dot(offset);
            let m = state.normals[g];
            let apart = m - n;
            let range = similarities(apart.dot(apart), ranges);
            let area = state.current.areas[g];
            let [a, b, c] =
                (state.noisy.areas[g] * state.trust[g] * state.noisy.normals[g]).to_array();
            let terms = [a, b, c, m.x * area, m.y * area, m.z * area, area, 0.0];
            let near = squares.map(|s| {
                let t = (1.0 - d * s).max(0.0);
                t * t
            });
            for (means, near) in sums.means.chunks_exact_mut(RANGES).zip(near) {
                if near > 0.0 {
                    for (mean, r) in means.iter_mut().zip(range) {
                        let w = near * r;
                        mean.iter_mut().zip(terms).for_each(|(x, t)| *x += w * t);
                    }
                }
            }
            for (tensor, w) in sums.tensors.iter_mut().zip(&near[1..]) {
                let w = w * area;
                let products = [m.x * m.x, m.x * m.y, m.x * m.z, m.y * m.y, m.y * m.z, m.z * m.z];
                tensor.iter_mut().zip(products).for_each(|(t, p)| *t += w * p);
            }
            let offset = inverse * (state.noisy.centroids[g] - centre);
            let point = moments([offset.dot(axes[0]), offset.dot(axes[1]), offset.dot(n)]);
            for (fit, (a, q)) in sums.fits.iter_mut().zip(FITS) {
                let w = near[a] * range[q] * state.trust[g];
                if w > 0.0 {
                    fit.add(&point, w);
                }
            }
            let w = near[0] * area;
            sums.near[0] += w;
            sums.near[1] += w * m.dot(state.noisy.normals[g]);
            let moved = state.noisy.centroids[g] - state.current.centroids[g];
            sums.displacement += near[1] * area * moved.dot(moved);
            let along = area * moved.dot(m);
            sums.offsets.iter_mut().zip(near).for_each(|(sum, w)| *sum += w * along);
        }
        sums
    }
}

/// The sums around a face, with the widest vectors of the processor. Multiplications and additions
/// are not fused, and no sum is reordered: the bits are the same on all of them.
struct Summing<'a> {
    gatherer: &'a Gatherer<'a>,
    face: usize,
}

impl NullaryFnOnce for Summing<'_> {
    type Output = Sums;

    #[inline(always)]
    fn call(self) -> Sums {
        self.gatherer.sums(self.face)
    }
}

/// The candidates for the normal of a face, and the results of its fits.
struct Candidates {
    all: [DVec3; CANDIDATES],
    of_fits: [[f64; 3]; FITS.len()],
    anchor: DVec3,
}

impl Candidates {
    fn new(
        state: &State<'_>,
        wide: &[Vec<DVec3>; WIDE],
        f: usize,
        sums: &Sums,
        beside: [usize; 3],
    ) -> Self {
        let n = state.normals[f];
        let mut all = [n; CANDIDATES];
        let or_present = |v: DVec3| unit_or(v, n);
        let (of_fits, turns, anchor) = read_fits(state, f, sums, &mut all);
        // Means of normals are close to normals of the smooth surface at the centroid. Those of
        // flat faces differ from them by a turn.
        let of_face =
            |v: DVec3, range: usize| or_present(or_present(v) + turns[FIT_OF_RANGE[range]]);
        for k in 0..MEANS {
            all[k] = of_face(sums.noisy(k), k % RANGES);
            all[MEANS + k] = of_face(sums.present(k), k % RANGES);
        }
        let single = 2 * MEANS + 2 * FITS.len();
        all[single] = or_present(state.noisy.normals[f]);
        all[single + 1] = or_present(state.current.normals[f]);
        for (k, normals) in wide.iter().enumerate() {
            all[CANDIDATES - WIDE + k] = of_face(normals[f], WIDE_RANGES[k]);
        }
        for (k, &g) in beside.iter().enumerate() {
            all[single + 3 + k] = state.normals[g];
        }
        Self { all, of_fits, anchor }
    }
}

/// The unit vector along `v`, or `other` where it has no length.
fn unit_or(v: DVec3, other: DVec3) -> DVec3 {
    let unit = v.normalize_or_zero();
    if unit == DVec3::ZERO { other } else { unit }
}

/// The numbers of the fits, the turns from the smooth surface to the flat face, and the point of
/// the surface; the normals become candidates.
fn read_fits(
    state: &State<'_>,
    f: usize,
    sums: &Sums,
    all: &mut [DVec3; CANDIDATES],
) -> ([[f64; 3]; FITS.len()], [DVec3; FITS.len()], DVec3) {
    let n = state.normals[f];
    let axes = tangents(n);
    let s = state.scales[f];
    let centre = state.current.centroids[f];
    let corners = state.surface.triangle(f).map(|p| {
        let offset = (DVec3::from(p) - centre) * (1.0 / s);
        axes.map(|e| offset.dot(e))
    });
    let mut of_fits = [[0.0; 3]; FITS.len()];
    let mut turns = [DVec3::ZERO; FITS.len()];
    let mut anchor = centre;
    for (k, fit) in sums.fits.iter().enumerate() {
        let found = read_fit(fit, n, axes, corners, state.sigma / s);
        all[2 * MEANS + 2 * k] = unit_or(found.normals[0], n);
        all[2 * MEANS + 2 * k + 1] = unit_or(found.normals[1] + found.turn, n);
        of_fits[k] = found.numbers;
        turns[k] = found.turn;
        if k == 0 {
            anchor = centre + found.height.clamp(-3.0, 3.0) * s * n;
        }
    }
    (of_fits, turns, anchor)
}

fn sample(state: &State<'_>, wide: &[Vec<DVec3>; WIDE], f: usize, sums: &Sums) -> Seen {
    let beside = across_sorted(state, f);
    let Candidates { all, of_fits, anchor } = Candidates::new(state, wide, f, sums, beside);
    let sum = all.iter().fold(DVec3::ZERO, |s, &c| s + c);
    let up = unit_or(sum, state.normals[f]);
    // The candidate that sees furthest fixes the signs of the axes.
    let frame = frame(up, &sums.tensors[0], all[(RADII.len() - 1) * RANGES + RANGES - 1]);
    let mut local = [[0.0; 3]; CANDIDATES];
    let mut squares = 0.0;
    for (l, &c) in local.iter_mut().zip(&all) {
        *l = frame.map(|e| c.dot(e));
        squares += l[0] * l[0] + l[1] * l[1];
    }
    let spread = (squares / CANDIDATES as f64 + MIN_SPREAD * MIN_SPREAD).sqrt();
    let mut inputs = [0.0f32; INPUTS];
    for (slot, l) in inputs.chunks_exact_mut(3).zip(&local) {
        slot[0] = (l[0] / spread) as f32;
        slot[1] = (l[1] / spread) as f32;
        slot[2] = l[2] as f32;
    }
    let scalars = scalars(state, f, sums, &frame, spread, &of_fits, beside);
    for (slot, x) in inputs[3 * CANDIDATES..].iter_mut().zip(scalars) {
        *slot = x as f32;
    }
    let residuals = SEEN_FITS.map(|k| of_fits[k][0]);
    Seen { sample: Sample { inputs, spread: spread as f32 }, frame, anchor, residuals }
}

/// The faces across the hinges of a face, that with the closest normal first;
/// the face itself where there is no hinge.
fn across_sorted(state: &State<'_>, f: usize) -> [usize; 3] {
    let n = state.normals[f];
    let mut found = state.hinges.beside[f].map(|g| match state.normals.get(g as usize) {
        Some(normal) if *normal != DVec3::ZERO => g as usize,
        _ => f,
    });
    found.sort_by(|&a, &b| state.normals[b].dot(n).total_cmp(&state.normals[a].dot(n)));
    found
}

/// log₂ of the distance of the noisy corners of face `f` from the tangent plane
/// at face `g`, root mean square, in noise levels.
fn misfit(state: &State<'_>, f: usize, g: usize) -> f64 {
    let (n, anchor) = (state.normals[g], state.anchors[g]);
    let squares = state.mesh().triangle(f).map(|p| n.dot(DVec3::from(p) - anchor).powi(2));
    let mean = (squares[0] + squares[1] + squares[2]) / 3.0;
    log2(mean.sqrt() / state.sigma + 0.1)
}

/// The part of a tensor across `up`, as entries over two tangents.
fn across(tensor: &[f64; 6], axes: [DVec3; 2]) -> [f64; 3] {
    let [xx, xy, xz, yy, yz, zz] = *tensor;
    let rows = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]].map(DVec3::from);
    let times = |a: DVec3| DVec3::from(rows.map(|r| r.dot(a)));
    let [a, b] = axes;
    [a.dot(times(a)), a.dot(times(b)), b.dot(times(b))]
}

/// The eigenvalues of `[[a, b], [b, c]]`, the larger first.
fn eigenvalues([a, b, c]: [f64; 3]) -> [f64; 2] {
    let (mean, root) = (0.5 * (a + c), (0.25 * (a - c).powi(2) + b * b).sqrt());
    [mean + root, (mean - root).max(0.0)]
}

/// Axes that turn with the mesh: the directions in which normals vary most and
/// least, and `up`. `far` has no negative component along the first two.
fn frame(up: DVec3, tensor: &[f64; 6], far: DVec3) -> [DVec3; 3] {
    let axes = tangents(up);
    let [a, b, c] = across(tensor, axes);
    let [largest, _] = eigenvalues([a, b, c]);
    // Both are eigenvectors; the longer one is exact.
    let (p, q) = ([b, largest - a], [largest - c, b]);
    let square = |v: [f64; 2]| v[0] * v[0] + v[1] * v[1];
    let v = if square(p) > square(q) { p } else { q };
    let first = (v[0] * axes[0] + v[1] * axes[1]).normalize_or_zero();
    let first = if first == DVec3::ZERO { axes[0] } else { first };
    let second = up.cross(first);
    let facing = |e: DVec3| if e.dot(far) < 0.0 { -e } else { e };
    [facing(first), facing(second), up]
}

fn scalars(
    state: &State<'_>,
    f: usize,
    sums: &Sums,
    frame: &[DVec3; 3],
    spread: f64,
    of_fits: &[[f64; 3]; FITS.len()],
    beside: [usize; 3],
) -> [f64; SCALARS] {
    let s = state.scales[f];
    let area = state.current.areas[f];
    let mut out = [0.0; SCALARS];
    let missing = state.hinges.of_face[f].iter().filter(|&&h| h == NO_HINGE).count();
    let noise = (state.noisy.centroids[f] - state.current.centroids[f]).length() / state.sigma;
    let moved = (sums.displacement / sums.weight(1, RANGES - 1).max(f64::MIN_POSITIVE)).sqrt();
    let fixed = [
        log2(state.sigma / s),
        log2(s / state.h),
        log2(area / (s * s)),
        log2(state.longest[f] / s),
        missing as f64,
        log2(spread),
        state.level.tail_ratio,
        state.level.low_ratio,
        log2(state.level.two_ring_ratio),
        state.level.correlation,
        log2(state.excess + 0.01),
        state.noisy.normals[f].dot(state.normals[f]),
        sums.near[1] / sums.near[0].max(f64::MIN_POSITIVE),
        noise,
        moved / state.sigma,
        state.current.normals[f].dot(state.normals[f]),
    ];
    out[..fixed.len()].copy_from_slice(&fixed);
    let mut next = fixed.len();
    out[next..next + QUANTILES].copy_from_slice(&state.quantiles);
    next += QUANTILES;
    for (a, tensor) in sums.tensors.iter().enumerate() {
        let total = sums.weight(a + 1, RANGES - 1).max(f64::MIN_POSITIVE);
        let entries = across(tensor, [frame[0], frame[1]]).map(|x| x / total);
        let [large, small] = eigenvalues(entries).map(|x| x.max(0.0).sqrt());
        for x in [log2(large + 1e-4), log2(small + 1e-4), large, small] {
            out[next] = x;
            next += 1;
        }
    }
    for a in 0..RADII.len() {
        let all = sums.weight(a, RANGES - 1).max(f64::MIN_POSITIVE);
        for q in 0..RANGES - 1 {
            out[next] = sums.weight(a, q) / all;
            next += 1;
        }
    }
    for (a, sum) in sums.offsets.iter().enumerate() {
        let mean = sum / sums.weight(a, RANGES - 1).max(f64::MIN_POSITIVE);
        out[next] = log2(mean.abs() / state.sigma + 0.01);
        next += 1;
    }
    for g in [f, beside[0], beside[1], beside[2]] {
        out[next] = misfit(state, f, g);
        next += 1;
    }
    for numbers in of_fits {
        out[next..next + 3].copy_from_slice(numbers);
        next += 3;
    }
    debug_assert_eq!(next, SCALARS);
    out
}
