//! Jets of degree 4 that are exact on spheres.
//!
//! ```text
//! z = c₀ + c₁ x + c₂ y + c₃ (x² + y² + z²) + c₄ (x² − y²) + c₅ xy + cubic and quartic terms
//! ```
//!
//! by least squares with weights (1 − d²/r²)²: with z² every sphere through the vertex is one of
//! these surfaces. The curvature is that of the implicit surface, where it meets the normal.

use fairing_sparse::smaller;
use glam::DVec3;
use pulp::NullaryFnOnce;

use super::gather::{Extent, Neighbor};
use super::systems::{Factors, Lanes};
use crate::normal_equations::NormalEquations;
use crate::tangent::tangent_frame;

/// The radii of the jets, in local mean edges.
pub(super) const RADII: [f64; 4] = [2.4, 3.0, 4.0, 5.5];

/// The jet whose residual shows the noise.
const OF_NOISE: usize = 1;

/// The least cosine between the normals of each neighbourhood and its centre.
const MIN_COSINES: [f64; RADII.len()] = [-0.5, 0.0, 0.0, 0.0];

/// The fewest points of a fit with 15 coefficients.
const MIN_POINTS: usize = 18;

/// The coefficients of a jet.
const TERMS: usize = 15;

/// A point of a fit.
#[derive(Debug, Clone, Copy)]
pub(super) struct Row {
    terms: [f64; TERMS],
    weights: [f64; RADII.len()],
}

/// The jets at a vertex, in local units.
#[derive(Debug, Clone, Copy)]
pub(super) struct Jets {
    /// H, K and the two parts of the second form without its trace.
    pub(super) values: [Option<[f64; 4]>; RADII.len()],
    /// The least cosine between the normals of each neighbourhood and its centre.
    pub(super) cosines: [f64; RADII.len()],
    /// The components along the tangents of the normal of each jet.
    pub(super) lean: [[f64; 2]; RADII.len()],
    /// The covariance of H, for noise of variance 1 along the normal.
    pub(super) covariance: [[f64; RADII.len()]; RADII.len()],
    /// The distance of the vertex from a jet over the standard deviation of that for noise of
    /// variance 1, if asked for.
    pub(super) residual: Option<f64>,
}

/// Fits jets to the neighbours; `rows` is memory. The widest of them is left out unless `extent` is
/// wide.
pub(super) fn jets(found: &[Neighbor], rows: &mut Vec<Row>, extent: Extent) -> Jets {
    let (fits, base) = pulp::Arch::new().dispatch(Fitting { found, rows, extent });
    let mut found = Jets {
        values: [None; RADII.len()],
        cosines: fits.cosines,
        lean: [[0.0; 2]; RADII.len()],
        covariance: fits.covariance,
        residual: None,
    };
    for k in (0..RADII.len()).filter(|&k| fits.valid[k]) {
        let coefficients = fits.coefficients.map(|c| c[k]);
        if let Some((value, lean)) = curvature(&coefficients) {
            (found.values[k], found.lean[k]) = (Some(value), lean);
        }
        if k == OF_NOISE && extent == Extent::Sample {
            let variance = Some(fits.residual_variance).filter(|v| *v > MIN_VARIANCE);
            found.residual = variance.map(|v| (base + coefficients[0]).abs() / v.sqrt());
        }
    }
    found
}

/// Fits of all jets, a lane for each.
struct Fits {
    coefficients: [Lanes; TERMS],
    valid: [bool; RADII.len()],
    cosines: [f64; RADII.len()],
    covariance: [[f64; RADII.len()]; RADII.len()],
    /// The variance of the height of the vertex over the jet of the noise, if asked for.
    residual_variance: f64,
}

/// Fits the jets, with the widest vectors of the processor.
struct Fitting<'a> {
    found: &'a [Neighbor],
    rows: &'a mut Vec<Row>,
    extent: Extent,
}

