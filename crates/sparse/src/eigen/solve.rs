//! The smallest eigenpairs: dense for small problems, one Lanczos run for few pairs, slices for
//! many.

use crate::direct::factor::LANES;
use crate::eigen::basis::Block;
use crate::eigen::lanczos::{self};
use crate::eigen::operator::ShiftInvert;
use crate::eigen::polish::{self};
use crate::eigen::problem::Problem;
use crate::eigen::projected::{Projected, ZERO};
use crate::eigen::run::{Below, Found, Run};
use crate::eigen::{EigenOptions, EigenPairs, dense, operator, slices};
use crate::error::SparseError;
use crate::mass::Mass;
use crate::matrix::SparseMatrix;
use crate::order::larger;

/// The `count` smallest eigenpairs of a connected problem.
pub(crate) fn connected(
    stiffness: &SparseMatrix,
    mass: Mass<'_>,
    count: usize,
    options: &EigenOptions,
) -> Result<EigenPairs, SparseError> {
    let rows = stiffness.rows();
    if count == 0 {
        return Ok(EigenPairs::none(rows));
    }
    if rows <= options.dense_rows || (rows <= 4 * options.dense_rows && 4 * count >= rows) {
        return dense_pairs(stiffness, mass, count, options);
    }
    let problem = Problem::new(stiffness, mass)?;
    let constants = problem.constants.0;
    let mut found = Found::constants(&problem, count);
    if constants < count {
        let wanted = count - constants;
        let first = wanted.min(options.slice);
        let shift = run_from_below(&problem, &mut found, first, options)?;
        found.clear_below = shift;
        if wanted > first {
            slices::continue_upwards(&problem, &mut found, shift, count, options)?;
        }
    }
    found.finish(&problem, count, options.tolerance)
}

fn dense_pairs(
    stiffness: &SparseMatrix,
    mass: Mass<'_>,
    count: usize,
    options: &EigenOptions,
) -> Result<EigenPairs, SparseError> {
    let problem = Problem::new(stiffness, mass)?;
    let (values, vectors) = dense::all_eigenpairs(stiffness, mass)?;
    let order = problem.order();
    let scale = problem.norm_unit();
    // The columns `first .. end` as blocks.
    let blocks = |first: usize, end: usize| -> Vec<Block> {
        let block = |from: usize| {
            let width = LANES.min(end - from);
            let mut block = vec![[0.0; LANES]; stiffness.rows()];
            for (block, &row) in block.iter_mut().zip(order) {
                for (lane, value) in block[..width].iter_mut().enumerate() {
                    *value = vectors[[row as usize, from + lane]] * scale;
                }
            }
            block
        };
        (first..end).step_by(LANES).map(block).collect()
    };
    let mut found = Found {
        lambdas: values.iter().map(|v| v / problem.unit).collect(),
        blocks: blocks(0, count),
        certified: true,
        clear_below: f64::INFINITY,
    };
    let constants = problem.constants.0;
    let strained = found.is_strained(&problem, options.tolerance);
    let unsettled = strained || found.unsettled(&problem, count, options.tolerance) > 0;
    if unsettled && constants < count {
        let basis = blocks(constants, stiffness.rows());
        let missing = count - constants;
        found = from_inverse(&problem, found, &basis, missing, strained)?;
    }
    found.finish(&problem, count, options.tolerance)
}

/// Shifts tried until one matches the size of the last wanted eigenvalue.
const INVERSE_TRIES: usize = 4;

/// The `wanted` smallest pairs above the constants, by decomposing (S' − σM')⁻¹ M' in a basis of
/// all vectors orthogonal to the constants.
///
/// A decomposition of S has an error of ε times its largest eigenvalue, which one needle triangle
/// makes huge. With σ at minus the last wanted eigenvalue, the error is a few ε times that
/// eigenvalue.
fn from_inverse(
    problem: &Problem,
    first: Found,
    basis: &[Block],
    wanted: usize,
    exact: bool,
) -> Result<Found, SparseError> {
    let constants = problem.constants.0;
    let mut last = first.lambdas[constants + wanted - 1].abs();
    let mut found = first;
    for _ in 0..INVERSE_TRIES {
        let sigma = -last.max(f64::MIN_POSITIVE / f64::EPSILON);
        let operator = ShiftInvert::below(problem, sigma).map_err(|source| {
            SparseError::Factor { shift: sigma * problem.unit, source: Box::new(source) }
        })?;
        let operator = if exact { operator.exact() } else { operator };
        let mut projected = Projected::default();
        for j in 0..basis.len() {
            let w = operator.apply(&basis[j]);
            let [column] = problem.mass_products([&basis[..=j]], &w);
            projected.push(column, ZERO);
        }
        let ritz = projected.solve().map_err(|_| SparseError::Dense { rows: problem.rows() })?;
        let top = ritz.values.len();
        let chosen: Vec<usize> = (0..wanted).map(|i| top - 1 - i).collect();
        let all = problem.rows() - constants;
        let lambdas: Vec<f64> =
            (0..all).map(|i| operator.eigenvalue(ritz.values[top - 1 - i])).collect();
        let mut vectors = lanczos::combined(basis, &ritz, &chosen);
        polish::polish(&operator, &lambdas, &mut vectors, 0.0);
        found = Found::constants(problem, constants + wanted);
        found.append(&lambdas[..wanted], &vectors);
        found.lambdas.extend(&lambdas[wanted..]);
        found.certified = true;
        found.clear_below = f64::INFINITY;
        let next = lambdas[wanted - 1];
        if next > 0.25 * last && next < 4.0 * last {
            break;
        }
        last = next.abs();
    }
    Ok(found)
}

/// Finds at least `wanted` eigenpairs above the constants; returns the shift below which they are
/// complete.
fn run_from_below(
    problem: &Problem,
    found: &mut Found,
    wanted: usize,
    options: &EigenOptions,
) -> Result<f64, SparseError> {
    let constants = found.lambdas.len();
    let locked: Vec<Block> = if constants <= LANES { found.blocks.clone() } else { vec![] };
    let mut operator = operator::for_smallest(problem, constants + wanted)?;
    let mut exact = false;
    loop {
        let mut run = Run::new(&operator, &locked, wanted, options);
        let (lambdas, vectors, counted) = match run.until_counted(constants)? {
            Below::Counted(lambdas, vectors, counted) => (lambdas, vectors, counted),
            // At least ten thousand times closer each time.
            Below::TooFar(distance) => {
                operator = ShiftInvert::below(problem, -distance).map_err(|source| {
                    SparseError::Factor {
                        shift: -distance * problem.unit,
                        source: Box::new(source),
                    }
                })?;
                if exact {
                    operator = operator.exact();
                }
                continue;
            }
        };
        let mut more =
            Found { blocks: found.blocks.clone(), lambdas: found.lambdas.clone(), ..*found };
        more.append(&lambdas, &vectors);
        if !exact && more.is_strained(problem, options.tolerance) {
            exact = true;
            operator = operator.exact();
            continue;
        }
        let nearest = lambdas.iter().fold(0.0, |m, l| larger(m, *l));
        let distance = counted.shift - nearest;
        more.certified &= counted.is_sure(problem.strain(&vectors), distance);
        *found = more;
        return Ok(counted.shift);
    }
}
