//! Curvature at a scale that is chosen at each vertex.
//!
//! Three families of candidates, at radii of 1.4 to 11 local mean edges (the mean of the edges at
//! a vertex, smoothed four times):
//!
//! - weighted regressions of the densities ½ μ¹/μ⁰ and μ²/μ⁰ of [corrected
//!   measures](super::corrected_curvature) on 1, x, y and ρ² in the tangent plane;
//! - weighted means of the same densities;
//! - jets of degree 4 in which x² + y² is replaced by x² + y² + z², so that spheres are exact.
//!
//! The noise σ along the normal is the median distance from a jet over its standard deviation. It
//! gives the variance of each candidate: for jets from their equations, for the others from a
//! regular plane. The squared bias of a candidate θ of radius r is
//!
//! ```text
//! b² = q² [P(θ₊ − θ)² − P Var(θ₊ − θ)]₊,    q = ρᵖ / (1 − ρᵖ),    ρ = r / r₊
//! ```
//!
//! with θ₊ the candidate of the next larger radius, P a mean over the neighbours within about 4
//! edges, and p = 4, or p = 2 for means. The squared bias is at least that of smaller radii of the
//! family, and at least the significant part of the differences from them and from the best jet.
//! Candidates have weights (b² + Var)⁻⁴, separately for H and for K. The standard error is √(b² +
//! Var) of the weighted mean.
//!
//! Candidates are left out where the surface turns too far. Where it turns by more than about 100°
//! within 2.75 edges, H and K are those of the [cotangent formula](super::cotangent_curvature) and
//! the angle defect on clean meshes, and densities of one ring under noise.
//!
//! **At borders** neighbourhoods are one-sided, so variance and bias are scaled as the equations of
//! each fit require. Under noise of a tenth of an edge, the error within three rings of a border is
//! several times that inside. **At creases** the field is smoothed over some scale, and its
//! standard error is too small.
//!
//! Constants were chosen on 28 surfaces (`tuning` in `examples/adaptive.rs`), the treatment of
//! coarse neighbourhoods also on 28 others (`checking`); nothing was chosen on the last 28
//! (`judging`). RMS errors there, over those of the best of all other estimators and of eight radii
//! of `corrected-ball` chosen with the truth, for H and K:
//!
//! ```text
//! noise, in edges    median         worst          truth within the error
//! none               0.28, 0.20     2.0, 1.9       0.67, 0.72
//! 0.03 and 0.12      0.80, 0.85     1.2, 1.4       0.75, 0.72
//! 0.3                1.25, 0.91     7.5, 79        0.52, 0.38
//! ```
//!
//! At 0.3 edges faces fold, and neither values nor errors should be relied on.
//!
//! Normals of samples are weighted as in [max1999], measures are those of [lachaud2020], jets
//! follow [cazals2005].
//!
//! [max1999]: https://doi.org/10.1080/10867651.1999.10487501
//! [lachaud2020]: https://doi.org/10.1111/cgf.14067
//! [cazals2005]: https://doi.org/10.1016/j.cagd.2004.09.004

mod candidate;
mod combine;
mod gather;
mod jets;
mod kind;
mod noise;
mod regression;
mod risk;
mod site;
mod systems;

use fairing_mesh::TriMesh;
use fairing_parameters::Options;
use fairing_watch::parallel;

use self::candidate::{Candidates, Level, Work};
use self::combine::{Combined, POWER, combine};
pub use self::kind::NoiseKind;
use self::noise::Noise;
use self::regression::density;
use self::site::Sites;
use super::cotangent::{self, CotangentOptions};
use super::field::CurvatureField;
use super::oriented::on_oriented;
use super::status::Undefined;
use crate::error::OperatorError;

fairing_parameters::options! {
    /// Options of [`adaptive_curvature`].
    #[derive(Debug, Clone, Copy, PartialEq)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    #[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
    pub struct AdaptiveOptions {
        /// The relation between the noise of neighbouring vertices.
        pub noise: NoiseKind = NoiseKind::Independent;
    }
    "adaptive": "recommended: chooses its scale at each vertex, and gives standard errors",
        ["lachaud2020", "cazals2005"];
}

/// Estimates curvature at a scale chosen at each vertex, with standard errors, scales and the level
/// of noise ([`CurvatureField::accuracy`]).
///
/// H and K are combined separately, so κ₁ κ₂ = K holds only within their errors; κ₁ + κ₂ = 2H is
/// exact. Undefined at isolated vertices, at vertices without a normal, and where one ring has no
/// area along its normals and no larger neighbourhood is valid. n·log n for n vertices: a
/// neighbourhood has at most 1200 of them.
///
/// # Errors
///
/// None: every option is valid.
pub fn adaptive_curvature(
    mesh: &TriMesh,
    options: AdaptiveOptions,
) -> Result<CurvatureField, OperatorError> {
    options.check()?;
    on_oriented(mesh, |mesh| Ok(estimate(mesh, options)))
}