impl NullaryFnOnce for Fitting<'_> {
    /// With the base of heights.
    type Output = (Fits, f64);

    #[inline(always)]
    fn call(self) -> (Fits, f64) {
        let Self { found, rows, extent } = self;
        let count = if extent == Extent::Wide { RADII.len() } else { RADII.len() - 1 };
        let base = base(found);
        let widest = RADII[count - 1] * RADII[count - 1];
        rows.clear();
        let (mut cosines, mut points) = ([1f64; RADII.len()], [0; RADII.len()]);
        let mut sums = [[0.0; MOMENTS]; RADII.len()];
        for neighbor in found {
            if neighbor.square >= widest {
                continue;
            }
            let [x, y, z] = neighbor.point;
            let height = z - base;
            let moments = moments(x, y, height);
            let weights = weights(x * x + y * y + height * height);
            for k in 0..count {
                if weights[k] == 0.0 {
                    continue;
                }
                cosines[k] = smaller(cosines[k], neighbor.cosine);
                points[k] += 1;
                for (sum, moment) in sums[k].iter_mut().zip(&moments) {
                    *sum += weights[k] * moment;
                }
            }
            rows.push(Row { terms: terms(&moments, height), weights });
        }
        let (matrix, rhs) = equations(&sums);
        let factors = Factors::new(&matrix);
        let mut valid = [false; RADII.len()];
        for k in 0..RADII.len() {
            let is_known = cosines[k] > MIN_COSINES[k] && points[k] >= MIN_POINTS;
            let is_spread = factors.determinant[k] > LEAST_DETERMINANT * spread(&sums[k]);
            valid[k] = is_known && is_spread && factors.is_valid(k);
        }
        let fits = Fits {
            coefficients: factors.solve(&rhs),
            valid,
            cosines,
            covariance: covariance(rows, &factors, valid),
            residual_variance: if extent == Extent::Sample {
                residual_variance(rows, &factors)
            } else {
                0.0
            },
        };
        (fits, base)
    }
}

/// The height of the surface over the tangent plane through the vertex, which has noise: the
/// intercept of a paraboloid about the normal.
///
/// Heights in the terms are relative to this base. If they were relative to the vertex, squared
/// heights would contain products of its noise with the noise of the others, and the fit would
/// follow the noise.
#[inline(always)]
fn base(found: &[Neighbor]) -> f64 {
    let (mut matrix, mut rhs) = ([[0.0; 4]; 4], [0.0; 4]);
    for neighbor in found {
        let [x, y, z] = neighbor.point;
        let inside = 1.0 - neighbor.square / (BASE_RADIUS * BASE_RADIUS);
        if inside > 0.0 {
            let row = [1.0, x, y, x * x + y * y];
            for i in 0..4 {
                let weighted = inside * inside * row[i];
                for j in 0..4 {
                    matrix[i][j] += weighted * row[j];
                }
                rhs[i] += weighted * z;
            }
        }
    }
    let solution = NormalEquations::from_sums(matrix, rhs).solve();
    solution.map_or(0.0, |c| c[0].clamp(-0.5, 0.5))
}

/// The radius of the paraboloid.
const BASE_RADIUS: f64 = 3.0;

/// The weights of a point in the jets, zero outside of their balls.
#[inline(always)]
fn weights(square: f64) -> [f64; RADII.len()] {
    let mut weights = [0.0; RADII.len()];
    for (weight, r) in weights.iter_mut().zip(RADII) {
        let inside = 1.0 - square / (r * r);
        *weight = if inside > 0.0 { inside * inside } else { 0.0 };
    }
    weights
}

/// Monomials of x and y up to degree 8 by degree, the first 15 of them times z² and times z, z⁴
/// and z³: the equations of a jet consist of their weighted sums.
const MOMENTS: usize = SQUARES + 2 * TERMS + 2 + 1;
const SQUARES: usize = 45;
const LINEAR: usize = SQUARES + TERMS;
const FOURTH: usize = LINEAR + TERMS;

#[inline(always)]
fn moments(x: f64, y: f64, z: f64) -> [f64; MOMENTS] {
    let mut all = [0.0; MOMENTS];
    all[0] = 1.0;
    next_degree::<1>(&mut all, x, y);
    next_degree::<2>(&mut all, x, y);
    next_degree::<3>(&mut all, x, y);
    next_degree::<4>(&mut all, x, y);
    next_degree::<5>(&mut all, x, y);
    next_degree::<6>(&mut all, x, y);
    next_degree::<7>(&mut all, x, y);
    next_degree::<8>(&mut all, x, y);
    let square = z * z;
    for k in 0..TERMS {
        all[SQUARES + k] = square * all[k];
        all[LINEAR + k] = z * all[k];
    }
    all[FOURTH] = square * square;
    all[FOURTH + 1] = square * z;
    all
}

