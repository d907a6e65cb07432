//! Normals by regression: stages of a small network that weighs candidates.

pub(crate) mod features;
pub(super) mod fits;
pub(crate) mod model;
pub(crate) mod network;
pub(crate) mod training;
mod wide;

use fairing_mesh::TriMesh;
use fairing_mesh::vec3::{add, distance, dot, scale, sub};
use fairing_operators::NoiseEstimate;
use rayon::prelude::*;

use super::follow::Follow;
use super::planes::{Evidence, flatten};
use crate::DenoiseError;
use crate::faces::{FaceLists, FaceShapes, Hinges, unit_or_zero};
use features::{Gatherer, QUANTILES, Seen, State, longest_sides};
use model::Model;
use network::{Network, Parts, Trace, combine};
use wide::wide_means;

/// Vertex steps between stages.
const STEPS: usize = 15;

/// The scale of the Cauchy weights of positions, in noise levels.
const TRUST: f64 = 3.0;

/// How far a vertex may go, in standard deviations: one Gaussian vertex in two
/// million is moved further by noise.
pub(super) const FAR: f64 = 5.0;

/// A vertex with more neighbours than this is not looked past.
const HUB: usize = 32;

/// What a stage finds at a face.
struct Answer {
    normal: [f64; 3],
    anchor: [f64; 3],
    /// As in [`Seen`]; `None` without a normal.
    residuals: Option<[f64; 2]>,
}

/// Faces that are treated together.
const BLOCK: usize = 1024;

/// A mesh on its way through the stages.
pub(crate) struct Progress<'a> {
    mesh: &'a TriMesh,
    hinges: &'a Hinges,
    rings: &'a FaceLists,
    level: NoiseEstimate,
    /// The variance of positions across the surface, weighted by the trust in them.
    variance: f64,
    /// The noise level: the estimate, or the displacements, if they are larger.
    sigma: f64,
    /// The median displacement over the estimate; one at first.
    excess: f64,
    /// How far vertices may go: five standard deviations.
    pub(crate) limit: f64,
    h: f64,
    noisy: FaceShapes,
    current: FaceShapes,
    pub(crate) normals: Vec<[f64; 3]>,
    anchors: Vec<[f64; 3]>,
    /// The surface that has followed the present normals; `None` before the first stage.
    surface: Option<TriMesh>,
    /// The weight of each vertex's position.
    vertex_trust: Vec<f64>,
    /// The weight of the position of each face.
    trust: Vec<f64>,
    scales: Vec<f64>,
    longest: Vec<f64>,
    /// The scales of differences between normals.
    ranges: [f64; 3],
    /// log₂ of quantiles of the residuals of local fits over a noise level, and that level.
    quantiles: Option<([f64; QUANTILES], f64)>,
}

impl<'a> Progress<'a> {
    /// Begins with the means of the noisy area vectors around each face.
    pub(crate) fn new(
        mesh: &'a TriMesh,
        hinges: &'a Hinges,
        rings: &'a FaceLists,
        level: NoiseEstimate,
    ) -> Self {
        let noisy = FaceShapes::new(mesh);
        let vector = |f: usize| scale(noisy.normals[f], noisy.areas[f]);
        let normals = (0..mesh.face_count())
            .into_par_iter()
            .map(|f| {
                let ring = rings.row(f).iter().map(|&g| vector(g as usize));
                unit_or_zero(ring.fold(vector(f), add))
            })
            .collect();
        let h = mesh.mean_edge_length();
        let mut progress = Self {
            mesh,
            hinges,
            rings,
            level,
            variance: level.sigma * level.sigma,
            sigma: level.sigma,
            excess: 1.0,
            limit: FAR * level.sigma,
            h,
            current: noisy.clone(),
            noisy,
            normals,
            anchors: vec![],
            surface: None,
            vertex_trust: vec![1.0; mesh.vertex_count()],
            trust: vec![1.0; mesh.face_count()],
            scales: vec![],
            longest: longest_sides(mesh),
            ranges: [0.0; 3],
            quantiles: None,
        };
        progress.anchors = progress.first_anchors();
        progress.set_scales();
        progress.set_ranges(2.0);
        progress
    }

