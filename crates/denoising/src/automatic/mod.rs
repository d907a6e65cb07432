//! Denoising without parameters.

mod creased;
mod follow;
mod local_fits;
mod mumford_shah;
mod parts;
pub(crate) mod regression;
mod relabel;
mod residuals;
mod smooth;
mod thin_plate;
mod unfold;
mod vote;

use fairing_mesh::TriMesh;
use fairing_mesh::vec3::dot;
use fairing_operators::{NoiseEstimate, NoisyParts, noisy_parts};

use super::faces::{FaceLists, FaceShapes, Hinges};
use super::unit_scale::at_unit_scale;
use super::vertex_update::{VertexUpdate, rebuild, update_vertices};
use crate::DenoiseError;
use creased::{denoise_creased, first_labels};
use parts::Part;
use residuals::neighbour_correlation;
use smooth::{Pilot, denoise_smooth};

/// The largest displacement, in noise levels: one Gaussian vertex in two
/// million is moved further by noise.
pub(crate) const LIMIT: f64 = 5.0;

/// Noise below this share of the mean edge length is rounding.
const LEAST_NOISE: f64 = 1e-7;

/// The steps of curved parts, 8° to 25°, and creases, above 25°, as cosines.
const STEP: f64 = 0.990_268;
const CREASE: f64 = 0.906_308;

/// With this share of the faces folded over, normals say nothing about creases:
/// those of a body with creases under noise of 0.7 h along the normals fold less
/// than a hundredth.
const ILLEGIBLE: f64 = 0.03;

/// With more steps than this share of the creases a surface has no creases to
/// speak of: machine parts stay below 0.6, whatever their fillets, and most
/// scans above 0.9.
const STEPS_PER_CREASE: f64 = 0.7;

/// How much more alike the residuals of neighbours may be after the treatment for
/// creases than after smoothing, which follows the noise a little more. Measured
/// are at most 0.08 on bodies with creases, with noise of 0.05 h to 0.7 h, and
/// 0.13 and more where the treatment has put facets on a curved surface.
const ALIKE: f64 = 0.1;

/// Which of its two ways [`automatic`] went.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum SurfaceKind {
    /// Smooth pieces that meet in creases, as designed bodies have them.
    Creased,
    /// Curved all over, as scans are.
    Smooth,
    /// No noise could be measured, and nothing was moved.
    Clean,
}

/// What [`automatic`] returns.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Automatic {
    /// The denoised mesh, with the faces of the input.
    pub mesh: TriMesh,
    /// The estimated noise, of the connected parts with most of it; `None` where
    /// the mesh is too small for one.
    pub noise: Option<NoiseEstimate>,
    /// The kind of surface that these parts were treated as.
    pub kind: SurfaceKind,
}

/// Denoises without parameters: noise level, kind of noise and kind of surface
/// are estimated from the mesh.
///
/// 1. The noise level σ̂ and whether it is impulsive ([`noise_level`](fairing_operators::noise_level)).
/// 2. First labels, normals that jump at creases only: guided normal filtering
///    under Gaussian noise, a Mumford–Shah-like field under impulsive noise;
///    faces on the wrong side of a crease change sides.
/// 3. The kind of surface. Labels of a body with creases differ by next to
///    nothing or by a crease; on a curved surface the same filter leaves steps
///    in between. With more than 0.7 hinges of 8° to 25° for each one above it
///    is smooth. With fewer it is treated both ways, and the residuals tell
///    which was right: they are noise if those of neighbours are independent.
///    If they are more alike after the treatment for creases than after
///    smoothing, that treatment has changed the shape. Where the noise has
///    folded more than three faces in a hundred, creases cannot be told at all,
///    and all surfaces are treated as smooth.
/// 4. Bodies with creases: planes and quadrics are fitted to the noisy
///    vertices within the creases, as large as Lepski's rule allows, vote on
///    the normals, and the vertices follow. Smooth surfaces: thin-plate
///    smoothing, its strength chosen locally by Stein's unbiased risk
///    estimate.
///
/// Connected parts whose noise differs by more than a factor of four are
/// denoised apart ([`noisy_parts`]), each group as a mesh of its own: a clean
/// part does not change, and does not reduce the smoothing of a noisy one.
///
/// No vertex moves further than 5 σ̂. Isolated vertices stay; borders move with
/// their faces; nothing is compared across edges with one, three or more faces
/// or a flip of orientation on bodies with creases. A mesh whose noise level is
/// undefined or below 10⁻⁷ h is returned unchanged. Moves with the mesh under
/// rotation, translation and scaling, up to rounding.
///
/// # Errors
///
/// [`DenoiseError::NotSolved`] or [`DenoiseError::NonFinite`] where numbers
/// leave the range in which the systems can be solved.
pub fn automatic(mesh: &TriMesh) -> Result<Automatic, DenoiseError> {
    let unit = mesh.scale_unit();
    let (mut noise, mut kind) = (None, SurfaceKind::Clean);
    let mesh = at_unit_scale(mesh, |mesh| {
        let result = group_by_group(mesh)?;
        (noise, kind) = (result.noise, result.kind);
        Ok(result.mesh)
    })?;
    let in_mesh_units = |mut noise: NoiseEstimate| {
        noise.sigma *= unit;
        noise
    };
    Ok(Automatic { mesh, noise: noise.map(in_mesh_units), kind })
}

