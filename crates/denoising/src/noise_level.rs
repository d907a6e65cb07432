//! The noise level of a mesh, estimated without a ground truth.

use fairing_mesh::TriMesh;
use fairing_watch::parallel;
use glam::DVec3;
use rayon::prelude::*;

use super::masked::Masked;
use super::noise_scale::{GAUSSIAN_MEDIAN, Growth, quadric_residual, residual};
use fairing_operators::tangent_frame;
use fairing_sparse::median;

/// The least tail ratio of impulsive noise: Gaussian
/// residuals give 1 by construction, and 1.15 is beyond what curvature and
/// creases do to it on clean shapes.
const IMPULSIVE_TAIL: f64 = 1.15;

/// The 90th percentile of |x| over its median, for Gaussian x.
const GAUSSIAN_TAIL: f64 = 2.4387;

/// The 10th percentile of |x| over its median, for Gaussian x.
const GAUSSIAN_LOW: f64 = 0.186_31;

/// The bound on residuals in correlations, in standard deviations.
const CLIP: f64 = 3.0;

/// The fits of a vertex: a quadric to its two-ring, a quadric to the [`NEAREST`] of it, and a
/// paraboloid of revolution to its one-ring.
const FITS: usize = 3;

/// The number of nearest points in the second fit. Fewer points see less of the surface, and fits
/// to them stray more.
const NEAREST: usize = 10;

/// The relative difference below which squared distances are equal, so that rounding does not
/// decide between two points.
const DISTANCE_ROUNDING: f64 = 1e-9;

/// A fit counts if it has residuals at this fraction of the vertices that have a quadric fitted to
/// their two-ring.
const ENOUGH: f64 = 0.5;

/// A fit counts if its level exceeds this fraction of the level over two-rings. Below, most
/// vertices lie on the fit exactly: on planes with few impulses most one-rings contain no impulse,
/// but every two-ring contains one.
const EXACT: f64 = 1e-3;

/// Result of [`noise_level`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct NoiseEstimate {
    /// The standard deviation of the displacement of a vertex along the
    /// normal, in mesh units.
    pub sigma: f64,
    /// The ratio of the 90th percentile to the median of the residuals'
    /// absolute values, over that of a Gaussian: 1 for Gaussian noise, more
    /// where some of the vertices are moved further than the rest.
    pub tail_ratio: f64,
    /// The ratio of the 10th percentile to the median of the residuals' absolute
    /// values, over that of a Gaussian: less than 1 where the level varies over the surface, or
    /// where details that a quadric misses look like noise.
    pub low_ratio: f64,
    /// The correlation of residuals across edges, from −1 to 1; residuals beyond three σ̂ count as
    /// three. Independent noise gives about −0.27, since each residual is in the fits of its
    /// neighbours. Noise that is correlated over two edges gives about 0.05 more. Zero where
    /// `sigma` is.
    pub correlation: f64,
    /// The level that the fits to two-rings find, over `sigma`: at least 1, exactly 1 if `sigma` is
    /// zero, and close to 1 if the surface is smooth over two rings and the noise is independent.
    /// The ratio is larger if creases and details are as dense as two-rings, or if the noise is
    /// correlated.
    pub two_ring_ratio: f64,
    /// The distance over which noise is correlated, in mean edge lengths: 0 for none, 4 or 8.
    ///
    /// The level is measured again by comparing each vertex with a quadric through the vertices s
    /// and 2 s edges away, for s = 1, 2, 4 and 8. Independent noise has the level `sigma` at all s,
    /// and a smooth or detailed surface about twice the level at twice the distance, or more. Noise
    /// of depth cameras is in between. The growth from each scale to the next, `tail_ratio`,
    /// `low_ratio` and `correlation` decide, by a polynomial of second degree whose coefficients a
    /// logistic regression has chosen on generated scans; the level at s = 4 must exceed a tenth of
    /// the mean edge length. The length is 8 if the level grows by 1.2 to 2 from s = 4 to 8, else
    /// 4. Smooth noise without a rough part looks like shape and is not found. Correlation is not
    ///   tested on closed parts, which no camera sees at once, on faces stretched to three times
    ///   their height, and on fewer than a few hundred vertices.
    pub correlation_length: f64,
    /// The level at the scale of `correlation_length`, in mesh units; `sigma` without correlation.
    /// Differences between the surface and a quadric of that size count as noise.
    pub wide_sigma: f64,
    /// The number of vertices that the estimate is made from.
    pub samples: usize,
}