    /// The mean centroid around each face.
    fn first_anchors(&self) -> Vec<[f64; 3]> {
        let centroids = &self.noisy.centroids;
        (0..centroids.len())
            .into_par_iter()
            .map(|f| {
                let row = self.rings.row(f);
                let sum = row.iter().fold(centroids[f], |s, &g| add(s, centroids[g as usize]));
                scale(sum, 1.0 / (row.len() + 1) as f64)
            })
            .collect()
    }

    /// The local scale of each face.
    fn set_scales(&mut self) {
        let (areas, rings, h) = (&self.current.areas, self.rings, self.h);
        self.scales = (0..areas.len())
            .into_par_iter()
            .map(|f| {
                let row = rings.row(f);
                let sum: f64 = areas[f] + row.iter().map(|&g| areas[g as usize]).sum::<f64>();
                // The side of an equilateral triangle of this area.
                let side = (sum / (row.len() + 1) as f64 * (4.0 / 3.0f64.sqrt())).sqrt();
                side.clamp(0.02 * h, 50.0 * h)
            })
            .collect();
    }

    /// Differences between normals that count: from what noise of `factor` σ̂/h
    /// makes to that of a crease.
    fn set_ranges(&mut self, factor: f64) {
        let low = (factor * self.sigma / self.h).clamp(0.02, 0.3);
        self.ranges = [low, (low * 0.5).sqrt(), 0.5];
    }

    fn state(&self) -> State<'_> {
        State {
            mesh: self.mesh,
            hinges: self.hinges,
            noisy: &self.noisy,
            surface: self.surface.as_ref().unwrap_or(self.mesh),
            current: &self.current,
            normals: &self.normals,
            anchors: &self.anchors,
            trust: &self.trust,
            scales: &self.scales,
            longest: &self.longest,
            sigma: self.sigma,
            excess: self.excess,
            h: self.h,
            tail: self.level.tail_ratio,
            low: self.level.low_ratio,
            two_ring: self.level.two_ring_ratio,
            correlation: self.level.correlation,
            quantiles: self.quantiles.map_or([0.0; QUANTILES], |(quantiles, sigma)| {
                quantiles.map(|q| q + libm::log2(sigma / self.sigma))
            }),
            ranges: self.ranges,
        }
    }

    /// What the network sees of some faces.
    pub(crate) fn samples(&self, faces: &[u32]) -> Vec<Option<Seen>> {
        let state = self.state();
        let wide = wide_means(&state);
        faces
            .par_chunks(BLOCK)
            .map_init(
                || Gatherer::new(&state, &wide),
                |gatherer, block| {
                    block.iter().map(|&f| gatherer.sample(f as usize)).collect::<Vec<_>>()
                },
            )
            .flatten_iter()
            .collect()
    }

    /// One stage: new normals, the means of what its networks say, and the surface follows.
    ///
    /// # Errors
    ///
    /// [`DenoiseError::Build`] if coordinates overflow.
    pub(crate) fn advance(&mut self, networks: &[Network]) -> Result<(), DenoiseError> {
        let state = self.state();
        let wide = wide_means(&state);
        let parts: Vec<Parts<'_>> = networks.iter().map(Network::parts).collect();
        let watch = fairing_watch::current();
        let count = self.normals.len();
        let blocks: Vec<Vec<Answer>> = (0..count.div_ceil(BLOCK))
            .into_par_iter()
            .map_init(
                || (Gatherer::new(&state, &wide), Trace::default()),
                |(gatherer, trace), block| {
                    watch.advance(1);
                    (block * BLOCK..((block + 1) * BLOCK).min(count))
                        .map(|f| {
                            let Some(seen) = gatherer.sample(f) else {
                                return Answer {
                                    normal: [0.0; 3],
                                    anchor: state.current.centroids[f],
                                    residuals: None,
                                };
                            };
                            let mut sum = [0.0; 3];
                            for parts in &parts {
                                parts.run(&seen.sample, trace);
                                let (mean, _) = combine(&seen.sample, &trace.outputs);
                                sum = add(sum, unit_or_zero(mean.map(f64::from)));
                            }
                            let [a, b, c] = seen.frame;
                            let [x, y, z] = sum;
                            let sum = add(add(scale(a, x), scale(b, y)), scale(c, z));
                            Answer {
                                normal: unit_or_zero(sum),
                                anchor: seen.anchor,
                                residuals: Some(seen.residuals),
                            }
                        })
                        .collect()
                },
            )
            .collect();
        let residuals: Vec<[f64; 2]> =
            blocks.iter().flatten().filter_map(|a| a.residuals).collect();
        (self.normals, self.anchors) =
            blocks.into_iter().flatten().map(|a| (a.normal, a.anchor)).unzip();
        self.quantiles = quantiles(&residuals).map(|q| (q, self.sigma));
        self.follow()
    }

    /// The displacements of vertices from the surface, along its normals and times their trust.
    fn offsets(&self) -> Vec<f64> {
        let Some(surface) = &self.surface else { return vec![0.0; self.vertex_trust.len()] };
        let mut up = vec![[0.0; 3]; self.vertex_trust.len()];
        for (face, &n) in self.mesh.faces().iter().zip(&self.normals) {
            face.iter().for_each(|&v| up[v as usize] = add(up[v as usize], n));
        }
        (self.mesh.positions().iter().zip(surface.positions()).zip(up).zip(&self.vertex_trust))
            .map(|(((&p, &x), n), t)| t * dot(unit_or_zero(n), sub(p, x)))
            .collect()
    }

    /// The surface follows the normals.
    fn follow(&mut self) -> Result<(), DenoiseError> {
        let follow = Follow::new(self.mesh, self.rings, self.limit / FAR, f64::INFINITY);
        let current = follow.run(self.mesh.positions(), &self.normals, STEPS)?;
        let moved: Vec<f64> = (self.mesh.positions().iter().zip(current.positions()))
            .map(|(&p, &x)| distance(p, x))
            .collect();
        let usual = median(moved.clone());
        self.excess = usual / self.level.sigma;
        self.sigma = self.level.sigma.max(usual);
        let scale = 1.0 / (TRUST * self.sigma);
        let trust: Vec<f64> = moved.iter().map(|d| 1.0 / (1.0 + (scale * d).powi(2))).collect();
        let squares: f64 = moved.iter().zip(&trust).map(|(d, t)| t * d * d).sum();
        self.variance = squares / trust.iter().sum::<f64>().max(f64::MIN_POSITIVE);
        self.limit = FAR * self.sigma.max(root_mean_square(&moved));
        self.trust = (self.mesh.faces().iter())
            .map(|face| face.iter().map(|&v| trust[v as usize]).sum::<f64>() / 3.0)
            .collect();
        self.vertex_trust = trust;
        self.current = FaceShapes::new(&current);
        self.longest = longest_sides(&current);
        self.surface = Some(current);
        self.set_scales();
        self.set_ranges(0.6);
        Ok(())
    }
}

