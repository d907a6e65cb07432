//! The inputs of the networks: candidates for the normal of a face, and numbers that describe its
//! surroundings.

use glam::DVec3;

use super::around::{FITS, Gatherer, RADII, Sums};
use super::fits::{log2, read_fit, tangents};
use super::state::{QUANTILES, RANGES, State};
use crate::faces::NO_HINGE;

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

/// The candidates for the normal of a face, and the results of its fits.
struct Candidates {
    all: [DVec3; CANDIDATES],
    of_fits: [[f64; 3]; FITS.len()],
    anchor: DVec3,
}

impl Candidates {
    #[inline(always)]
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
        // Means of normals are close to normals of the smooth surface at the centroid. Normals of
        // flat faces differ from them by a turn.
        let of_face =
            |v: DVec3, range: usize| or_present(or_present(v) + turns[FIT_OF_RANGE[range]]);
        for (k, mean) in sums.means.as_flattened().iter().enumerate() {
            all[k] = of_face(DVec3::from_slice(&mean[..3]), k % RANGES);
            all[MEANS + k] = of_face(DVec3::from_slice(&mean[3..6]), k % RANGES);
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
#[inline(always)]
fn unit_or(v: DVec3, other: DVec3) -> DVec3 {
    let unit = v.normalize_or_zero();
    if unit == DVec3::ZERO { other } else { unit }
}

/// The numbers of the fits, the turns from the smooth surface to the flat face, and the point of
/// the surface; the normals become candidates.
#[inline(always)]
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

/// The inputs at face `f`; `None` for a face without a present normal.
#[inline(always)]
pub(super) fn sample(
    gatherer: &mut Gatherer<'_>,
    wide: &[Vec<DVec3>; WIDE],
    f: usize,
) -> Option<Seen> {
    let state = gatherer.state();
    if state.normals[f] == DVec3::ZERO {
        return None;
    }
    let sums = &gatherer.sums(f);
    let beside = across_sorted(state, f);
    let Candidates { all, of_fits, anchor } = Candidates::new(state, wide, f, sums, beside);
    let sum = all.iter().fold(DVec3::ZERO, |s, &c| s + c);
    let up = unit_or(sum, state.normals[f]);
    // The candidate that sees furthest fixes the signs of the axes.
    let frame = frame(up, tensor(sums, 1), all[(RADII.len() - 1) * RANGES + RANGES - 1]);
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
    Some(Seen { sample: Sample { inputs, spread: spread as f32 }, frame, anchor, residuals })
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

/// The sum of the area over a radius.
fn area(sums: &Sums, radius: usize) -> f64 {
    sums.means[radius][RANGES - 1][6].max(f64::MIN_POSITIVE)
}

/// The sum of the products of two components of present normals over a radius.
fn tensor(sums: &Sums, radius: usize) -> [f64; 6] {
    let [xx, xy, xz, yy, yz, zz, ..] = sums.others[radius];
    [xx, xy, xz, yy, yz, zz]
}

/// The part of a tensor across `up`, as entries over two tangents.
fn across(tensor: [f64; 6], axes: [DVec3; 2]) -> [f64; 3] {
    let [xx, xy, xz, yy, yz, zz] = tensor;
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
#[inline(always)]
fn frame(up: DVec3, tensor: [f64; 6], far: DVec3) -> [DVec3; 3] {
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

/// The numbers of face `f` that are no sums over radii and no results of fits.
#[inline(always)]
fn of_face(state: &State<'_>, f: usize, sums: &Sums, spread: f64) -> [f64; 16] {
    let s = state.scales[f];
    let missing = state.hinges.of_face[f].iter().filter(|&&h| h == NO_HINGE).count();
    let noise = (state.noisy.centroids[f] - state.current.centroids[f]).length() / state.sigma;
    let moved = (sums.others[1][6] / area(sums, 1)).sqrt();
    [
        log2(state.sigma / s),
        log2(s / state.h),
        log2(state.current.areas[f] / (s * s)),
        log2(state.longest[f] / s),
        missing as f64,
        log2(spread),
        state.level.tail_ratio,
        state.level.low_ratio,
        log2(state.level.two_ring_ratio),
        state.level.correlation,
        log2(state.excess + 0.01),
        state.noisy.normals[f].dot(state.normals[f]),
        sums.others[0][7] / area(sums, 0),
        noise,
        moved / state.sigma,
        state.current.normals[f].dot(state.normals[f]),
    ]
}

/// The numbers that describe the surroundings of face `f`.
#[inline(always)]
fn scalars(
    state: &State<'_>,
    f: usize,
    sums: &Sums,
    frame: &[DVec3; 3],
    spread: f64,
    of_fits: &[[f64; 3]; FITS.len()],
    beside: [usize; 3],
) -> [f64; SCALARS] {
    let mut out = [0.0; SCALARS];
    let mut next = 0;
    let mut put = |numbers: &[f64]| {
        out[next..next + numbers.len()].copy_from_slice(numbers);
        next += numbers.len();
    };
    put(&of_face(state, f, sums, spread));
    put(&state.quantiles);
    for radius in 1..RADII.len() {
        let entries = across(tensor(sums, radius), [frame[0], frame[1]]);
        let [large, small] = eigenvalues(entries.map(|x| x / area(sums, radius)));
        let [large, small] = [large, small].map(|x| x.max(0.0).sqrt());
        put(&[log2(large + 1e-4), log2(small + 1e-4), large, small]);
    }
    for (radius, means) in sums.means.iter().enumerate() {
        means[..RANGES - 1].iter().for_each(|mean| put(&[mean[6] / area(sums, radius)]));
    }
    for (radius, means) in sums.means.iter().enumerate() {
        let mean = means[RANGES - 1][7] / area(sums, radius);
        put(&[log2(mean.abs() / state.sigma + 0.01)]);
    }
    for g in [f, beside[0], beside[1], beside[2]] {
        put(&[misfit(state, f, g)]);
    }
    put(of_fits.as_flattened());
    debug_assert_eq!(next, SCALARS);
    out
}
