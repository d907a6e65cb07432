//! Denoising without parameters.

mod around;
mod correlation;
mod features;
mod fits;
mod follow;
mod impulses;
mod merge;
mod model;
mod network;
mod offset;
mod parts;
mod planes;
mod restraint;
mod safety;
mod spikes;
mod stage;
mod state;
mod surface;
#[cfg(feature = "training")]
pub mod training;
mod wide;

use std::borrow::Cow;

use fairing_mesh::TriMesh;
use fairing_parameters::{Options, Range};
use glam::DVec3;

use crate::faces::{FaceLists, Hinges};
use crate::masked::on_oriented;
use crate::noise_level::{NoiseEstimate, NoisyParts, noisy_parts};
use crate::noise_scale::level_at_scale;
use crate::total_generalised_variation::filtered_normals;
use crate::{DenoiseError, Masked, TotalGeneralisedVariationOptions};
use correlation::{
    correlation_across_edges, is_sheet_of_waves, mean_displacement, variance_of_means,
};
use follow::{Follow, relabel};
use impulses::{Impulses, has_impulses};
use merge::{Merged, VolumeNoise};
use model::Model;
use offset::in_the_middle;
use parts::Part;
use planes::{Evidence, flatten};
use restraint::{Allowed, Restrained, restrained};
use safety::{Unflipped, without_flips};
use spikes::{counted_spikes, without_impulses, without_spikes};
use stage::{advance, blocks};
use state::{FAR, State};
use surface::face_kinds;

pub use surface::{FaceKind, SurfaceKind};

/// The largest noise level that counts as rounding, in mean edge lengths.
const ROUNDING: f64 = 1e-7;

/// The largest noise level that is not worth removing, in mean edge lengths: it turns normals by a
/// tenth of a degree. On a model of each family of the development set denoising adds more error
/// than noise of this level, and less than noise three times as strong.
const WEAK: f64 = 1e-3;

/// The least correlation of displacements across edges that shows correlated noise. On models and
/// views of the development set it is negative under independent noise of 0.05 edges or more, and
/// 0.23 or more under correlated noise on 143 of 144.
const CORRELATED: f64 = 0.15;

/// The most times that a mesh is denoised again, without its impulses.
const ROUNDS: usize = 3;

/// Vertex steps of the final surface.
const STEPS: usize = 60;

/// The weight of total generalised variation over the noise level at two edges. The best of 1.4 to
/// 6.2 on scans of the models of the development set by a depth camera.
const WEIGHT: f64 = 3.2;

/// The expected error of the networks, in degrees, above which they may have taken correlated noise
/// for shape. The best of 0, 1, 1.5, 2, 2.5 and 3 on scans and models of the development set.
const MISTAKEN: f64 = 2.0;

/// The factor and the power by which the disagreement of the networks of the last stage predicts
/// the mean angle between normals and truth, in degrees: a fit of logarithms on the development
/// set, with networks of 96 units. A fit with those of 128 is no better on this set.
const EXPECTED: (f64, f64) = (750.0, 0.99);

/// The same for the networks for correlated noise: a fit on views of models of the development set.
const EXPECTED_CORRELATED: (f64, f64) = (2810.0, 1.134);

/// The same for total generalised variation, from the noise level at two edges in mean edge
/// lengths: a fit on scans of the models of the development set by a depth camera.
const EXPECTED_FILTERED: (f64, f64) = (19.3, 0.73);

/// Result of [`automatic`].
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
    /// unchanged. Remeshing makes such parts usable.
    pub uneven_vertices: usize,
    /// The number of spikes that were put on the surface around them: vertices farther from it
    /// than noise and shape explain.
    pub spikes: usize,
    /// The kind of surface at each face of the result.
    pub faces: Vec<FaceKind>,
    /// The largest distance that a vertex was allowed to move, in mesh units.
    pub limit: f64,
    /// The way in which the noisiest of the moved parts were denoised; `None` if nothing was moved.
    pub approach: Option<Approach>,
    /// The expected mean angle between the normals of the moved faces and the true ones, in
    /// degrees; `None` if nothing was moved. For [networks](Approach::Networks) it follows from
    /// how far two of different random start disagree the first time that a mesh is denoised, so it
    /// does not see what both overlook and is too high where impulses are then taken out: in
    /// 135 of the 156 benchmark cases that were not used for the fit it was within a factor of two
    /// of the actual angle. For total generalised variation it follows from the noise level at two
    /// edges. Under correlated noise and that of a depth camera it was within a factor of two on 63
    /// of the 66 views that were not used for the fits.
    pub expected_error: Option<f64>,
    /// The number of moved faces that are turned against the normals found for them: folds that
    /// could not be opened.
    pub flipped_faces: usize,
    /// The part of the measured level that may be relief as well as noise, in mesh units: it was
    /// kept. A [strength](AutomaticOptions::strength) above one removes it.
    pub undecided: f64,
}

