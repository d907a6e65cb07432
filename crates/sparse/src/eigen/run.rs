//! Found eigenpairs, and the Lanczos run that finds them.

use ndarray::Array2;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use crate::direct::factor::LANES;
use crate::eigen::basis::Block;
use crate::eigen::certificate::{Counted, count_in_gap};
use crate::eigen::lanczos::{self, Candidate, Lanczos};
use crate::eigen::operator::ShiftInvert;
use crate::eigen::polish::{self, lanes_of};
use crate::eigen::problem::Problem;
use crate::eigen::projected::Ritz;
use crate::eigen::{Beyond, EigenOptions, EigenPairs, SLACK};
use crate::error::SparseError;
use crate::order::larger;
/// Error of a diagonal entry in ε: a sum of six terms, and as many in the elimination.
const DIAGONAL_ROUNDINGS: f64 = 4.0;

/// Dimensionless eigenpairs, ascending, in the order of the factor.
pub(crate) struct Found {
    /// May be more than there are vectors.
    pub(crate) lambdas: Vec<f64>,
    /// Vectors in blocks; the last block may have empty lanes.
    pub(crate) blocks: Vec<Block>,
    pub(crate) certified: bool,
    /// No other eigenvalue lies below.
    pub(crate) clear_below: f64,
}

impl Found {
    /// The exact zero modes; at most the first `count` get vectors.
    pub(crate) fn constants(problem: &Problem, count: usize) -> Self {
        let constants = problem.constants.0;
        Self {
            lambdas: vec![0.0; constants],
            blocks: lanczos::constants(problem, count.min(constants)),
            certified: true,
            clear_below: 0.0,
        }
    }

    /// Appends pairs whose vectors are in blocks of their own.
    pub(crate) fn append(&mut self, lambdas: &[f64], blocks: &[Block]) {
        for (i, &lambda) in lambdas.iter().enumerate() {
            let lane = self.lambdas.len() % LANES;
            let source = &blocks[i / LANES];
            if lane == 0 {
                self.blocks.push(vec![[0.0; LANES]; source.len()]);
            }
            if let Some(target) = self.blocks.last_mut() {
                for (t, s) in target.iter_mut().zip(source) {
                    t[lane] = s[i % LANES];
                }
            }
            self.lambdas.push(lambda);
        }
    }

    /// Residuals of all vectors, dimensionless.
    fn residuals(&self, problem: &Problem) -> Vec<f64> {
        let of = |(b, block)| polish::residuals(problem, block, &lanes_of(&self.lambdas, b));
        self.blocks.iter().enumerate().flat_map(of).collect()
    }

    /// The number of the first `count` pairs with residuals above both the tolerance and the
    /// rounding.
    pub(crate) fn unsettled(&self, problem: &Problem, count: usize, tolerance: f64) -> usize {
        self.above_limit(problem, &self.residuals(problem), count, tolerance)
    }

    /// Returns true if rounding of the diagonal of S, in its entries or its factor, moves an
    /// eigenvalue by more than the tolerance: by some ε Σ sᵢᵢ φᵢ².
    pub(crate) fn is_strained(&self, problem: &Problem, tolerance: f64) -> bool {
        let strains = self.blocks.iter().flat_map(|block| problem.strains(block));
        // Exact zeros belong to constants.
        strains.zip(&self.lambdas).any(|(strain, &lambda)| {
            lambda != 0.0 && DIAGONAL_ROUNDINGS * f64::EPSILON * strain > SLACK * tolerance * lambda
        })
    }

    /// Residuals with the rounding of assembly added if it matters: an entry computed from lengths
    /// or angles of a thin face has lost as many digits as the diagonal.
    fn with_rounding(
        &self,
        problem: &Problem,
        mut residuals: Vec<f64>,
        tolerance: f64,
    ) -> Vec<f64> {
        let strains = self.blocks.iter().flat_map(|block| problem.strains(block));
        for ((residual, strain), &lambda) in residuals.iter_mut().zip(strains).zip(&self.lambdas) {
            let rounding = DIAGONAL_ROUNDINGS * f64::EPSILON * strain;
            if lambda != 0.0 && rounding > SLACK * tolerance * lambda {
                *residual += rounding;
            }
        }
        residuals
    }

