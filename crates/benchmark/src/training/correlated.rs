//! Noisy open surfaces with their truth, to train the networks for correlated noise on: views of
//! models by a camera, and models of which a part is cut off.

use anyhow::Result;
use fairing_evaluation::{NoiseKind, NoiseLevel, add_noise};
use rayon::prelude::*;

use super::TrainingPair;
use super::pairs::{Source, draw, faces, sources};
use crate::cases::view;
use crate::families::{Triangulation, cut, detailed};

/// The kinds of noise on parts of models, and the largest level of each.
const ON_PARTS: [(NoiseKind, f64); 9] = [
    (NoiseKind::Correlated { length: 2.0 }, 0.35),
    (NoiseKind::Fused { length: 8.0 }, 0.8),
    (NoiseKind::GaussianAlongNormals, WEAK),
    (NoiseKind::Correlated { length: 1.5 }, 0.4),
    (NoiseKind::Fused { length: 5.0 }, 0.5),
    (NoiseKind::GaussianAlongNormals, 0.15),
    (NoiseKind::Correlated { length: 3.0 }, 0.3),
    (NoiseKind::Fused { length: 15.0 }, 1.2),
    (NoiseKind::Correlated { length: 1.5 }, WEAK),
];

/// The same on views; the camera is that of the view.
const ON_VIEWS: [(NoiseKind, f64); 11] = [
    (NoiseKind::DepthCamera { camera: None, length: 5.0 }, 1.2),
    (NoiseKind::Fused { length: 8.0 }, 0.8),
    (NoiseKind::GaussianAlongNormals, WEAK),
    (NoiseKind::Correlated { length: 2.0 }, 0.35),
    (NoiseKind::Correlated { length: 1.5 }, WEAK),
    (NoiseKind::Fused { length: 5.0 }, 0.5),
    (NoiseKind::DepthCamera { camera: None, length: 3.0 }, 1.0),
    (NoiseKind::Rays { camera: None }, WEAK),
    (NoiseKind::Fused { length: 15.0 }, 1.2),
    (NoiseKind::Correlated { length: 1.5 }, 0.4),
    (NoiseKind::Fused { length: 25.0 }, 2.0),
];

/// The largest level of weak noise; the least is a hundredth of it.
const WEAK: f64 = 0.04;

/// The fraction of models that get details: under weak noise, and otherwise.
const DETAILED: [f64; 2] = [0.5, 0.2];

/// The pixels of views.
const SIZES: [[u32; 2]; 3] = [[110, 82], [160, 120], [80, 60]];

/// The number of faces of the models of views.
const SEEN_FACES: usize = 20_000;

/// Seeds of parts and of views are larger by this than those of whole models.
const SEEDS: [u64; 2] = [10_000_000, 20_000_000];

/// Noisy parts and views of models, half as many each as there are whole models of a source. Some
/// have weak independent noise: details of a clean surface are correlated, too.
pub fn correlated_pairs(models: u64) -> Result<Vec<TrainingPair>> {
    let mut jobs = vec![];
    for (source, seeds) in sources(models / 2) {
        for (is_view, larger) in [(false, SEEDS[0]), (true, SEEDS[1])] {
            // Shapes of no set are seen in parts only.
            if !(is_view && matches!(source, Source::Shape(_))) {
                jobs.extend(seeds.clone().map(|k| Job { source, is_view, seed: larger + k }));
            }
        }
    }
    jobs.into_par_iter().map(Job::pair).collect()
}

/// An open surface to make.
struct Job {
    source: Source,
    /// It is what a camera sees; else what is on one side of a plane.
    is_view: bool,
    seed: u64,
}

impl Job {
    fn pair(self) -> Result<TrainingPair> {
        let Self { source, is_view, seed } = self;
        let draw = |salt: u64| draw(seed, salt);
        let drawn = (seed / 4 + seed) as usize;
        let (triangulation, (mut kind, most), faces) = match is_view {
            true => (Triangulation::Regular, ON_VIEWS[drawn % ON_VIEWS.len()], SEEN_FACES),
            false => {
                let triangulation = Triangulation::ALL[(seed % 4) as usize];
                (triangulation, ON_PARTS[drawn % ON_PARTS.len()], faces(seed))
            }
        };
        let most = source.most(most, triangulation);
        let is_weak = most <= WEAK;
        let weak = |salt: u64| WEAK * libm::pow(0.01, draw(salt));
        let mut level = if is_weak { weak(1) } else { WEAK + (most - WEAK) * draw(1) };
        let mut truth = source.model(faces, triangulation, seed)?;
        if draw(5) < DETAILED[usize::from(!is_weak)] {
            truth = detailed(&truth, seed)?;
        }
        if is_view {
            let seen = view(&truth, SIZES[(3.0 * draw(6)) as usize], seed)?;
            kind = kind.with_camera(seen.camera).unwrap_or(kind);
            truth = seen.mesh;
        } else {
            truth = cut(&truth, seed)?;
        }
        // Waves of all lengths, as high as they are long.
        let stretch = libm::pow(3.0, draw(8) - 0.5);
        match &mut kind {
            NoiseKind::DepthCamera { length, .. } => *length *= stretch,
            NoiseKind::Fused { length } => {
                *length *= stretch;
                level *= stretch;
            }
            _ => {}
        }
        let mut noisy = add_noise(&truth, kind, NoiseLevel::EdgeLengths(level), seed)?;
        if let NoiseKind::Fused { .. } = kind
            && draw(9) < 0.5
        {
            let fine = NoiseLevel::EdgeLengths(weak(10));
            noisy = add_noise(&noisy, NoiseKind::GaussianAlongNormals, fine, seed)?;
        }
        Ok(TrainingPair { noisy, truth })
    }
}
