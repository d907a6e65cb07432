//! Seeded noise on vertices.

mod field;
mod independent;
mod kind;
mod level;
mod normals;
mod rays;

use fairing_mesh::TriMesh;
use fairing_parameters::Range;
use glam::DVec3;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use crate::error::EvaluationError;
pub use kind::NoiseKind;
pub use level::NoiseLevel;
pub(crate) use rays::camera_and_centre;

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
        | NoiseKind::Fused { .. } => (sigma, normals::along_normals(mesh, kind, rng)),
        NoiseKind::Rays { camera } => (sigma, rays::along_rays(mesh, camera, rng)?),
        NoiseKind::DepthCamera { camera, length } => {
            (1.0, rays::depth_camera(mesh, camera, length, sigma, rng)?)
        }
        _ => {
            let vertices = 0..mesh.vertex_count();
            (sigma, vertices.map(|_| independent::in_space(kind, rng)).collect())
        }
    };
    let positions = mesh.positions().iter().zip(displacements);
    let positions = positions.map(|(&p, d)| (DVec3::from(p) + unit * d).to_array()).collect();
    mesh.with_positions(positions).map_err(EvaluationError::Positions)
}

#[cfg(test)]
mod tests;
