//! A flow that moves nothing.

use fairing_mesh::TriMesh;

use crate::engine::error::FlowError;
use crate::engine::outcome::{Report, Smoothed};
use crate::engine::run::Observer;

fairing_parameters::options! {
    /// Options of [`dummy`].
    #[derive(Debug, Clone, PartialEq)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    #[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
    pub struct Dummy {
        /// The number of steps.
        pub iterations: usize = 10;
    }
    "dummy": "steps that move nothing", ["vollmer1999"];
}

/// Returns the mesh.
///
/// # Errors
///
/// None.
pub fn dummy(
    mesh: &TriMesh,
    options: &Dummy,
    _: Option<&mut Observer<'_>>,
) -> Result<Smoothed, FlowError> {
    let report = Report { iterations: options.iterations, ..Report::default() };
    Ok(Smoothed { mesh: mesh.clone(), report })
}
