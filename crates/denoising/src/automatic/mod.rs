//! Denoising without parameters.

mod correlation;
mod features;
mod fits;
mod follow;
mod model;
mod network;
mod offset;
mod parts;
mod planes;
mod relabel;
mod safety;
mod spikes;
mod stage;
mod state;
mod surface;
pub mod training;
mod uneven;
mod wide;

use fairing_mesh::TriMesh;
use fairing_mesh::vec3::norm;

use crate::DenoiseError;
use crate::faces::Hinges;
use crate::noise_level::{NoiseEstimate, noisy_parts};
use crate::oriented::on_oriented;
use correlation::variance_of_means;
use model::Model;
use offset::in_the_middle;
use parts::Part;
use planes::{Evidence, flatten};
use relabel::relabel;
use safety::without_flips;
use spikes::without_spikes;
use stage::{advance, blocks};
use state::State;
use surface::face_kinds;
use uneven::uneven_parts;

pub use surface::FaceKind;

/// Noise below this fraction of the mean edge length is rounding.
const LEAST_NOISE: f64 = 1e-7;

/// Vertex steps of the result.
const STEPS: usize = 60;

/// What the surface that [`automatic`] found is like as a whole.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum SurfaceKind {
    /// Its creases are together as long as two diagonals: a designed body.
    Creased,
    /// Curved all over, as scans are, or flat.
    Smooth,
    /// No noise could be measured, and nothing was moved.
    Clean,
    /// The faces are too uneven for their normals to say where vertices belong, and nothing was
    /// moved.
    Uneven,
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
    /// The kind of surface that the result is. Nothing depends on it.
    pub kind: SurfaceKind,
    /// The vertices of connected parts that were left as they are, because their faces are too
    /// uneven. Remeshed, they can be denoised.
    pub uneven_vertices: usize,
    /// What the result is like at each face.
    pub faces: Vec<FaceKind>,
    /// The largest distance that a vertex was allowed to move, in mesh units.
    pub limit: f64,
}

impl Automatic {
    /// The fraction of the area that is of a kind, from 0 to 1; 0 without area.
    pub fn fraction(&self, kind: FaceKind) -> f64 {
        let area = |wanted: &dyn Fn(FaceKind) -> bool| -> f64 {
            let faces = self.faces.iter().enumerate().filter(|(_, k)| wanted(**k));
            faces.map(|(f, _)| norm(self.mesh.area_vector(f))).sum()
        };
        let all = area(&|_| true);
        if all > 0.0 { area(&|k| k == kind) / all } else { 0.0 }
    }
}

fairing_parameters::options! {
    /// [`automatic`] has no options.
    #[derive(Debug, Clone, Copy, PartialEq)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    #[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
    pub struct AutomaticOptions {}
    "automatic": "all estimated from the mesh; creases kept where there are any", [];
}