impl NoiseEstimate {
    /// Returns `true` if the tails are those of impulsive noise: a tail ratio above 1.15.
    pub fn is_impulsive(&self) -> bool {
        self.tail_ratio > IMPULSIVE_TAIL
    }
}

/// Connected parts of a mesh with noise of about the same level.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct NoisyParts {
    /// The noise of all of them together.
    pub level: NoiseEstimate,
    /// The numbers of the parts, as [`Topology::components`] counts them,
    /// ascending.
    ///
    /// [`Topology::components`]: fairing_mesh::Topology::components
    pub components: Vec<u32>,
}

/// Estimates the standard deviation of the noise along the normal, and whether
/// its tails are heavy, where there is most of it: that of the first of the
/// [`noisy_parts`].
///
/// A surface is fitted to the neighbours of each vertex without the vertex, as
/// a height field over the plane of the two-ring's area vector. With the leverage
/// ℓ, the variance of the fit at the vertex over σ², the vertex's own residual
/// r has the variance σ² (1 + ℓ) where the surface is as the fit on that scale, so
///
/// ```text
/// σ̂ = 1.4826 · median |r| / √(1 + ℓ)
/// ```
///
/// This is done with three fits, and the least of the three is the result, since what a fit misses
/// can only add to the noise: a quadric to the two-ring, a quadric to the ten vertices of it that
/// are nearest (more where several are as far as the tenth), and a + bx + cy + d(x² + y²) to the
/// one-ring. Fits to nearer points include fewer creases and details, above all on stretched
/// triangles. A level below a thousandth of that over two-rings does not count: most vertices lie
/// on that fit exactly, and the noise is elsewhere. The other numbers of a [`NoiseEstimate`] are of
/// the residuals over two-rings.
///
/// The median is hardly changed by the vertices near creases. On Gaussian noise σ̂ is a
/// few percent high; on a clean mesh it is what the fits miss, not zero.
/// A connected part that is clean does not lower the level of another one.
/// Scales with the mesh. `None` if no vertex has a two-ring that determines a
/// quadric (at least eight neighbours in general position). Linear cost.
pub fn noise_level(mesh: &TriMesh) -> Option<NoiseEstimate> {
    noisy_parts(mesh).first().map(|parts| parts.level)
}

/// The levels of a part within this factor of each other count as the same:
/// estimates from a few dozen vertices differ by as much as two.
const LEVEL_RATIO: f64 = 4.0;

/// The connected parts of a mesh, grouped by similar noise, those with the most noise first.
///
/// The part with the largest `n σ̂²`, n the number of its vertices, is taken with all parts whose
/// level is at least a quarter and at most four times its own, and so on with the remaining parts.
/// Parts that are too small for an estimate are in the first group; empty if all are. Fixed
/// vertices ([`Masked`]) take part in the fits, but do not count.
pub fn noisy_parts<'a>(mesh: impl Into<Masked<'a>>) -> Vec<NoisyParts> {
    let input = mesh.into();
    let oriented = input.mesh().oriented();
    let mesh = &*oriented;
    let residuals = residuals(input.on(mesh));
    let components = mesh.topology().components();
    let mut of_part = vec![Sizes::default(); components.count()];
    for (v, residuals) in residuals.iter().enumerate() {
        if let Some(part) = components.label(v as u32) {
            for (sizes, residual) in of_part[part as usize].iter_mut().zip(residuals) {
                sizes.extend(residual.map(|r| r.abs()));
            }
        }
    }
    let mut unmeasured = vec![];
    let mut left: Vec<(u32, Sizes, NoiseEstimate)> = vec![];
    for (part, mut sizes) in of_part.into_iter().enumerate() {
        match level_of(&mut sizes) {
            Some(level) => left.push((part as u32, sizes, level)),
            None => unmeasured.push(part as u32),
        }
    }
    let mut groups: Vec<NoisyParts> = vec![];
    while let Some(first) = most_noise(&left) {
        let sigma = left[first].2.sigma;
        let alike = |level: &NoiseEstimate| {
            level.sigma * LEVEL_RATIO >= sigma && level.sigma <= LEVEL_RATIO * sigma
        };
        let (group, rest): (Vec<_>, Vec<_>) = left.into_iter().partition(|(.., l)| alike(l));
        left = rest;
        let mut components: Vec<u32> = group.iter().map(|(part, ..)| *part).collect();
        components.append(&mut unmeasured);
        components.sort_unstable();
        let mut sizes = Sizes::default();
        for (_, part, _) in group {
            sizes.iter_mut().zip(part).for_each(|(all, part)| all.extend(part));
        }
        groups.extend(level_of(&mut sizes).map(|level| NoisyParts { level, components }));
    }
    for group in &mut groups {
        let inside = |v: u32| {
            let part = components.label(v).filter(|_| !input.is_fixed(v as usize));
            part.is_some_and(|part| group.components.binary_search(&part).is_ok())
        };
        let sigma = group.level.sigma * group.level.two_ring_ratio;
        if sigma > 0.0 {
            group.level.correlation = correlation(mesh, &residuals, sigma, inside);
            find_waves(mesh, &mut group.level, inside);
        }
    }
    groups
}

