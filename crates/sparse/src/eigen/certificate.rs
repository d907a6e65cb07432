//! Counting eigenvalues by inertia.

use crate::eigen::EigenError;
use crate::eigen::problem::Problem;

/// Pivots may outgrow the matrix by so much before a count is not trusted.
const SAFE_GROWTH: f64 = 1e8;

/// The number of eigenvalues λ' below a shift in the gap (from, to), and the shift: the first of a few places
/// in the gap where elimination without pivoting is stable.
pub(crate) fn count_in_gap(
    problem: &Problem,
    from: f64,
    to: f64,
) -> Result<(usize, f64), EigenError> {
    let mut best: Option<(f64, usize, f64)> = None;
    let mut failure = None;
    // Close to the lower end, which is known, while the upper end may be an estimate from above.
    for share in [0.25, 0.32, 0.19, 0.41] {
        let shift = from + share * (to - from);
        match problem.indefinite(shift) {
            Ok(ldlt) => {
                let (growth, count) = (ldlt.growth(), ldlt.inertia().negative);
                if growth < SAFE_GROWTH {
                    return Ok((count, shift));
                }
                if best.is_none_or(|(g, ..)| growth < g) {
                    best = Some((growth, count, shift));
                }
            }
            Err(source) => {
                failure = Some(EigenError::Factor { shift: shift * problem.unit, source });
            }
        }
    }
    match (best, failure) {
        (Some((_, count, shift)), _) => Ok((count, shift)),
        (None, Some(error)) => Err(error),
        // The loop above always tries.
        (None, None) => Ok((0, from)),
    }
}
