//! Spectrum slicing: eigenpairs window by window, each counted by the inertia at its ends.
//!
//! Each window has its own shift in its middle, so that its basis stays small however many pairs
//! lie below. Vectors of the previous window near the common end are locked, so that vectors on
//! both sides stay orthogonal even if their eigenvalues are close.

use crate::direct::factor::LANES;
use crate::eigen::EigenOptions;
use crate::eigen::basis::Block;
use crate::eigen::certificate::{Counted, count_in_gap};
use crate::eigen::operator::ShiftInvert;
use crate::eigen::polish;
use crate::eigen::problem::Problem;
use crate::eigen::run::{Found, RANDOM_RESTARTS, Run};
use crate::error::SparseError;

/// Blocks of the previous window that a new one stays orthogonal to.
const LOCKED_BLOCKS: usize = 6;
/// A window is cut if it holds more than this multiple of the planned number.
const TOO_FULL: f64 = 1.5;
/// Cuts of a window before it is solved whole.
const MAX_CUTS: usize = 30;

/// Adds pairs above the found ones, which are complete below `shift`, until there are `wanted`.
pub(crate) fn continue_upwards(
    problem: &Problem,
    found: &mut Found,
    shift: f64,
    wanted: usize,
    options: &EigenOptions,
) -> Result<(), SparseError> {
    let counted = found.lambdas.len();
    // The spacing of the upper half of the known values, times the number wanted in a window.
    let half = counted / 2;
    let spacing = (shift - found.lambdas[half]) / (counted - half) as f64;
    let mut slices = Slices { problem, from: shift, counted, options };
    slices.up_to(found, wanted, spacing * options.slice as f64)
}

struct Slices<'a> {
    problem: &'a Problem,
    /// All pairs below are known.
    from: f64,
    /// Eigenvalues below `from`.
    counted: usize,
    options: &'a EigenOptions,
}

impl Slices<'_> {
    /// Solves windows until `wanted` eigenvalues lie below the last end.
    fn up_to(
        &mut self,
        found: &mut Found,
        wanted: usize,
        mut width: f64,
    ) -> Result<(), SparseError> {
        let plan = self.options.slice;
        while self.counted < wanted {
            let missing = (wanted - self.counted) as f64;
            // Slightly more than needed, so that no tiny window remains.
            let fraction = (1.15 * missing / plan as f64).min(1.0);
            let mut to = self.from + width * fraction;
            let mut next = count_in_gap(self.problem, to, to * (1.0 + 1e-8))?;
            // Each cut shrinks the window by a third or more; only an eigenvalue of huge
            // multiplicity resists.
            for _ in 0..MAX_CUTS {
                let inside = next.count.saturating_sub(self.counted) as f64;
                if inside <= TOO_FULL * plan as f64 {
                    break;
                }
                to = self.from + (to - self.from) * plan as f64 / inside;
                next = count_in_gap(self.problem, to, to * (1.0 + 1e-8))?;
            }
            let Counted { count, shift, .. } = next;
            let inside = count.saturating_sub(self.counted);
            if inside > 0 {
                self.window(found, next, inside)?;
            }
            found.clear_below = shift;
            // The next window follows the density of this one, between half and twice its width.
            let density = inside.max(1) as f64 / (shift - self.from);
            width = (plan as f64 / density).clamp(0.5 * width, 2.0 * width);
            self.from = shift;
            self.counted = count;
        }
        Ok(())
    }

    /// All `inside` pairs between `self.from` and the shift of the next count.
    fn window(&self, found: &mut Found, next: Counted, inside: usize) -> Result<(), SparseError> {
        let (problem, to) = (self.problem, next.shift);
        let sigma = 0.5 * (self.from + to) + 1e-3 * (to - self.from);
        let (mut operator, ..) = ShiftInvert::among(problem, sigma).map_err(|source| {
            SparseError::Factor { shift: sigma * problem.unit, source: Box::new(source) }
        })?;
        let mut here = self.run(&operator, found, next, inside)?;
        if here.is_strained(problem, self.options.tolerance) {
            operator = operator.exact();
            here = self.run(&operator, found, next, inside)?;
        }
        found.certified &= here.certified;
        found.append(&here.lambdas, &here.blocks);
        Ok(())
    }

    /// The pairs of a window, by the operator with the shift in its middle.
    fn run(
        &self,
        operator: &ShiftInvert<'_>,
        found: &Found,
        next: Counted,
        inside: usize,
    ) -> Result<Found, SparseError> {
        let (problem, to, sigma) = (self.problem, next.shift, operator.sigma);
        let known = found.blocks.len();
        let mut locked: Vec<Block> = found.blocks[known.saturating_sub(LOCKED_BLOCKS)..].to_vec();
        // Empty lanes are zero vectors and harmless.
        if known > LOCKED_BLOCKS && (1..=LANES).contains(&problem.constants.0) {
            locked.push(found.blocks[0].clone());
        }
        let mut run = Run::new(operator, &locked, inside, self.options);
        let goal = self.options.tolerance * to;
        let (mut random_restarts, mut most) = (0, 0);
        let mut stalled = 0;
        loop {
            let (ritz, mut candidates) = run.advance()?;
            candidates
                .sort_by(|a, b| (a.lambda - sigma).abs().total_cmp(&(b.lambda - sigma).abs()));
            let is_inside = |lambda: f64| lambda > self.from && lambda < to;
            let showing: Vec<_> =
                candidates.iter().copied().filter(|c| is_inside(c.lambda)).collect();
            let will_do = run.will_do(&showing, goal, inside);
            let mut done: Vec<_> =
                showing.iter().zip(will_do).filter(|(_, done)| *done).map(|(c, _)| *c).collect();
            run.report(done.len().min(inside))?;
            if done.len() == inside {
                done.sort_by(|a, b| a.lambda.total_cmp(&b.lambda));
                let chosen: Vec<usize> = done.iter().map(|c| c.index).collect();
                let mut vectors = run.lanczos.vectors(&ritz, &chosen);
                let lambdas: Vec<f64> = done.iter().map(|c| c.lambda).collect();
                polish::polish(operator, &lambdas, &mut vectors, goal);
                let nearest = lambdas.last().map_or(f64::INFINITY, |last| to - last);
                let certified = next.is_sure(problem.strain(&vectors), nearest);
                return Ok(Found { lambdas, blocks: vectors, certified, clear_below: to });
            }
            if done.len() > most {
                (most, random_restarts) = (done.len(), 0);
            }
            // All visible pairs have converged, yet some are missing: eigenvectors orthogonal to
            // the starting block.
            stalled = if showing.len() == done.len() { stalled + 1 } else { 0 };
            if done.len() > inside || (stalled >= 3 && random_restarts == RANDOM_RESTARTS) {
                return Err(SparseError::Miscounted {
                    found: self.counted + done.len(),
                    counted: self.counted + inside,
                    shift: to * problem.unit,
                });
            }
            if stalled >= 3 {
                random_restarts += 1;
                stalled = 0;
                run.restart_randomly(&ritz, &candidates, done.len());
            } else {
                run.restart_if_full(&ritz, &candidates);
            }
        }
    }
}
