//! Noisy meshes with their truth to train on: models of the development set, random models, and
//! shapes of no set.

use anyhow::Result;
use fairing_evaluation::{NoiseKind, NoiseLevel, add_noise};
use fairing_mesh::TriMesh;
use fairing_shapes as shapes;
use rayon::prelude::*;

use super::TrainingPair;
use crate::cases::unit;
use crate::families::{Family, RandomModel, Set, Triangulation, warped};

/// The kinds of noise, and the largest level of each.
const NOISE: [(NoiseKind, f64); 10] = [
    (NoiseKind::GaussianAlongNormals, 0.8),
    (NoiseKind::GaussianPerAxis, 0.35),
    (NoiseKind::GaussianAlongNormals, 0.4),
    (NoiseKind::Correlated { length: 2.0 }, 0.35),
    (NoiseKind::Impulsive { fraction: 0.25 }, 0.8),
    (NoiseKind::Varying, 0.45),
    (NoiseKind::Correlated { length: 1.5 }, 0.4),
    (NoiseKind::GaussianAlongDirections, 0.5),
    (NoiseKind::Impulsive { fraction: 0.6 }, 0.6),
    (NoiseKind::Correlated { length: 3.0 }, 0.3),
];

/// The fraction of models that are warped.
const WARPED: f64 = 0.5;

/// Seeds from here on belong to no case of the benchmark.
const SEEDS: u64 = 1_000_000;

/// Noisy models of the families of the development set, random models, and shapes of no set.
pub fn training_pairs(models: u64) -> Result<Vec<TrainingPair>> {
    let families = Family::ALL.iter().copied().filter(|f| f.set() == Set::Development);
    let mut jobs: Vec<(Source, u64)> = vec![];
    for (i, family) in families.enumerate() {
        for k in 0..models {
            let seed = SEEDS + 1000 * i as u64 + k;
            jobs.push((Source::Family(family), seed));
        }
    }
    for shape in 0..SHAPES {
        for k in 0..models / 2 {
            jobs.push((Source::Shape(shape), SEEDS + 1000 * (50 + shape as u64) + k));
        }
    }
    for (i, &model) in RandomModel::ALL.iter().enumerate() {
        for k in 0..models * 3 / 2 {
            jobs.push((Source::Random(model), SEEDS + 100_000 * (i as u64 + 1) + k));
        }
    }
    jobs.into_par_iter().map(|(source, seed)| source.pair(seed)).collect()
}

/// The origin of the model of a pair.
#[derive(Clone, Copy)]
enum Source {
    Family(Family),
    Random(RandomModel),
    Shape(usize),
}

/// The number of shapes outside of the families.
const SHAPES: usize = 6;

impl Source {
    fn pair(self, seed: u64) -> Result<TrainingPair> {
        let draw = |salt: u64| unit(seed.wrapping_mul(31).wrapping_add(salt));
        let triangulation = Triangulation::ALL[(seed % 4) as usize];
        let (kind, most) = NOISE[((seed / 4 + seed) % 10) as usize];
        let most: f64 = match (self, triangulation) {
            (Self::Shape(_), _) => most,
            (_, Triangulation::Anisotropic) => most.min(0.3),
            (_, Triangulation::Graded) => most.min(0.4),
            _ => most,
        };
        let level = 0.04 + (most - 0.04) * draw(1);
        let faces = [2200, 3000, 4000, 9000, 16_000][(5.0 * draw(2)) as usize];
        let truth = match self {
            Self::Family(family) => family.mesh(faces, triangulation, seed),
            Self::Random(model) => model.mesh(faces, triangulation, seed),
            Self::Shape(k) => shape(k, [draw(2), draw(4)], seed),
        };
        let truth = if draw(3) < WARPED { warped(&truth, seed)? } else { truth };
        let noisy = add_noise(&truth, kind, NoiseLevel::EdgeLengths(level), seed)?;
        Ok(TrainingPair { noisy, truth })
    }
}

/// One of the shapes, in a size that `t` from 0 to 1 decides on.
fn shape(k: usize, [t, u]: [f64; 2], seed: u64) -> TriMesh {
    // Sides of a tube, from a few to many.
    let sides = 9 + (36.0 * t) as u32;
    match k {
        0 => shapes::cad_block(0.08 + 0.08 * t),
        1 => shapes::creature(48 + (30.0 * t) as u32),
        2 => shapes::bumpy_sphere(4, 0.05 + 0.1 * t, 4.0 + 4.0 * u),
        3 => {
            let minor = 0.1 + 0.5 * u;
            let around = f64::from(sides) / minor;
            shapes::torus(1.0, minor, around.clamp(40.0, 200.0) as u32, sides)
        }
        4 => shapes::irregular_plane(0.025 + 0.01 * t, seed),
        _ => {
            let radius = 0.15 + 0.85 * u;
            let along = 2.0 / (std::f64::consts::TAU * radius / f64::from(sides));
            shapes::cylinder(
                radius,
                2.0,
                sides,
                along.clamp(8.0, 80.0) as u32,
                shapes::Ends::Closed,
            )
        }
    }
}
