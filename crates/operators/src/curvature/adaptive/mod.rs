//! Curvature that finds its own scale.

mod candidate;
mod combine;
mod gather;
mod jets;
mod noise;
mod regression;
mod risk;
mod site;

use fairing_mesh::TriMesh;
use fairing_parameters::Options;
use rayon::prelude::*;

use self::candidate::{Candidates, Level, Work};
use self::noise::Noise;
use self::combine::{Combined, combine};
use self::site::Sites;
use super::field::CurvatureField;
use super::oriented::on_oriented;
use super::status::Undefined;
use crate::error::OperatorError;

/// How the noise of neighbouring vertices is related.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum NoiseKind {
    /// Each vertex by itself.
    Independent,
    /// Neighbours alike, as the waves of a scanner.
    Correlated,
}

fairing_parameters::choices!(NoiseKind, "kind of noise",
    Independent: "independent", "Each vertex by itself";
    Correlated: "correlated", "Neighbours alike, as the waves of some scanners";
);
#[cfg(feature = "serde")]
fairing_parameters::serde_by_name!(NoiseKind);

fairing_parameters::options! {
    /// Options of [`adaptive_curvature`].
    #[derive(Debug, Clone, Copy, PartialEq)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    #[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
    pub struct AdaptiveOptions {
        /// How the noise of neighbouring vertices is related.
        pub noise: NoiseKind = NoiseKind::Independent;
    }
    "adaptive": "recommended: finds its own scale, and says how far to trust it",
        ["lachaud2020", "cazals2005"];
}

/// Curvature at a scale of its own at each vertex, with standard errors
/// ([`CurvatureField::accuracy`]).
///
/// Undefined at isolated vertices and where faces have no area.
///
/// # Errors
///
/// None at present.
pub fn adaptive_curvature(
    mesh: &TriMesh,
    options: AdaptiveOptions,
) -> Result<CurvatureField, OperatorError> {
    options.check()?;
    Ok(on_oriented(mesh, |mesh| Ok::<_, OperatorError>(estimate(mesh, options)))?)
}

fn estimate(mesh: &TriMesh, options: AdaptiveOptions) -> CurvatureField {
    let topology = mesh.topology();
    let sites = Sites::new(mesh);
    let noise = noise::noise(mesh, &sites);
    let count = mesh.vertex_count() as u32;
    let all: Vec<Candidates> = (0..count)
        .into_par_iter()
        .with_min_len(1024)
        .map_init(Work::default, |work, v| match sites.length[v as usize] > 0.0 {
            true => Candidates::new(&sites, topology, work, v, noise[v as usize].extent).0,
            false => Candidates::none(),
        })
        .collect();
    let level = |(noise, length): (&Noise, &f64)| Level {
        heights: (noise.heights / length).powi(2),
        measures: (noise.measures / length).powi(2),
    };
    let levels: Vec<Level> = noise.iter().zip(&sites.length).map(level).collect();
    let bias = risk::squared_bias(topology, &all, &levels, options.noise);
    let at = |v: u32| {
        if mesh.incidence().corners(v).is_empty() {
            return Err(Undefined::Isolated);
        }
        let v = v as usize;
        combine(&sites, v, &all[v], &bias[v], levels[v])
    };
    let found: Vec<Result<Combined, Undefined>> =
        (0..count).into_par_iter().with_min_len(1024).map(at).collect();
    combine::field(mesh, &sites, &noise, found)
}