/// The sum of the correlations of the displacement of a vertex with those of all vertices up to two edges
/// away, itself included (beyond a vertex with many neighbours none); at least one. The variance of a mean over many vertices is so many times that
/// of independent noise.
fn correlation_sum(mesh: &TriMesh, offsets: &[f64]) -> f64 {
    let topology = mesh.topology();
    let terms: Vec<[f64; 2]> = (0..offsets.len() as u32)
        .into_par_iter()
        .map_init(Vec::new, |disc: &mut Vec<u32>, v| {
            disc.clear();
            disc.push(v);
            for &w in topology.neighbors(v) {
                disc.push(w);
                let ring = topology.neighbors(w);
                if ring.len() <= HUB {
                    disc.extend_from_slice(ring);
                }
            }
            disc.sort_unstable();
            disc.dedup();
            let sum: f64 = disc.iter().map(|&w| offsets[w as usize]).sum();
            let r = offsets[v as usize];
            [r * sum, r * r]
        })
        .collect();
    let [products, squares] = terms.iter().fold([0.0; 2], |s, t| [s[0] + t[0], s[1] + t[1]]);
    if squares > 0.0 { (products / squares).max(1.0) } else { 1.0 }
}

/// The first decile and the median of both numbers.
fn quantiles(residuals: &[[f64; 2]]) -> Option<[f64; QUANTILES]> {
    let mut found = [0.0; QUANTILES];
    for (k, slots) in found.chunks_exact_mut(2).enumerate() {
        let mut numbers: Vec<f64> = residuals.iter().map(|r| r[k]).collect();
        for (slot, divisor) in slots.iter_mut().zip([10, 2]) {
            let at = numbers.len() / divisor;
            if numbers.is_empty() {
                return None;
            }
            *slot = *numbers.select_nth_unstable_by(at, f64::total_cmp).1;
        }
    }
    Some(found)
}

