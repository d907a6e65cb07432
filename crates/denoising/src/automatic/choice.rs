//! The choice of the method that finds the normals.

use glam::DVec3;

use super::correlation::{
    correlation_across_edges, is_sheet_of_waves, mean_displacement, variance_of_means,
};
use super::impulses::has_impulses;
use super::merge::VolumeNoise;
use super::model::{Model, Trained};
use super::planes::{Evidence, flatten};
use super::stage::{advance, blocks};
use super::state::{MAX_DEVIATIONS, State};
use crate::error::DenoiseError;
use crate::faces::FaceLists;
use crate::masked::Masked;
use crate::noise_level::NoiseEstimate;
use crate::noise_scale::level_at_scale;
use crate::total_generalised_variation::{TotalGeneralisedVariationOptions, filtered_normals};

/// The approach that [`automatic`](super::automatic) chose for a mesh.
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

/// The strength of denoising, and the noise that is looked for.
#[derive(Debug, Clone, Copy)]
pub(super) struct Settings {
    pub(super) strength: f64,
    /// The noise of the surface of a volume.
    pub(super) volume_noise: Option<VolumeNoise>,
    /// Impulses have been found and removed. Then correlated noise is not looked for.
    pub(super) impulses_removed: bool,
}

/// The method that finds the normals.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Method {
    /// The networks for all meshes.
    Networks,
    /// The networks for correlated noise.
    CorrelatedNetworks,
    /// The filter of the published method.
    TotalGeneralisedVariation,
}

/// The measurements that decide on the method.
struct Measured {
    /// The noise is that of a depth camera.
    from_camera: bool,
    /// The mean error of normals that the networks for all meshes predict for their result, in
    /// degrees.
    expected_error: f64,
    /// The result of the networks for correlated noise; `None` unless the displacements by the
    /// others are correlated.
    correlated: Option<Correlated>,
}

/// The result of the networks for correlated noise.
struct Correlated {
    /// They move the vertices less than the networks for all meshes.
    moves_less: bool,
    surface: Surface,
}

enum Surface {
    /// The surface of a volume.
    Volume,
    /// A sheet of waves, or a quarter of it in planes.
    WavesOrPlanes,
    Other,
}

/// The expected error of the networks, in degrees, above which they may have taken correlated noise
/// for shape. The best of 0, 1, 1.5, 2, 2.5 and 3 on scans and models of the development set.
const MISTAKEN: f64 = 2.0;

/// Chooses the method:
///
/// | Noise | Surface | Networks | Method |
/// |---|---|---|---|
/// | of a depth camera | any | expect an error above 2° | total generalised variation |
/// | correlated | waves or planes | any | networks for correlated noise |
/// | correlated | of a volume | for correlated noise do not move less | the same |
/// | correlated | other | for correlated noise move less | the same |
/// | otherwise | | | networks for all meshes |
///
/// On surfaces of volumes, the networks for all meshes mistake filtered noise for shape and move
/// vertices less; on others, they mistake relief for noise and move vertices more.
fn choose(measured: &Measured) -> Method {
    if measured.from_camera && measured.expected_error > MISTAKEN {
        return Method::TotalGeneralisedVariation;
    }
    let is_better = measured.correlated.as_ref().is_some_and(|found| match found.surface {
        Surface::Volume => !found.moves_less,
        Surface::WavesOrPlanes => true,
        Surface::Other => found.moves_less,
    });
    if is_better { Method::CorrelatedNetworks } else { Method::Networks }
}

/// The normals of a surface without noise.
pub(super) struct Normals {
    pub(super) approach: Approach,
    pub(super) normals: Vec<DVec3>,
    /// The faces around each.
    pub(super) rings: FaceLists,
    /// The noise level, and the largest displacement, as the distance of the surface from the noisy
    /// mesh shows them.
    pub(super) sigma: f64,
    pub(super) limit: f64,
    /// As in [`Automatic`](super::Automatic).
    pub(super) expected_error: f64,
    /// The distance of the noisy mesh from its planes, root mean square, if a quarter of it lies in
    /// planes: a level of the noise at all scales.
    pub(super) planes: f64,
}

impl Normals {
    /// The normals by the method that is chosen for the noise of this level.
    pub(super) fn find(
        input: Masked<'_>,
        level: NoiseEstimate,
        settings: Settings,
    ) -> Result<Self, DenoiseError> {
        let state = after_stages(input, level, Trained::ForAll)?;
        let mut other = None;
        if !settings.impulses_removed && is_correlated(&state) {
            other = Some(after_stages(input, level, Trained::ForCorrelated)?);
        }
        let measured = Measured {
            from_camera: level.correlation_length > 0.0,
            expected_error: expected_error(Trained::ForAll, &state),
            correlated: other.as_ref().map(|other| compared(&state, other, settings)),
        };
        let error = measured.expected_error;
        match (choose(&measured), other) {
            (Method::CorrelatedNetworks, Some(other)) => {
                let own = expected_error(Trained::ForCorrelated, &other);
                Ok(Self::of_networks(other, error.max(own)))
            }
            (Method::TotalGeneralisedVariation, _) => {
                Self::of_networks(state, error).filtered(input, level, settings.strength)
            }
            _ => Ok(Self::of_networks(state, error)),
        }
    }

