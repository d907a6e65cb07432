//! A mesh from its faces and new positions.

use fairing_mesh::TriMesh;

use super::DenoiseError;

/// The mesh with other positions; an error instead of infinities.
pub(crate) fn rebuild(mesh: &TriMesh, positions: Vec<[f64; 3]>) -> Result<TriMesh, DenoiseError> {
    let broken = positions.iter().position(|p| p.iter().any(|x| !x.is_finite()));
    mesh.with_positions(positions)
        .map_err(|_| DenoiseError::NonFinite { vertex: broken.unwrap_or(usize::MAX) })
}
