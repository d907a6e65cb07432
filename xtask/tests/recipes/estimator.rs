//! One mean curvature everywhere.

use fairing_mesh::TriMesh;

use super::field::{AtVertex, CurvatureField};

fairing_parameters::options! {
    /// Options of [`dummy_curvature`].
    #[derive(Debug, Clone, Copy, PartialEq)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    #[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
    pub struct DummyOptions {
        /// The mean curvature of every vertex.
        pub mean: f64 = 1.0;
    }
    "dummy": "one curvature everywhere", ["meyer2003"];
}

/// Sets the curvature of every vertex.
pub fn dummy_curvature(mesh: &TriMesh, options: &DummyOptions) -> CurvatureField {
    let at = AtVertex::from_mean_and_gaussian(options.mean, options.mean * options.mean);
    CurvatureField::collect(vec![(Ok(at), false); mesh.vertex_count()], false)
}
