//! Guided normal filtering.

use std::f64::consts::LOG2_E;

use fairing_mesh::TriMesh;
use fairing_parameters::{Options, Range};
use fairing_watch::parallel;
use glam::DVec3;

use super::error::DenoiseError;
use super::faces::{FaceLists, FaceShapes, Hinges, NO_HINGE, mean_centroid_distance};
use super::masked::{Masked, on_oriented};
use super::vertex_update::follow_normals;

fairing_parameters::options! {
    /// Options of [`guided_normal`].
    ///
    /// The defaults are those of the source.
    #[derive(Debug, Clone, Copy, PartialEq)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    #[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
    pub struct GuidedNormalOptions {
        /// The radius of the neighbourhood.
        pub radius: f64 = 2.0, in Range::POSITIVE, unit "mean distances of neighbouring centroids";
        /// The spatial scale.
        pub spatial: f64 = 1.0, in Range::POSITIVE, unit "mean distances of neighbouring centroids";
        /// The scale of differences between unit normals.
        pub range: f64 = 0.35, in Range::POSITIVE;
        /// Rounds of normal filtering and vertex updates.
        pub iterations: usize = 20;
        /// Vertex updates in each round.
        pub vertex_steps: usize = 10;
    }
    "guided-normal": "bilateral filter of normals guided by patches (Zhang et al. 2015)",
        ["zhang2015"];
}

/// Denoises by a joint bilateral filter of face normals, guided by the most
/// consistent patch around each face.
///
/// A patch is a face with all faces that share a vertex with it. Among the
/// patches that contain face i, the one with the least `H = Φ R` is chosen: Φ
/// is the largest difference between two normals of the patch, R the largest
/// difference across an edge inside it over the sum of these. Its mean normal
/// (weighted by area) is the guidance gᵢ. Then
///
/// ```text
/// nᵢ ← normalise Σⱼ Aⱼ exp(−‖cᵢ − cⱼ‖²/2σ_s²) exp(−‖gᵢ − gⱼ‖²/2σ_r²) nⱼ
/// ```
///
/// over the faces within the radius, and the vertices follow
/// ([`update_vertices`](super::update_vertices)). Nothing is compared across borders, non-manifold
/// edges and flips of orientation; a face without area takes the direction of
/// its neighbours.
///
/// # Errors
///
/// [`DenoiseError::Option`] for a length or scale that is not positive.
///
/// Source: [zhang2015].
///
/// [zhang2015]: https://doi.org/10.1111/cgf.12742
pub fn guided_normal<'a>(
    mesh: impl Into<Masked<'a>>,
    options: &GuidedNormalOptions,
) -> Result<TriMesh, DenoiseError> {
    on_oriented(mesh.into(), |mesh| filter(mesh, options))
}

fn filter(input: Masked<'_>, options: &GuidedNormalOptions) -> Result<TriMesh, DenoiseError> {
    let mesh = input.mesh();
    options.check()?;
    let hinges = Hinges::new(mesh);
    let rings = FaceLists::rings(mesh);
    let shapes = FaceShapes::new(mesh);
    let unit = mean_centroid_distance(&hinges, &shapes.centroids);
    let near = FaceLists::within(&rings, &shapes.centroids, options.radius * unit);
    let mut current = mesh.clone();
    fairing_watch::stage("rounds", options.iterations as u64);
    for _ in 0..options.iterations {
        fairing_watch::advance(1);
        let shapes = FaceShapes::new(&current);
        let guidance = guidance(&hinges, &rings, &shapes);
        let unit = mean_centroid_distance(&hinges, &shapes.centroids);
        let half = -0.5 * LOG2_E;
        let spatial = half / (options.spatial * unit).powi(2).max(f64::MIN_POSITIVE);
        let range = half / options.range.powi(2);
        let normals: Vec<DVec3> = parallel::map(current.face_count(), 64, |f| {
            let weighted = |g: usize, w: f64| w * shapes.normals[g];
            let mut sum = weighted(f, shapes.areas[f]);
            for &g in near.row(f) {
                let g = g as usize;
                let d = shapes.centroids[f].distance(shapes.centroids[g]);
                let t = guidance[f].distance(guidance[g]);
                let w = shapes.areas[g] * libm::exp2(spatial * d * d + range * t * t);
                sum += weighted(g, w);
            }
            sum.normalize_or_zero()
        });
        current = follow_normals(input.on(&current), &normals, options.vertex_steps)?;
    }
    Ok(current)
}

/// The mean normal of the most consistent patch around each face.
fn guidance(hinges: &Hinges, rings: &FaceLists, shapes: &FaceShapes) -> Vec<DVec3> {
    let consistency = |patch: &mut Vec<u32>, f: usize| {
        patch.clear();
        patch.push(f as u32);
        patch.extend_from_slice(rings.row(f));
        patch.sort_unstable();
        patch_consistency(hinges, patch, shapes)
    };
    let patches = parallel::map_with(shapes.areas.len(), 64, Vec::new, consistency);
    parallel::map(shapes.areas.len(), 64, |f| {
        let mut best = patches[f];
        for &g in rings.row(f) {
            let patch = patches[g as usize];
            if patch.0 < best.0 {
                best = patch;
            }
        }
        best.1
    })
}

/// `H = Φ R` and the mean normal of a patch of ascending faces.
fn patch_consistency(hinges: &Hinges, patch: &[u32], shapes: &FaceShapes) -> (f64, DVec3) {
    // Keeps R defined on flat patches, as in the authors' code.
    const FLAT: f64 = 1e-9;
    let normal = |f: u32| shapes.normals[f as usize];
    let mut mean = DVec3::ZERO;
    let mut widest: f64 = 0.0;
    let (mut largest, mut sum): (f64, f64) = (0.0, 0.0);
    for (i, &f) in patch.iter().enumerate() {
        let n = normal(f);
        mean += shapes.areas[f as usize] * n;
        for &g in &patch[..i] {
            widest = widest.max(n.distance(normal(g)));
        }
        for h in hinges.of_face[f as usize] {
            if h == NO_HINGE {
                continue;
            }
            let [a, b] = hinges.all[h as usize].faces;
            // Each inner hinge once, from its lower face.
            if a == f && patch.binary_search(&b).is_ok() {
                let jump = normal(a).distance(normal(b));
                largest = largest.max(jump);
                sum += jump;
            }
        }
    }
    (widest * largest / (FLAT + sum), mean.normalize_or_zero())
}
