//! The smallest eigenpairs: dense for small problems, one Lanczos run for some pairs, slices for many.

use std::ops::ControlFlow;

use ndarray::Array2;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use crate::eigen::basis::Block;
use crate::eigen::certificate::count_in_gap;
use crate::eigen::lanczos::{self, Candidate, Lanczos};
use crate::eigen::operator::ShiftInvert;
use crate::eigen::problem::Problem;
use crate::eigen::projected::Ritz;
use crate::eigen::{
    Count, EigenError, EigenOptions, EigenPairs, EigenProgress, EigenWatch, dense, shift, slices,
};
use crate::factor::LANES;
use crate::mass::Mass;
use crate::matrix::SparseMatrix;

/// The count smallest eigenpairs of S φ = λ M φ.
///
/// S must be symmetric positive semi-definite, M positive definite. Cost: one factorisation of S − σM, another
/// one for the count, and about 2 to 3 k solves and orthogonalisations against as many vectors; beyond
/// [`EigenOptions::slice`] pairs it grows like k.
///
/// # Errors
///
/// [`EigenError`]; among them a mass that is not positive, with its row, and [`EigenError::NotConverged`],
/// which says how many pairs met the tolerance.
///
/// # Examples
///
/// ```
/// use fairing_sparse::{EigenOptions, Mass, SparseMatrix, smallest_eigenpairs};
/// // A path of two vertices: eigenvalues 0 and 2.
/// let s = SparseMatrix::new((2, 2), vec![0, 2, 4], vec![0, 1, 0, 1], vec![1.0, -1.0, -1.0, 1.0]);
/// let pairs = smallest_eigenpairs(&s, Mass::Lumped(&[1.0, 1.0]), 2, &EigenOptions::default())?;
/// assert_eq!(pairs.values[0], 0.0);
/// assert!((pairs.values[1] - 2.0).abs() < 1e-14);
/// # Ok::<(), fairing_sparse::EigenError>(())
/// ```
pub fn smallest_eigenpairs(
    stiffness: &SparseMatrix,
    mass: Mass<'_>,
    count: usize,
    options: &EigenOptions,
) -> Result<EigenPairs, EigenError> {
    smallest_eigenpairs_with(stiffness, mass, count, options, &mut |_| ControlFlow::Continue(()))
}

/// [`smallest_eigenpairs`] with a watch, which sees the progress and may cancel.
///
/// # Errors
///
/// As [`smallest_eigenpairs`], and [`EigenError::Cancelled`].
pub fn smallest_eigenpairs_with(
    stiffness: &SparseMatrix,
    mass: Mass<'_>,
    count: usize,
    options: &EigenOptions,
    watch: &mut EigenWatch<'_>,
) -> Result<EigenPairs, EigenError> {
    let rows = stiffness.rows();
    if count > rows {
        return Err(EigenError::TooMany { wanted: count, rows });
    }
    mass.check(rows)?;
    if count == 0 {
        let vectors = Array2::zeros((rows, 0));
        return Ok(EigenPairs { values: vec![], vectors, residuals: vec![], certified: true });
    }
    if rows <= options.dense_rows || (rows <= 4 * options.dense_rows && 4 * count >= rows) {
        return dense_pairs(stiffness, mass, count, options);
    }
    let problem = Problem::new(stiffness, mass)?;
    let mut found = Found::constants(&problem);
    let constants = found.lambdas.len();
    if constants < count {
        let wanted = count - constants;
        let first = wanted.min(options.slice);
        let certified = run_from_below(&problem, &mut found, first, options, watch)?;
        if wanted > first {
            slices::continue_upwards(&problem, &mut found, certified, count, options, watch)?;
        }
        found.certified = options.count == Count::Certified || wanted > first;
    } else {
        found.certified = true;
    }
    found.finish(&problem, 0, count, options.tolerance)
}

fn dense_pairs(
    stiffness: &SparseMatrix,
    mass: Mass<'_>,
    count: usize,
    options: &EigenOptions,
) -> Result<EigenPairs, EigenError> {
    let problem = Problem::new(stiffness, mass)?;
    let (mut values, vectors) = dense::all_eigenpairs(stiffness, mass, options.dense)?;
    values.truncate(count);
    let order = problem.order();
    let mut found = Found { lambdas: vec![], blocks: vec![], certified: true };
    let scale = problem.norm_unit();
    for from in (0..count).step_by(LANES) {
        let width = LANES.min(count - from);
        let mut block = vec![[0.0; LANES]; stiffness.rows()];
        for (k, &row) in order.iter().enumerate() {
            for lane in 0..width {
                block[k][lane] = vectors[[row as usize, from + lane]] * scale;
            }
        }
        found.blocks.push(block);
    }
    found.lambdas = values.iter().map(|v| v / problem.unit).collect();
    found.finish(&problem, 0, count, options.tolerance)
}

