//! All eigenpairs of an interval.

use std::ops::Range;

use ndarray::{Axis, Slice};

use crate::eigen::certificate::{Counted, count_in_gap};
use crate::eigen::problem::Problem;
use crate::eigen::run::Found;
use crate::eigen::slices::Slices;
use crate::eigen::{EigenOptions, EigenPairs, solve};
use crate::error::SparseError;
use crate::mass::Mass;
use crate::matrix::SparseMatrix;

/// All eigenpairs of a connected problem within an interval.
pub(crate) fn connected(
    stiffness: &SparseMatrix,
    mass: Mass<'_>,
    interval: Range<f64>,
    options: &EigenOptions,
) -> Result<EigenPairs, SparseError> {
    let (from, to) = (interval.start, interval.end);
    let problem = Problem::new(stiffness, mass)?;
    let below = |lambda: f64| -> Result<Counted, SparseError> {
        let shift = lambda / problem.unit;
        if shift <= 0.0 {
            return Ok(Counted::NONE);
        }
        count_in_gap(&problem, shift, shift * (1.0 + 1e-10))
    };
    let (lower, upper) = (below(from)?, below(to)?);
    let (first, last) = (lower.count, upper.count);
    if first == 0 || stiffness.rows() <= options.dense_rows {
        let mut pairs = solve::connected(stiffness, mass, last, options)?;
        let vectors = pairs.vectors.slice_axis(Axis(1), Slice::from(first..)).to_owned();
        pairs.values.drain(..first);
        pairs.residuals.drain(..first);
        return Ok(EigenPairs { vectors, ..pairs });
    }
    let mut found =
        Found { lambdas: vec![], blocks: vec![], certified: true, clear_below: upper.shift };
    let mut slices = Slices { problem: &problem, from: lower.shift, counted: first, options };
    let width = upper.shift - lower.shift;
    let guess = width * options.slice as f64 / (last - first).max(1) as f64;
    slices.up_to(&mut found, Some(upper.shift), last, guess)?;
    let count = found.lambdas.len();
    found.finish(&problem, 0, count, options.tolerance)
}