impl Automatic {
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

fairing_parameters::options! {
    /// Options of [`automatic`].
    #[derive(Debug, Clone, Copy, PartialEq)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    #[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
    pub struct AutomaticOptions {
        /// A factor on the estimated noise, for a result that is too smooth or too rough.
        pub strength: f64 = 1.0, in Range::POSITIVE;
    }
    "automatic": "estimates everything from the mesh; keeps creases", [];
}

/// The way in which [`automatic`] has denoised a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Approach {
    /// Networks on the neighbourhood of each face.
    Networks,
    /// [`total_generalised_variation`](crate::total_generalised_variation), for the noise of a
    /// depth camera.
    TotalGeneralisedVariation,
}

fairing_parameters::named!(Approach, "approach of the automatic denoiser",
    Networks: "networks",
    TotalGeneralisedVariation: "total-generalised-variation",
);

/// Denoises without parameters that have to be chosen: noise level and kind of surface are
/// estimated from the mesh.
///
/// 1. The noise level σ̂ ([`noise_level`](crate::noise_level())).
/// 2. Normals, in stages. Each stage collects candidates for the normal of a face from the faces
///    around it, at three radii and four scales of similarity between normals: means of the noisy
///    and of the present normals, normals of planes and quadrics fitted to the noisy positions,
///    the normals of adjacent faces, and means over wide regions that end at creases.
///    A small network sees the candidates in axes that turn with the mesh, together with
///    numbers such as the residuals of the fits over σ̂, and assigns a
///    positive weight to each. The new normal is the weighted mean, turned by at
///    most the spread of the candidates. The networks are trained on generated
///    models (`cargo xtask benchmark train`) and built into this crate. If the displacements of the
///    vertices correlate across edges by more than 0.15 after the last stage, as where details were
///    taken for noise, the stages begin anew with networks that are trained on correlated noise;
///    these are taken if they move the vertices less, and on open surfaces whose residuals
///    correlate by 0.05 to 0.4 ([`NoiseEstimate::correlation`]); on surfaces of volumes, if they
///    move them more.
/// 3. Faces that lie in one plane, which ends at creases, get the normal of a plane
///    fitted to all their noisy vertices.
/// 4. The surface follows the normals between the stages and at the end, and folds
///    open. Faces that then contradict their normal are on the wrong side of a
///    crease and take the normal of a neighbour.
///
/// If all candidates agree, so does the new normal: planes stay planes.
///
/// The surface then moves no further than the noise that was measured (Morozov's discrepancy
/// principle): where the root mean square displacement along the normals, over some 150 vertices or
/// over a connected part, exceeds 1.2 times its level, displacements are shortened. The level is
/// that of the residuals where those of neighbours are independent. Where they are alike, as on
/// relief and at creases, it is that of the rest of the mesh; and where they are alike on more than
/// half of it, relief and correlated noise cannot be told apart, and the level is smaller in
/// proportion ([`Automatic::undecided`]), by a tenth of an edge at most. Distances from planes
/// count as noise if a quarter of the surface lies in planes. Three kinds of noise have a level of
/// their own, which bounds the displacement as a whole: correlated noise that was found
/// ([`NoiseEstimate::wide_sigma`]), that of open surfaces whose residuals correlate, and that of
/// volumes (measured at four edges).
///
/// Where the noise is found to be that of a depth camera ([`NoiseEstimate::correlation_length`]),
/// and the networks expect to leave more than 2°, the normals are those of
/// [`total_generalised_variation`](crate::total_generalised_variation) with a weight of 3.2 times
/// the noise level at two edges ([`Automatic::approach`]).
///
/// Spikes are put on the surface around them before anything is measured: vertices whose distance
/// from all that the two rings around them predict exceeds the distance of their neighbours, and
/// eight times the median height around them ([`Automatic::spikes`]). Vertices on borders are
/// none.
///
/// Under impulsive noise, where the distances of the vertices from the result then show that some
/// are impulses and the others are not, the mesh is denoised again with the impulses on the surface
/// that was found: the vertices farther from it than 4.5 standard deviations of the others. This is
/// repeated up to three times, as long as the others get closer to the surface.
///
/// Connected parts whose noise differs by more than a factor of four are
/// denoised apart ([`noisy_parts`]), each group as a mesh of its own: a clean
/// part does not change, and does not reduce the smoothing of a noisy one.
///
/// Marching cubes, which turns fused scans and tomographs into surfaces, leaves very short edges
/// beside edges of ordinary length. On such surfaces of volumes (8 % to 35 % of 500 vertices or
/// more have an edge shorter than a fifth of the mean around it, and at most 1 % of the edges are
/// longer than 1.9 times that) the ends of edges shorter than 0.35 times the mean are merged in all
/// steps, unless this would change the topology. At the end they are moved apart again, along the
/// new surface. The level of independent noise is doubled there: fits follow half of it.
///
/// Tessellated CAD models and similar parts stay unchanged ([`Automatic::uneven_vertices`]):
/// connected parts in which, at one vertex in ten, a twentieth of the longest side of the faces
/// exceeds both their least height and the noise. On such a face an error of 3° in the normal
/// displaces the far end by more than the noise, and folds neighbouring faces.
///
/// Each connected part is then offset so that its noisy vertices lie evenly on both sides; a closed
/// part keeps the volume that it has without its impulses.
///
/// No vertex moves further than five times the larger of σ̂ and the root mean square displacement,
/// each time that the mesh is denoised, and the distance of the farthest spike
/// ([`Automatic::limit`]). Isolated vertices stay; borders move with their faces; nothing is
/// compared across edges with one, three or more faces. Faces count as
/// [oriented](TriMesh::oriented). A mesh whose noise level is undefined, or times the strength
/// below 10⁻³ h without impulses, is returned unchanged, spikes excepted. Moves with the mesh under
/// rotation, reflection, translation and scaling, up to rounding.
///
/// # Errors
///
/// [`DenoiseError::Option`] for a strength that is not positive;
/// [`DenoiseError::Unwelded`] for faces that do not share their corners;
/// [`DenoiseError::Build`] where numbers leave the range of floats;
/// [`DenoiseError::Model`] if the trained numbers were damaged in the build.
///
/// Source of the regression of normals in stages: [wang2016].
///
/// [wang2016]: https://doi.org/10.1145/2980179.2980232
pub fn automatic<'a>(
    mesh: impl Into<Masked<'a>>,
    options: &AutomaticOptions,
) -> Result<Automatic, DenoiseError> {
    options.check()?;
    let (mut noise, mut approach) = (None, None);
    let (mut limit, mut uneven_vertices) = (0.0f64, 0);
    let (mut spikes, mut farthest) = (0, 0.0f64);
    let (mut error, mut faces_denoised, mut flipped_faces) = (0.0, 0, 0);
    let mut undecided = 0.0f64;
    let moved = on_oriented(mesh.into(), |input| {
        let original = input.mesh();
        let mesh = &*without_spikes(input)?;
        let merged = Merged::new(input.on(mesh))?;
        let input = merged.masked()?;
        let groups = noisy_parts(input);
        noise = groups.first().map(|group| merged.level(group));
        let uneven = merged.uneven(&groups);
        let is_uneven = |v: u32| merged.part(v).is_some_and(|part| uneven[part as usize]);
        uneven_vertices = (0..mesh.vertex_count() as u32).filter(|&v| is_uneven(v)).count();
        let mut may_move = movable(input);
        may_move.iter_mut().zip(&uneven).for_each(|(may, uneven)| *may &= !uneven);
        let mut start = mesh.positions().to_vec();
        (spikes, farthest) = counted_spikes(original, &mut start, is_uneven);
        let mut positions = merged.mesh.positions().to_vec();
        for (group, settings) in tasks(&merged, groups, &may_move, options.strength) {
            let part = Part::new(input, &group.components)?;
            let done = denoise_repeatedly(part.masked()?, group.level, settings)?;
            part.put_back(done.mesh.positions(), &mut positions);
            limit = limit.max(done.limit);
            flipped_faces += done.flipped;
            undecided = undecided.max(done.undecided);
            approach = approach.or(done.approach);
            if let Some(expected) = done.expected_error {
                error += expected * done.mesh.face_count() as f64;
                faces_denoised += done.mesh.face_count();
            }
        }
        let positions = merged.spread(&start, positions)?;
        Ok(mesh.with_positions(positions)?)
    })?;
    limit += farthest;
    let view = moved.oriented();
    let (faces, creased) = face_kinds(&view, &Hinges::new(&view));
    let kind = match (limit > 0.0, creased) {
        (false, _) if uneven_vertices > 0 => SurfaceKind::Uneven,
        (false, _) => SurfaceKind::Clean,
        (true, true) => SurfaceKind::Creased,
        (true, false) => SurfaceKind::Smooth,
    };
    let expected_error = (faces_denoised > 0).then(|| error / faces_denoised as f64);
    Ok(Automatic {
        mesh: moved,
        noise,
        kind,
        uneven_vertices,
        faces,
        limit,
        approach,
        expected_error,
        spikes,
        flipped_faces,
        undecided,
    })
}

