//! The mean of the candidates, weighted by their risks.

use fairing_mesh::TriMesh;
use glam::DVec3;

use super::super::field::{Accuracy, AtVertex, CurvatureField};
use super::super::status::Undefined;
use super::candidate::{COUNT, Candidates, JETS, Level, QUANTITIES, Quantity, RADII};
use super::gather::Extent;
use super::noise::Noise;
use super::regression::density;
use super::risk::SquaredBias;
use super::site::{Site, Sites};
use crate::tangent::Symmetric2;

/// The weight of a candidate is the risk to the power of minus this.
pub(super) const POWER: i32 = 4;

/// Where many candidates compete, the least of the estimated risks is too small: the errors of the
/// surfaces that constants are chosen on are larger by this.
const CHOSEN: f64 = 1.3;

/// Below this, a squared error in local units is rounding.
const ROUNDING: f64 = 1e-22;

/// The estimate at a vertex.
#[derive(Debug, Clone, Copy)]
pub(super) struct Combined {
    at: AtVertex,
    /// The standard errors of H and K.
    errors: [f64; 2],
    scale: f64,
    normal: DVec3,
}

/// Weights of the candidates that sum to one, and the error.
fn weights(
    all: &Candidates,
    bias: &SquaredBias,
    quantity: Quantity,
    level: Level,
) -> Option<([f64; COUNT], f64)> {
    let risk: [f64; COUNT] = std::array::from_fn(|k| {
        if all.is_valid(k) {
            let variance = all.variance(quantity, k, level);
            f64::from(bias[quantity as usize][k]) + variance + ROUNDING
        } else {
            f64::INFINITY
        }
    });
    let least = risk.iter().copied().fold(f64::INFINITY, f64::min);
    if !least.is_finite() {
        return None;
    }
    let mut weights = risk.map(|r| (least / r).powi(POWER));
    let sum: f64 = weights.iter().sum();
    weights = weights.map(|w| w / sum);
    let terms = weights.iter().zip(&risk).filter(|(w, _)| **w > 0.0);
    let error = terms.map(|(w, r)| w * r).sum::<f64>();
    Some((weights, error.sqrt()))
}

/// The estimate at vertex `v`. Where H and K of a `coarse` neighbourhood are given, they are taken,
/// and the candidates are a check.
pub(super) fn combine(
    sites: &Sites,
    v: usize,
    all: &Candidates,
    bias: &SquaredBias,
    level: Level,
    extent: Extent,
    coarse: Option<[[f64; 2]; 2]>,
) -> Result<Combined, Undefined> {
    let combined = of_candidates(sites, v, all, bias, level, extent)?;
    Ok(match coarse {
        Some(values) => combined.replaced(values, &sites.all[v], sites.length[v]),
        None => combined,
    })
}

/// The mean of the candidates at vertex `v`, or the value of one ring without them.
fn of_candidates(
    sites: &Sites,
    v: usize,
    all: &Candidates,
    bias: &SquaredBias,
    level: Level,
    extent: Extent,
) -> Result<Combined, Undefined> {
    let (site, length) = (&sites.all[v], sites.length[v]);
    if site.normal == DVec3::ZERO || length <= 0.0 {
        return Err(Undefined::NoArea);
    }
    let [of_mean, of_gaussian] = QUANTITIES.map(|q| weights(all, bias, q, level));
    let (Some(of_mean), Some(of_gaussian)) = (of_mean, of_gaussian) else {
        return Combined::one_ring(sites, v);
    };
    let mean = |of: &dyn Fn(usize) -> f64, weights: &[f64; COUNT]| {
        (0..COUNT).filter(|&k| weights[k] > 0.0).map(|k| weights[k] * of(k)).sum::<f64>()
    };
    let h = mean(&|k| all.mean[k], &of_mean.0);
    let k = mean(&|k| all.gaussian[k], &of_gaussian.0);
    let [p, q] = [0, 1].map(|i| mean(&|k| all.deviator[k][i].into(), &of_mean.0));
    let scale = mean(&|k| RADII[k], &of_mean.0);
    let chosen = if extent == Extent::Wide { CHOSEN } else { 1.0 };
    Ok(Combined {
        at: site.at([h, k, p, q], length),
        errors: [chosen * of_mean.1 / length, chosen * of_gaussian.1 / (length * length)],
        scale: scale * length,
        normal: normal(site, all, &of_mean.0),
    })
}

