//! The mesh as it is.

use fairing_mesh::TriMesh;

use crate::Masked;
use crate::error::DenoiseError;

fairing_parameters::options! {
    /// Options of [`dummy`].
    #[derive(Debug, Clone, Copy, PartialEq)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    #[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
    pub struct DummyOptions {
        /// The number of iterations, which do nothing.
        pub iterations: usize = 3;
    }
    "dummy": "the mesh as it is", ["fleishman2003"];
}

/// Returns the mesh.
///
/// # Errors
///
/// None.
pub fn dummy<'a>(mesh: impl Into<Masked<'a>>, _: &DummyOptions) -> Result<TriMesh, DenoiseError> {
    Ok(mesh.into().mesh().clone())
}
