//! The state of the denoiser: normals, and the surface that follows them.

use std::borrow::Cow;

use fairing_mesh::TriMesh;
use fairing_sparse::upper_median;
use fairing_watch::parallel;
use glam::DVec3;

use super::follow::Follow;
use crate::error::DenoiseError;
use crate::faces::{FaceLists, FaceShapes, Hinges, longest_side};
use crate::masked::Masked;
use crate::noise_level::NoiseEstimate;

/// Vertex steps between stages.
const STEPS: usize = 15;

/// The scale of the Cauchy weights of positions, in noise levels.
const TRUST: f64 = 3.0;

/// The largest displacement of a vertex, in standard deviations: noise moves one Gaussian vertex
/// in two million further.
pub(super) const MAX_DEVIATIONS: f64 = 5.0;

/// The number of scales of differences between normals; the last is infinite.
pub(super) const RANGES: usize = 4;

/// The number of quantiles of the residuals of local fits.
pub(super) const QUANTILES: usize = 4;

/// A mesh between two stages.
pub struct State<'a> {
    /// The noisy mesh.
    pub(super) input: Masked<'a>,
    pub(super) hinges: Hinges,
    pub(super) rings: FaceLists,
    /// The noise of the mesh, estimated before the first stage.
    pub(super) level: NoiseEstimate,
    /// The mean edge length of the mesh.
    pub(super) h: f64,
    /// The faces of the noisy mesh.
    pub(super) noisy: FaceShapes,
    /// The present normal of each face; zero for a face without one.
    pub(super) normals: Vec<DVec3>,
    /// A point of the surface at each face, from a local fit.
    pub(super) anchors: Vec<DVec3>,
    /// The surface that has followed the present normals; the noisy mesh before the first stage.
    pub(super) surface: Cow<'a, TriMesh>,
    /// The faces of the surface.
    pub(super) current: FaceShapes,
    /// The longest side of each face of the surface.
    pub(super) longest: Vec<f64>,
    /// The local scale of each face: the side of an equilateral triangle of the mean area around
    /// the face.
    pub(super) scales: Vec<f64>,
    /// The noise level: the estimate, or the median displacement if that is larger.
    pub(super) sigma: f64,
    /// The median displacement over the estimate; one before the first stage.
    pub(super) excess: f64,
    /// The variance of positions across the surface, weighted by the trust in them.
    pub(super) variance: f64,
    /// The largest displacement of a vertex: five standard deviations.
    pub(super) limit: f64,
    /// The weight of the position of each vertex.
    pub(super) vertex_trust: Vec<f64>,
    /// The weight of the position of each face.
    pub(super) trust: Vec<f64>,
    /// The finite scales of differences between normals.
    pub(super) ranges: [f64; RANGES - 1],
    /// The mean over all faces of the root mean square distance of the answers of the networks from
    /// their mean; zero before the first stage.
    pub(super) apart: f64,
    /// log₂ of quantiles over all faces of the residuals of local fits over σ; zero before the
    /// first stage. Correlated noise has no face with small ones; details leave some.
    pub(super) quantiles: [f64; QUANTILES],
}

impl<'a> State<'a> {
    /// The state before the first stage: normals are the means of the noisy area vectors around
    /// each face.
    pub fn new(input: impl Into<Masked<'a>>, level: NoiseEstimate) -> Self {
        let input = input.into();
        let mesh = input.mesh();
        let rings = FaceLists::rings(mesh);
        let noisy = FaceShapes::new(mesh);
        let vector = |f: usize| noisy.areas[f] * noisy.normals[f];
        let normals = parallel::map(mesh.face_count(), 64, |f| {
            let ring = rings.row(f).iter().map(|&g| vector(g as usize));
            ring.fold(vector(f), |sum, v| sum + v).normalize_or_zero()
        });
        let mut state = Self {
            input,
            hinges: Hinges::new(mesh),
            level,
            h: mesh.mean_edge_length(),
            normals,
            anchors: mean_centroids(&noisy.centroids, &rings),
            surface: Cow::Borrowed(mesh),
            current: noisy.clone(),
            longest: longest_sides(mesh),
            scales: vec![],
            sigma: level.sigma,
            excess: 1.0,
            variance: level.sigma * level.sigma,
            limit: MAX_DEVIATIONS * level.sigma,
            vertex_trust: vec![1.0; mesh.vertex_count()],
            trust: vec![1.0; mesh.face_count()],
            ranges: [0.0; 3],
            apart: 0.0,
            quantiles: [0.0; QUANTILES],
            rings,
            noisy,
        };
        state.set_scales();
        state.set_ranges(2.0);
        state
    }