/// The normal of the jets, with their weights among each other; that of the frame without any.
fn normal(site: &Site, all: &Candidates, weights: &[f64; COUNT]) -> DVec3 {
    let (mut lean, mut sum) = ([0.0; 2], 0.0);
    for (k, of_jet) in JETS.zip(&all.lean) {
        sum += weights[k];
        for (lean, x) in lean.iter_mut().zip(of_jet) {
            *lean += weights[k] * f64::from(*x);
        }
    }
    if sum < 1e-100 {
        return site.normal;
    }
    let [x, y] = lean.map(|x| x / sum);
    let z = (1.0 - x * x - y * y).max(0.0).sqrt();
    let turned = x * site.axis + y * site.normal.cross(site.axis) + z * site.normal;
    turned.try_normalize().unwrap_or(site.normal)
}

impl Combined {
    /// Given H and K with their squared errors, in the unit of the sites.
    fn replaced(self, [[h, of_h], [k, of_k]]: [[f64; 2]; 2], site: &Site, length: f64) -> Self {
        let half = 0.5 * (self.at.values[0] - self.at.values[1]);
        let directions = self.at.directions;
        let at = AtVertex { values: [h + half, h - half], mean: h, gaussian: k, directions };
        let errors = [of_h.sqrt(), of_k.sqrt()];
        Self { at, errors, scale: length, normal: site.normal }
    }

    /// The estimate of one ring, without an error estimate.
    fn one_ring(sites: &Sites, v: usize) -> Result<Self, Undefined> {
        let (site, length) = (&sites.all[v], sites.length[v]);
        let value = density(sites, v).ok_or(Undefined::NoArea)?;
        let at = site.at(value, length);
        let errors = [at.mean.abs(), at.gaussian.abs()];
        Ok(Self { at, errors, scale: length, normal: site.normal })
    }
}

impl Site {
    /// H, K and the second form without its trace, in local units.
    fn at(&self, [h, k, p, q]: [f64; 4], length: f64) -> AtVertex {
        let form = Symmetric2 { a: h + p, b: q, c: h - p };
        let frame = [self.axis, self.normal.cross(self.axis)];
        let at = AtVertex::from_form(form, frame, self.normal);
        let unit = 1.0 / length;
        AtVertex {
            values: at.values.map(|k| k * unit),
            mean: h * unit,
            gaussian: k * unit * unit,
            directions: at.directions,
        }
    }
}

/// The field, in mesh units.
pub(super) fn field(
    mesh: &TriMesh,
    sites: &Sites,
    noise: &[Noise],
    found: Vec<Result<Combined, Undefined>>,
) -> CurvatureField {
    let unit = 1.0 / sites.unit;
    let topology = mesh.topology();
    let of = |number: fn(&Combined) -> f64, scale: f64| {
        found.iter().map(|at| at.as_ref().map_or(0.0, |at| number(at) * scale)).collect()
    };
    let accuracy = Accuracy {
        mean_error: of(|at| at.errors[0], unit),
        gaussian_error: of(|at| at.errors[1], unit * unit),
        scale: of(|at| at.scale, sites.unit),
        noise: noise.iter().map(|noise| noise.heights * sites.unit).collect(),
        normals: found
            .iter()
            .map(|at| at.as_ref().map_or([0.0; 3], |at| at.normal.to_array()))
            .collect(),
    };
    let in_mesh_units = |at: AtVertex| AtVertex {
        values: at.values.map(|k| k * unit),
        mean: at.mean * unit,
        gaussian: at.gaussian * unit * unit,
        directions: at.directions,
    };
    let values = found
        .into_iter()
        .enumerate()
        .map(|(v, at)| (at.map(|at| in_mesh_units(at.at)), topology.is_boundary_vertex(v as u32)))
        .collect();
    CurvatureField { accuracy: Some(accuracy), ..CurvatureField::collect(values, true) }
}
