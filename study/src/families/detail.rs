//! Models with details.

use std::f64::consts::TAU;

use fairing_mesh::{BuildError, TriMesh};
use fairing_operators::{NormalWeight, weighted_vertex_normals};
use glam::DVec3;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::build::Proportions;

/// The waves that a field is the sum of.
const WAVES: usize = 12;

/// The mesh with bumps, ridges, plateaus or dents along its normals, everywhere or on a part of it,
/// like those of scanned objects: one to three layers, each of half the length of the one before,
/// the longest from 6 to 60 edges. A mesh whose edges have no length stays as it is.
pub fn detailed(mesh: &TriMesh, seed: u64) -> Result<TriMesh, BuildError> {
    let mut random = Proportions(ChaCha8Rng::seed_from_u64(seed ^ 0xde7a11));
    let h = mesh.mean_edge_length();
    if !h.is_normal() {
        return Ok(mesh.clone());
    }
    let longest = random.log_between(6.0, 60.0) * h;
    let slope = random.log_between(0.05, 0.6);
    let fall = random.between(0.7, 1.3);
    let part = Field::new(&mut random, 2.5 * longest);
    let threshold = random.between(-1.5, 0.5);
    let layers: Vec<(Field, Profile, f64)> = (0..random.count(1, 3))
        .map(|k| {
            let length = libm::pow(0.5, f64::from(k)) * longest;
            let profile = Profile::ALL[random.count(0, 3) as usize];
            let height = slope * libm::pow(fall, f64::from(k)) * length / TAU;
            let sign = if random.count(0, 1) == 0 { -1.0 } else { 1.0 };
            (Field::new(&mut random, length), profile, sign * height)
        })
        .collect();
    let moved = mesh.positions().iter().zip(weighted_vertex_normals(mesh, NormalWeight::Area)).map(
        |(&p, n)| {
            let p = DVec3::from(p);
            let share = (2.0 * (part.at(p) - threshold)).clamp(0.0, 1.0);
            let height: f64 =
                layers.iter().map(|(field, f, height)| height * f.of(field.at(p))).sum();
            (p + share * height * DVec3::from(n)).to_array()
        },
    );
    mesh.with_positions(moved.collect())
}

/// A sum of waves of random directions and about one length: mean zero, variance one.
struct Field(Vec<(DVec3, f64)>);

impl Field {
    fn new(random: &mut Proportions, length: f64) -> Self {
        let mut wave = || {
            let frequency = TAU / (length * random.between(0.7, 1.4));
            (frequency * random.direction(), random.between(0.0, TAU))
        };
        Self((0..WAVES).map(|_| wave()).collect())
    }

    fn at(&self, p: DVec3) -> f64 {
        let sum: f64 = self.0.iter().map(|(k, phase)| libm::sin(k.dot(p) + phase)).sum();
        sum * (2.0 / WAVES as f64).sqrt()
    }
}

/// The section of a detail.
#[derive(Clone, Copy)]
enum Profile {
    /// The field itself.
    Waves,
    /// Its absolute value: round hills between sharp valleys.
    Ridges,
    /// Steep between two levels.
    Plateaus,
    /// Its positive part: single bumps.
    Bumps,
}

impl Profile {
    const ALL: [Self; 4] = [Self::Waves, Self::Ridges, Self::Plateaus, Self::Bumps];

    fn of(self, x: f64) -> f64 {
        match self {
            Self::Waves => x,
            Self::Ridges => x.abs(),
            Self::Plateaus => 0.6 * x / (x * x + 0.04).sqrt(),
            Self::Bumps => (x - 0.5).max(0.0),
        }
    }
}