    /// The noisy mesh.
    pub(super) fn mesh(&self) -> &'a TriMesh {
        self.input.mesh()
    }

    /// The present normal of each face; zero for a face without one.
    pub fn normals(&self) -> &[DVec3] {
        &self.normals
    }

    /// The way of vertices to the present normals, none further than `limit` from its noisy
    /// position. Fixed vertices move as well: the surface is an estimate of the true one.
    pub(super) fn follower(&self, limit: f64) -> Follow<'a> {
        Follow::new(self.mesh(), &self.rings, self.limit / MAX_DEVIATIONS, limit)
    }

    /// The surface follows the normals; the noise level, the trust in positions and the scales
    /// are those that its distance from the noisy mesh shows, at the vertices that may move.
    pub(super) fn follow(&mut self) -> Result<(), DenoiseError> {
        let noisy = self.mesh().positions();
        let surface = self.follower(f64::INFINITY).run(noisy, &self.normals, STEPS)?;
        let moved: Vec<f64> = noisy
            .iter()
            .zip(surface.positions())
            .map(|(&p, &x)| DVec3::from(p).distance(x.into()))
            .collect();
        let free: Vec<usize> = (0..moved.len()).filter(|&v| !self.input.is_fixed(v)).collect();
        let distances: Vec<f64> = free.iter().map(|&v| moved[v]).collect();
        let usual = upper_median(distances.clone()).unwrap_or(0.0);
        self.excess = usual / self.level.sigma;
        self.sigma = self.level.sigma.max(usual);
        let scale = 1.0 / (TRUST * self.sigma);
        let trust: Vec<f64> = moved.iter().map(|d| 1.0 / (1.0 + (scale * d).powi(2))).collect();
        let squares: f64 = free.iter().map(|&v| trust[v] * moved[v] * moved[v]).sum();
        let total: f64 = free.iter().map(|&v| trust[v]).sum();
        self.variance = squares / total.max(f64::MIN_POSITIVE);
        self.limit = MAX_DEVIATIONS * self.sigma.max(root_mean_square(&distances));
        self.trust = (self.mesh().faces().iter())
            .map(|face| face.iter().map(|&v| trust[v as usize]).sum::<f64>() / 3.0)
            .collect();
        self.vertex_trust = trust;
        self.current = FaceShapes::new(&surface);
        self.longest = longest_sides(&surface);
        self.surface = Cow::Owned(surface);
        self.set_scales();
        self.set_ranges(0.6);
        Ok(())
    }

    /// The local scale of each face.
    fn set_scales(&mut self) {
        let (areas, rings, h) = (&self.current.areas, &self.rings, self.h);
        self.scales = parallel::map(areas.len(), 64, |f| {
            // The side of an equilateral triangle of this area.
            let side = (rings.mean(areas, f) * (4.0 / 3.0f64.sqrt())).sqrt();
            side.clamp(0.02 * h, 50.0 * h)
        });
    }

    /// Differences between normals that count: from what noise of `factor` σ̂/h
    /// makes to that of a crease.
    fn set_ranges(&mut self, factor: f64) {
        let low = (factor * self.sigma / self.h).clamp(0.02, 0.3);
        self.ranges = [low, (low * 0.5).sqrt(), 0.5];
    }

    /// The weight of a normal that differs by `apart`, in one of the ranges.
    pub(super) fn similarity(&self, apart: DVec3, range: usize) -> f64 {
        similarities(apart.dot(apart), self.factors())[range]
    }

    pub(super) fn factors(&self) -> [f64; RANGES - 1] {
        self.ranges.map(|r| 0.25 / (r * r))
    }
}

/// The weights of a normal at a squared distance, for each range: close to
/// Gaussians, with tails of an eighth power; the last is one.
#[inline(always)]
pub(super) fn similarities(square: f64, factors: [f64; RANGES - 1]) -> [f64; RANGES] {
    let mut weights = [1.0; RANGES];
    for (w, factor) in weights.iter_mut().zip(factors) {
        let q = 1.0 / (1.0 + factor * square);
        *w = (q * q) * (q * q);
    }
    weights
}

/// The mean centroid around each face.
fn mean_centroids(centroids: &[DVec3], rings: &FaceLists) -> Vec<DVec3> {
    parallel::map(centroids.len(), 64, |f| {
        let row = rings.row(f);
        let sum = row.iter().fold(centroids[f], |s, &g| s + centroids[g as usize]);
        sum * (1.0 / (row.len() + 1) as f64)
    })
}

/// The longest side of each face.
fn longest_sides(mesh: &TriMesh) -> Vec<f64> {
    parallel::map(mesh.face_count(), 64, |f| longest_side(mesh, f))
}

pub(super) fn root_mean_square(numbers: &[f64]) -> f64 {
    (numbers.iter().map(|x| x * x).sum::<f64>() / numbers.len().max(1) as f64).sqrt()
}
