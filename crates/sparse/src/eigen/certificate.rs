//! Counting eigenvalues by inertia, and how far such a count can be trusted.

use crate::eigen::EigenError;
use crate::eigen::problem::Problem;

/// Growth up to which the first place is taken without looking at others.
const SMALL_GROWTH: f64 = 1e4;
/// An entry of L D Lᵀ is a sum of some ten products, each rounded; the bound on the sum of all of their errors
/// against a vector is this many ε.
const ROUNDINGS: f64 = 64.0;

/// A number of eigenvalues, and where it was taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Counted {
    /// Eigenvalues λ' below the shift.
    pub(crate) count: usize,
    /// σ'.
    pub(crate) shift: f64,
    /// How much the products of the elimination outgrew the matrix.
    pub(crate) growth: f64,
}

impl Counted {
    /// Nothing lies below zero.
    pub(crate) const NONE: Self = Self { count: 0, shift: 0.0, growth: 1.0 };

    /// Whether the factorisation could tell eigenvalues at this distance from σ' apart from it.
    ///
    /// It is exact for S' + E − σ'M' with |φᵀEφ| ≤ c ε growth Σ aᵢ φᵢ², aᵢ the diagonal of S' + σ'M'. `strain` is
    /// the largest such sum without σ' of the vectors next to σ', of length 1 in M'.
    pub(crate) fn is_sure(&self, strain: f64, distance: f64) -> bool {
        ROUNDINGS * f64::EPSILON * self.growth * (strain + self.shift.abs()) < distance
    }
}

/// The number of eigenvalues λ' below a shift in the gap (from, to): the first of a few places in the gap where
/// elimination without pivoting is stable, or else the best of them. [`Counted::is_sure`] must judge it.
pub(crate) fn count_in_gap(problem: &Problem, from: f64, to: f64) -> Result<Counted, EigenError> {
    let mut best: Option<Counted> = None;
    let mut failure = None;
    // Close to the lower end, which is known, while the upper end may be an estimate from above.
    for share in [0.25, 0.32, 0.19, 0.41] {
        let shift = from + share * (to - from);
        match problem.indefinite(shift) {
            Ok(ldlt) => {
                let (growth, count) = (ldlt.growth(), ldlt.inertia().negative);
                let counted = Counted { count, shift, growth };
                if growth < SMALL_GROWTH {
                    return Ok(counted);
                }
                if best.is_none_or(|b| growth < b.growth) {
                    best = Some(counted);
                }
            }
            Err(source) => {
                failure = Some(EigenError::Factor { shift: shift * problem.unit, source });
            }
        }
    }
    match (best, failure) {
        (Some(counted), _) => Ok(counted),
        (None, Some(error)) => Err(error),
        // The loop above always tries.
        (None, None) => Ok(Counted { shift: from, ..Counted::NONE }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Growth, strain and nearness each take certainty away; without any of them a gap of 10⁻¹¹ is sure.
    #[test]
    fn counts_are_sure_away_from_eigenvalues() {
        let counted = |growth| Counted { count: 3, shift: 1e-3, growth };
        assert!(counted(1.0).is_sure(1.0, 1e-11));
        assert!(!counted(1e9).is_sure(1.0, 1e-11));
        assert!(!counted(1.0).is_sure(1e9, 1e-11));
        assert!(!counted(1.0).is_sure(1.0, 1e-15));
        assert!(!counted(f64::NAN).is_sure(1.0, 1.0));
    }
}