    fn above_limit(
        &self,
        problem: &Problem,
        residuals: &[f64],
        count: usize,
        tolerance: f64,
    ) -> usize {
        let largest = self.lambdas[..count].iter().fold(0.0, |m, l| larger(m, *l));
        // [`EigenOptions::residual_limit`].
        let limit = SLACK * tolerance * largest;
        let mut above = 0;
        for (b, block) in self.blocks.iter().enumerate() {
            let suspects: Vec<usize> = (0..LANES)
                .filter(|lane| b * LANES + lane < count)
                .filter(|lane| {
                    let residual = residuals[b * LANES + lane];
                    residual.is_nan() || residual > limit
                })
                .collect();
            if !suspects.is_empty() {
                let lambda = lanes_of(&self.lambdas, b);
                let attainable = polish::attainable(problem, block, &lambda);
                // NaN is above every limit.
                let meets = |lane: &&usize| residuals[b * LANES + **lane] <= attainable[**lane];
                above += suspects.len() - suspects.iter().filter(meets).count();
            }
        }
        above
    }

    /// The first `count` pairs in the caller's units and order, with measured residuals.
    ///
    /// # Errors
    ///
    /// [`SparseError::PairsNotConverged`] if measured residuals far exceed their estimates: a
    /// safeguard.
    pub(crate) fn finish(
        self,
        problem: &Problem,
        count: usize,
        tolerance: f64,
    ) -> Result<EigenPairs, SparseError> {
        let residuals = self.residuals(problem);
        let unsettled = self.above_limit(problem, &residuals, count, tolerance);
        if unsettled > 0 {
            return Err(SparseError::PairsNotConverged {
                converged: count - unsettled,
                wanted: count,
                blocks: self.blocks.len(),
            });
        }
        let residuals = self.with_rounding(problem, residuals, tolerance);
        let mut vectors = Array2::zeros((problem.rows(), count));
        for (k, &row) in problem.order().iter().enumerate() {
            let mut out = vectors.row_mut(row as usize);
            for (i, value) in out.iter_mut().enumerate() {
                *value = self.blocks[i / LANES][k][i % LANES] / problem.norm_unit();
            }
        }
        let scaled = |values: &[f64]| values.iter().map(|v| v * problem.unit).collect();
        Ok(EigenPairs {
            values: scaled(&self.lambdas[..count]),
            vectors,
            residuals: scaled(&residuals[..count]),
            certified: self.certified,
            beyond: Beyond {
                values: scaled(&self.lambdas[count..]),
                clear_below: self.clear_below * problem.unit,
            },
        })
    }
}

/// A Lanczos run for a number of pairs.
pub(crate) struct Run<'a> {
    pub(crate) lanczos: Lanczos<'a>,
    problem: &'a Problem,
    pub(crate) wanted: usize,
    pub(crate) blocks: usize,
    options: &'a EigenOptions,
    cap: usize,
    next_check: usize,
    /// Checks of the basis since a step of inverse iteration could finish all wanted pairs.
    waited: usize,
}

/// The wanted pairs are completed up to a gap of at least this fraction of the eigenvalue above it:
/// wide enough that a count at a fifth of it leaves two parts in 10⁵ without eigenvalues, which
/// separates the vectors on both sides.
const GAP: f64 = 1.1e-4;
/// Required ratio of the residual after a step of inverse iteration to the goal, if the step is
/// used.
const POLISHED: f64 = 1e-2;
/// Checks of the basis before the step is used for many pairs. Residuals that are not magnified
/// converge earlier.
const PATIENCE: usize = 2;
/// Blocks of pairs for which the step, a solve for each, takes less time than another block of the
/// basis, which is solved for and orthogonalised against all others.
const QUICKLY_POLISHED: usize = 3;
/// Fraction of σ below which an eigenvalue counts as zero up to rounding.
const ZERO_FRACTION: f64 = 1e-6;
/// Restarts with new vectors that find nothing before a mismatched count is an error. The
/// multiplicity of an eigenvalue may be as large as the problem, and a block of new vectors finds
/// eight more copies.
pub(super) const RANDOM_RESTARTS: usize = 3;
/// Blocks in which a gap above the converged pairs is looked for.
const GAP_BLOCKS: usize = 250;
/// Maximum size of a basis in numbers (2.4 GB), unless the pairs themselves need more.
const MAX_BASIS_NUMBERS: usize = 300_000_000;

