//! Weighted regression of the densities of corrected measures.

use glam::DVec3;

use super::gather::{Neighbor, turn_of_frame};
use super::site::Sites;
use crate::NormalEquations;

/// The radii of the regressions, in local mean edges.
pub(super) const RADII: [f64; 6] = [2.0, 2.75, 4.0, 5.5, 8.0, 11.0];

/// The least cosine between the normals of a neighbourhood and its centre.
const MIN_COSINE: f64 = -0.2;

/// The same for a mean.
const MIN_COSINE_OF_MEAN: f64 = -0.5;

/// One-ring densities are means over some disc: f + SMEAR × spread × (coefficient of x² + y²).
/// On a regular plane of triangles with sides h the spread is 5 h² / 12, and the densities of
/// curvature come out as f + 0.23 h² Δf.
const SMEAR: f64 = 2.2;

/// Products of a row (1, x, y, ρ² + s) with itself and with four values.
const PRODUCTS: usize = 10 + 16;

/// A regression: H, K and the two parts of the second form without its trace, in local units.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fit {
    /// The intercepts.
    pub(super) value: [f64; 4],
    /// The coefficients of ρ² + s.
    bend: [f64; 4],
    leverage: f64,
}

/// The number of the means, which leave out the first radius.
pub(super) const MEANS: usize = RADII.len() - 1;

/// Values at the centre, in local units.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fits {
    /// Those of one ring without the smear, then those of each radius.
    pub(super) regressions: [Option<[f64; 4]>; 1 + RADII.len()],
    /// The means of each radius but the first.
    pub(super) means: [Option<[f64; 4]>; MEANS],
    /// The variance of the intercept over that of the mean, for independent values.
    pub(super) leverage: [f64; RADII.len()],
}

/// The values at the centre.
pub(super) fn fits(sites: &Sites, found: &[Neighbor]) -> Fits {
    let (sums, cosines, regressions) = regressions(sites, found);
    let v = found[0].vertex as usize;
    let bent = regressions[1].or(regressions[0]);
    let smear = smear(sites, v, 1.0 / sites.length[v]);
    let value = density(sites, v, 1.0 / sites.length[v]);
    let one_ring =
        bent.zip(value).map(|(fit, value)| std::array::from_fn(|k| value[k] - smear * fit.bend[k]));
    let mut all = [None; 1 + RADII.len()];
    all[0] = one_ring;
    for (to, fit) in all[1..].iter_mut().zip(&regressions) {
        *to = fit.map(|fit| fit.value);
    }
    let mean = |r: usize| {
        let of = |k: usize| sums[r][10 + 4 * k] / sums[r][0];
        (cosines[r] > MIN_COSINE_OF_MEAN && sums[r][0] > 0.0).then(|| std::array::from_fn(of))
    };
    Fits {
        regressions: all,
        means: std::array::from_fn(|k| mean(k + 1)),
        leverage: regressions.map(|fit| fit.map_or(1.0, |fit| fit.leverage)),
    }
}

/// The measures at a vertex, in local units.
fn measure(sites: &Sites, v: usize, unit: f64) -> [f64; 4] {
    let [mean, gaussian, p, q] = sites.all[v].measure;
    [mean * unit, gaussian, p * unit, q * unit]
}

/// The one-ring density at a vertex, in local units; `None` without a positive area.
pub(super) fn density(sites: &Sites, v: usize, unit: f64) -> Option<[f64; 4]> {
    let area = sites.all[v].area * unit * unit;
    (area > 0.0).then(|| measure(sites, v, unit).map(|x| x / area))
}

fn smear(sites: &Sites, v: usize, unit: f64) -> f64 {
    SMEAR * sites.all[v].spread * unit * unit
}

type Sums = [[f64; PRODUCTS]; RADII.len()];

fn regressions(
    sites: &Sites,
    found: &[Neighbor],
) -> (Sums, [f64; RADII.len()], [Option<Fit>; RADII.len()]) {
    let centre = &sites.all[found[0].vertex as usize];
    let unit = 1.0 / sites.length[found[0].vertex as usize];
    let frame = [centre.axis, centre.normal.cross(centre.axis), centre.normal];
    let mut sums = [[0.0; PRODUCTS]; RADII.len()];
    let mut cosines = [1f64; RADII.len()];
    for neighbor in found {
        let first = RADII.iter().position(|r| neighbor.square < r * r).unwrap_or(RADII.len());
        for cosine in &mut cosines[first..] {
            *cosine = cosine.min(neighbor.cosine);
        }
        if let Some(products) = products(sites, neighbor, frame, unit) {
            for (sum, r) in sums[first..].iter_mut().zip(&RADII[first..]) {
                let inside = 1.0 - neighbor.square / (r * r);
                let weight = inside * inside;
                for (s, p) in sum.iter_mut().zip(&products) {
                    *s += weight * p;
                }
            }
        }
    }
    let fit = |k: usize| if cosines[k] > MIN_COSINE { solve(&sums[k]) } else { None };
    (sums, cosines, std::array::from_fn(fit))
}

#[inline]
fn products(
    sites: &Sites,
    neighbor: &Neighbor,
    frame: [DVec3; 3],
    unit: f64,
) -> Option<[f64; PRODUCTS]> {
    let w = neighbor.vertex as usize;
    let site = &sites.all[w];
    let [c, s] = turn_of_frame([site.axis, site.normal], frame, neighbor.cosine)?;
    let (c2, s2) = (c * c - s * s, 2.0 * c * s);
    let [mean, gaussian, p, q] = measure(sites, w, unit);
    let area = site.area * unit * unit;
    let values = [mean, gaussian, c2 * p - s2 * q, s2 * p + c2 * q];
    let [x, y, _] = neighbor.point;
    let row = [1.0, x, y, x * x + y * y + smear(sites, w, unit)];
    let mut products = [0.0; PRODUCTS];
    let mut at = 0;
    for i in 0..4 {
        for j in 0..=i {
            products[at] = area * row[i] * row[j];
            at += 1;
        }
    }
    for value in values {
        for x in row {
            products[at] = x * value;
            at += 1;
        }
    }
    Some(products)
}

fn solve(sums: &[f64; PRODUCTS]) -> Option<Fit> {
    let mut matrix = [[0.0; 4]; 4];
    let mut at = 0;
    for i in 0..4 {
        for j in 0..=i {
            matrix[i][j] = sums[at];
            at += 1;
        }
    }
    let factor = NormalEquations::from_sums(matrix, [0.0; 4]).factor()?;
    let solutions: [[f64; 4]; 4] =
        std::array::from_fn(|k| factor.solve(&std::array::from_fn(|i| sums[10 + 4 * k + i])));
    let leverage = factor.solve(&[1.0, 0.0, 0.0, 0.0])[0] * matrix[0][0];
    Some(Fit { value: solutions.map(|s| s[0]), bend: solutions.map(|s| s[3]), leverage })
}
