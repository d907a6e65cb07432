//! Meshes with fixed vertices.

use std::borrow::Cow;

use fairing_mesh::TriMesh;
use fairing_parameters::ParameterError;

use super::error::DenoiseError;

/// A mesh with the vertices that a denoiser must not move.
///
/// Every denoiser takes a `Masked` mesh, or a plain mesh, all of whose vertices may move. Fixed
/// vertices keep the bits of their positions in every step. Fixed vertices still count as noisy:
/// the normals of their faces are estimated like all others, and the vertices beside them move to
/// fit these normals. The noise level is measured at the vertices that may move, and so is the
/// distance of the result from the noisy mesh.
///
/// # Examples
///
/// ```
/// use fairing_denoising::{Denoiser, Masked};
///
/// let noisy = fairing_shapes::jittered(&fairing_shapes::icosphere(3), 0.1, 7, |p| p);
/// let below: Vec<bool> = noisy.positions().iter().map(|p| p[2] < 0.0).collect();
/// let half = Denoiser::by_name("guided-normal")?.denoise(Masked::new(&noisy, &below)?)?;
/// for (v, &fixed) in below.iter().enumerate() {
///     assert_eq!(half.positions()[v] == noisy.positions()[v], fixed);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Masked<'a> {
    mesh: &'a TriMesh,
    /// A flag for each vertex; empty if none is fixed.
    fixed: &'a [bool],
}

impl<'a> Masked<'a> {
    /// A mesh with a flag for each vertex, `true` for a fixed one.
    ///
    /// # Errors
    ///
    /// [`ParameterError`] if there is not one flag per vertex.
    pub fn new(mesh: &'a TriMesh, fixed: &'a [bool]) -> Result<Self, ParameterError> {
        let one_each = fixed.len() == mesh.vertex_count();
        let (count, expected) = (fixed.len() as f64, "the number of vertices");
        ParameterError::require(one_each, "number of flags of fixed vertices", count, expected)?;
        Ok(Self { mesh, fixed })
    }

    /// The mesh.
    pub fn mesh(self) -> &'a TriMesh {
        self.mesh
    }

    /// Returns `true` if vertex `v` is fixed.
    #[inline]
    pub fn is_fixed(self, v: usize) -> bool {
        self.fixed.get(v) == Some(&true)
    }

    /// Another mesh of the same vertices, with these fixed.
    pub(crate) fn on<'b>(self, mesh: &'b TriMesh) -> Masked<'b>
    where
        'a: 'b,
    {
        Masked { mesh, fixed: self.fixed }
    }
}

/// A mesh without fixed vertices.
impl<'a> From<&'a TriMesh> for Masked<'a> {
    fn from(mesh: &'a TriMesh) -> Self {
        Self { mesh, fixed: &[] }
    }
}

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
