//! Weighted regression of the densities of corrected measures.

use glam::DVec3;

use super::gather::{Neighbor, turn_of_frame};
use super::site::{Site, Sites};
use crate::normal_equations::NormalEquations;

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

/// A regression: H, K and the two parts of the second form without its trace.
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
    /// Regressions over one ring without the smear, then over each radius.
    pub(super) regressions: [Option<[f64; 4]>; 1 + RADII.len()],
    /// The means of each radius but the first.
    pub(super) means: [Option<[f64; 4]>; MEANS],
    /// The variance of the intercept over that of the mean, for independent values.
    pub(super) leverage: [f64; RADII.len()],
}

/// The values at the centre.
pub(super) fn fits(sites: &Sites, found: &[Neighbor]) -> Fits {
    let (sums, cosines) = sums(sites, found);
    let fit = |k: usize| if cosines[k] > MIN_COSINE { solve(&sums[k]) } else { None };
    let fits: [Option<Fit>; RADII.len()] = std::array::from_fn(fit);
    let v = found[0].vertex as usize;
    let length = sites.length[v];
    let smear = SMEAR * sites.all[v].spread / (length * length);
    let one_ring = fits[1].or(fits[0]).zip(density(sites, v)).map(|(fit, value)| {
        let bend = in_local_units(fit.bend, length);
        std::array::from_fn(|k| value[k] - smear * bend[k])
    });
    let mut regressions = [None; 1 + RADII.len()];
    regressions[0] = one_ring;
    for (to, fit) in regressions[1..].iter_mut().zip(&fits) {
        *to = fit.map(|fit| in_local_units(fit.value, length));
    }
    let mean = |r: usize| {
        let of = |k: usize| sums[r][10 + 4 * k] / sums[r][0];
        let is_valid = cosines[r] > MIN_COSINE_OF_MEAN && sums[r][0] > 0.0;
        is_valid.then(|| in_local_units(std::array::from_fn(of), length))
    };
    Fits {
        regressions,
        means: std::array::from_fn(|k| mean(k + 1)),
        leverage: fits.map(|fit| fit.map_or(1.0, |fit| fit.leverage)),
    }
}

/// The one-ring density at a vertex, in local units; `None` without a positive area.
pub(super) fn density(sites: &Sites, v: usize) -> Option<[f64; 4]> {
    let Site { area, measure, .. } = sites.all[v];
    (area > 0.0).then(|| in_local_units(measure.map(|x| x / area), sites.length[v]))
}

fn in_local_units([mean, gaussian, p, q]: [f64; 4], length: f64) -> [f64; 4] {
    [mean * length, gaussian * length * length, p * length, q * length]
}

type Sums = [[f64; PRODUCTS]; RADII.len()];

/// The sums of the products and the least cosine, for each radius.
fn sums(sites: &Sites, found: &[Neighbor]) -> (Sums, [f64; RADII.len()]) {
    let centre = &sites.all[found[0].vertex as usize];
    let unit = 1.0 / sites.length[found[0].vertex as usize];
    let frame = [centre.axis, centre.normal.cross(centre.axis), centre.normal];
    let smear = SMEAR * unit * unit;
    let mut sums = [[0.0; PRODUCTS]; RADII.len()];
    let mut cosines = [1f64; RADII.len()];
    for neighbor in found {
        let Some(first) = RADII.iter().position(|r| neighbor.square < r * r) else { continue };
        cosines[first] = cosines[first].min(neighbor.cosine);
        let site = &sites.all[neighbor.vertex as usize];
        if let Some(products) = products(site, neighbor, frame, smear) {
            for (sum, r) in sums[first..].iter_mut().zip(&RADII[first..]) {
                let inside = 1.0 - neighbor.square * (1.0 / (r * r));
                let weight = inside * inside;
                for (s, p) in sum.iter_mut().zip(&products) {
                    *s += weight * p;
                }
            }
        }
    }
    for k in 1..RADII.len() {
        cosines[k] = cosines[k].min(cosines[k - 1]);
    }
    (sums, cosines)
}

#[inline]
fn products(
    site: &Site,
    neighbor: &Neighbor,
    frame: [DVec3; 3],
    smear: f64,
) -> Option<[f64; PRODUCTS]> {
    let [c, s] = turn_of_frame([site.axis, site.normal], frame, neighbor.cosine)?;
    let (c2, s2) = (c * c - s * s, 2.0 * c * s);
    let [mean, gaussian, p, q] = site.measure;
    let values = [mean, gaussian, c2 * p - s2 * q, s2 * p + c2 * q];
    let [x, y, _] = neighbor.point;
    let row = [1.0, x, y, x * x + y * y + smear * site.spread];
    let mut products = [0.0; PRODUCTS];
    let mut at = 0;
    for i in 0..4 {
        for j in 0..=i {
            products[at] = site.area * row[i] * row[j];
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
