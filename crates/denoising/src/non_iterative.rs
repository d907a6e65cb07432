//! Non-iterative, feature-preserving smoothing.

use std::f64::consts::LOG2_E;

use fairing_mesh::TriMesh;
use fairing_parameters::{Options, Range};
use glam::DVec3;
use rayon::prelude::*;

use super::error::DenoiseError;
use super::faces::{FaceLists, FaceShapes, Marks, search};
use super::masked::{Masked, on_oriented};

fairing_parameters::options! {
    /// Options of [`non_iterative`].
    #[derive(Debug, Clone, Copy, PartialEq)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    #[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
    pub struct NonIterativeOptions {
        /// The spatial scale; faces within twice this distance count.
        pub spatial: f64 = 2.0, in Range::POSITIVE, unit "mean edge lengths";
        /// The scale of the distance between a vertex and its prediction.
        pub influence: f64 = 0.5, in Range::POSITIVE, unit "mean edge lengths";
    }
    "non-iterative": "robust averages of predictions from nearby faces (Jones et al. 2003)", ["jones2003"];
}

/// Denoises in one pass: robust averages of the predictions that nearby faces
/// make for a vertex.
///
/// Face q, with centroid c, area A and mollified normal n, predicts for vertex
/// p the foot Π(p) = p + n (n·(c − p)) on its plane, and
///
/// ```text
/// p′ = Σ A f g Π(p) / Σ A f g,   f = exp(−‖p − c‖²/2σ_f²),  g = exp(−‖Π(p) − p‖²/2σ_g²)
/// ```
///
/// The mollified normals are those of the mesh whose vertices are moved to the
/// averages Σ A f c / Σ A f of centroids at the scale σ_f/2, as in the source.
/// Faces are reached through shared vertices within 2 σ_f of the vertex.
///
/// # Errors
///
/// [`DenoiseError::Option`] for a scale that is not positive.
///
/// Source: [jones2003].
///
/// [jones2003]: https://doi.org/10.1145/1201775.882367
pub fn non_iterative<'a>(
    mesh: impl Into<Masked<'a>>,
    options: &NonIterativeOptions,
) -> Result<TriMesh, DenoiseError> {
    on_oriented(mesh.into(), |mesh| filter(mesh, options))
}

fn filter(input: Masked<'_>, options: &NonIterativeOptions) -> Result<TriMesh, DenoiseError> {
    let mesh = input.mesh();
    options.check()?;
    let h = mesh.mean_edge_length();
    let (spatial, influence) = (options.spatial * h, options.influence * h);
    let shapes = FaceShapes::new(mesh);
    let rings = FaceLists::rings(mesh);
    // Only normals are taken from this mesh, so that fixed vertices move with it.
    let mollified = average(mesh.into(), &rings, &shapes, 0.5 * spatial, |_, c, _| Some((c, 1.0)))?;
    let normals = FaceShapes::new(&mollified).normals;
    let b = -0.5 * LOG2_E / (influence * influence).max(f64::MIN_POSITIVE);
    average(input, &rings, &shapes, spatial, |p, c, f| {
        let normal = normals[f];
        let height = normal.dot(c - p);
        Some((p + height * normal, libm::exp2(b * height * height)))
            .filter(|_| normal != DVec3::ZERO)
    })
}

/// Moves each vertex p to the average of `predict(p, centroid, face)`, a
/// position and a weight that multiplies `A exp(−‖p − c‖²/2 spatial²)`.
fn average(
    input: Masked<'_>,
    rings: &FaceLists,
    shapes: &FaceShapes,
    spatial: f64,
    predict: impl Fn(DVec3, DVec3, usize) -> Option<(DVec3, f64)> + Sync,
) -> Result<TriMesh, DenoiseError> {
    let mesh = input.mesh();
    let a = -0.5 * LOG2_E / (spatial * spatial).max(f64::MIN_POSITIVE);
    let positions = (0..mesh.vertex_count())
        .into_par_iter()
        .map_init(
            || (vec![], Marks::new(mesh.face_count())),
            |(near, marks), v| {
                if input.is_fixed(v) {
                    return mesh.positions()[v];
                }
                let p = DVec3::from(mesh.positions()[v]);
                near.clear();
                marks.clear();
                near.extend(mesh.incidence().corners(v as u32).iter().map(|c| c / 3));
                near.iter().for_each(|&f| {
                    marks.insert(f);
                });
                let near_enough = |g: u32| p.distance(shapes.centroids[g as usize]) < 2.0 * spatial;
                search(near, |f| rings.row(f as usize), |g| near_enough(g) && marks.insert(g));
                let (mut sum, mut total) = (DVec3::ZERO, 0.0);
                for &f in near.iter() {
                    let f = f as usize;
                    let c = shapes.centroids[f];
                    let Some((q, w)) = predict(p, c, f) else { continue };
                    let d = p.distance(c);
                    let w = w * shapes.areas[f] * libm::exp2(a * d * d);
                    sum += w * (q - p);
                    total += w;
                }
                (if total > 0.0 { p + sum * (1.0 / total) } else { p }).to_array()
            },
        )
        .collect();
    Ok(mesh.with_positions(positions)?)
}
