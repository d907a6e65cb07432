//! The test for the noise of depth cameras: what it finds on generated scans and models, and the
//! fit of its weights.

use anyhow::{Context as _, Result};
use fairing_denoising::noise_level;
use fairing_denoising::training::{Growth, TERMS};
use fairing_evaluation::{NoiseKind, NoiseLevel, add_noise};
use fairing_mesh::TriMesh;
use fairing_operators::NormalEquations;
use rayon::prelude::*;

use crate::cases::view;
use crate::families::{Family, Set, Triangulation};

/// Views of each family, each with another model.
const VIEWS: u64 = 8;

/// Seeds from here on belong to no case of the benchmark and to no pair of the training.
const SEEDS: u64 = 900_000;

/// The pixels of the views.
const SIZES: [[u32; 2]; 3] = [[110, 82], [160, 120], [80, 60]];

/// The kinds of noise on scans, and their levels in mean edge lengths. The camera is that of the
/// scan.
const ON_SCANS: [(NoiseKind, &[f64]); 8] = [
    (NoiseKind::DepthCamera { camera: None, length: 3.0 }, &[0.3, 0.67, 1.0]),
    (NoiseKind::DepthCamera { camera: None, length: 5.0 }, &[0.4, 0.67, 1.0]),
    (NoiseKind::DepthCamera { camera: None, length: 8.0 }, &[0.5, 0.8, 1.2]),
    (NoiseKind::Rays { camera: None }, &[0.05, 0.15, 0.35]),
    (NoiseKind::Correlated { length: 2.0 }, &[0.05, 0.2, 0.35]),
    (NoiseKind::Correlated { length: 1.5 }, &[0.1, 0.3]),
    (NoiseKind::Impulsive { fraction: 0.25 }, &[0.3, 0.5]),
    (NoiseKind::Varying, &[0.1, 0.3]),
];

/// The same on models.
const ON_MODELS: [(NoiseKind, &[f64]); 6] = [
    (NoiseKind::GaussianAlongNormals, &[0.02, 0.05, 0.1, 0.2, 0.5]),
    (NoiseKind::GaussianPerAxis, &[0.05, 0.1, 0.2]),
    (NoiseKind::Correlated { length: 2.0 }, &[0.05, 0.15, 0.35]),
    (NoiseKind::Impulsive { fraction: 0.25 }, &[0.3, 0.5]),
    (NoiseKind::Impulsive { fraction: 0.6 }, &[0.3]),
    (NoiseKind::Varying, &[0.1, 0.3]),
];

/// The number of faces of the models.
const FACES: [usize; 2] = [4000, 8000];

/// The weight of the sum of squares of the weights in a fit.
const RIDGE: f64 = 0.1;

/// Steps of a fit.
const STEPS: usize = 60;

/// A mesh, and what is measured on it.
#[derive(Debug, Clone)]
pub struct Sighting {
    /// The kind of the mesh and of its noise, for a table.
    pub kind: String,
    /// The noise is that of a depth camera.
    pub is_camera: bool,
    /// `None` where the test does not get so far.
    pub growth: Option<Growth>,
}

impl Sighting {
    fn new(place: &str, noise: Option<NoiseKind>, mesh: &TriMesh) -> Self {
        let kind = noise.map_or("clean", |noise| noise.name());
        let growth = noise_level(mesh).filter(|level| level.sigma > 0.0).and_then(|level| {
            let shape = [level.tail_ratio, level.low_ratio, level.correlation];
            Growth::new(mesh, level.sigma, shape, |_| true)
        });
        let is_camera = matches!(noise, Some(NoiseKind::DepthCamera { .. }));
        Self { kind: format!("{place}, {kind}"), is_camera, growth }
    }

    /// Returns `true` if the test finds the noise of a depth camera.
    pub fn is_found(&self) -> bool {
        self.growth.is_some_and(|growth| growth.is_correlated())
    }
}