/// The median; zero without numbers.
fn median(mut numbers: Vec<f64>) -> f64 {
    let middle = numbers.len() / 2;
    if numbers.is_empty() {
        return 0.0;
    }
    *numbers.select_nth_unstable_by(middle, f64::total_cmp).1
}

fn root_mean_square(numbers: &[f64]) -> f64 {
    (numbers.iter().map(|x| x * x).sum::<f64>() / numbers.len().max(1) as f64).sqrt()
}

/// What the stages make of a mesh.
pub(crate) struct Regressed {
    pub(crate) normals: Vec<[f64; 3]>,
    /// How far vertices may go.
    pub(crate) limit: f64,
}

/// Runs all stages.
///
/// # Errors
///
/// [`DenoiseError::Build`] if coordinates overflow.
pub(crate) fn regress(
    mesh: &TriMesh,
    hinges: &Hinges,
    rings: &FaceLists,
    level: NoiseEstimate,
    model: &Model,
) -> Result<Regressed, DenoiseError> {
    let mut progress = Progress::new(mesh, hinges, rings, level);
    let blocks = mesh.face_count().div_ceil(BLOCK);
    fairing_watch::stage("normals", (model.stages.len() * blocks) as u64);
    for networks in &model.stages {
        progress.advance(networks)?;
    }
    let variance = progress.variance * correlation_sum(mesh, &progress.offsets());
    let Progress { mut normals, limit, trust, .. } = progress;
    flatten(&Evidence::new(mesh, hinges, &trust, variance), &mut normals);
    Ok(Regressed { normals, limit })
}

#[cfg(test)]
mod tests {
    use fairing_shapes as shapes;

    use super::*;

    /// Independent displacements count one by one, apart from chance; means of them over two rings count
    /// as the number of vertices of about such a mean.
    #[test]
    fn correlated_displacements_are_told_by_their_sums() {
        let mesh = shapes::plane(60, 60, shapes::Diagonals::Alternating);
        let noisy = shapes::jittered(&mesh, 0.1, 3, |p| p);
        let topology = noisy.topology();
        let mut state = 1u64;
        let white: Vec<f64> = (0..noisy.vertex_count())
            .map(|_| {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                (state >> 40) as f64 / (1u64 << 23) as f64 - 1.0
            })
            .collect();
        let averaged = |x: &[f64]| -> Vec<f64> {
            (0..x.len() as u32)
                .map(|v| {
                    let ring = topology.neighbors(v);
                    let sum: f64 = ring.iter().map(|&w| x[w as usize]).sum();
                    (sum + x[v as usize]) / (ring.len() + 1) as f64
                })
                .collect()
        };
        let correlated = correlation_sum(&noisy, &averaged(&averaged(&white)));
        assert!((7.0..20.0).contains(&correlated), "{correlated}");
        let independent = correlation_sum(&noisy, &white);
        assert!((1.0..1.4).contains(&independent), "{independent}");
        assert_eq!(correlation_sum(&noisy, &vec![0.0; noisy.vertex_count()]), 1.0);
    }

    /// Faces of a torus are right triangles in pairs: their normals differ from those of the smooth surface at their centroids by 2°,
    /// to one side and to the other. A mean of normals does not see that; as a candidate it is turned.
    #[test]
    fn means_are_turned_to_flat_faces() {
        let truth = shapes::torus(1.0, 0.4, 75, 30);
        let noisy = shapes::jittered(&truth, 1e-4, 3, |p| p);
        let (hinges, rings) = (Hinges::new(&noisy), FaceLists::rings(&noisy));
        let level = fairing_operators::noise_level(&noisy).unwrap();
        let progress = Progress::new(&noisy, &hinges, &rings, level);
        let wanted = FaceShapes::new(&truth).normals;
        let faces: Vec<u32> = (0..noisy.face_count() as u32).collect();
        // The mean over the smallest neighbourhood, whatever the normals in it.
        let plain = features::RANGES - 1;
        let sum: f64 = (progress.samples(&faces).iter().zip(&wanted))
            .map(|(seen, &t)| {
                let seen = seen.as_ref().unwrap();
                let found = unit_or_zero(seen.sample.candidate(plain).map(f64::from));
                distance(found, seen.frame.map(|e| dot(e, t)))
            })
            .sum();
        let mean = (sum / faces.len() as f64).to_degrees();
        assert!(mean < 0.5, "{mean}");
    }
}
