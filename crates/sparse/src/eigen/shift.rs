//! Choice of the shift for the k smallest eigenvalues.
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
use crate::eigen::operator::ShiftInvert;
use crate::eigen::problem::Problem;
use crate::error::SparseError;

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
