//! Denoising of a mesh whose faces agree in orientation.

use std::borrow::Cow;

use fairing_mesh::TriMesh;

use super::{DenoiseError, Masked};

/// Denoises the [oriented](TriMesh::oriented) mesh and gives the result the faces of the input.
///
/// # Errors
///
/// [`DenoiseError::Unwelded`] for a mesh whose faces share no corners, and those of `denoise`.
pub(crate) fn on_oriented(
    input: Masked<'_>,
    denoise: impl FnOnce(Masked<'_>) -> Result<TriMesh, DenoiseError>,
) -> Result<TriMesh, DenoiseError> {
    let mesh = input.mesh();
    if mesh.is_unwelded() {
        let (vertices, seams) = (mesh.vertex_count(), mesh.seam_vertices());
        return Err(DenoiseError::Unwelded { seams, vertices });
    }
    let oriented = mesh.oriented();
    let denoised = denoise(input.on(&oriented))?;
    match oriented {
        Cow::Borrowed(_) => Ok(denoised),
        Cow::Owned(_) => Ok(mesh.with_positions(denoised.into_positions())?),
    }
}