/// Sets the length and the level of correlated noise. On closed surfaces it is not looked for.
fn find_waves(mesh: &TriMesh, level: &mut NoiseEstimate, inside: impl Fn(u32) -> bool + Sync) {
    let on_border = mesh.topology().boundary_vertices();
    if !(0..mesh.vertex_count()).any(|v| on_border[v] && inside(v as u32)) {
        return;
    }
    let shape = [level.tail_ratio, level.low_ratio, level.correlation];
    let growth = Growth::new(mesh, level.sigma, shape, inside);
    if let Some(growth) = growth.filter(Growth::is_correlated) {
        (level.correlation_length, level.wide_sigma) = growth.length_and_level();
    }
}

/// The absolute values of the residuals of each fit.
type Sizes = [Vec<f64>; FITS];

/// The correlation across edges of the residuals over two-rings of the vertices that are `inside`;
/// zero if there is none.
fn correlation(
    mesh: &TriMesh,
    residuals: &[[Option<f64>; FITS]],
    sigma: f64,
    inside: impl Fn(u32) -> bool,
) -> f64 {
    let clipped: Vec<Option<f64>> = (0u32..)
        .zip(residuals)
        .map(|(v, r)| r[0].filter(|_| inside(v)).map(|r| (r / sigma).clamp(-CLIP, CLIP)))
        .collect();
    let (mut products, mut squares) = (0.0, 0.0);
    for &[a, b, c] in mesh.faces() {
        for (v, w) in [(a, b), (b, c), (c, a)] {
            if let (Some(x), Some(y)) = (clipped[v as usize], clipped[w as usize]) {
                products += x * y;
                squares += 0.5 * (x * x + y * y);
            }
        }
    }
    if squares > 0.0 { products / squares } else { 0.0 }
}

/// Sums of the residuals over two-rings at each vertex, over the level of the noise and clipped.
pub(crate) struct LocalResiduals {
    /// The mean squares of the residuals at both ends of each edge.
    pub(crate) squares: Vec<f64>,
    /// The products of the residuals at both ends.
    pub(crate) products: Vec<f64>,
    /// The numbers of edges.
    pub(crate) counts: Vec<f64>,
}

impl LocalResiduals {
    /// The residuals at the vertices that may move, zeros elsewhere.
    pub(crate) fn new(input: Masked<'_>, level: &NoiseEstimate) -> Self {
        let mesh = input.mesh();
        let sigma = (level.sigma * level.two_ring_ratio).max(f64::MIN_POSITIVE);
        let of_fits = residuals(input);
        let residuals: Vec<Option<f64>> =
            of_fits.into_iter().map(|[two_ring, ..]| two_ring.map(|r| r / sigma)).collect();
        let terms: Vec<[f64; 3]> = parallel::map(mesh.vertex_count(), 64, |v| {
            let v = v as u32;
            let Some(own) = residuals[v as usize] else { return [0.0; 3] };
            let own = own.clamp(-CLIP, CLIP);
            let mut sums = [0.0; 3];
            for w in mesh.topology().neighbors(v) {
                if let Some(other) = residuals[*w as usize] {
                    let other = other.clamp(-CLIP, CLIP);
                    sums[0] += 0.5 * (own * own + other * other);
                    sums[1] += own * other;
                    sums[2] += 1.0;
                }
            }
            sums
        });
        let column = |k: usize| terms.iter().map(|term| term[k]).collect();
        Self { squares: column(0), products: column(1), counts: column(2) }
    }
}