/// The parts that are denoised together: of each group those that may move, surfaces of volumes
/// apart from others.
fn tasks(
    merged: &Merged<'_>,
    groups: Vec<NoisyParts>,
    may_move: &[bool],
    strength: f64,
) -> Vec<(NoisyParts, Settings)> {
    let both = groups.into_iter().flat_map(|group| [(group.clone(), false), (group, true)]);
    let tasks = both.map(|(mut group, is_volume)| {
        group.components.retain(|&part| {
            may_move[part as usize] && merged.is_volume[part as usize] == is_volume
        });
        let volume_noise = merged.volume_noise(&group);
        (group, Settings { strength, volume_noise, may_be_correlated: true })
    });
    tasks.filter(|(group, _)| !group.components.is_empty()).collect()
}

/// The parts that have a vertex that may move.
fn movable(input: Masked<'_>) -> Vec<bool> {
    let parts = input.mesh().topology().components();
    let mut movable = vec![false; parts.count()];
    for v in (0..input.mesh().vertex_count()).filter(|&v| !input.is_fixed(v)) {
        if let Some(part) = parts.label(v as u32) {
            movable[part as usize] = true;
        }
    }
    movable
}

/// A mesh whose noise has one level, denoised.
struct Denoised {
    mesh: TriMesh,
    /// The largest distance allowed; zero for a clean mesh.
    limit: f64,
    /// `None` where normals were not changed.
    approach: Option<Approach>,
    /// As in [`Automatic`].
    expected_error: Option<f64>,
    /// As in [`Automatic`].
    flipped: usize,
    /// As in [`Automatic`].
    undecided: f64,
}

