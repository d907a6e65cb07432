//! Denoising of a mesh in the form that all methods expect.

use std::borrow::Cow;

use fairing_mesh::TriMesh;

use super::DenoiseError;
use super::rebuild::rebuild;

/// Denoises the [oriented](TriMesh::oriented) mesh [at unit scale](TriMesh::at_unit_scale), and
/// gives the result the faces and the scale of the input. A vertex that does not move keeps its
/// position to the last bit. Refuses a mesh whose faces share no corners.
pub(crate) fn at_unit_scale(
    mesh: &TriMesh,
    denoise: impl FnOnce(&TriMesh) -> Result<TriMesh, DenoiseError>,
) -> Result<TriMesh, DenoiseError> {
    if mesh.is_unwelded() {
        let (vertices, seams) = (mesh.vertex_count(), mesh.seam_vertices());
        return Err(DenoiseError::Unwelded { seams, vertices });
    }
    let oriented = mesh.oriented();
    let (scaled, unit) = oriented.at_unit_scale();
    let denoised = denoise(&scaled)?;
    if unit == 1.0 {
        return match oriented {
            Cow::Borrowed(_) => Ok(denoised),
            Cow::Owned(_) => rebuild(mesh, denoised.into_positions()),
        };
    }
    let moved = scaled.positions().iter().zip(denoised.positions());
    let positions = mesh.positions().iter().zip(moved);
    let back = positions.map(|(&p, (old, new))| if old == new { p } else { new.map(|x| x * unit) });
    rebuild(mesh, back.collect())
}