/// Views of models of a set and the models themselves, clean and with noise of many kinds.
pub fn sightings(set: Set) -> Result<Vec<Sighting>> {
    let families = Family::ALL.iter().copied().filter(|f| f.set() == set);
    let jobs: Vec<(Family, u64)> =
        families.flat_map(|family| (0..VIEWS).map(move |k| (family, k))).collect();
    let found: Result<Vec<Vec<Sighting>>> =
        jobs.into_par_iter().with_max_len(1).map(|(family, k)| of_model(family, k)).collect();
    Ok(found?.into_iter().flatten().collect())
}

fn of_model(family: Family, k: u64) -> Result<Vec<Sighting>> {
    let seed = SEEDS + 100 * family as u64 + k;
    let pick = |count: usize| k as usize % count;
    let mut all = vec![];
    let mut add = |place: &str, truth: &TriMesh, noise: NoiseKind, level: f64| -> Result<()> {
        let noisy = add_noise(truth, noise, NoiseLevel::EdgeLengths(level), seed)?;
        all.push(Sighting::new(place, Some(noise), &noisy));
        Ok(())
    };
    let scan = view(&family.mesh(20_000, Triangulation::Regular, seed), SIZES[pick(3)], seed)?;
    for (noise, levels) in ON_SCANS {
        let noise = noise.with_camera(scan.camera).unwrap_or(noise);
        add("scan", &scan.mesh, noise, levels[pick(levels.len())])?;
    }
    let mut models = vec![];
    for (i, faces) in FACES.into_iter().enumerate() {
        let model = family.mesh(faces, Triangulation::ALL[(k as usize + i) % 4], seed);
        for (noise, levels) in ON_MODELS {
            add("model", &model, noise, levels[(k as usize + i) % levels.len()])?;
        }
        models.push(model);
    }
    all.push(Sighting::new("scan", None, &scan.mesh));
    all.extend(models.iter().map(|model| Sighting::new("model", None, model)));
    Ok(all)
}

/// The weights of the test that are most likely, by logistic regression with a small ridge:
/// Newton's method on the logarithm of the likelihood.
pub fn fitted(all: &[Sighting]) -> Result<[f64; TERMS]> {
    let rows: Vec<([f64; TERMS], f64)> = (all.iter())
        .filter_map(|seen| Some((seen.growth?.terms(), f64::from(u8::from(seen.is_camera)))))
        .collect();
    let mut weights = [0.0; TERMS];
    for _ in 0..STEPS {
        let mut equations = NormalEquations::<TERMS>::default();
        for (row, is_camera) in &rows {
            let score: f64 = row.iter().zip(weights).map(|(x, w)| x * w).sum();
            let score = score.clamp(-15.0, 15.0);
            let likely = 1.0 / (1.0 + libm::exp(-score));
            let weight = likely * (1.0 - likely);
            equations.add(row, score + (is_camera - likely) / weight, weight);
        }
        for k in 0..TERMS {
            let mut row = [0.0; TERMS];
            row[k] = 1.0;
            equations.add(&row, 0.0, RIDGE);
        }
        weights = equations.solve().context("the sightings do not determine the weights")?;
    }
    Ok(weights)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A fit to the sightings of one model tells them apart, and the test finds the same.
    #[test]
    fn depth_cameras_are_told_apart() {
        let all = of_model(Family::Stairs, 2).unwrap();
        let measured: Vec<&Sighting> = all.iter().filter(|seen| seen.growth.is_some()).collect();
        let cameras = measured.iter().filter(|seen| seen.is_camera).count();
        assert!(cameras == 3 && measured.len() > 10, "{cameras} of {}", measured.len());
        let weights = fitted(&all).unwrap();
        for seen in measured {
            let terms = seen.growth.unwrap().terms();
            let score: f64 = terms.iter().zip(weights).map(|(x, w)| x * w).sum();
            assert_eq!(score > 0.0, seen.is_camera, "{}: {score}", seen.kind);
            assert_eq!(seen.is_found(), seen.is_camera, "{}", seen.kind);
        }
    }
}