/// The part with the largest `n σ̂²`; the first of equal ones.
fn most_noise(parts: &[(u32, Sizes, NoiseEstimate)]) -> Option<usize> {
    let amount = |i: usize| (parts[i].2.samples as f64).sqrt() * parts[i].2.sigma;
    (0..parts.len()).reduce(|best, i| if amount(i) > amount(best) { i } else { best })
}

/// The level of the residuals, which it sorts.
fn level_of(sizes: &mut Sizes) -> Option<NoiseEstimate> {
    sizes.iter_mut().for_each(|sizes| sizes.sort_unstable_by(f64::total_cmp));
    let [two_ring, ..] = &*sizes;
    let (median, low, high) =
        (median(two_ring)?, two_ring[two_ring.len() / 10], two_ring[two_ring.len() * 9 / 10]);
    let over_gaussian =
        |size: f64, gaussian: f64| if median > 0.0 { size / median / gaussian } else { 1.0 };
    let enough = ENOUGH * two_ring.len() as f64;
    let counted = sizes.iter().filter(|sizes| sizes.len() as f64 >= enough);
    let levels = counted.filter_map(|sizes| fairing_sparse::median(sizes));
    let least = levels.filter(|&level| level > EXACT * median).fold(median, f64::min);
    Some(NoiseEstimate {
        sigma: least / GAUSSIAN_MEDIAN,
        tail_ratio: over_gaussian(high, GAUSSIAN_TAIL),
        low_ratio: over_gaussian(low, GAUSSIAN_LOW),
        correlation: 0.0,
        two_ring_ratio: if least > 0.0 { median / least } else { 1.0 },
        correlation_length: 0.0,
        wide_sigma: least / GAUSSIAN_MEDIAN,
        samples: two_ring.len(),
    })
}

/// Faces of a neighbour that a fit takes, spread over them where there are more:
/// each of n neighbours of a vertex would have all the others.
const HUB: usize = 256;

/// Buffers for the fits of one vertex, reused for the next.
#[derive(Default)]
struct Scratch {
    one_ring: Vec<u32>,
    ring: Vec<u32>,
    points: Vec<[f64; 3]>,
    squares: Vec<f64>,
}

/// The residuals of each vertex that may move, as [`leave_one_out`]; `None` at the others.
fn residuals(input: Masked<'_>) -> Vec<[Option<f64>; FITS]> {
    let mesh = input.mesh();
    let at = |scratch: &mut Scratch, v: u32| {
        if input.is_fixed(v as usize) {
            return [None; FITS];
        }
        leave_one_out(mesh, v, scratch)
    };
    (0..mesh.vertex_count() as u32).into_par_iter().map_init(Scratch::default, at).collect()
}

/// The residuals of vertex `v` from the fits to its neighbours, each standardised
/// to the variance of the noise.
fn leave_one_out(mesh: &TriMesh, v: u32, scratch: &mut Scratch) -> [Option<f64>; FITS] {
    two_ring_residuals(mesh, v, scratch).unwrap_or_default()
}

