//! Weighted regression of the densities of corrected measures.

use fairing_sparse::{larger, smaller};
use glam::DVec3;
use pulp::NullaryFnOnce;

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

/// Products of a row (1, x, y, ρ² + s) with itself, weighted, and with four values.
type Products = [[f64; 8]; 4];

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

/// The values at the centre. Sets the cosines of the neighbours; `points` is memory.
pub(super) fn fits(sites: &Sites, found: &mut [Neighbor], points: &mut Vec<Point>) -> Fits {
    let v = found[0].vertex as usize;
    let (sums, cosines) = pulp::Arch::new().dispatch(Summing { sites, found, points });
    let fit = |k: usize| if cosines[k] > MIN_COSINE { solve(&sums[k]) } else { None };
    let fits: [Option<Fit>; RADII.len()] = std::array::from_fn(fit);
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
        let [area, of_row @ ..] = sums[r][0];
        let of = |k: usize| of_row[3 + k] / area;
        let is_valid = cosines[r] > MIN_COSINE_OF_MEAN && area > 0.0;
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

/// The sums of the products and the least cosine, for each radius.
///
/// A kernel, as are those of jets, runs with the widest vectors of the processor, so all functions
/// that it calls are `#[inline(always)]`. Nothing is fused and no sum reordered: the bits are the
/// same everywhere.
struct Summing<'a> {
    sites: &'a Sites,
    found: &'a mut [Neighbor],
    points: &'a mut Vec<Point>,
}

impl NullaryFnOnce for Summing<'_> {
    type Output = ([Products; RADII.len()], [f64; RADII.len()]);

    #[inline(always)]
    fn call(self) -> Self::Output {
        let Self { sites, found, points } = self;
        let centre = &sites.all[found[0].vertex as usize];
        let unit = 1.0 / sites.length[found[0].vertex as usize];
        let frame = [centre.axis, centre.normal.cross(centre.axis), centre.normal];
        let smear = SMEAR * unit * unit;
        let (mut cosines, mut ends) = ([1f64; RADII.len()], [0; RADII.len()]);
        points.clear();
        for neighbor in found {
            let site = &sites.all[neighbor.vertex as usize];
            neighbor.cosine = site.normal.dot(centre.normal);
            points.extend(Point::new(site, neighbor, frame, smear));
            for k in 0..RADII.len() {
                if neighbor.square < RADII[k] * RADII[k] {
                    cosines[k] = smaller(cosines[k], neighbor.cosine);
                    ends[k] = points.len();
                }
            }
        }
        let mut sums = [[[0.0; 8]; 4]; RADII.len()];
        for k in 0..RADII.len() {
            let inverse = 1.0 / (RADII[k] * RADII[k]);
            let mut sum = [[0.0; 8]; 4];
            for point in &points[..ends[k]] {
                let inside = larger(1.0 - point.square * inverse, 0.0);
                let weight = inside * inside;
                for i in 0..4 {
                    for j in 0..8 {
                        sum[i][j] += weight * (point.row[i] * point.values[j]);
                    }
                }
            }
            sums[k] = sum;
        }
        (sums, cosines)
    }
}

/// A point of a regression.
#[derive(Debug, Clone, Copy)]
pub(super) struct Point {
    row: [f64; 4],
    /// The row times the area, and four values.
    values: [f64; 8],
    square: f64,
}

impl Point {
    #[inline(always)]
    fn new(site: &Site, neighbor: &Neighbor, frame: [DVec3; 3], smear: f64) -> Option<Self> {
        let [c, s] = turn_of_frame([site.axis, site.normal], frame, neighbor.cosine)?;
        let (c2, s2) = (c * c - s * s, 2.0 * c * s);
        let [h, k, p, q] = site.measure;
        let [x, y, _] = neighbor.point;
        let t = x * x + y * y + smear * site.spread;
        let area = site.area;
        let [p, q] = [c2 * p - s2 * q, s2 * p + c2 * q];
        let values = [area, area * x, area * y, area * t, h, k, p, q];
        Some(Self { row: [1.0, x, y, t], values, square: neighbor.square })
    }
}

fn solve(sums: &Products) -> Option<Fit> {
    // The part of the factor is below the diagonal.
    let matrix: [[f64; 4]; 4] = std::array::from_fn(|i| sums.map(|products| products[i]));
    let factor = NormalEquations::from_sums(matrix, [0.0; 4]).factor()?;
    let solutions: [[f64; 4]; 4] =
        std::array::from_fn(|k| factor.solve(&sums.map(|products| products[4 + k])));
    let leverage = factor.solve(&[1.0, 0.0, 0.0, 0.0])[0] * matrix[0][0];
    Some(Fit { value: solutions.map(|s| s[0]), bend: solutions.map(|s| s[3]), leverage })
}