/// Denoises without parameters: noise level and kind of surface are estimated from
/// the mesh.
///
/// 1. The noise level σ̂ ([`noise_level`](fairing_operators::noise_level)).
/// 2. Normals, in stages. In each stage a face looks at the faces around it, at
///    three radii, and at four scales of how different their normals may be:
///    means of the noisy normals, means of the present ones, planes and quadrics
///    fitted to the noisy positions, the normals beside it, and means over wide
///    regions that end at creases. These are candidates.
///    A small network sees them in axes that turn with the mesh, together with
///    numbers such as the residuals of the fits over σ̂, and answers with a
///    positive weight for each. The new normal is the weighted mean, turned by at
///    most the spread of the candidates. The networks are trained on generated
///    bodies (`cargo xtask benchmark train`) and part of this crate.
/// 3. Faces that lie in one plane, which ends at creases, get the normal of a plane
///    fitted to all their noisy vertices.
/// 4. The surface follows the normals between the stages and at the end, and folds
///    open. Faces that then contradict their normal are on the wrong side of a
///    crease and take the normal of a neighbour.
///
/// Where all candidates agree the network changes nothing: planes stay planes.
///
/// Under impulsive noise, where at least 1 % of the vertices are spikes, more than 15 σ̂ and a quarter of an edge from the
/// plane of their neighbours and three times as far as each of these, spikes are first put into that plane.
///
/// Connected parts whose noise differs by more than a factor of four are
/// denoised apart ([`noisy_parts`]), each group as a mesh of its own: a clean
/// part does not change, and does not reduce the smoothing of a noisy one.
///
/// A connected part where at one vertex in ten a twentieth of the longest side is more than the least height of the
/// faces and more than σ̂, such as a tessellated CAD model, stays as it is ([`Automatic::uneven_vertices`]): a normal
/// that is off by 3° would put the far end of such a face off by more than the noise does, and fold its neighbours.
///
/// Each connected part is then offset so that its noisy vertices lie on both sides of it
/// alike; a closed part so keeps its volume.
///
/// No vertex moves further than five times the larger of σ̂ and the root mean
/// square displacement, and the height of the highest spike ([`Automatic::limit`]). Isolated vertices stay; borders
/// move with their faces; nothing is compared across edges with one, three or
/// more faces. Faces count as [oriented](TriMesh::oriented). A mesh whose noise level is undefined or
/// below 10⁻⁷ h is returned unchanged. Moves with the mesh under rotation,
/// reflection, translation and scaling, up to rounding.
///
/// # Errors
///
/// [`DenoiseError::Unwelded`] for faces that do not share their corners;
/// [`DenoiseError::Build`] where numbers leave the range of floats;
/// [`DenoiseError::Model`] if the trained numbers were damaged in the build.
///
/// Source of the regression of normals in stages: \[wang2016\].
pub fn automatic(mesh: &TriMesh) -> Result<Automatic, DenoiseError> {
    let mut noise = None;
    let mut limit = 0.0f64;
    let mut uneven_vertices = 0;
    let moved = on_oriented(mesh, |mesh| {
        let groups = noisy_parts(mesh);
        noise = groups.first().map(|group| group.level);
        let uneven = uneven_parts(mesh, &groups);
        let parts = mesh.topology().components();
        let is_uneven = |v: &u32| parts.label(*v).is_some_and(|part| uneven[part as usize]);
        uneven_vertices = (0..mesh.vertex_count() as u32).filter(is_uneven).count();
        let mut positions = mesh.positions().to_vec();
        for mut group in groups {
            group.components.retain(|&part| !uneven[part as usize]);
            if group.components.is_empty() {
                continue;
            }
            let part = Part::new(mesh, &group.components)?;
            let (moved, farthest) = denoise(&part.mesh, group.level)?;
            part.put_back(&moved, &mut positions);
            limit = limit.max(farthest);
        }
        Ok(mesh.with_positions(positions)?)
    })?;
    let view = moved.oriented();
    let (faces, creased) = face_kinds(&view, &Hinges::new(&view));
    let kind = match (limit > 0.0, creased) {
        (false, _) if uneven_vertices > 0 => SurfaceKind::Uneven,
        (false, _) => SurfaceKind::Clean,
        (true, true) => SurfaceKind::Creased,
        (true, false) => SurfaceKind::Smooth,
    };
    Ok(Automatic { mesh: moved, noise, kind, uneven_vertices, faces, limit })
}

/// Denoises a mesh whose noise has one level; also the largest distance allowed, zero for a clean
/// mesh.
fn denoise(mesh: &TriMesh, level: NoiseEstimate) -> Result<(TriMesh, f64), DenoiseError> {
    if is_clean(mesh, level) {
        return Ok((mesh.clone(), 0.0));
    }
    // Impulses are put into the planes of their neighbours.
    let (mesh, level, farthest) = without_spikes(mesh, level)?;
    if is_clean(&mesh, level) {
        return Ok((mesh.into_owned(), farthest));
    }
    // Normals in stages; after each the surface follows them.
    let model = Model::released().ok_or(DenoiseError::Model)?;
    fairing_watch::stage("normals", (model.stages.len() * blocks(mesh.face_count())) as u64);
    let mut state = State::new(&mesh, level);
    for networks in &model.stages {
        advance(&mut state, networks)?;
    }
    // Faces that lie in one plane take its normal.
    let variance = variance_of_means(&state);
    let evidence = Evidence::new(&mesh, &state.hinges, &state.trust, variance);
    flatten(&evidence, &mut state.normals);
    // Faces on the wrong side of a crease change sides, and the surface follows to the end.
    fairing_watch::stage("positions", 0);
    let follow = state.follower(state.limit);
    let normals = relabel(&mesh, &state.rings, state.normals, &follow)?;
    let surface = follow.run(mesh.positions(), &normals, STEPS)?;
    // Noise lies on both sides of the surface, and no face opposes its normal.
    let surface = in_the_middle(&mesh, surface, &normals, state.limit)?;
    let surface = without_flips(&mesh, surface, &normals, &follow)?;
    Ok((surface, state.limit + farthest))
}

/// Whether the noise of a mesh is rounding.
fn is_clean(mesh: &TriMesh, level: NoiseEstimate) -> bool {
    level.sigma <= LEAST_NOISE * mesh.mean_edge_length()
}
