//! The result of the automatic denoiser.

use fairing_mesh::TriMesh;
use glam::DVec3;

use super::choice::Approach;
use super::group::Denoised;
use super::merge::Merged;
use super::spikes::{Spikes, counted_spikes};
use super::surface::{FaceKind, SurfaceKind, face_kinds};
use crate::faces::Hinges;
use crate::noise_level::{NoiseEstimate, NoisyParts};

/// Result of [`automatic`](super::automatic).
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Automatic {
    /// The denoised mesh, with the faces of the input.
    pub mesh: TriMesh,
    /// The estimated noise of the noisiest connected parts, without spikes, and without the short
    /// edges of surfaces of volumes; `None` if the mesh is too small for an estimate.
    pub noise: Option<NoiseEstimate>,
    /// The kind of surface of the result; informative only.
    pub kind: SurfaceKind,
    /// The number of vertices in connected parts whose faces are too uneven, which were left
    /// unchanged: parts in which, at one vertex in ten, a twentieth of the longest side of the
    /// faces exceeds both their least height and the noise. Remeshing makes such parts usable.
    pub uneven_vertices: usize,
    /// The number of spikes, vertices farther from the surface around them than noise and shape
    /// explain, which were moved to this surface.
    pub spikes: usize,
    /// The kind of surface at each face of the result.
    pub faces: Vec<FaceKind>,
    /// The largest distance that a vertex was allowed to move, in mesh units: five times the larger
    /// of the noise level and the root mean square displacement, each time that the mesh is
    /// denoised, and the distance of the farthest spike.
    pub limit: f64,
    /// The way in which the noisiest of the moved parts were denoised; `None` if nothing was moved.
    pub approach: Option<Approach>,
    /// The expected mean angle between the normals of the moved faces and the true ones, in
    /// degrees; `None` if nothing was moved. For [networks](Approach::Networks) it follows from the
    /// disagreement of two networks of different random start in the first pass, so it misses
    /// errors that both share, and is too high where impulses are removed later: in 135 of the 156
    /// benchmark cases that were not used for the fit it was within a factor of two of the actual
    /// angle. For total generalised variation it follows from the noise level at two edges. Under
    /// correlated noise and that of a depth camera it was within a factor of two on 63 of the 66
    /// views that were not used for the fits.
    pub expected_error: Option<f64>,
    /// The number of moved faces that oppose the normals found for them: folds that could not be
    /// opened.
    pub flipped_faces: usize,
    /// The part of the measured level that may be relief instead of noise, in mesh units; this part
    /// was kept. A [strength](super::AutomaticOptions::strength) above one removes it.
    pub undecided: f64,
}

/// A mesh before its groups of parts are denoised.
#[derive(Default)]
pub(super) struct Start {
    noise: Option<NoiseEstimate>,
    uneven_vertices: usize,
    spikes: Spikes,
    /// The positions without spikes, but the original ones in uneven parts.
    pub(super) positions: Vec<[f64; 3]>,
}

impl Start {
    /// The start from a mesh, the mesh `without` its spikes, and the noise and the unevenness of
    /// its parts.
    pub(super) fn new(
        mesh: &TriMesh,
        without: &TriMesh,
        merged: &Merged<'_>,
        parts: &[NoisyParts],
        uneven: &[bool],
    ) -> Self {
        let is_uneven = |v: u32| merged.part(v).is_some_and(|part| uneven[part as usize]);
        let mut positions = without.positions().to_vec();
        Self {
            noise: parts.first().map(|group| merged.level(group)),
            uneven_vertices: (0..mesh.vertex_count() as u32).filter(|&v| is_uneven(v)).count(),
            spikes: counted_spikes(mesh, &mut positions, is_uneven),
            positions,
        }
    }
}

impl Automatic {
    /// The result, from the denoised mesh and its groups of parts.
    pub(super) fn new(mesh: TriMesh, start: Start, groups: &[Denoised]) -> Self {
        let limit = groups.iter().fold(0.0f64, |most, group| most.max(group.limit));
        let limit = limit + start.spikes.farthest;
        let errors = groups.iter().filter_map(|group| Some((group.expected_error?, group)));
        let (error, count) = errors.fold((0.0, 0), |(sum, count), (error, group)| {
            let faces = group.mesh.face_count();
            (sum + error * faces as f64, count + faces)
        });
        let (faces, creased) = {
            let view = mesh.oriented();
            face_kinds(&view, &Hinges::new(&view))
        };
        let kind = match (limit > 0.0, creased) {
            (false, _) if start.uneven_vertices > 0 => SurfaceKind::Uneven,
            (false, _) => SurfaceKind::Clean,
            (true, true) => SurfaceKind::Creased,
            (true, false) => SurfaceKind::Smooth,
        };
        Self {
            mesh,
            noise: start.noise,
            kind,
            uneven_vertices: start.uneven_vertices,
            spikes: start.spikes.count,
            faces,
            limit,
            approach: groups.iter().find_map(|group| group.approach),
            expected_error: (count > 0).then(|| error / count as f64),
            flipped_faces: groups.iter().map(|group| group.flipped).sum(),
            undecided: groups.iter().fold(0.0f64, |most, group| most.max(group.undecided)),
        }
    }

    /// The fraction of the area of one kind, from 0 to 1; 0 without area.
    pub fn fraction(&self, kind: FaceKind) -> f64 {
        let area = |wanted: &dyn Fn(FaceKind) -> bool| -> f64 {
            let faces = self.faces.iter().enumerate().filter(|(_, k)| wanted(**k));
            faces.map(|(f, _)| DVec3::from(self.mesh.area_vector(f)).length()).sum()
        };
        let all = area(&|_| true);
        if all > 0.0 { area(&|k| k == kind) / all } else { 0.0 }
    }
}
