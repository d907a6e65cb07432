//! Fast and effective feature-preserving denoising.

use fairing_mesh::TriMesh;
use fairing_mesh::vec3::{add, dot, scale};
use fairing_parameters::{Algorithm, OptionError, Parameter, ParameterError, Values};
use rayon::prelude::*;

use super::DenoiseError;
use super::faces::{FaceLists, FaceShapes, unit_or_zero};
use super::method::Method;
use super::oriented::on_oriented;
use super::vertex_update::{VertexUpdate, update_vertices};

/// Parameters of [`fast_effective`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct FastEffectiveOptions {
    /// The threshold T on the cosine between normals, from −1 to below 1:
    /// faces that differ by more have no weight.
    pub threshold: f64,
    /// Rounds of filtering normals, all before the vertices move.
    pub iterations: usize,
    /// Vertex steps at the end.
    pub vertex_steps: usize,
}

impl Default for FastEffectiveOptions {
    /// T 0.5, 20 rounds, 50 vertex steps.
    fn default() -> Self {
        Self { threshold: 0.5, iterations: 20, vertex_steps: 50 }
    }
}

impl Method for FastEffectiveOptions {
    const ALGORITHM: &'static Algorithm = &Algorithm::new(
        "fast-effective",
        "weighted averages of normals, cut off (Sun et al. 2007)",
        &["sun2007"],
        &[
            Parameter::number(
                "threshold",
                "0.5",
                "The least cosine between normals that see each other",
            ),
            Parameter::count("iterations", "20", "Rounds of filtering normals"),
            Parameter::count("vertex-steps", "50", "Vertex steps at the end"),
        ],
    );

    fn read(&mut self, values: &Values<'_>) -> Result<(), ParameterError> {
        values.read("threshold", &mut self.threshold)?;
        values.read("iterations", &mut self.iterations)?;
        values.read("vertex-steps", &mut self.vertex_steps)
    }

    fn run(&self, mesh: &TriMesh) -> Result<TriMesh, DenoiseError> {
        fast_effective(mesh, self)
    }
}

/// Denoises by weighted averages of face normals with a cut-off.
///
/// Over face i and the faces j that share a vertex with it,
///
/// ```text
/// nᵢ ← normalise Σⱼ max(0, nᵢ·nⱼ − T)² nⱼ
/// ```
///
/// then the vertices follow ([`update_vertices`]).
///
/// # Errors
///
/// [`DenoiseError::Option`] for a threshold outside `[−1, 1)`.
///
/// Source: \[sun2007\].
pub fn fast_effective(
    mesh: &TriMesh,
    options: &FastEffectiveOptions,
) -> Result<TriMesh, DenoiseError> {
    on_oriented(mesh, |mesh| filter(mesh, options))
}

fn filter(mesh: &TriMesh, options: &FastEffectiveOptions) -> Result<TriMesh, DenoiseError> {
    let threshold = options.threshold;
    let between = (-1.0..1.0).contains(&threshold);
    OptionError::require(between, "threshold", threshold, "at least −1 and below 1")?;
    let rings = FaceLists::rings(mesh);
    let mut normals = FaceShapes::new(mesh).normals;
    fairing_watch::stage("rounds", options.iterations as u64);
    for _ in 0..options.iterations {
        fairing_watch::advance(1);
        normals = (0..normals.len())
            .into_par_iter()
            .map(|f| {
                let own = normals[f];
                let start = scale(own, (1.0 - threshold).powi(2));
                let sum = rings.row(f).iter().fold(start, |sum, &g| {
                    let n = normals[g as usize];
                    let w = (dot(own, n) - threshold).max(0.0);
                    add(sum, scale(n, w * w))
                });
                unit_or_zero(sum)
            })
            .collect();
    }
    update_vertices(mesh, &normals, &VertexUpdate { steps: options.vertex_steps, limit: None })
}
