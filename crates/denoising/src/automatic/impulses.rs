//! Vertices far from the denoised surface, between others that lie on it.

use fairing_mesh::TriMesh;
use fairing_sparse::upper_median;
use glam::DVec3;

use crate::masked::Masked;

/// The largest median distance from the surface over the root mean square distance around each
/// vertex. It is 0.70 or more on the models of the development set under noise without impulses
/// (0.67 for distances of a normal distribution), and 0.55 or less under impulses.
const MAX_MEDIAN: f64 = 0.6;

/// The distance of an impulse, in standard deviations of the distances of the other vertices. These
/// are errors of the surface more than noise, and reach farther than a normal distribution. The
/// best of 2, 3.5, 4.5 and 6 on models of the development set of which a tenth to six tenths of the
/// vertices are impulses.
const OUTLYING: f64 = 4.5;

/// The number of distances that the distributions are fitted to.
const SAMPLES: usize = 4096;

/// Steps of expectation and maximisation.
const STEPS: usize = 100;

/// The vertices of a noisy mesh, divided into impulses and others by their distance from the
/// denoised surface.
pub(super) struct Impulses {
    /// A flag for each vertex.
    pub(super) is_impulse: Vec<bool>,
    /// The standard deviation of the distances of the other vertices.
    pub(super) rest: f64,
}

impl Impulses {
    /// `None` where the distances do not differ from vertex to vertex as those of impulses do. A
    /// fixed vertex is no impulse.
    ///
    /// Distances follow two normal distributions, fitted by expectation and maximisation. The
    /// narrow one is that of the vertices without impulses.
    pub(super) fn find(noisy: Masked<'_>, denoised: &TriMesh) -> Option<Self> {
        let distances = distances(noisy.mesh(), denoised);
        if !are_uneven(noisy, &distances) {
            return None;
        }
        let free = (0..distances.len()).filter(|&v| !noisy.is_fixed(v));
        let rest = narrow_deviation(free.map(|v| distances[v]).collect());
        let is_impulse = (distances.iter().enumerate())
            .map(|(v, &d)| d > OUTLYING * rest && !noisy.is_fixed(v))
            .collect();
        Some(Self { is_impulse, rest })
    }

    /// The noisy mesh with its impulses on the denoised surface.
    pub(super) fn moved_onto(&self, noisy: &TriMesh, denoised: &TriMesh) -> Vec<[f64; 3]> {
        let pairs = noisy.positions().iter().zip(denoised.positions());
        pairs.zip(&self.is_impulse).map(|((&p, &x), is)| if *is { x } else { p }).collect()
    }
}

/// Returns `true` if the vertices differ in their distance from a surface as impulses and others
/// do.
pub(super) fn has_impulses(noisy: Masked<'_>, surface: &TriMesh) -> bool {
    are_uneven(noisy, &distances(noisy.mesh(), surface))
}

/// Returns `true` if the distances of the vertices that may move differ from vertex to vertex as
/// those of impulses do.
fn are_uneven(noisy: Masked<'_>, distances: &[f64]) -> bool {
    let around = mean_squares_around(noisy.mesh(), distances);
    let free = (0..distances.len()).filter(|&v| !noisy.is_fixed(v) && around[v] > 0.0);
    let relative = free.map(|v| distances[v] / around[v].sqrt()).collect();
    upper_median(relative).is_some_and(|median| median <= MAX_MEDIAN)
}

/// The distance of each vertex from its place in the denoised mesh.
fn distances(noisy: &TriMesh, denoised: &TriMesh) -> Vec<f64> {
    let pairs = noisy.positions().iter().zip(denoised.positions());
    pairs.map(|(&p, &x)| DVec3::from(p).distance(x.into())).collect()
}

/// The mean of the squares of the distances over two rings around each vertex; zero without faces.
fn mean_squares_around(mesh: &TriMesh, distances: &[f64]) -> Vec<f64> {
    let mut means: Vec<f64> = distances.iter().map(|d| d * d).collect();
    for _ in 0..2 {
        let mut sums = vec![(0.0, 0u32); means.len()];
        for face in mesh.faces() {
            let sum: f64 = face.iter().map(|&v| means[v as usize]).sum();
            for &v in face {
                let slot = &mut sums[v as usize];
                *slot = (slot.0 + sum, slot.1 + 3);
            }
        }
        means = sums.iter().map(|(sum, count)| sum / f64::from((*count).max(1))).collect();
    }
    means
}

