//! The operator of shift-invert iteration, (S − σM)⁻¹ M, whose eigenvalues are θ = 1 / (λ − σ).

use crate::cholesky::CholeskyError;
use crate::eigen::basis::Block;
use crate::eigen::problem::Problem;
use crate::factor::Factor;

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

    /// λ of an eigenvalue θ.
    pub(crate) fn eigenvalue(&self, theta: f64) -> f64 {
        self.sigma + 1.0 / theta
    }
}
