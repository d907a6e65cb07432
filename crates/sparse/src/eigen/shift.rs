//! Where to put the shift for the k smallest eigenvalues.
//!
//! Block Lanczos with b vectors finds λ_k fast where 1/(λ − σ) sets it apart from λ_(k+b). With σ ≤ 0 the two
//! differ by a share of b/k. With σ among the wanted eigenvalues the upper ones move apart, and the lower ones
//! turn negative, away from everything unwanted; with σ too high they come too close to zero. Measured for 100
//! pairs in blocks of eight, on two spheres:
//!
//! | Vertices | σ < 0 | 40 % below σ | 50 % | 60 % | 70 % | 75 % | the choice here |
//! |---|---|---|---|---|---|---|---|
//! | 10 thousand | 38 | 38 | 35 | 32 | 32 | 35 | |
//! | 160 thousand | 50 | | | | | | 32 |

use crate::eigen::EigenError;
use crate::eigen::operator::ShiftInvert;
use crate::eigen::problem::Problem;

/// Weyl's law in dimensionless units: λ_k ≈ 3.5 k / n, with 2√3 cotangents in a row of a regular mesh
/// (λ = 4πk/A, S = 2√3, M = A/n; a square grid gives π).
const WEYL: f64 = 3.5;
/// Share of the wanted eigenvalues to lie below σ.
const BEST_SHARE: f64 = 0.62;
/// Shares that are not worth another factorisation.
const GOOD_SHARES: std::ops::Range<f64> = 0.45..0.75;
/// Fewer pairs come as fast with a shift below them, where a factorisation never needs a second try.
const FEW: usize = 6;
/// Shifts to try before falling back to one below the spectrum.
const TRIES: usize = 4;
/// In an operator, pivots may outgrow the matrix by this factor: solutions keep nine digits.
const SAFE_GROWTH: f64 = 1e6;

/// The operator for the `count` smallest eigenvalues, constants included.
pub(crate) fn for_smallest(problem: &Problem, count: usize) -> Result<ShiftInvert<'_>, EigenError> {
    let n = problem.rows() as f64;
    let mut below = -1.0 / n;
    if count >= FEW {
        let mut sigma = BEST_SHARE * WEYL * count as f64 / n;
        for _ in 0..TRIES {
            let Ok((operator, inertia, growth)) = ShiftInvert::among(problem, sigma) else {
                sigma *= 0.97;
                continue;
            };
            let share = inertia as f64 / count as f64;
            if !GOOD_SHARES.contains(&share) {
                // Far more below than wanted: the wanted ones lie much closer to zero than Weyl's law predicts.
                if inertia > count {
                    below = below.max(-sigma / share);
                }
                sigma *= (BEST_SHARE / share.max(0.05)).min(8.0);
            } else if growth > SAFE_GROWTH {
                sigma *= 0.97;
            } else {
                return Ok(operator);
            }
        }
    }
    ShiftInvert::below(problem, below)
        .map_err(|source| EigenError::Factor { shift: below * problem.unit, source })
}