/// The smaller standard deviation of two normal distributions with the mean zero, of which the
/// distances are the absolute values.
fn narrow_deviation(mut distances: Vec<f64>) -> f64 {
    distances.sort_unstable_by(f64::total_cmp);
    let n = distances.len();
    let count = n.min(SAMPLES);
    let at = |k: usize| distances[(2 * k + 1) * n / (2 * count)];
    let samples: Vec<f64> = (0..count).map(at).collect();
    let least = 1e-9 * samples[count - 1];
    let (mut fraction, mut narrow, mut wide) =
        (0.5, samples[count / 3].max(least), samples[count * 9 / 10].max(least));
    for _ in 0..STEPS {
        // The weight and the squares of either distribution.
        let mut sums = [[0.0; 2]; 2];
        for d in &samples {
            let density =
                |part: f64, scale: f64| part / scale * libm::exp(-0.5 * (d / scale).powi(2));
            let (a, b) = (density(fraction, narrow), density(1.0 - fraction, wide));
            let weight = if a + b > 0.0 { a / (a + b) } else { 0.0 };
            for (sum, weight) in sums.iter_mut().zip([weight, 1.0 - weight]) {
                sum[0] += weight;
                sum[1] += weight * d * d;
            }
        }
        let [first, second] = sums.map(|[w, s]| (s / w.max(f64::MIN_POSITIVE)).sqrt());
        fraction = sums[0][0] / count as f64;
        narrow = first.max(least);
        wide = second.max(narrow);
    }
    narrow
}

#[cfg(test)]
mod tests {
    use fairing_shapes as shapes;

    use super::*;

    /// `count` quantiles of the absolute value of a normal distribution.
    fn half_normal(count: usize, deviation: f64) -> impl Iterator<Item = f64> {
        (0..count).map(move |k| {
            // By bisection.
            let wanted = (k as f64 + 0.5) / count as f64;
            let (mut low, mut high) = (0.0, 8.0);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if libm::erf(middle / 2.0f64.sqrt()) < wanted {
                    low = middle
                } else {
                    high = middle
                }
            }
            deviation * low
        })
    }

    #[test]
    fn the_narrow_of_two_distributions_is_found() {
        for (narrow, fraction) in [(0.01, 0.75), (0.05, 0.4), (0.1, 0.9)] {
            let few = (fraction * 3000.0) as usize;
            let all = half_normal(few, narrow).chain(half_normal(3000 - few, 0.5)).collect();
            let found = narrow_deviation(all);
            assert!((found / narrow - 1.0).abs() < 0.05, "{found}, {narrow}");
        }
    }

    /// A sphere with normal noise has no impulses, at any level; with every third vertex moved by
    /// half an edge these are found, all but those with the least distances.
    #[test]
    fn impulses_are_vertices_far_between_near_ones() {
        let truth = shapes::icosphere(4);
        let h = truth.mean_edge_length();
        for amount in [0.01, 0.3] {
            let noisy = shapes::jittered(&truth, amount, 4, |p| p);
            assert!(Impulses::find((&noisy).into(), &truth).is_none());
        }
        // The surface is off by a hundredth of an edge.
        let denoised = shapes::jittered(&truth, 0.01, 5, |p| p);
        let far = shapes::jittered(&truth, 0.49, 6, |p| p);
        let positions = (truth.positions().iter().zip(far.positions()).enumerate())
            .map(|(v, (&p, &q))| if v % 3 == 0 { q } else { p })
            .collect();
        let noisy = truth.with_positions(positions).unwrap();
        let fixed: Vec<bool> = (0..truth.vertex_count()).map(|v| v % 6 == 0).collect();
        let found = Impulses::find(Masked::new(&noisy, &fixed).unwrap(), &denoised).unwrap();
        let mut missed = 0;
        for (v, is) in found.is_impulse.iter().enumerate() {
            assert!(!is || v % 6 == 3, "vertex {v}");
            let distance = DVec3::from(noisy.positions()[v]).distance(truth.positions()[v].into());
            missed += usize::from(v % 6 == 3 && distance > 0.1 * h && !is);
        }
        assert_eq!(missed, 0);
        let moved = found.moved_onto(&noisy, &denoised);
        for (v, (p, is)) in moved.iter().zip(&found.is_impulse).enumerate() {
            let from = if *is { &denoised } else { &noisy };
            assert_eq!(*p, from.positions()[v]);
        }
    }

    /// Three vertices in ten of a sphere are impulses. Denoised without them, it is closer to the
    /// truth than by the first time (1.35°).
    #[test]
    fn a_sphere_is_denoised_again_without_its_impulses() {
        let truth = shapes::icosphere(4);
        let far = shapes::jittered(&truth, 0.49, 7, |p| p);
        let positions = (truth.positions().iter().zip(far.positions()).enumerate())
            .map(|(v, (&p, &q))| {
                let (p, q) = (DVec3::from(p), DVec3::from(q));
                let amount = if v * 7 % 10 < 3 { 2.5 } else { 0.0 };
                (p + amount * (q - p)).to_array()
            })
            .collect();
        let noisy = truth.with_positions(positions).unwrap();
        let found = crate::automatic(&noisy, &crate::AutomaticOptions::default()).unwrap();
        let normals = |mesh: &TriMesh| crate::faces::FaceShapes::new(mesh).normals;
        let angles = (normals(&found.mesh).into_iter().zip(normals(&truth)))
            .map(|(n, t)| n.dot(t).clamp(-1.0, 1.0).acos().to_degrees());
        let mean = angles.sum::<f64>() / truth.face_count() as f64;
        assert!(mean < 1.1, "{mean}");
    }
}