impl Denoised {
    /// A mesh without noise.
    fn clean(mesh: TriMesh) -> Self {
        Self { mesh, limit: 0.0, approach: None, expected_error: None, flipped: 0, undecided: 0.0 }
    }
}

/// The strength of denoising, and the noise that is looked for.
#[derive(Debug, Clone, Copy)]
struct Settings {
    strength: f64,
    /// The noise of the surface of a volume.
    volume_noise: Option<VolumeNoise>,
    /// No impulses have been found.
    may_be_correlated: bool,
}

impl Settings {
    /// The noise that displacements may remove, for a level without the strength. A strength above
    /// one takes what may be relief for noise as well.
    fn allowed(&self, input: Masked<'_>, level: &NoiseEstimate) -> Allowed {
        let wide = level.wide_sigma.max(level.sigma);
        let mut allowed = if level.correlation_length > 0.0 {
            Allowed::uniform(wide)
        } else if self.volume_noise.is_some() || is_sheet_of_waves(input.mesh(), level) {
            Allowed::uniform(level_at_scale(input.mesh(), 4).map_or(wide, |four| four.max(wide)))
        } else {
            Allowed::measured(input, level)
        };
        let wanted = 1.0 - 1.0 / (self.strength * self.strength);
        allowed.at_least(level.sigma * wanted.max(0.0).sqrt());
        allowed
    }
}