    fn of_networks(state: State<'_>, expected_error: f64) -> Self {
        let (normals, planes) = in_planes(&state);
        let (sigma, limit) = (state.limit / MAX_DEVIATIONS, state.limit);
        let approach = Approach::Networks;
        Self { approach, normals, rings: state.rings, sigma, limit, expected_error, planes }
    }

    /// The normals of total generalised variation instead of those of networks.
    fn filtered(
        self,
        input: Masked<'_>,
        level: NoiseEstimate,
        strength: f64,
    ) -> Result<Self, DenoiseError> {
        let mesh = input.mesh();
        let two = level_at_scale(mesh, 2).unwrap_or(level.wide_sigma / strength);
        let two = two / mesh.mean_edge_length();
        let weight = WEIGHT * strength * two;
        let options = TotalGeneralisedVariationOptions { weight, ..Default::default() };
        let sigma = level.wide_sigma;
        let (factor, power) = EXPECTED_FILTERED;
        Ok(Self {
            approach: Approach::TotalGeneralisedVariation,
            normals: filtered_normals(mesh, &options)?,
            sigma,
            limit: MAX_DEVIATIONS * sigma,
            expected_error: factor * libm::pow(two, power),
            ..self
        })
    }
}

/// The weight of total generalised variation over the noise level at two edges. The best of 1.4 to
/// 6.2 on scans of the models of the development set by a depth camera.
const WEIGHT: f64 = 3.2;

/// The factor and the power by which the noise level at two edges, in mean edge lengths, predicts
/// the mean angle between the normals of total generalised variation and the truth, in degrees: a
/// fit of logarithms on scans of the models of the development set by a depth camera.
const EXPECTED_FILTERED: (f64, f64) = (19.3, 0.73);

/// The mean angle between normals and truth, in degrees, that the disagreement of the networks of
/// the last stage predicts, by a factor and a power: fits of logarithms on the development set with
/// networks of 96 units (a fit with those of 128 is no better on this set), and on views of its
/// models.
fn expected_error(trained: Trained, state: &State<'_>) -> f64 {
    let (factor, power) = match trained {
        Trained::ForAll => (750.0, 0.99),
        Trained::ForCorrelated => (2810.0, 1.134),
    };
    factor * libm::pow(state.apart, power)
}

/// The state after the last stage of a released model.
fn after_stages(
    input: Masked<'_>,
    level: NoiseEstimate,
    trained: Trained,
) -> Result<State<'_>, DenoiseError> {
    let model = Model::released(trained).ok_or(DenoiseError::Model)?;
    let blocks = blocks(input.mesh().face_count());
    fairing_watch::stage("normals", (model.stages.len() * blocks) as u64);
    let mut state = State::new(input, level);
    for networks in &model.stages {
        advance(&mut state, networks)?;
    }
    Ok(state)
}

/// The least correlation of displacements across edges that shows correlated noise. On models and
/// views of the development set it is negative under independent noise of 0.05 edges or more, and
/// 0.23 or more under correlated noise on 143 of 144.
const CORRELATED: f64 = 0.15;

/// Returns `true` if the displacements of the last stage show that the noise is correlated. That of
/// a depth camera was found before. Between impulses, the displacements of the other vertices are
/// correlated, too.
fn is_correlated(state: &State<'_>) -> bool {
    state.level.correlation_length == 0.0
        && correlation_across_edges(state) > CORRELATED
        && !has_impulses(state.input, &state.surface)
}

/// The networks for correlated noise against those for all meshes.
fn compared(state: &State<'_>, correlated: &State<'_>, settings: Settings) -> Correlated {
    let moves_less = mean_displacement(correlated) < mean_displacement(state);
    let surface = if settings.volume_noise.is_some() {
        Surface::Volume
    } else if is_sheet_of_waves(state.mesh(), &state.level) || in_planes(correlated).1 > 0.0 {
        Surface::WavesOrPlanes
    } else {
        Surface::Other
    };
    Correlated { moves_less, surface }
}

/// The normals, with faces in one plane sharing its normal, and the distance from planes as in
/// [`Normals`].
fn in_planes(state: &State<'_>) -> (Vec<DVec3>, f64) {
    let mut normals = state.normals.clone();
    let variance = variance_of_means(state);
    let evidence = Evidence::new(state.mesh(), &state.hinges, &state.trust, variance);
    let square = flatten(&evidence, &mut normals);
    (normals, square.map_or(0.0, |square| square.sqrt() * state.h))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All rows of the table.
    #[test]
    fn the_noise_and_the_surface_decide() {
        let camera = |expected_error| {
            choose(&Measured { from_camera: true, expected_error, correlated: None })
        };
        assert_eq!(camera(2.1), Method::TotalGeneralisedVariation);
        assert_eq!(camera(1.9), Method::Networks);
        let independent = Measured { from_camera: false, expected_error: 9.0, correlated: None };
        assert_eq!(choose(&independent), Method::Networks);
        let correlated = |surface, moves_less| {
            let correlated = Some(Correlated { moves_less, surface });
            let measured = Measured { from_camera: false, expected_error: 9.0, correlated };
            choose(&measured) == Method::CorrelatedNetworks
        };
        assert!(correlated(Surface::WavesOrPlanes, true));
        assert!(correlated(Surface::WavesOrPlanes, false));
        assert!(correlated(Surface::Volume, false) && !correlated(Surface::Volume, true));
        assert!(correlated(Surface::Other, true) && !correlated(Surface::Other, false));
    }
}
