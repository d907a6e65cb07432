//! Displacements that do not follow the surface.

use glam::DVec3;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::kind::NoiseKind;
use crate::normal::standard_normal;

/// A displacement for σ = 1 that does not follow the surface.
pub(super) fn in_space(kind: NoiseKind, rng: &mut ChaCha8Rng) -> DVec3 {
    match kind {
        NoiseKind::GaussianPerAxis => std::array::from_fn(|_| standard_normal(rng)).into(),
        NoiseKind::UniformPerAxis => std::array::from_fn(|_| rng.random_range(-1.0..=1.0)).into(),
        NoiseKind::Impulsive { fraction } => {
            let moved = rng.random::<f64>() < fraction;
            let direction = direction(rng);
            (if moved { standard_normal(rng) } else { 0.0 }) * direction
        }
        _ => {
            let direction = direction(rng);
            standard_normal(rng) * direction
        }
    }
}

/// A unit vector, all directions equally likely: by the area of the sphere
/// between two heights, which depends on their difference only.
fn direction(rng: &mut ChaCha8Rng) -> DVec3 {
    let z: f64 = rng.random_range(-1.0..=1.0);
    let (s, c) = libm::sincos(rng.random_range(0.0..std::f64::consts::TAU));
    let r = (1.0 - z * z).sqrt();
    let d = DVec3::new(r * c, r * s, z);
    debug_assert!((d.length() - 1.0).abs() < 1e-12);
    d
}