/// How much larger than the tolerance a measured residual may be: eigenvalues of a multiple group are measured
/// with the residual of their neighbours, and rounding adds its share.
const SLACK: f64 = 10.0;
/// Residuals of the constants, in units of S': a few ε.
const ROUNDING: f64 = 1e-5;

/// Dimensionless eigenpairs, ascending, in the order of the factor.
pub(crate) struct Found {
    pub(crate) lambdas: Vec<f64>,
    /// Vectors in blocks; the last block may have empty lanes.
    pub(crate) blocks: Vec<Block>,
    pub(crate) certified: bool,
}

impl Found {
    /// The exact zero modes.
    pub(crate) fn constants(problem: &Problem) -> Self {
        Self {
            lambdas: vec![0.0; problem.constants.0],
            blocks: lanczos::constants(problem),
            certified: false,
        }
    }

    /// Appends vectors given in blocks of their own.
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

    /// Pairs `from .. to` in the caller's units and order, residuals measured.
    ///
    /// # Errors
    ///
    /// [`EigenError::NotConverged`] if measured residuals are far from what was estimated: a guard, not a step.
    pub(crate) fn finish(
        self,
        problem: &Problem,
        from: usize,
        to: usize,
        tolerance: f64,
    ) -> Result<EigenPairs, EigenError> {
        let mut residuals = vec![];
        for (b, block) in self.blocks.iter().enumerate() {
            let lambda = std::array::from_fn(|lane| {
                self.lambdas.get(b * LANES + lane).copied().unwrap_or(0.0)
            });
            let square = problem.inverse_gram(&problem.residual(block, &lambda));
            residuals.extend((0..LANES).map(|j| square[j][j].max(0.0).sqrt() * problem.unit));
        }
        // With constants only there is nothing but the rounding of S', of size 1, to compare with.
        let largest = self.lambdas[from..to].iter().fold(ROUNDING, |m: f64, l| m.max(*l));
        let limit = SLACK * tolerance * largest * problem.unit;
        let converged = residuals[from..to].iter().filter(|r| **r <= limit).count();
        if converged < to - from {
            let blocks = self.blocks.len();
            return Err(EigenError::NotConverged { converged, wanted: to - from, blocks });
        }
        let mut vectors = Array2::zeros((problem.rows(), to - from));
        for (k, &row) in problem.order().iter().enumerate() {
            let mut out = vectors.row_mut(row as usize);
            for (j, value) in out.iter_mut().enumerate() {
                let i = from + j;
                *value = self.blocks[i / LANES][k][i % LANES] / problem.norm_unit();
            }
        }
        Ok(EigenPairs {
            values: self.lambdas[from..to].iter().map(|l| l * problem.unit).collect(),
            vectors,
            residuals: residuals[from..to].to_vec(),
            certified: self.certified,
        })
    }
}

/// Finds at least `wanted` eigenpairs above the constants. The shift up to which they are complete.
fn run_from_below(
    problem: &Problem,
    found: &mut Found,
    wanted: usize,
    options: &EigenOptions,
    watch: &mut EigenWatch<'_>,
) -> Result<f64, EigenError> {
    let operator = shift::for_smallest(problem, found.lambdas.len() + wanted)?;
    let constants = found.lambdas.len();
    let locked = std::mem::take(&mut found.blocks);
    let result = {
        let mut run = Run::new(&operator, &locked, wanted, options, watch);
        run.until_counted(constants)
    };
    found.blocks = locked;
    let (candidates, vectors, shift) = result?;
    found.append(&candidates.iter().map(|c| c.lambda).collect::<Vec<_>>(), &vectors);
    Ok(shift)
}

/// A Lanczos run towards some number of pairs.
pub(crate) struct Run<'a, 'w> {
    pub(crate) lanczos: Lanczos<'a>,
    problem: &'a Problem,
    pub(crate) wanted: usize,
    pub(crate) blocks: usize,
    options: &'a EigenOptions,
    watch: &'a mut EigenWatch<'w>,
    cap: usize,
    next_check: usize,
}

/// Two eigenvalues closer than this share of the larger are not told apart by a count between them.
const GAP: f64 = 1e-7;
/// New starting vectors before a count that does not fit is an error.
const RENEWALS: usize = 3;
/// Numbers in a basis, at most, unless the pairs themselves need more: 2.4 GB.
const MOST_NUMBERS: usize = 300_000_000;

type Counted = (Vec<Candidate>, Vec<Block>, f64);