/// Denoises a mesh whose noise has one level; under impulsive noise again and again, with impulses
/// put on the surface that was found, as long as the other vertices get closer to it. Noise that is
/// not worth removing stays.
fn denoise_repeatedly(
    input: Masked<'_>,
    level: NoiseEstimate,
    settings: Settings,
) -> Result<Denoised, DenoiseError> {
    let mesh = input.mesh();
    let is_weak = level.sigma * settings.strength <= WEAK * mesh.mean_edge_length();
    if is_weak && !level.is_impulsive() {
        return Ok(Denoised::clean(mesh.clone()));
    }
    let mut done = denoise(input, level, settings)?;
    if !level.is_impulsive() || done.approach != Some(Approach::Networks) {
        return Ok(done);
    }
    let mut found = Impulses::find(input, &done.mesh);
    if is_weak && found.is_none() {
        return Ok(Denoised::clean(mesh.clone()));
    }
    let settings = Settings { may_be_correlated: false, ..settings };
    for _ in 0..ROUNDS {
        let Some(impulses) = found else { break };
        let without = mesh.with_positions(impulses.moved_onto(mesh, &done.mesh))?;
        let Some(group) = noisy_parts(input.on(&without)).into_iter().next() else { break };
        let next = denoise(input.on(&without), group.level, settings)?;
        found = Impulses::find(input, &next.mesh).filter(|next| next.rest < impulses.rest);
        if found.is_none() {
            break;
        }
        let limit = done.limit + next.limit;
        done = Denoised { mesh: next.mesh, flipped: next.flipped, limit, ..done };
    }
    Ok(done)
}

/// Denoises a mesh whose noise has one level.
fn denoise(
    input: Masked<'_>,
    mut level: NoiseEstimate,
    settings: Settings,
) -> Result<Denoised, DenoiseError> {
    let without = match level.is_impulsive() {
        true => without_impulses(input, level.sigma)?,
        false => Cow::Borrowed(input.mesh()),
    };
    let (mesh, input) = (&*without, input.on(&without));
    if let Cow::Owned(_) = without
        && let Some(group) = noisy_parts(input).into_iter().next()
    {
        level = group.level;
    }
    if let Some(noise) = settings.volume_noise {
        level = noise.level(level);
    }
    let mut allowed = settings.allowed(input, &level);
    level.sigma *= settings.strength;
    level.wide_sigma *= settings.strength;
    if level.sigma <= ROUNDING * mesh.mean_edge_length() {
        return Ok(Denoised::clean(mesh.clone()));
    }
    let mut approach = Approach::Networks;
    let mut normals = regressed(input, level, settings)?;
    if level.correlation_length > 0.0 && normals.expected_error > Some(MISTAKEN) {
        approach = Approach::TotalGeneralisedVariation;
        let two = level_at_scale(mesh, 2).unwrap_or(level.wide_sigma / settings.strength);
        let two = two / mesh.mean_edge_length();
        let weight = WEIGHT * settings.strength * two;
        let options = TotalGeneralisedVariationOptions { weight, ..Default::default() };
        let sigma = level.wide_sigma;
        let filtered = filtered_normals(mesh, &options)?;
        let expected_error = Some(EXPECTED_FILTERED.0 * libm::pow(two, EXPECTED_FILTERED.1));
        normals =
            Normals { normals: filtered, sigma, limit: FAR * sigma, expected_error, ..normals };
    }
    let Normals { normals, rings, sigma, limit, expected_error, planes } = normals;
    allowed.at_least(planes);
    allowed.scale(settings.strength);
    let undecided = (level.sigma - allowed.level()).max(0.0);
    if allowed.level() <= WEAK * mesh.mean_edge_length() {
        return Ok(Denoised { undecided, ..Denoised::clean(mesh.clone()) });
    }
    // Faces on the wrong side of a crease change sides, and the surface follows to the end.
    fairing_watch::stage("positions", 0);
    let follow = Follow::new(mesh, &rings, sigma, limit);
    let normals = relabel(mesh, &rings, normals, &follow)?;
    let follow = follow.with_fixed(input);
    let surface = follow.run(mesh.positions(), &normals, STEPS)?;
    let Restrained { mesh: surface, normals, turned } =
        restrained(input, surface, normals, &allowed)?;
    let expected_error = expected_error.map(|error| error.max(turned));
    // Noise lies on both sides of the surface, and no face opposes its normal.
    let surface = in_the_middle(input, surface, &normals, limit)?;
    let Unflipped { mesh, flipped } = without_flips(mesh, surface, &normals, &follow)?;
    Ok(Denoised { mesh, limit, approach: Some(approach), expected_error, flipped, undecided })
}

