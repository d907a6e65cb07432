//! Seeded noise on vertices, and its level.

mod field;
mod kind;
mod rays;

use fairing_mesh::TriMesh;
use fairing_parameters::Range;
use glam::DVec3;
pub use kind::NoiseKind;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
pub(crate) use rays::camera_and_centre;

use crate::error::EvaluationError;
use crate::normal::standard_normal;

/// Adds noise to the vertices; faces and topology are shared with the input.
///
/// The sequence of random numbers (ChaCha8) does not depend on the level, so for a given seed the
/// displacements are proportional to it, except that [`NoiseKind::DepthCamera`] rounds disparities
/// in steps that depend on the level. Where noise follows the normals, vertices without a normal
/// (isolated ones) stay.
///
/// # Errors
///
/// [`EvaluationError::Option`] for a level that is negative or not finite, or too large for a
/// depth camera (more than about 7 % of the distance), and for parameters of the kind outside
/// their range; [`EvaluationError::NotInFront`] for a vertex at the camera, or behind a depth
/// camera; [`EvaluationError::Positions`] if the moved vertices are not a valid mesh.
///
/// # Examples
///
/// ```
/// use fairing_evaluation::{NoiseKind, NoiseLevel, add_noise};
/// let sphere = fairing_shapes::icosphere(3);
/// let noisy = add_noise(&sphere, NoiseKind::GaussianPerAxis, NoiseLevel::EdgeLengths(0.2), 7)?;
/// assert_eq!(noisy.faces(), sphere.faces());
/// # Ok::<(), fairing_evaluation::EvaluationError>(())
/// ```
pub fn add_noise(
    mesh: &TriMesh,
    kind: NoiseKind,
    level: NoiseLevel,
    seed: u64,
) -> Result<TriMesh, EvaluationError> {
    let sigma = level.in_mesh_units(mesh);
    Range::NOT_NEGATIVE.check("noise level in mesh units", sigma)?;
    kind.check()?;
    let rng = &mut ChaCha8Rng::seed_from_u64(seed);
    // The displacements for a unit of length.
    let (unit, displacements) = match kind {
        NoiseKind::GaussianAlongNormals
        | NoiseKind::Correlated { .. }
        | NoiseKind::Varying
        | NoiseKind::Fused { .. } => (sigma, field::along_normals(mesh, kind, rng)),
        NoiseKind::Rays { camera } => (sigma, rays::along_rays(mesh, camera, rng)?),
        NoiseKind::DepthCamera { camera, length } => {
            (1.0, rays::depth_camera(mesh, camera, length, sigma, rng)?)
        }
        _ => {
            let vertices = 0..mesh.vertex_count();
            (sigma, vertices.map(|_| in_space(kind, rng)).collect())
        }
    };
    let positions = mesh.positions().iter().zip(displacements);
    let positions = positions.map(|(&p, d)| (DVec3::from(p) + unit * d).to_array()).collect();
    mesh.with_positions(positions).map_err(EvaluationError::Positions)
}

/// The noise level σ, in the unit of the variant's name.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum NoiseLevel {
    /// In mesh units.
    Model(f64),
    /// In mean edge lengths h, an edge counted once for each of its faces.
    EdgeLengths(f64),
    /// In diagonals of the bounding box.
    Diagonals(f64),
}

impl NoiseLevel {
    /// The level on this mesh, in mesh units.
    pub fn in_mesh_units(self, mesh: &TriMesh) -> f64 {
        match self {
            Self::Model(sigma) => sigma,
            Self::EdgeLengths(share) => share * mesh.mean_edge_length(),
            Self::Diagonals(share) => share * mesh.diagonal(),
        }
    }
}

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

#[cfg(test)]
mod tests;