/// Fills in the monomials of a degree from those of the degree below.
#[inline(always)]
fn next_degree<const DEGREE: usize>(all: &mut [f64; MOMENTS], x: f64, y: f64) {
    let (from, to) = (place([DEGREE - 1, 0]), place([DEGREE, 0]));
    for j in 0..DEGREE {
        all[to + j] = x * all[from + j];
    }
    all[to + DEGREE] = y * all[to - 1];
}

/// The exponents of x and y of the terms; the place of two terms is taken by x² and y².
const EXPONENTS: [[usize; 2]; TERMS] = [
    [0, 0],
    [1, 0],
    [0, 1],
    [2, 0],
    [0, 2],
    [1, 1],
    [3, 0],
    [2, 1],
    [1, 2],
    [0, 3],
    [4, 0],
    [3, 1],
    [2, 2],
    [1, 3],
    [0, 4],
];

/// The place of x² + y² + z², and that of x² − y².
const SPHERE: usize = 3;
const SADDLE: usize = 4;

/// The place of a monomial among the moments.
const fn place([i, j]: [usize; 2]) -> usize {
    (i + j) * (i + j + 1) / 2 + j
}

/// The least determinant of the equations of a jet over its [`spread`]: 10⁻¹⁸ to 10⁻¹⁶ where
/// points surround the centre, less than 10⁻²¹ over three rows of a grid, on which a quartic is a
/// parabola.
const LEAST_DETERMINANT: f64 = 1e-19;

/// The product of the sums of r²ᵈ over the points, for the degree d of each term. Neither it nor
/// the determinant changes when the tangents turn.
#[inline(always)]
fn spread(sums: &[f64; MOMENTS]) -> f64 {
    const BINOMIALS: [&[f64]; 5] =
        [&[1.0], &[1.0, 1.0], &[1.0, 2.0, 1.0], &[1.0, 3.0, 3.0, 1.0], &[1.0, 4.0, 6.0, 4.0, 1.0]];
    let mut product = 1.0;
    for (degree, binomials) in BINOMIALS.into_iter().enumerate() {
        let terms = binomials.iter().enumerate();
        let sum: f64 = terms.map(|(j, b)| b * sums[place([2 * (degree - j), 2 * j])]).sum();
        for _ in 0..=degree {
            product *= sum;
        }
    }
    product
}

#[inline(always)]
fn terms(moments: &[f64; MOMENTS], z: f64) -> [f64; TERMS] {
    let mut terms = [0.0; TERMS];
    for (term, exponents) in terms.iter_mut().zip(EXPONENTS) {
        *term = moments[place(exponents)];
    }
    let [xx, yy] = [terms[SPHERE], terms[SADDLE]];
    (terms[SPHERE], terms[SADDLE]) = (xx + yy + z * z, xx - yy);
    terms
}

/// The normal equations of each jet from the weighted sums of the moments.
#[inline(always)]
fn equations(sums: &[[f64; MOMENTS]; RADII.len()]) -> ([[Lanes; TERMS]; TERMS], [Lanes; TERMS]) {
    let (mut matrix, mut rhs) = ([[[0.0; RADII.len()]; TERMS]; TERMS], [[0.0; 4]; TERMS]);
    for (lane, sums) in sums.iter().enumerate() {
        let mut squares = [0.0; TERMS];
        for k in 0..TERMS {
            let [i, j] = EXPONENTS[k];
            rhs[k][lane] = sums[LINEAR + place([i, j])];
            squares[k] = sums[SQUARES + place([i, j])];
            for l in 0..TERMS {
                let [m, n] = EXPONENTS[l];
                matrix[k][l][lane] = sums[place([i + m, j + n])];
            }
        }
        // Products with x² and y² become those with their sum and difference, columns then rows.
        for row in &mut matrix {
            let [xx, yy] = [row[SPHERE][lane], row[SADDLE][lane]];
            (row[SPHERE][lane], row[SADDLE][lane]) = (xx + yy, xx - yy);
        }
        for l in 0..TERMS {
            let [xx, yy] = [matrix[SPHERE][l][lane], matrix[SADDLE][l][lane]];
            (matrix[SPHERE][l][lane], matrix[SADDLE][l][lane]) = (xx + yy, xx - yy);
        }
        let [xx, yy] = [rhs[SPHERE][lane], rhs[SADDLE][lane]];
        (rhs[SPHERE][lane], rhs[SADDLE][lane]) = (xx + yy + sums[FOURTH + 1], xx - yy);
        // The products with z² are added to those of the sum.
        let [xx, yy] = [squares[SPHERE], squares[SADDLE]];
        (squares[SPHERE], squares[SADDLE]) = (xx + yy + sums[FOURTH], xx - yy);
        for l in 0..TERMS {
            matrix[SPHERE][l][lane] += squares[l];
            if l != SPHERE {
                matrix[l][SPHERE][lane] += squares[l];
            }
        }
        matrix[SPHERE][SPHERE][lane] += xx + yy;
    }
    (matrix, rhs)
}