/// `None` where the two-ring determines no quadric.
fn two_ring_residuals(
    mesh: &TriMesh,
    v: u32,
    Scratch { one_ring, ring, points, squares }: &mut Scratch,
) -> Option<[Option<f64>; FITS]> {
    let (incidence, faces) = (mesh.incidence(), mesh.faces());
    one_ring.clear();
    for &c in incidence.corners(v) {
        one_ring.extend_from_slice(&faces[c as usize / 3]);
    }
    one_ring.sort_unstable();
    one_ring.dedup();
    ring.clear();
    let mut area = DVec3::ZERO;
    for &w in &*one_ring {
        let corners = incidence.corners(w);
        let stride = if w == v { 1 } else { 1 + corners.len().saturating_sub(1) / HUB };
        for &c in corners.iter().step_by(stride) {
            area += DVec3::from(mesh.area_vector(c as usize / 3));
            ring.extend_from_slice(&faces[c as usize / 3]);
        }
    }
    ring.sort_unstable();
    ring.dedup();
    if ring.len() < 9 {
        return None;
    }
    let at = |w: u32| DVec3::from(mesh.positions()[w as usize]);
    let offset = |w: &u32| at(*w) - at(v);
    let radius = ring.iter().map(|w| offset(w).length()).fold(0.0, f64::max);
    let normal = area.try_normalize()?;
    let [e1, e2] = tangent_frame(normal);
    if radius.is_nan() || radius <= 0.0 {
        return None;
    }
    let flat = |w: &u32| {
        let d = offset(w) * (1.0 / radius);
        [d.dot(e1), d.dot(e2), d.dot(normal)]
    };
    points.clear();
    points.extend(ring.iter().filter(|&&w| w != v).map(flat));
    let two_ring = quadric_residual(points)?;
    if points.len() > NEAREST {
        let square = |p: &[f64; 3]| DVec3::from(*p).length_squared();
        squares.clear();
        squares.extend(points.iter().map(square));
        let (_, tenth, _) = squares.select_nth_unstable_by(NEAREST - 1, f64::total_cmp);
        let far = *tenth * (1.0 + DISTANCE_ROUNDING);
        points.retain(|p| square(p) <= far);
    }
    let nearest = quadric_residual(points);
    points.clear();
    points.extend(one_ring.iter().filter(|&&w| w != v).map(flat));
    let residual = |r: f64| Some(r * radius).filter(|r| r.is_finite());
    Some([
        residual(two_ring),
        nearest.and_then(residual),
        round_residual(points).and_then(residual),
    ])
}

