//! Denoising of connected parts whose noise has one level.

use std::borrow::Cow;

use fairing_mesh::TriMesh;

use super::choice::{Approach, Normals, Settings};
use super::correlation::is_sheet_of_waves;
use super::flips::{Unflipped, without_flips};
use super::follow::{Follow, relabel};
use super::impulses::Impulses;
use super::merge::Merged;
use super::offset::in_the_middle;
use super::restraint::{Allowed, Restrained, restrained};
use super::spikes::without_impulses;
use crate::error::DenoiseError;
use crate::masked::Masked;
use crate::noise_level::{NoiseEstimate, NoisyParts, noisy_parts};
use crate::noise_scale::level_at_scale;

/// The largest noise level that is not worth removing, in mean edge lengths: it turns normals by a
/// tenth of a degree. On a model of each family of the development set denoising adds more error
/// than noise of this level, and less than noise three times as strong.
const WEAK: f64 = 1e-3;

/// The largest noise level that counts as rounding, in mean edge lengths.
const ROUNDING: f64 = 1e-7;

/// The largest number of times that a mesh is denoised again, without its impulses.
const ROUNDS: usize = 3;

/// Vertex steps of the final surface.
const STEPS: usize = 60;

/// Connected parts that are denoised together.
pub(super) struct Group {
    /// The numbers of the parts, ascending.
    pub(super) components: Vec<u32>,
    level: NoiseEstimate,
    settings: Settings,
}

/// The parts that are denoised together: of those with noise of one level the ones that may move
/// and are not uneven, surfaces of volumes apart from others.
pub(super) fn groups(
    merged: &Merged<'_>,
    input: Masked<'_>,
    parts: Vec<NoisyParts>,
    uneven: &[bool],
    strength: f64,
) -> Vec<Group> {
    let may_move = movable(input);
    let mut groups = vec![];
    for NoisyParts { components, level } in parts {
        for is_volume in [false, true] {
            let mut components = components.clone();
            components.retain(|&part| {
                let part = part as usize;
                may_move[part] && !uneven[part] && merged.is_volume[part] == is_volume
            });
            if !components.is_empty() {
                let volume_noise = merged.volume_noise(&components);
                let settings = Settings { strength, volume_noise, impulses_removed: false };
                groups.push(Group { components, level, settings });
            }
        }
    }
    groups
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
pub(super) struct Denoised {
    pub(super) mesh: TriMesh,
    /// The largest distance allowed; zero for a mesh that was not changed.
    pub(super) limit: f64,
    /// `None` where normals were not changed.
    pub(super) approach: Option<Approach>,
    /// As in [`Automatic`](super::Automatic).
    pub(super) expected_error: Option<f64>,
    /// As in [`Automatic`](super::Automatic).
    pub(super) flipped: usize,
    /// As in [`Automatic`](super::Automatic).
    pub(super) undecided: f64,
}

impl Denoised {
    /// The same mesh, for noise that is not worth removing.
    fn unchanged(mesh: &TriMesh) -> Self {
        let mesh = mesh.clone();
        Self { mesh, limit: 0.0, approach: None, expected_error: None, flipped: 0, undecided: 0.0 }
    }
}

impl Group {
    /// Denoises the mesh of these parts; under impulsive noise repeatedly, with impulses put on the
    /// surface that was found, as long as the other vertices get closer to it. Noise that is not
    /// worth removing stays.
    pub(super) fn denoise(&self, input: Masked<'_>) -> Result<Denoised, DenoiseError> {
        let (mesh, level, settings) = (input.mesh(), self.level, self.settings);
        let is_weak = level.sigma * settings.strength <= WEAK * mesh.mean_edge_length();
        if is_weak && !level.is_impulsive() {
            return Ok(Denoised::unchanged(mesh));
        }
        let mut done = denoise(input, level, settings)?;
        if !level.is_impulsive() || done.approach != Some(Approach::Networks) {
            return Ok(done);
        }
        let mut found = Impulses::find(input, &done.mesh);
        if is_weak && found.is_none() {
            return Ok(Denoised::unchanged(mesh));
        }
        let settings = Settings { impulses_removed: true, ..settings };
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
}

/// The noise that displacements may remove, for a level without the strength. With a strength above
/// one, possible relief counts as noise, too.
fn allowed(input: Masked<'_>, level: &NoiseEstimate, settings: Settings) -> Allowed {
    let wide = level.wide_sigma.max(level.sigma);
    let mut allowed = if level.correlation_length > 0.0 {
        Allowed::uniform(wide)
    } else if settings.volume_noise.is_some() || is_sheet_of_waves(input.mesh(), level) {
        Allowed::uniform(level_at_scale(input.mesh(), 4).map_or(wide, |four| four.max(wide)))
    } else {
        Allowed::measured(input, level)
    };
    let wanted = 1.0 - 1.0 / (settings.strength * settings.strength);
    allowed.at_least(level.sigma * wanted.max(0.0).sqrt());
    allowed
}

/// Denoises a mesh whose noise has one level.
fn denoise(
    input: Masked<'_>,
    mut level: NoiseEstimate,
    settings: Settings,
) -> Result<Denoised, DenoiseError> {
    let mut without = Cow::Borrowed(input.mesh());
    if level.is_impulsive() {
        without = without_impulses(input, level.sigma)?;
    }
    let (mesh, input) = (&*without, input.on(&without));
    if let Cow::Owned(_) = without
        && let Some(group) = noisy_parts(input).into_iter().next()
    {
        level = group.level;
    }
    if let Some(noise) = settings.volume_noise {
        level = noise.level(level);
    }
    let mut allowed = allowed(input, &level, settings);
    level.sigma *= settings.strength;
    level.wide_sigma *= settings.strength;
    let h = mesh.mean_edge_length();
    if level.sigma <= ROUNDING * h {
        return Ok(Denoised::unchanged(mesh));
    }
    let found = Normals::find(input, level, settings)?;
    allowed.at_least(found.planes);
    allowed.scale(settings.strength);
    let undecided = (level.sigma - allowed.level()).max(0.0);
    if allowed.level() <= WEAK * h {
        return Ok(Denoised { undecided, ..Denoised::unchanged(mesh) });
    }
    Ok(Denoised { undecided, ..fit(input, found, &allowed)? })
}

/// Fits the surface to normals: faces on the wrong side of a crease change sides, vertices follow
/// to the end, no further than the noise allows, the noise comes to lie on both sides, and folds
/// open.
fn fit(input: Masked<'_>, found: Normals, allowed: &Allowed) -> Result<Denoised, DenoiseError> {
    fairing_watch::stage("positions", 0);
    let mesh = input.mesh();
    let Normals { approach, normals, rings, sigma, limit, expected_error, .. } = found;
    let follow = Follow::new(mesh, &rings, sigma, limit);
    let normals = relabel(mesh, &rings, normals, &follow)?;
    let follow = follow.with_fixed(input);
    let surface = follow.run(mesh.positions(), &normals, STEPS)?;
    let Restrained { mesh: surface, normals, turned } =
        restrained(input, surface, normals, allowed)?;
    let surface = in_the_middle(input, surface, &normals, limit)?;
    let Unflipped { mesh, flipped } = without_flips(mesh, surface, &normals, &follow)?;
    let (approach, expected_error) = (Some(approach), Some(expected_error.max(turned)));
    Ok(Denoised { mesh, limit, approach, expected_error, flipped, undecided: 0.0 })
}
