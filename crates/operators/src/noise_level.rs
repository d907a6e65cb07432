//! The noise level of a mesh, estimated without a ground truth.

use fairing_mesh::TriMesh;
use fairing_mesh::vec3::{add, dot, norm, normalize, scale, sub};
use rayon::prelude::*;

use crate::NormalEquations;
use crate::curvature::PrincipalAxes;
use crate::tangent::tangent_frame;

/// A tail ratio above this tells impulsive from Gaussian noise: Gaussian
/// residuals give 1 by construction, and 1.15 is beyond what curvature and
/// creases do to it on clean shapes.
const IMPULSIVE_TAIL: f64 = 1.15;

/// The 90th percentile of |x| over its median, for Gaussian x.
const GAUSSIAN_TAIL: f64 = 2.4387;

/// The 10th percentile of |x| over its median, for Gaussian x.
const GAUSSIAN_LOW: f64 = 0.186_31;

/// Residuals count in correlations up to this many standard deviations.
const CLIP: f64 = 3.0;

/// The median of |x| is this share of the standard deviation of Gaussian x.
const GAUSSIAN_MEDIAN: f64 = 0.674_489_75;

/// What [`noise_level`] finds.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct NoiseEstimate {
    /// The standard deviation of the displacement of a vertex along the
    /// normal, in mesh units.
    pub sigma: f64,
    /// The ratio of the 90th percentile to the median of the residuals'
    /// absolute values, over that of a Gaussian: 1 for Gaussian noise, more
    /// where a share of the vertices is moved further than the rest.
    pub tail_ratio: f64,
    /// The ratio of the 10th percentile to the median of the residuals' absolute
    /// values, over that of a Gaussian: less than 1 where the level varies over the surface, or
    /// where details that a quadric misses are taken for noise.
    pub low_ratio: f64,
    /// The correlation of residuals across edges, from −1 to 1; residuals beyond three σ̂ count as
    /// three. Independent noise gives about −0.27, since each residual is in the fits of its
    /// neighbours. Noise that is correlated over two edges gives about 0.05 more.
    pub correlation: f64,
    /// The number of vertices that the estimate is made from.
    pub samples: usize,
}

