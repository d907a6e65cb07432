//! Denoising at a size whose powers are floats.

use fairing_mesh::TriMesh;

use super::DenoiseError;
use super::rebuild::rebuild;

/// Denoises the mesh [at unit scale](TriMesh::at_unit_scale) and scales the
/// result back. A vertex that does not move keeps its position to the last bit.
pub(crate) fn at_unit_scale(
    mesh: &TriMesh,
    denoise: impl FnOnce(&TriMesh) -> Result<TriMesh, DenoiseError>,
) -> Result<TriMesh, DenoiseError> {
    let (scaled, unit) = mesh.at_unit_scale();
    let denoised = denoise(&scaled)?;
    if unit == 1.0 {
        return Ok(denoised);
    }
    let moved = scaled.positions().iter().zip(denoised.positions());
    let positions = mesh.positions().iter().zip(moved);
    let back = positions.map(|(&p, (old, new))| if old == new { p } else { new.map(|x| x * unit) });
    rebuild(mesh, back.collect())
}
