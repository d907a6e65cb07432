//! Noisy meshes with their truth to train on: models of the development set, random models, and
//! shapes of no set.

use std::ops::Range;

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

/// The numbers of faces of the models.
const FACES: [usize; 5] = [2200, 3000, 4000, 9000, 16_000];

/// Noisy models of the families of the development set, random models, and shapes of no set.
pub fn training_pairs(models: u64) -> Result<Vec<TrainingPair>> {
    let jobs = sources(models).into_iter();
    let jobs: Vec<(Source, u64)> =
        jobs.flat_map(|(source, seeds)| seeds.map(move |seed| (source, seed))).collect();
    jobs.into_par_iter()
        .map(|(source, seed)| {
            let triangulation = Triangulation::ALL[(seed % 4) as usize];
            let (kind, most) = NOISE[((seed / 4 + seed) % 10) as usize];
            let most = source.most(most, triangulation);
            let level = NoiseLevel::EdgeLengths(0.04 + (most - 0.04) * draw(seed, 1));
            let truth = source.model(faces(seed), triangulation, seed)?;
            let noisy = add_noise(&truth, kind, level, seed)?;
            Ok(TrainingPair { noisy, truth })
        })
        .collect()
}

/// Each source, with the seeds of its models.
pub(super) fn sources(models: u64) -> Vec<(Source, Range<u64>)> {
    let from = |first: u64, count: u64| SEEDS + first..SEEDS + first + count;
    let families = Family::ALL.iter().copied().filter(|f| f.set() == Set::Development);
    let families =
        (0..).zip(families).map(|(i, family)| (Source::Family(family), from(1000 * i, models)));
    let shapes = (0..SHAPES).map(|k| (Source::Shape(k), from(1000 * (50 + k), models / 2)));
    let random = (1..).zip(&RandomModel::ALL);
    let random =
        random.map(|(i, &model)| (Source::Random(model), from(100_000 * i, models * 3 / 2)));
    families.chain(shapes).chain(random).collect()
}

/// A number from 0 to 1 for a model.
pub(super) fn draw(seed: u64, salt: u64) -> f64 {
    unit(seed.wrapping_mul(31).wrapping_add(salt))
}

/// The number of faces of a model.
pub(super) fn faces(seed: u64) -> usize {
    FACES[(5.0 * draw(seed, 2)) as usize]
}

/// The origin of a model.
#[derive(Debug, Clone, Copy)]
pub(super) enum Source {
    Family(Family),
    Random(RandomModel),
    Shape(u64),
}

/// The number of shapes outside of the families.
const SHAPES: u64 = 6;

impl Source {
    /// The largest level of noise: less on stretched and graded triangles.
    pub(super) fn most(self, most: f64, triangulation: Triangulation) -> f64 {
        match (self, triangulation) {
            (Self::Shape(_), _) => most,
            (_, Triangulation::Anisotropic) => most.min(0.3),
            (_, Triangulation::Graded) => most.min(0.4),
            _ => most,
        }
    }

    /// A model, in half of the cases warped.
    pub(super) fn model(
        self,
        faces: usize,
        triangulation: Triangulation,
        seed: u64,
    ) -> Result<TriMesh> {
        let model = match self {
            Self::Family(family) => family.mesh(faces, triangulation, seed),
            Self::Random(model) => model.mesh(faces, triangulation, seed),
            Self::Shape(k) => shape(k, [draw(seed, 2), draw(seed, 4)], seed),
        };
        Ok(if draw(seed, 3) < WARPED { warped(&model, seed)? } else { model })
    }
}

/// One of the shapes, in a size that `t` from 0 to 1 decides on.
fn shape(k: u64, [t, u]: [f64; 2], seed: u64) -> TriMesh {
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