/// [`automatic`] where powers of lengths are floats.
fn group_by_group(mesh: &TriMesh) -> Result<Automatic, DenoiseError> {
    let groups = noisy_parts(mesh);
    match &groups[..] {
        [] => Ok(Automatic { mesh: mesh.clone(), noise: None, kind: SurfaceKind::Clean }),
        [NoisyParts { level, .. }] => denoise_alike(mesh, *level),
        [first, ..] => {
            let (mut positions, mut kind) = (mesh.positions().to_vec(), SurfaceKind::Clean);
            for (i, group) in groups.iter().enumerate() {
                let part = Part::new(mesh, &group.components)?;
                let result = denoise_alike(&part.mesh, group.level)?;
                part.put_back(&result.mesh, &mut positions);
                if i == 0 {
                    kind = result.kind;
                }
            }
            let mesh = rebuild(mesh, positions)?;
            Ok(Automatic { mesh, noise: Some(first.level), kind })
        }
    }
}

/// Denoises a mesh whose noise has one level.
fn denoise_alike(mesh: &TriMesh, level: NoiseEstimate) -> Result<Automatic, DenoiseError> {
    let noise = Some(level);
    if level.sigma <= LEAST_NOISE * mesh.mean_edge_length() {
        return Ok(Automatic { mesh: mesh.clone(), noise, kind: SurfaceKind::Clean });
    }
    let (impulsive, limit) = (level.is_impulsive(), LIMIT * level.sigma);
    let pilot = Pilot::new(mesh, level.sigma, impulsive)?;
    let hinges = Hinges::new(mesh);
    let rings = FaceLists::rings(mesh);
    let labels = match pilot.folded < ILLEGIBLE {
        true => Some(first_labels(mesh, &hinges, &rings, impulsive)?),
        false => None,
    };
    let creased = match labels {
        Some(labels) if steps_per_crease(mesh, &hinges, &labels)? < STEPS_PER_CREASE => {
            let (sigma, rings) = (level.sigma, &rings);
            Some(denoise_creased(mesh, &hinges, rings, labels, sigma, impulsive, limit)?)
        }
        _ => None,
    };
    let smooth = denoise_smooth(mesh, pilot, level.sigma, limit)?;
    if let Some(creased) = creased {
        let [own, other] = [&creased, &smooth].map(|result| neighbour_correlation(mesh, result));
        if own - other < ALIKE {
            return Ok(Automatic { mesh: creased, noise, kind: SurfaceKind::Creased });
        }
    }
    Ok(Automatic { mesh: smooth, noise, kind: SurfaceKind::Smooth })
}

/// The number of hinges of 8° to 25° for each one above, once the vertices have
/// followed the labels; zero if there are none of either.
fn steps_per_crease(
    mesh: &TriMesh,
    hinges: &Hinges,
    labels: &[[f64; 3]],
) -> Result<f64, DenoiseError> {
    let followed = update_vertices(mesh, labels, &VertexUpdate { steps: 60, limit: None })?;
    let normals = FaceShapes::new(&followed).normals;
    let (mut steps, mut creases) = (0usize, 0usize);
    for hinge in &hinges.all {
        let [a, b] = hinge.faces.map(|f| normals[f as usize]);
        let cosine = dot(a, b);
        creases += usize::from(cosine < CREASE);
        steps += usize::from((CREASE..STEP).contains(&cosine));
    }
    Ok(if steps == 0 { 0.0 } else { steps as f64 / creases as f64 })
}
