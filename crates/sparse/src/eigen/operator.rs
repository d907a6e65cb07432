//! The operator of shift-invert iteration, (S − σM)⁻¹ M, whose eigenvalues are θ = 1 / (λ − σ).
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
