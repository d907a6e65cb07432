//! Fast and effective feature-preserving denoising.

use fairing_mesh::TriMesh;
use fairing_parameters::Options;
use fairing_watch::parallel;

use super::error::DenoiseError;
use super::faces::{FaceLists, FaceShapes};
use super::masked::{Masked, on_oriented};
use super::vertex_update::follow_normals;

fairing_parameters::options! {
    /// Options of [`fast_effective`].
    #[derive(Debug, Clone, Copy, PartialEq)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    #[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
    pub struct FastEffectiveOptions {
        /// The cosine of the angle between normals below which they have no weight on each other.
        pub threshold: f64 = 0.5, in -1.0..1.0;
        /// Rounds of normal filtering.
        pub iterations: usize = 20;
        /// Vertex updates at the end.
        pub vertex_steps: usize = 50;
    }
    "fast-effective": "thresholded averages of normals (Sun et al. 2007)", ["sun2007"];
}

/// Denoises by weighted averages of face normals with a cut-off.
///
/// Over face i and the faces j that share a vertex with it,
///
/// ```text
/// nᵢ ← normalise Σⱼ max(0, nᵢ·nⱼ − T)² nⱼ
/// ```
///
/// then the vertices follow ([`update_vertices`](super::update_vertices)).
///
/// # Errors
///
/// [`DenoiseError::Option`] for a threshold outside `[−1, 1)`.
///
/// Source: [sun2007].
///
/// [sun2007]: https://doi.org/10.1109/TVCG.2007.1065
pub fn fast_effective<'a>(
    mesh: impl Into<Masked<'a>>,
    options: &FastEffectiveOptions,
) -> Result<TriMesh, DenoiseError> {
    on_oriented(mesh.into(), |mesh| filter(mesh, options))
}

fn filter(input: Masked<'_>, options: &FastEffectiveOptions) -> Result<TriMesh, DenoiseError> {
    let mesh = input.mesh();
    options.check()?;
    let threshold = options.threshold;
    let rings = FaceLists::rings(mesh);
    let mut normals = FaceShapes::new(mesh).normals;
    fairing_watch::stage("rounds", options.iterations as u64);
    for _ in 0..options.iterations {
        fairing_watch::advance(1);
        normals = parallel::map(normals.len(), 64, |f| {
            let own = normals[f];
            let start = (1.0 - threshold).powi(2) * own;
            let sum = rings.row(f).iter().fold(start, |sum, &g| {
                let n = normals[g as usize];
                let w = (own.dot(n) - threshold).max(0.0);
                sum + w * w * n
            });
            sum.normalize_or_zero()
        });
    }
    follow_normals(input, &normals, options.vertex_steps)
}