/// An eigenvalue below this fraction of −σ is too far from σ: (λ − σ)⁻¹ hardly separates it from
/// zero. On compact meshes the fraction is 10⁻³ or more.
const FAR: f64 = 1e-4;
/// Fraction of −σ that rounding may turn zero into.
const FAR_ROUNDING: f64 = 1e-12;

/// Outcome of a run from below.
pub(crate) enum Below {
    /// The pairs below a gap, in agreement with the count.
    Counted(Vec<f64>, Vec<Block>, Counted),
    /// All wanted eigenvalues lie within this distance of zero, which is far closer than σ.
    TooFar(f64),
}

impl<'a> Run<'a> {
    pub(crate) fn new(
        operator: &'a ShiftInvert<'a>,
        locked: &'a [Block],
        wanted: usize,
        options: &'a EigenOptions,
    ) -> Self {
        let rows = operator.problem.rows();
        let lanczos = Lanczos::new(operator, locked, ChaCha8Rng::seed_from_u64(options.seed));
        let limit = (MAX_BASIS_NUMBERS / rows).max(wanted + wanted / 2 + 8 * LANES);
        let cap = (3 * wanted + 12 * LANES).min(limit).min(3 * rows / 4);
        Self {
            lanczos,
            problem: operator.problem,
            wanted,
            blocks: 0,
            options,
            cap,
            next_check: wanted + wanted / 3 + 5 * LANES,
            waited: 0,
        }
    }

    /// Flags of the acceptable candidates: their residual meets the goal or, if that takes too long
    /// for `wanted` of them, will meet it after a step of inverse iteration.
    pub(crate) fn will_do(
        &mut self,
        candidates: &[Candidate],
        goal: f64,
        wanted: usize,
    ) -> Vec<bool> {
        let now: Vec<bool> = candidates.iter().map(|c| c.residual <= goal).collect();
        let soon: Vec<bool> = candidates
            .iter()
            .zip(&now)
            .map(|(c, now)| *now || c.polished <= POLISHED * goal)
            .collect();
        let count = |of: &[bool]| of.iter().take(wanted).filter(|x| **x).count();
        if count(&now) < wanted && count(&soon) == wanted {
            self.waited += 1;
        }
        let is_quick = wanted <= QUICKLY_POLISHED * LANES;
        if self.waited >= if is_quick { 1 } else { PATIENCE } { soon } else { now }
    }

    /// Extends the basis until its next check.
    pub(crate) fn advance(&mut self) -> Result<(Ritz, Vec<Candidate>), SparseError> {
        while self.lanczos.len() < self.next_check.min(self.cap) {
            self.lanczos.extend();
            self.blocks += 1;
        }
        self.next_check = self.lanczos.len() + (self.lanczos.len() / 12).max(LANES);
        self.lanczos.ritz().map_err(|_| SparseError::Dense { rows: self.lanczos.len() })
    }

    /// Reports progress, and fails if the run has taken too many blocks.
    pub(crate) fn report(&mut self, converged: usize) -> Result<(), SparseError> {
        let (wanted, blocks) = (self.wanted, self.blocks);
        fairing_watch::reach(converged as u64);
        if blocks > self.options.max_blocks {
            return Err(SparseError::PairsNotConverged { converged, wanted, blocks });
        }
        Ok(())
    }