impl<'a, 'w> Run<'a, 'w> {
    pub(crate) fn new(
        operator: &'a ShiftInvert<'a>,
        locked: &'a [Block],
        wanted: usize,
        options: &'a EigenOptions,
        watch: &'a mut EigenWatch<'w>,
    ) -> Self {
        let rows = operator.problem.rows();
        let lanczos = Lanczos::new(operator, locked, ChaCha8Rng::seed_from_u64(options.seed));
        let room = (MOST_NUMBERS / rows).max(wanted + wanted / 2 + 8 * LANES);
        let cap = (3 * wanted + 12 * LANES).min(room).min(3 * rows / 4);
        Self {
            lanczos,
            problem: operator.problem,
            wanted,
            blocks: 0,
            options,
            watch,
            cap,
            next_check: wanted + wanted / 3 + 5 * LANES,
        }
    }

    /// Extends the basis until the next look at it. Restarts where it is full.
    pub(crate) fn advance(&mut self) -> Result<(Ritz, Vec<Candidate>), EigenError> {
        while self.lanczos.len() < self.next_check.min(self.cap) {
            self.lanczos.extend();
            self.blocks += 1;
        }
        self.next_check = self.lanczos.len() + (self.lanczos.len() / 12).max(LANES);
        self.lanczos.ritz().map_err(|_| EigenError::Dense { rows: self.lanczos.len() })
    }

    /// Tells the watch, and whether to go on.
    pub(crate) fn report(&mut self, converged: usize) -> Result<(), EigenError> {
        let (wanted, blocks) = (self.wanted, self.blocks);
        if (self.watch)(&EigenProgress { converged, wanted, blocks }).is_break() {
            return Err(EigenError::Cancelled { converged, wanted });
        }
        if blocks > self.options.max_blocks {
            return Err(EigenError::NotConverged { converged, wanted, blocks });
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

    /// Keeps the first candidates, rounded up to whole blocks, and looks again a while later.
    pub(crate) fn restart(&mut self, ritz: &Ritz, best: &[Candidate], keep: usize) {
        let keep = (keep.div_ceil(LANES) * LANES).min(best.len() / LANES * LANES);
        let chosen: Vec<usize> = best[..keep].iter().map(|c| c.index).collect();
        self.lanczos.restart(ritz, &chosen);
        self.next_check = (keep + 6 * LANES).max(keep + keep / 4);
    }

    /// Keeps what has converged and continues with random vectors.
    pub(crate) fn renew(&mut self, ritz: &Ritz, best: &[Candidate], converged: usize) {
        self.restart(ritz, best, converged);
        self.lanczos.renew();
        self.cap = self.cap.max(self.lanczos.len() + 12 * LANES);
        self.next_check = self.lanczos.len() + 10 * LANES;
    }

    /// The wanted pairs from below, completed to the next gap, which inertia counts.
    fn until_counted(&mut self, constants: usize) -> Result<Counted, EigenError> {
        let mut renewals = 0;
        loop {
            let (ritz, mut candidates) = self.advance()?;
            candidates.retain(|c| c.lambda > 0.0);
            candidates.sort_by(|a, b| a.lambda.total_cmp(&b.lambda));
            let goal = candidates
                .get(self.wanted - 1)
                .map_or(0.0, |last| self.options.tolerance * last.lambda);
            let converged = candidates.iter().take_while(|c| c.residual <= goal).count();
            self.report(converged.min(self.wanted))?;
            let gap = (self.wanted..=converged).find(|&g| {
                candidates
                    .get(g)
                    .is_none_or(|next| next.lambda - candidates[g - 1].lambda > GAP * next.lambda)
            });
            let Some(g) = gap else {
                self.restart_if_full(&ritz, &candidates);
                continue;
            };
            let from = candidates[g - 1].lambda;
            let to = candidates.get(g).map_or(1.01 * from, |next| next.lambda);
            let (count, shift) = match self.options.count {
                Count::Certified => count_in_gap(self.problem, from, to)?,
                Count::Unchecked => (constants + g, from + 0.5 * (to - from)),
            };
            if count == constants + g {
                candidates.truncate(g);
                let chosen: Vec<usize> = candidates.iter().map(|c| c.index).collect();
                let vectors = self.lanczos.vectors(&ritz, &chosen);
                return Ok((candidates, vectors, shift));
            }
            renewals += 1;
            if renewals > RENEWALS {
                return Err(EigenError::Miscounted {
                    found: constants + g,
                    counted: count,
                    shift: shift * self.problem.unit,
                });
            }
            self.renew(&ritz, &candidates, converged);
        }
    }
}