fn estimate(mesh: &TriMesh, options: AdaptiveOptions) -> CurvatureField {
    let topology = mesh.topology();
    let sites = Sites::new(mesh);
    let noise = noise::noise(mesh, &sites, options.noise);
    let count = mesh.vertex_count();
    let all: Vec<Candidates> = parallel::map_with(count, 1024, Work::default, |work, v| {
        if sites.length[v] > 0.0 {
            Candidates::new(&sites, topology, work, v as u32, noise[v].extent).0
        } else {
            Candidates::none()
        }
    });
    let level = |(noise, length): (&Noise, &f64)| Level {
        heights: (noise.heights / length).powi(2),
        measures: (noise.measures / length).powi(2),
    };
    let levels: Vec<Level> = noise.iter().zip(&sites.length).map(level).collect();
    let bias = risk::squared_bias(topology, &all, &levels, options.noise);
    let coarse = coarse(mesh, &sites, &all, &levels);
    let at = |v: usize| {
        if mesh.incidence().corners(v as u32).is_empty() {
            return Err(Undefined::Isolated);
        }
        combine(&sites, v, &all[v], &bias[v], levels[v], noise[v].extent, coarse[v])
    };
    let found: Vec<Result<Combined, Undefined>> = parallel::map(count, 1024, at);
    combine::field(mesh, &sites, &noise, found)
}

/// The variance of the noise, in squared local mean edges, up to which the cotangent formula is
/// taken on coarse neighbourhoods.
const COARSE_NOISE: f64 = 0.06 * 0.06;

/// H and K and their squared errors, in the unit of the sites, where the neighbourhood is too
/// coarse for any fit: the mean of two estimates, the cotangent formula with the angle defect,
/// which has little bias, and the density of corrected measures of one ring, which has little
/// noise.
///
/// The difference of both is rough where it is noise of the former, and smooth where it is bias of
/// the latter.
fn coarse(
    mesh: &TriMesh,
    sites: &Sites,
    all: &[Candidates],
    levels: &[Level],
) -> Vec<Option<[[f64; 2]; 2]>> {
    let topology = mesh.topology();
    let is_coarse = |v: usize| {
        all[v].is_coarse()
            && levels[v].heights <= COARSE_NOISE
            && !topology.is_boundary_vertex(v as u32)
    };
    let mut found = vec![None; all.len()];
    if !(0..all.len()).any(is_coarse) {
        return found;
    }
    let Ok(field) = cotangent::estimate(mesh, CotangentOptions::DEFAULT) else { return found };
    let both = |v: usize| {
        let [mean, gaussian, ..] = density(sites, v).filter(|_| field.status[v].is_defined())?;
        let (unit, length) = (sites.unit, sites.length[v]);
        let cotangent = [field.mean[v] * unit, field.gaussian[v] * unit * unit];
        Some([cotangent, [mean / length, gaussian / (length * length)]])
    };
    let both: Vec<Option<[[f64; 2]; 2]>> = (0..all.len()).map(both).collect();
    let [of_mean, of_gaussian] = [0, 1].map(|q| {
        let gaps: Vec<f64> = both.iter().map(|x| x.map_or(0.0, |[c, d]| c[q] - d[q])).collect();
        let rough = |v: usize| {
            let neighbors = topology.neighbors(v as u32);
            let sum: f64 = neighbors.iter().map(|&w| gaps[w as usize]).sum();
            (gaps[v] - sum / (neighbors.len() as f64).max(1.0)).powi(2)
        };
        let noise = site::smoothed(mesh, (0..all.len()).map(rough).collect());
        (noise, site::smoothed(mesh, gaps))
    });
    for v in (0..all.len()).filter(|&v| is_coarse(v)) {
        found[v] = both[v].map(|[cotangent, density]| {
            [0, 1].map(|q| {
                let (noise, bias) = [&of_mean, &of_gaussian][q];
                let (noise, bias) = (noise[v], bias[v] * bias[v]);
                let risks = [noise + COTANGENT_BIAS * bias, bias + ONE_RING_NOISE * noise];
                let least = risks[0].min(risks[1]) + f64::MIN_POSITIVE;
                let [a, b] = risks.map(|r| (least / (r + f64::MIN_POSITIVE)).powi(POWER));
                let of_density = b / (a + b);
                let value = cotangent[q] + of_density * (density[q] - cotangent[q]);
                [value, risks[0] + of_density * (risks[1] - risks[0])]
            })
        });
    }
    found
}

/// The variance of the density of one ring over that of the cotangent formula.
const ONE_RING_NOISE: f64 = 0.05;

/// The squared bias of the cotangent formula over that of the density of one ring.
const COTANGENT_BIAS: f64 = 0.2;

#[cfg(test)]
mod tests;