/// The standardised residual at the origin from a + bx + cy + d(x² + y²) through the points, five
/// at least.
fn round_residual(points: &[[f64; 3]]) -> Option<f64> {
    if points.len() < 5 {
        return None;
    }
    residual(points, |[x, y]| [1.0, x, y, x * x + y * y])
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    /// A bumpy grid of 60 × 60 squares, each vertex raised by `noise`.
    fn grid(mut noise: impl FnMut() -> f64) -> TriMesh {
        let n = 60u32;
        let positions = (0..n * n)
            .map(|i| {
                let (x, y) = ((i % n) as f64, (i / n) as f64);
                [x, y, 3.0 * (0.1 * x).sin() * (0.07 * y).cos() + noise()]
            })
            .collect();
        let mut faces = vec![];
        for (i, j) in (0..n - 1).flat_map(|j| (0..n - 1).map(move |i| (i, j))) {
            let a = j * n + i;
            faces.extend([[a, a + 1, a + n + 1], [a, a + n + 1, a + n]]);
        }
        TriMesh::new(positions, faces).unwrap()
    }

    /// Twelve uniform numbers sum to a variance of one.
    fn gaussian(rng: &mut ChaCha8Rng) -> f64 {
        (0..12).map(|_| rng.random::<f64>()).sum::<f64>() - 6.0
    }

    /// The median of 3600 residuals has a standard error of 2 %; the fit's
    /// neighbours are correlated, and the bias is known to reach 8 %.
    #[test]
    fn gaussian_noise_is_measured() {
        for sigma in [0.03, 0.1, 0.3] {
            let mut rng = ChaCha8Rng::seed_from_u64(7);
            let level = noise_level(&grid(|| sigma * gaussian(&mut rng))).unwrap();
            assert!((0.94..1.1).contains(&(level.sigma / sigma)), "{sigma}: {level:?}");
            assert!(!level.is_impulsive(), "{level:?}");
        }
    }

    /// A pleated grid with a crease at every third row: two-rings always meet one, one-rings on the
    /// planes between do not.
    #[test]
    fn creases_within_two_rings_are_not_noise() {
        let mut rng = ChaCha8Rng::seed_from_u64(9);
        let mut k = 0;
        let pleated = grid(|| {
            let (x, y) = (f64::from(k % 60), f64::from(k / 60));
            k += 1;
            // The relief that `grid` adds.
            let bumps = 3.0 * (0.1 * x).sin() * (0.07 * y).cos();
            (x % 6.0 - 3.0).abs() - bumps + 0.03 * gaussian(&mut rng)
        });
        let level = noise_level(&pleated).unwrap();
        assert!((0.024..0.036).contains(&level.sigma), "{level:?}");
        assert!(level.two_ring_ratio > 2.0, "{level:?}");
    }

    /// Independent noise correlates as the fits make it; means over neighbours correlate more, and
    /// so do waves that a quadric misses. A level that varies leaves more small residuals.
    #[test]
    fn correlated_and_varying_noise_are_found() {
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let independent = noise_level(&grid(|| 0.1 * gaussian(&mut rng))).unwrap();
        assert!((-0.4..-0.1).contains(&independent.correlation), "{independent:?}");
        assert!((0.85..1.15).contains(&independent.low_ratio), "{independent:?}");
        let white: Vec<f64> = (0..62 * 62).map(|_| gaussian(&mut rng)).collect();
        let mut k = 0;
        // Means over three by three vertices.
        let correlated = noise_level(&grid(|| {
            let corner = k / 60 * 62 + k % 60;
            k += 1;
            let rows = [0, 62, 124].map(|row| white[corner + row..corner + row + 3].iter().sum());
            rows.iter().sum::<f64>() / 30.0
        }))
        .unwrap();
        assert!(correlated.correlation > independent.correlation + 0.03, "{correlated:?}");
        let mut k = 0;
        let varying = noise_level(&grid(|| {
            k += 1;
            if k % 3600 < 2400 { 0.1 * gaussian(&mut rng) } else { 0.01 * gaussian(&mut rng) }
        }))
        .unwrap();
        assert!(varying.low_ratio < 0.85, "{varying:?}");
    }

    /// Of an even number of residuals the level is that of the mean of the two in the middle.
    #[test]
    fn the_median_of_an_even_number_lies_between() {
        let level = level_of(&mut [vec![9.0, 2.0, 1.0, 4.0], vec![], vec![]]).unwrap();
        assert_eq!((level.sigma, level.samples), (3.0 / GAUSSIAN_MEDIAN, 4));
        assert_eq!(level.tail_ratio, 3.0 / GAUSSIAN_TAIL);
        assert!(level_of(&mut Sizes::default()).is_none());
        // Another fit counts if it is less, and has residuals at half of the vertices or more.
        let with =
            |other: Vec<f64>| level_of(&mut [vec![9.0, 2.0, 1.0, 4.0], other, vec![]]).unwrap();
        assert_eq!(with(vec![2.0, 1.0]).two_ring_ratio, 2.0);
        assert_eq!(with(vec![2.0, 1.0]).sigma, 1.5 / GAUSSIAN_MEDIAN);
        assert_eq!((with(vec![1.0]), with(vec![5.0, 5.0])), (level, level));
        // One that passes through most vertices does not.
        assert_eq!(with(vec![0.0, 1e-12, 1e-9]), level);
    }

    #[test]
    fn impulses_differ_from_gaussian_noise() {
        let mut rng = ChaCha8Rng::seed_from_u64(8);
        let spikes = grid(|| {
            let hit = rng.random::<f64>() < 0.25;
            let noise = gaussian(&mut rng);
            if hit { noise } else { 0.05 * noise }
        });
        assert!(noise_level(&spikes).unwrap().is_impulsive());
    }

    #[test]
    fn too_few_neighbours_give_no_level() {
        let triangle =
            TriMesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]);
        assert!(noise_level(&triangle.unwrap()).is_none());
        let flat = TriMesh::new(vec![[0.0; 3]; 3], vec![[0, 1, 2]]).unwrap();
        assert!(noise_level(&flat).is_none());
    }

    /// Seven points around a vertex are hardly more than the six unknowns of a
    /// fit: their residuals contain no information about noise.
    #[test]
    fn few_neighbours_measure_nothing() {
        let mut positions = vec![[0.1, 0.0, 1.0], [0.0, 0.05, -1.1]];
        positions.extend((0..6).map(|i| {
            let (s, c) = (f64::from(i) * 1.05).sin_cos();
            [c, s, 0.1 * (3.1 * f64::from(i)).sin()]
        }));
        let faces = (0..6).flat_map(|i| {
            let (a, b) = (2 + i, 2 + (i + 1) % 6);
            [[0, a, b], [1, b, a]]
        });
        let mesh = TriMesh::new(positions, faces.collect()).unwrap();
        assert_eq!(noise_level(&mesh), None);
    }
}
