//! Inertia counts of eigenvalues and their reliability.
use crate::eigen::problem::Problem;
use crate::error::SparseError;

/// Growth up to which the first shift is accepted without trying others.
const SMALL_GROWTH: f64 = 1e4;
/// Error of L D Lᵀ against a vector, in ε: an entry is a sum of some ten rounded products.
const ROUNDINGS: f64 = 64.0;

/// The number of eigenvalues below a shift.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Counted {
    /// Eigenvalues λ' below the shift.
    pub(crate) count: usize,
    /// σ'.
    pub(crate) shift: f64,
    /// Growth of the products of the elimination relative to the matrix.
    pub(crate) growth: f64,
}

impl Counted {
    /// No eigenvalue lies below zero.
    pub(crate) const NONE: Self = Self { count: 0, shift: 0.0, growth: 1.0 };

    /// Returns true if the factorisation separates σ' from eigenvalues at this distance.
    ///
    /// The count is exact for S' + E − σ'M' with |φᵀEφ| ≤ c ε growth Σ aᵢ φᵢ², where aᵢ is the
    /// diagonal of S' + σ'M'. `strain` is the largest such sum, without σ', over the vectors of
    /// length 1 in M' next to σ'.
    pub(crate) fn is_sure(&self, strain: f64, distance: f64) -> bool {
        ROUNDINGS * f64::EPSILON * self.growth * (strain + self.shift.abs()) < distance
    }
}

/// The number of eigenvalues λ' below a shift in the gap (from, to): of a few candidate shifts, the
/// first for which elimination without pivoting is stable, or else the best. Check with
/// [`Counted::is_sure`].
pub(crate) fn count_in_gap(problem: &Problem, from: f64, to: f64) -> Result<Counted, SparseError> {
    let mut best: Option<Counted> = None;
    let mut failure = None;
    // Close to the lower end, which is known; the upper end may be an overestimate.
    for fraction in [0.25, 0.32, 0.19, 0.41] {
        let shift = from + fraction * (to - from);
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
                failure = Some(SparseError::Factor {
                    shift: shift * problem.unit,
                    source: Box::new(source),
                });
            }
        }
    }
    match (best, failure) {
        (Some(counted), _) => Ok(counted),
        (None, Some(error)) => Err(error),
        // The loop tries at least one shift.
        (None, None) => Ok(Counted { shift: from, ..Counted::NONE }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Growth, strain and proximity each reduce certainty; without them a gap of 10⁻¹¹ suffices.
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