impl NoiseEstimate {
    /// Whether the tails are those of impulsive noise: a tail ratio above 1.15.
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
/// A quadric is fitted to the two-ring of each vertex without the vertex, as
/// a height field over the plane of the ring's area vector. With the leverage
/// ℓ, the variance of the fit at the vertex over σ², the vertex's own residual
/// r has the variance σ² (1 + ℓ) where the surface is smooth on that scale, so
///
/// ```text
/// σ̂ = 1.4826 · median |r| / √(1 + ℓ)
/// ```
///
/// The median is hardly changed by the vertices near creases. On Gaussian noise σ̂ is a
/// few percent high; on a clean mesh it is what the quadric misses, not zero.
/// A connected part that is clean does not lower the level of another one.
/// Scales with the mesh. `None` if no vertex has a two-ring that determines a
/// quadric (at least eight neighbours in general position). Linear cost.
pub fn noise_level(mesh: &TriMesh) -> Option<NoiseEstimate> {
    noisy_parts(mesh).first().map(|parts| parts.level)
}

/// The levels of a part within this factor of each other count as the same:
/// estimates from a few dozen vertices differ by as much as two.
const ALIKE: f64 = 4.0;

/// The connected parts of a mesh, put together where their noise is about the
/// same, those with most of it first.
///
/// The part with the largest `n σ̂²`, n the number of its vertices, is taken with
/// all parts whose level is at least a quarter and at most four times its own,
/// and so on with what is left. Parts that are too small for an estimate are in
/// the first group; empty if all are.
pub fn noisy_parts(mesh: &TriMesh) -> Vec<NoisyParts> {
    let (mesh, unit) = mesh.at_unit_scale();
    let mesh = &*mesh;
    let residuals: Vec<Option<f64>> = (0..mesh.vertex_count() as u32)
        .into_par_iter()
        .map_init(Default::default, |scratch, v| leave_one_out(mesh, v, scratch))
        .collect();
    let components = mesh.topology().components();
    let mut of_part = vec![vec![]; components.count()];
    for (v, residual) in residuals.iter().enumerate() {
        if let (Some(part), Some(r)) = (components.label(v as u32), residual) {
            of_part[part as usize].push(r.abs() * unit);
        }
    }
    let mut unmeasured = vec![];
    let mut left: Vec<(u32, Vec<f64>, NoiseEstimate)> = vec![];
    for (part, mut sizes) in of_part.into_iter().enumerate() {
        match level_of(&mut sizes) {
            Some(level) => left.push((part as u32, sizes, level)),
            None => unmeasured.push(part as u32),
        }
    }
    let mut groups: Vec<NoisyParts> = vec![];
    while let Some(first) = most_noise(&left) {
        let sigma = left[first].2.sigma;
        let alike =
            |level: &NoiseEstimate| level.sigma * ALIKE >= sigma && level.sigma <= ALIKE * sigma;
        let (group, rest): (Vec<_>, Vec<_>) = left.into_iter().partition(|(.., l)| alike(l));
        left = rest;
        let mut components: Vec<u32> = group.iter().map(|(part, ..)| *part).collect();
        components.append(&mut unmeasured);
        components.sort_unstable();
        let mut sizes: Vec<f64> = group.into_iter().flat_map(|(_, sizes, _)| sizes).collect();
        groups.extend(level_of(&mut sizes).map(|level| NoisyParts { level, components }));
    }
    for group in &mut groups {
        let inside = |v: u32| {
            let part = components.label(v);
            part.is_some_and(|part| group.components.binary_search(&part).is_ok())
        };
        group.level.correlation = correlation(mesh, &residuals, group.level.sigma / unit, inside);
    }
    groups
}

/// The correlation across edges of the residuals of the vertices that are `inside`; zero if there is none.
fn correlation(
    mesh: &TriMesh,
    residuals: &[Option<f64>],
    sigma: f64,
    inside: impl Fn(u32) -> bool,
) -> f64 {
    let clipped: Vec<Option<f64>> = (0u32..)
        .zip(residuals)
        .map(|(v, r)| r.filter(|_| inside(v)).map(|r| (r / sigma).clamp(-CLIP, CLIP)))
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

/// Which part has the largest `n σ̂²`; the first of equal ones.
fn most_noise(parts: &[(u32, Vec<f64>, NoiseEstimate)]) -> Option<usize> {
    let amount = |i: usize| (parts[i].2.samples as f64).sqrt() * parts[i].2.sigma;
    (0..parts.len()).reduce(|best, i| if amount(i) > amount(best) { i } else { best })
}

/// The level of absolute values, which it sorts.
fn level_of(sizes: &mut [f64]) -> Option<NoiseEstimate> {
    sizes.sort_unstable_by(f64::total_cmp);
    let (median, low, high) =
        (median(sizes)?, sizes[sizes.len() / 10], sizes[sizes.len() * 9 / 10]);
    let over_gaussian =
        |size: f64, gaussian: f64| if median > 0.0 { size / median / gaussian } else { 1.0 };
    Some(NoiseEstimate {
        sigma: median / GAUSSIAN_MEDIAN,
        tail_ratio: over_gaussian(high, GAUSSIAN_TAIL),
        low_ratio: over_gaussian(low, GAUSSIAN_LOW),
        correlation: 0.0,
        samples: sizes.len(),
    })
}

/// The middle of ascending values; the mean of both where there are two.
fn median(sorted: &[f64]) -> Option<f64> {
    let n = sorted.len();
    Some(0.5 * sorted.get(n.checked_sub(1)? / 2)? + 0.5 * sorted[n / 2])
}

/// The residual of vertex `v` from the quadric of its two-ring, standardised
/// to the variance of the noise. The last argument is scratch space.
fn leave_one_out(
    mesh: &TriMesh,
    v: u32,
    (ring, points): &mut (Vec<u32>, Vec<[f64; 3]>),
) -> Option<f64> {
    let (incidence, faces) = (mesh.incidence(), mesh.faces());
    ring.clear();
    for &c in incidence.corners(v) {
        ring.extend_from_slice(&faces[c as usize / 3]);
    }
    ring.sort_unstable();
    ring.dedup();
    let one_ring = ring.len();
    let mut area = [0.0; 3];
    for i in 0..one_ring {
        for &c in incidence.corners(ring[i]) {
            area = add(area, mesh.area_vector(c as usize / 3));
            ring.extend_from_slice(&faces[c as usize / 3]);
        }
    }
    ring.sort_unstable();
    ring.dedup();
    if ring.len() < 9 {
        return None;
    }
    let origin = mesh.positions()[v as usize];
    let offsets =
        ring.iter().filter(|&&w| w != v).map(|&w| sub(mesh.positions()[w as usize], origin));
    let radius = offsets.clone().map(norm).fold(0.0, f64::max);
    let normal = normalize(area)?;
    let [e1, e2] = tangent_frame(normal);
    if radius.is_nan() || radius <= 0.0 {
        return None;
    }
    points.clear();
    let flat = |d: [f64; 3]| [dot(d, e1), dot(d, e2), dot(d, normal)];
    points.extend(offsets.map(|d| flat(scale(d, 1.0 / radius))));
    let axes = PrincipalAxes::new(points.iter().map(|p| [p[0], p[1]]))?;
    let mut equations = NormalEquations::<6>::default();
    for p in points.iter() {
        let [x, y] = axes.coordinates([p[0], p[1]]);
        equations.add(&[1.0, x, y, x * x, x * y, y * y], p[2], 1.0);
    }
    let factor = equations.factor()?;
    let leverage = factor.variance(&[1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let residual = -radius * factor.solve(equations.rhs())[0] / (1.0 + leverage).sqrt();
    residual.is_finite().then_some(residual)
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

    /// Independent noise correlates as the fits make it; means over neighbours correlate more, and so do
    /// waves that a quadric misses. A level that varies leaves more small residuals.
    #[test]
    fn correlated_and_varying_noise_are_told() {
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
        assert_eq!(median(&[1.0, 2.0, 4.0, 9.0]), Some(3.0));
        assert_eq!(
            (median(&[1.0, 2.0, 9.0]), median(&[7.0]), median(&[])),
            (Some(2.0), Some(7.0), None)
        );
        let level = level_of(&mut [9.0, 2.0, 1.0, 4.0]).unwrap();
        assert_eq!((level.sigma, level.samples), (3.0 / GAUSSIAN_MEDIAN, 4));
        assert_eq!(level.tail_ratio, 3.0 / GAUSSIAN_TAIL);
        assert!(level_of(&mut []).is_none());
    }

    #[test]
    fn impulses_are_told_from_gaussian_noise() {
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
    /// fit: what is left of them says nothing about noise.
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
