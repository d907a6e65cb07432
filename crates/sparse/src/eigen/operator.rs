//! The operator of shift-invert iteration, (S − σM)⁻¹ M, whose eigenvalues are θ = 1 / (λ − σ).

use crate::direct::cholesky::CholeskyError;
use crate::direct::factor::{Factor, LANES};
use crate::eigen::basis::Block;
use crate::eigen::problem::Problem;

/// S − σM, factorised.
pub(crate) struct ShiftInvert<'a> {
    pub(crate) problem: &'a Problem,
    pub(crate) sigma: f64,
    factor: Factor,
}

impl<'a> ShiftInvert<'a> {
    /// With σ below all eigenvalues.
    pub(crate) fn below(problem: &'a Problem, sigma: f64) -> Result<Self, CholeskyError> {
        Ok(Self { problem, sigma, factor: problem.definite(sigma)?.into_factor() })
    }

    /// With σ among the eigenvalues; how many lie below it, and the growth of the pivots.
    pub(crate) fn among(
        problem: &'a Problem,
        sigma: f64,
    ) -> Result<(Self, usize, f64), CholeskyError> {
        let ldlt = problem.indefinite(sigma)?;
        let (count, growth) = (ldlt.inertia().negative, ldlt.growth());
        Ok((Self { problem, sigma, factor: ldlt.into_factor() }, count, growth))
    }

    /// (S − σM)⁻¹ M V.
    pub(crate) fn apply(&self, v: &Block) -> Block {
        let mut w = self.problem.mass_times(v);
        self.factor.solve_ordered(&mut w);
        w
    }

    /// [`ShiftInvert::apply`], once refined: what the factor leaves of the right-hand side is solved for too, so that
    /// what is left is the rounding of each row's own terms, however small they are beside those of other rows.
    pub(crate) fn apply_refined(&self, v: &Block) -> Block {
        let mut w = self.apply(v);
        let mut rest = self.problem.mass_times(v);
        let found = self.problem.residual(&w, &[self.sigma; LANES]);
        for (rest, found) in rest.iter_mut().zip(found) {
            for lane in 0..LANES {
                rest[lane] -= found[lane];
            }
        }
        self.factor.solve_ordered(&mut rest);
        for (w, correction) in w.iter_mut().zip(rest) {
            for lane in 0..LANES {
                w[lane] += correction[lane];
            }
        }
        w
    }

    /// λ of an eigenvalue θ.
    pub(crate) fn eigenvalue(&self, theta: f64) -> f64 {
        self.sigma + 1.0 / theta
    }
}
