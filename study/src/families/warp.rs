//! Stretched and sheared models.

use std::f64::consts::TAU;

use fairing_mesh::{BuildError, TriMesh};
use glam::DVec3;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::build::Proportions;

/// The largest factor of a stretch; its inverse is the least.
const STRETCH: f64 = 2.0;

/// The fraction of meshes that get a relief.
const RELIEF: f64 = 1.0 / 3.0;

/// The mesh, stretched along three directions at random and sheared a few times along waves, and
/// in a third of all cases also along the plateaus and valleys of a random relief with flanks a few
/// edges wide. No shear folds space over. The faces stay, so that creases are lines of edges as
/// before; planes become curved, curved faces flatter or rounder, and each model gets details
/// that its family does not have. A mesh whose edges have no length is only stretched.
pub fn warped(mesh: &TriMesh, seed: u64) -> Result<TriMesh, BuildError> {
    let mut random = Proportions(ChaCha8Rng::seed_from_u64(seed));
    let axes = random.axes();
    let most = libm::log(STRETCH);
    let factors = [(); 3].map(|()| libm::exp(random.between(-most, most)));
    let mut positions: Vec<DVec3> = (mesh.positions().iter())
        .map(|&p| DVec3::from(p))
        .map(|p| {
            (axes.iter().zip(factors)).fold(DVec3::ZERO, |sum, (a, f)| sum + *a * (f * a.dot(p)))
        })
        .collect();
    let stretched = mesh.with_positions(arrays(&positions))?;
    let (h, size) = (stretched.mean_edge_length(), stretched.diagonal());
    if !h.is_normal() {
        return Ok(stretched);
    }
    for _ in 0..random.count(0, 3) {
        let length = random.log_between(5.0 * h, 0.6 * size);
        let wave = Shear::new(&mut random, 1, length);
        let height = random.between(0.0, 0.8) * length / TAU;
        wave.apply(&mut positions, |t| height * t);
    }
    if random.between(0.0, 1.0) < RELIEF {
        for _ in 0..random.count(1, 2) {
            let length = random.log_between(7.0 * h, 30.0 * h);
            let flank = random.between(1.5 * h, (0.2 * length).max(2.5 * h));
            let relief = Shear::new(&mut random, 3, length);
            let height = random.between(0.3, 1.5) * flank;
            // Half of the way up within `flank` of the middle of a flank.
            let width = TAU / length * flank;
            relief.apply(&mut positions, |t| height * t / (t * t + width * width).sqrt());
        }
    }
    mesh.with_positions(arrays(&positions))
}

/// Positions as meshes take them.
fn arrays(positions: &[DVec3]) -> Vec<[f64; 3]> {
    positions.iter().map(DVec3::to_array).collect()
}

/// A displacement along one direction by a function of the coordinates across it.
struct Shear {
    along: DVec3,
    /// Wave vectors across it, and phases.
    waves: Vec<(DVec3, f64)>,
}

impl Shear {
    /// By a sum of waves of about this length.
    fn new(random: &mut Proportions, waves: usize, length: f64) -> Self {
        let along = random.direction();
        let mut wave = || {
            let across = loop {
                let d = random.direction();
                let d = d - (along * d.dot(along));
                if d.length() > 0.1 {
                    break d * (1.0 / d.length());
                }
            };
            let frequency = TAU / (length * random.between(0.8, 1.25));
            (across * frequency, random.between(0.0, TAU))
        };
        Self { along, waves: (0..waves).map(|_| wave()).collect() }
    }

    fn apply(&self, positions: &mut [DVec3], height: impl Fn(f64) -> f64) {
        for p in positions {
            let sum: f64 = self.waves.iter().map(|(k, phase)| libm::sin(k.dot(*p) + phase)).sum();
            *p += self.along * height(sum);
        }
    }
}