/// H, K and the second form without its trace, carried to the frame of the vertex, and the
/// components of the normal along the tangents.
fn curvature(c: &[f64; TERMS]) -> Option<([f64; 4], [f64; 2])> {
    // The root near c₀ of z = c₀ + c₃ z², by two steps.
    let z = c[0] + c[3] * c[0] * c[0];
    let z = c[0] + c[3] * z * z;
    let gradient = DVec3::new(-c[1], -c[2], 1.0 - 2.0 * c[3] * z);
    let length = gradient.length();
    let normal = gradient / length;
    if !(normal.z > 0.0 && length.is_finite()) {
        return None;
    }
    let hessian = |a: DVec3, b: DVec3| {
        let plane = 2.0 * (c[3] + c[4]) * a.x * b.x
            + 2.0 * (c[3] - c[4]) * a.y * b.y
            + c[5] * (a.x * b.y + a.y * b.x);
        -(plane + 2.0 * c[3] * a.z * b.z) / length
    };
    // The frame that the least rotation from the vertical carries there.
    let [e, f] = tangent_frame(normal);
    let (a, b, c) = (hessian(e, e), hessian(e, f), hessian(f, f));
    let value = [0.5 * (a + c), a * c - b * b, 0.5 * (a - c), b];
    value.iter().all(|x| x.is_finite()).then_some((value, [normal.x, normal.y]))
}

/// The least variance of a residual: below it, the jet passes through the vertex.
const MIN_VARIANCE: f64 = 0.02;

/// The variance of the height of the vertex over the jet of the noise.
#[inline(always)]
fn residual_variance(rows: &[Row], factors: &Factors<TERMS>) -> f64 {
    let solutions = factors.solve(&unit(0, 1.0));
    let (mut own, mut sum) = (0.0, 0.0);
    for (at, row) in rows.iter().enumerate() {
        let influence = influence(row, &solutions)[OF_NOISE];
        if at == 0 {
            own = influence;
        }
        sum += influence * influence;
    }
    1.0 - 2.0 * own + sum
}

/// H is nearly −2 c₃, which is linear in the heights: the sums of products of its derivatives.
#[inline(always)]
fn covariance(
    rows: &[Row],
    factors: &Factors<TERMS>,
    valid: [bool; RADII.len()],
) -> [[f64; RADII.len()]; RADII.len()] {
    let solutions = factors.solve(&unit(SPHERE, -2.0));
    let mut sums = [[0.0; RADII.len()]; RADII.len()];
    for row in rows {
        let influence = influence(row, &solutions);
        for i in 0..RADII.len() {
            for j in 0..RADII.len() {
                sums[i][j] += influence[i] * influence[j];
            }
        }
    }
    for i in 0..RADII.len() {
        for j in 0..RADII.len() {
            sums[i][j] = if valid[i] && valid[j] { sums[i][j] } else { 0.0 };
        }
    }
    sums
}

/// A right-hand side with one entry.
#[inline(always)]
fn unit(place: usize, x: f64) -> [Lanes; TERMS] {
    let mut unit = [[0.0; RADII.len()]; TERMS];
    unit[place] = [x; RADII.len()];
    unit
}

/// The derivative of a linear function of each jet by the height of a point.
#[inline(always)]
fn influence(row: &Row, solutions: &[Lanes; TERMS]) -> Lanes {
    let mut influence = [0.0; RADII.len()];
    for (term, solutions) in row.terms.iter().zip(solutions) {
        for (influence, x) in influence.iter_mut().zip(solutions) {
            *influence += term * x;
        }
    }
    for (influence, weight) in influence.iter_mut().zip(&row.weights) {
        *influence *= weight;
    }
    influence
}
