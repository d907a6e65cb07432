//! Noisy open surfaces with their truth, to train the networks for correlated noise on: views of
//! models by a camera, models of which a part is cut off, and sheets of waves.

use anyhow::Result;
use fairing_denoising::training::is_open;
use fairing_denoising::{NoiseEstimate, noise_level};
use fairing_evaluation::{NoiseKind, NoiseLevel, add_noise};
use rayon::prelude::*;

use super::TrainingPair;
use super::pairs::{Source, draw, faces, sources};
use crate::cases::view;
use crate::families::{RandomModel, Triangulation, cut, detailed};

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
const ON_VIEWS: [(NoiseKind, f64); 9] = [
    (NoiseKind::Fused { length: 8.0 }, 0.8),
    (NoiseKind::GaussianAlongNormals, WEAK),
    (NoiseKind::Correlated { length: 2.0 }, 0.35),
    (NoiseKind::Correlated { length: 1.5 }, WEAK),
    (NoiseKind::Fused { length: 5.0 }, 0.5),
    (NoiseKind::Rays { camera: None }, WEAK),
    (NoiseKind::Fused { length: 15.0 }, 1.2),
    (NoiseKind::Correlated { length: 1.5 }, 0.4),
    (NoiseKind::Fused { length: 25.0 }, 2.0),
];

/// The largest level of weak noise; the least is a hundredth of it.
const WEAK: f64 = 0.04;

/// The least correlation of residuals.
const LEAST: f64 = 0.05;

/// The fraction of models that get details: under weak noise, and otherwise.
const DETAILED: [f64; 2] = [0.5, 0.2];

/// The pixels of views.
const SIZES: [[u32; 2]; 3] = [[110, 82], [160, 120], [80, 60]];

/// The number of faces of the models of views.
const SEEN_FACES: usize = 20_000;

/// Seeds of parts, of views and of sheets are larger by this than those of whole models.
const SEEDS: [u64; 3] = [10_000_000, 20_000_000, 30_000_000];

/// Sheets of waves, over the number of models of a family.
const SHEETS: u64 = 16;

/// Noisy parts and views of models, half as many each as there are whole models of a source, and
/// sheets of waves with independent noise; of all these, the open meshes whose residuals are
/// correlated ([`NoiseEstimate::correlation`]), but not as those of a depth camera. Some have weak
/// independent noise: the residuals of details and of short waves are correlated, too.
pub fn correlated_pairs(models: u64) -> Result<Vec<TrainingPair>> {
    let mut jobs = vec![];
    for (source, seeds) in sources(models / 2) {
        for (sight, larger) in [(Sight::Part, SEEDS[0]), (Sight::View, SEEDS[1])] {
            // Shapes of no set are seen in parts only.
            if !(sight == Sight::View && matches!(source, Source::Shape(_))) {
                jobs.extend(seeds.clone().map(|k| Job { source, sight, seed: larger + k }));
            }
        }
    }
    let source = Source::Random(RandomModel::Swell);
    let sheets = SEEDS[2]..SEEDS[2] + SHEETS * models;
    jobs.extend(sheets.map(|seed| Job { source, sight: Sight::Whole, seed }));
    let pairs: Vec<TrainingPair> = jobs.into_par_iter().map(Job::pair).collect::<Result<_>>()?;
    let is_taken = |TrainingPair { noisy, .. }: &TrainingPair| {
        let is_correlated = |l: NoiseEstimate| l.correlation_length == 0.0 && l.correlation > LEAST;
        is_open(noisy) && noise_level(noisy).is_some_and(is_correlated)
    };
    Ok(pairs.into_par_iter().filter(is_taken).collect())
}

/// The part of a model that is seen.
#[derive(Clone, Copy, PartialEq)]
enum Sight {
    Whole,
    /// The faces on one side of a plane.
    Part,
    /// The depth image of a camera.
    View,
}

/// An open surface to make.
struct Job {
    source: Source,
    sight: Sight,
    seed: u64,
}

impl Job {
    fn pair(self) -> Result<TrainingPair> {
        let Self { source, sight, seed } = self;
        let draw = |salt: u64| draw(seed, salt);
        let drawn = (seed / 4 + seed) as usize;
        let triangulation = match sight {
            Sight::View => Triangulation::Regular,
            _ => Triangulation::ALL[(seed % 4) as usize],
        };
        let ((mut kind, most), faces) = match sight {
            Sight::View => (ON_VIEWS[drawn % ON_VIEWS.len()], SEEN_FACES),
            Sight::Part => (ON_PARTS[drawn % ON_PARTS.len()], faces(seed)),
            Sight::Whole => ((NoiseKind::GaussianAlongNormals, WEAK), faces(seed)),
        };
        let most = source.most(most, triangulation);
        let is_weak = most <= WEAK;
        let weak = |salt: u64| WEAK * libm::pow(0.01, draw(salt));
        let mut level = match sight {
            Sight::Whole => 4.0 * weak(1),
            _ if is_weak => weak(1),
            _ => WEAK + (most - WEAK) * draw(1),
        };
        let mut truth = source.model(faces, triangulation, seed)?;
        if draw(5) < DETAILED[usize::from(!is_weak)] {
            truth = detailed(&truth, seed)?;
        }
        match sight {
            Sight::Whole => {}
            Sight::Part => truth = cut(&truth, seed)?,
            Sight::View => {
                let seen = view(&truth, SIZES[(3.0 * draw(6)) as usize], seed)?;
                kind = kind.with_camera(seen.camera).unwrap_or(kind);
                truth = seen.mesh;
            }
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