/// The normals of a surface without noise.
struct Normals {
    normals: Vec<DVec3>,
    /// The faces around each.
    rings: FaceLists,
    /// The noise level, and the largest displacement, as the distance of the surface from the noisy
    /// mesh shows them.
    sigma: f64,
    limit: f64,
    /// As in [`Automatic`].
    expected_error: Option<f64>,
    /// The distance of the noisy mesh from its planes, root mean square, if a quarter of it lies in
    /// planes: a level of the noise at all scales.
    planes: f64,
}

/// Returns `true` if the displacements of the last stage show that the noise is correlated. That of
/// a depth camera was found before. Between impulses, the displacements of the other vertices are
/// correlated, too.
fn is_correlated(state: &State<'_>) -> bool {
    state.level.correlation_length == 0.0
        && correlation_across_edges(state) > CORRELATED
        && !has_impulses(state.input, &state.surface)
}

/// The state after the last stage of a released model.
fn after_stages<'a>(
    input: Masked<'a>,
    level: NoiseEstimate,
    for_correlated: bool,
) -> Result<State<'a>, DenoiseError> {
    let model = Model::released(for_correlated).ok_or(DenoiseError::Model)?;
    let blocks = blocks(input.mesh().face_count());
    fairing_watch::stage("normals", (model.stages.len() * blocks) as u64);
    let mut state = State::new(input, level);
    for networks in &model.stages {
        advance(&mut state, networks)?;
    }
    Ok(state)
}

/// The normals, where faces that lie in one plane take that of it, and the distance from planes as
/// in [`Normals`].
fn in_planes(state: &State<'_>) -> (Vec<DVec3>, f64) {
    let mut normals = state.normals.clone();
    let variance = variance_of_means(state);
    let evidence = Evidence::new(state.mesh(), &state.hinges, &state.trust, variance);
    let square = flatten(&evidence, &mut normals);
    (normals, square.map_or(0.0, |square| square.sqrt() * state.h))
}

/// The normals by the networks; if their displacements are correlated, by those for correlated
/// noise, provided that these move the vertices less, as where the first take relief for noise, or
/// that the surface is a sheet of waves or lies in planes; on surfaces of volumes, if they move
/// them more: filtered noise that the first take for shape.
fn regressed(
    input: Masked<'_>,
    level: NoiseEstimate,
    settings: Settings,
) -> Result<Normals, DenoiseError> {
    let mesh = input.mesh();
    let mut state = after_stages(input, level, false)?;
    let expected = |state: &State<'_>, (factor, power)| factor * libm::pow(state.apart, power);
    let mut expected_error = expected(&state, EXPECTED);
    if settings.may_be_correlated && is_correlated(&state) {
        let other = after_stages(input, level, true)?;
        let moves_less = mean_displacement(&other) < mean_displacement(&state);
        let is_better = match settings.volume_noise {
            Some(_) => !moves_less,
            None => {
                let has_planes = in_planes(&other).1 > 0.0;
                moves_less || has_planes || is_sheet_of_waves(mesh, &level)
            }
        };
        if is_better {
            expected_error = expected_error.max(expected(&other, EXPECTED_CORRELATED));
            state = other;
        }
    }
    let (normals, planes) = in_planes(&state);
    let expected_error = Some(expected_error);
    let (sigma, limit) = (state.limit / FAR, state.limit);
    Ok(Normals { normals, rings: state.rings, sigma, limit, expected_error, planes })
}