    /// Restarts a full basis with the first of the given candidates.
    pub(crate) fn restart_if_full(&mut self, ritz: &Ritz, best: &[Candidate]) {
        if self.lanczos.len() + LANES > self.cap {
            let keep = (self.wanted + (self.cap - self.wanted.min(self.cap)) / 3)
                .min(self.cap - 4 * LANES);
            self.restart(ritz, best, keep);
        }
    }

    /// Keeps the first candidates, rounded up to whole blocks, and postpones the next check.
    pub(crate) fn restart(&mut self, ritz: &Ritz, best: &[Candidate], keep: usize) {
        let keep = (keep.div_ceil(LANES) * LANES).min(best.len() / LANES * LANES);
        let chosen: Vec<usize> = best[..keep].iter().map(|c| c.index).collect();
        self.lanczos.restart(ritz, &chosen);
        self.next_check = (keep + 6 * LANES).max(keep + keep / 4);
    }

    /// Keeps the converged vectors and continues with random ones.
    pub(crate) fn restart_randomly(&mut self, ritz: &Ritz, best: &[Candidate], converged: usize) {
        self.restart(ritz, best, converged);
        self.lanczos.randomise_next();
        self.cap = self.cap.max(self.lanczos.len() + 12 * LANES);
        self.next_check = self.lanczos.len() + 10 * LANES;
    }

    /// The wanted pairs from below, completed to the next gap and verified by an inertia count.
    pub(crate) fn until_counted(&mut self, constants: usize) -> Result<Below, SparseError> {
        let (mut random_restarts, mut most, mut without_gap) = (0, 0, None);
        let operator = self.lanczos.operator;
        // Zeros may be slightly negative after rounding; unconverged values may be anywhere.
        let least = -ZERO_FRACTION * operator.sigma.abs();
        loop {
            let (ritz, mut candidates) = self.advance()?;
            candidates.retain(|c| c.lambda > least);
            candidates.sort_by(|a, b| a.lambda.total_cmp(&b.lambda));
            let last = candidates.get(self.wanted - 1).map(|last| last.lambda);
            // Ritz values are above the eigenvalues, converged or not.
            if let Some(last) = last.filter(|last| *last < FAR * -operator.sigma) {
                return Ok(Below::TooFar(last.max(FAR_ROUNDING * -operator.sigma)));
            }
            let goal = last.map_or(0.0, |last| self.options.tolerance * last);
            let done = self.will_do(&candidates, goal, self.wanted);
            let converged = done.iter().take_while(|done| **done).count();
            self.report(converged.min(self.wanted))?;
            let gap = (self.wanted..=converged).find(|&g| {
                candidates
                    .get(g)
                    .is_none_or(|next| next.lambda - candidates[g - 1].lambda > GAP * next.lambda)
            });
            let Some(g) = gap else {
                if converged >= self.wanted
                    && self.blocks > *without_gap.get_or_insert(self.blocks) + GAP_BLOCKS
                {
                    let value = candidates[self.wanted - 1].lambda * self.problem.unit;
                    return Err(SparseError::Crowded { wanted: constants + self.wanted, value });
                }
                self.restart_if_full(&ritz, &candidates);
                continue;
            };
            let from = candidates[g - 1].lambda;
            let to = candidates.get(g).map_or(1.01 * from, |next| next.lambda);
            let counted = count_in_gap(self.problem, from, to)?;
            if counted.count == constants + g {
                candidates.truncate(g);
                let chosen: Vec<usize> = candidates.iter().map(|c| c.index).collect();
                let lambdas: Vec<f64> = candidates.iter().map(|c| c.lambda).collect();
                let mut vectors = self.lanczos.vectors(&ritz, &chosen);
                polish::polish(operator, &lambdas, &mut vectors, goal);
                return Ok(Below::Counted(lambdas, vectors, counted));
            }
            random_restarts = if g > most { 1 } else { random_restarts + 1 };
            most = most.max(g);
            if random_restarts > RANDOM_RESTARTS {
                return Err(SparseError::Miscounted {
                    found: constants + g,
                    counted: counted.count,
                    shift: counted.shift * self.problem.unit,
                });
            }
            self.restart_randomly(&ritz, &candidates, converged);
        }
    }
}
