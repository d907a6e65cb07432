//! The operator of shift-invert iteration, (S − σM)⁻¹ M, whose eigenvalues are θ = 1 / (λ − σ).
//!
//! The shift for the k smallest eigenvalues:
//!
//! Block Lanczos with b vectors finds λ_k fast if 1/(λ − σ) separates it from λ_(k+b). With σ ≤ 0
//! the two differ by a fraction b/k. With σ among the wanted eigenvalues, the upper ones move apart
//! and the lower ones turn negative, away from everything unwanted; with σ too high they come too
//! close to zero. Blocks measured for 100 pairs in blocks of eight, on two spheres:
//!
//! | Vertices | σ < 0 | 40 % below σ | 50 % | 60 % | 70 % | 75 % | this choice |
//! |---|---|---|---|---|---|---|---|
//! | 10 thousand | 38 | 38 | 35 | 32 | 32 | 35 | |
//! | 160 thousand | 50 | | | | | | 32 |

use crate::direct::factor::{Factor, LANES};
use crate::eigen::basis::Block;
use crate::eigen::problem::Problem;
use crate::error::SparseError;

/// S − σM, factorised.
pub(crate) struct ShiftInvert<'a> {
    pub(crate) problem: &'a Problem,
    pub(crate) sigma: f64,
    factor: Factor,
    /// Maximum number of refinement steps.
    steps: usize,
}

/// Steps that reduce an error of a third to [`SETTLED`].
const EXACT_STEPS: usize = 30;
/// Relative change of a solution that does not matter for eigenvalues of ten digits.
const SETTLED: f64 = 1e-14;

impl<'a> ShiftInvert<'a> {
    /// Factorises with σ below all eigenvalues.
    pub(crate) fn below(problem: &'a Problem, sigma: f64) -> Result<Self, SparseError> {
        Ok(Self { problem, sigma, factor: problem.definite(sigma)?.into_factor(), steps: 0 })
    }

    /// Factorises with σ among the eigenvalues; returns the number of eigenvalues below σ and the
    /// growth of the pivots.
    pub(crate) fn among(
        problem: &'a Problem,
        sigma: f64,
    ) -> Result<(Self, usize, f64), SparseError> {
        let ldlt = problem.indefinite(sigma)?;
        let (count, growth) = (ldlt.inertia().negative, ldlt.growth());
        Ok((Self { problem, sigma, factor: ldlt.into_factor(), steps: 0 }, count, growth))
    }

    /// The same operator, with solutions refined to those of S with exact row sums.
    pub(crate) fn exact(self) -> Self {
        Self { steps: EXACT_STEPS, ..self }
    }

    /// (S − σM)⁻¹ M V.
    pub(crate) fn apply(&self, v: &Block) -> Block {
        self.solve(v, self.steps)
    }

    /// [`ShiftInvert::apply`] with at least one step of iterative refinement, so that each row has
    /// the rounding of its own terms only, however small beside those of other rows.
    pub(crate) fn apply_refined(&self, v: &Block) -> Block {
        self.solve(v, self.steps.max(1))
    }

    fn solve(&self, v: &Block, steps: usize) -> Block {
        let mut w = self.problem.mass_times(v);
        self.factor.solve_ordered(&mut w);
        let mut before = f64::INFINITY;
        for _ in 0..steps {
            let mut rest = self.problem.mass_times(v);
            let found = self.problem.residual(&w, &[self.sigma; LANES]);
            for (rest, found) in rest.iter_mut().zip(found) {
                for lane in 0..LANES {
                    rest[lane] -= found[lane];
                }
            }
            self.factor.solve_ordered(&mut rest);
            for (w, correction) in w.iter_mut().zip(&rest) {
                for lane in 0..LANES {
                    w[lane] += correction[lane];
                }
            }
            if steps > 1 {
                let length = |block: &Block| self.problem.squares(block).iter().sum::<f64>().sqrt();
                let change = length(&rest) / length(&w);
                // Settled or at the limit; NaN ends the refinement too.
                if !(change > SETTLED && change < 0.5 * before) {
                    break;
                }
                before = change;
            }
        }
        w
    }

    /// The eigenvalue λ that belongs to θ.
    pub(crate) fn eigenvalue(&self, theta: f64) -> f64 {
        self.sigma + 1.0 / theta
    }
}

/// Weyl's law in units of a median entry of S and a mean mass: λ_k ≈ 3.2 k / n. With 2√3
/// cotangents in a row of a regular mesh it would be 3.63 (λ = 4πk/A, M = A/n; a square grid gives
/// π), but in a row of a scan they are 1.0 to 1.4 times as many.
const WEYL: f64 = 3.2;
/// Fraction of the wanted eigenvalues that should lie below σ.
const BEST_FRACTION: f64 = 0.62;
/// Fractions that are not worth another factorisation.
const GOOD_FRACTIONS: std::ops::Range<f64> = 0.45..0.75;
/// Fewer pairs converge as fast with a shift below them, and its factorisation never needs a second
/// try.
const FEW: usize = 6;
/// Shifts tried before falling back to one below the spectrum.
const TRIES: usize = 4;
/// Allowed growth of pivots in an operator: solutions keep nine digits.
const SAFE_GROWTH: f64 = 1e6;

/// The operator for the `count` smallest eigenvalues, constants included.
pub(crate) fn for_smallest(
    problem: &Problem,
    count: usize,
) -> Result<ShiftInvert<'_>, SparseError> {
    let n = problem.rows() as f64;
    let mut below = -1.0 / n;
    if count >= FEW {
        let mut sigma = BEST_FRACTION * WEYL * problem.rate * count as f64 / n;
        for _ in 0..TRIES {
            let Ok((operator, inertia, growth)) = ShiftInvert::among(problem, sigma) else {
                sigma *= 0.97;
                continue;
            };
            let fraction = inertia as f64 / count as f64;
            if !GOOD_FRACTIONS.contains(&fraction) {
                // Far more eigenvalues below than wanted: they lie much closer to zero than Weyl's
                // law predicts.
                if inertia > count {
                    below = below.max(-sigma / fraction);
                }
                sigma *= (BEST_FRACTION / fraction.max(0.05)).min(8.0);
            } else if growth > SAFE_GROWTH {
                sigma *= 0.97;
            } else {
                return Ok(operator);
            }
        }
    }
    ShiftInvert::below(problem, below).map_err(|source| SparseError::Factor {
        shift: below * problem.unit,
        source: Box::new(source),
    })
}
