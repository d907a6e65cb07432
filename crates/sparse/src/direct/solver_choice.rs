//! The choice between a direct and an iterative solver, by a cost model fitted to measurements.
//!
//! Times per row on M + tS of regular triangle grids, two cores, three right-hand sides together,
//! residual 10⁻¹⁰ (`cargo run --release -p fairing-sparse --example direct_or_iterative`):
//!
//! | rows | nonzeros of L | analyse and factorise | solve | one CG iteration |
//! |--:|--:|--:|--:|--:|
//! | 1 024 | 21 | 0.68 µs | 29 ns | 10 ns |
//! | 4 096 | 29 | 0.76 µs | 37 ns | 11 ns |
//! | 16 384 | 38 | 0.90 µs | 47 ns | 13 ns |
//! | 65 536 | 49 | 1.3 µs | 53 ns | 10 ns |
//! | 160 000 | 57 | 1.6 µs | 106 ns | 9 to 15 ns |
//! | 640 000 | 72 | 2.6 µs | 200 ns | 28 ns |
//!
//! The iteration count depends on t, not on the size: 28, 86, 270, 850 for t/h² = 1, 10, 100, 1000
//! (fewer if t is as large as the mesh). It is a tenth below Chebyshev's bound ½ √κ ln (2/ε) with
//! κ = 3/2 · (1 + t Sᵢᵢ/Mᵢᵢ): after Jacobi scaling, the spectrum of a triangle mesh lies between
//! M/(M + tS) and 3/2.
//!
//! A factorisation therefore pays for a single solve from t ≈ 10 h² (16 thousand rows) or 50 h²
//! (160 thousand), and for ten solves with one matrix from t = h². Beyond some million rows memory
//! decides: a factor takes 8 bytes for each of its 60 to 80 nonzeros per row, conjugate gradients
//! 20 numbers per row in all.

use crate::direct::ordering;

/// Properties of the systems to solve that decide between the solvers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Workload {
    /// Rows of the matrix.
    pub rows: usize,
    /// Entries of the matrix.
    pub entries: usize,
    /// Condition κ of the matrix scaled to a unit diagonal.
    pub condition: f64,
    /// Residual to reach, relative to the initial one. Cholesky solves to rounding.
    pub tolerance: f64,
    /// Number of solves with this matrix, each for up to three right-hand sides together.
    pub solves: usize,
}

/// Analysis and factorisation, in nanoseconds per row: constant term and coefficient of √n.
const FACTORISE: (f64, f64) = (700.0, 2.4);
/// A solve for three right-hand sides, in nanoseconds per entry of the factor.
const SOLVE: f64 = 1.8;
/// An iteration for three right-hand sides, in nanoseconds per entry of the matrix.
const ITERATE: f64 = 1.6;
/// Iterations of conjugate gradients as a fraction of Chebyshev's bound.
const EARLY: f64 = 0.9;

impl Workload {
    /// Returns true if [`Cholesky`](crate::Cholesky), with the factor of a surface mesh, is
    /// expected to be faster than conjugate gradients.
    ///
    /// # Examples
    ///
    /// ```
    /// use fairing_sparse::Workload;
    /// let step = Workload {
    ///     rows: 10_000,
    ///     entries: 70_000,
    ///     condition: 6.0,
    ///     tolerance: 1e-10,
    ///     solves: 1,
    /// };
    /// // A factorisation pays for one long step of a flow or for many, but not for a short one.
    /// assert!(!step.prefers_factorisation());
    /// assert!(Workload { condition: 6000.0, ..step }.prefers_factorisation());
    /// assert!(Workload { solves: 50, ..step }.prefers_factorisation());
    /// ```
    pub fn prefers_factorisation(&self) -> bool {
        let (rows, solves) = (self.rows as f64, self.solves as f64);
        let direct = rows * (FACTORISE.0 + FACTORISE.1 * rows.sqrt())
            + solves * SOLVE * ordering::usual_fill(self.rows);
        solves * self.iterations() * ITERATE * self.entries as f64 >= direct
    }

    /// Expected iterations of conjugate gradients in one solve: 0.9 · ½ √κ ln (2/ε), at most one
    /// per row.
    fn iterations(&self) -> f64 {
        let digits = libm::log(2.0 / self.tolerance.clamp(f64::EPSILON, 1.0));
        (EARLY * 0.5 * self.condition.max(1.0).sqrt() * digits).clamp(1.0, self.rows.max(1) as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mesh(rows: usize, t: f64, solves: usize) -> Workload {
        Workload {
            rows,
            entries: 7 * rows,
            condition: 1.5 * (1.0 + 4.0 * t),
            tolerance: 1e-10,
            solves,
        }
    }

    /// The iterations measured, within a fifth.
    #[test]
    fn iterations_are_those_measured() {
        for (t, measured) in [(1.0, 28.0), (10.0, 86.0), (100.0, 270.0), (1000.0, 850.0)] {
            let expected = mesh(160_000, t, 1).iterations();
            assert!((expected / measured - 1.0_f64).abs() < 0.2, "{t}: {expected}");
        }
        assert_eq!(mesh(5, 1e9, 1).iterations(), 5.0);
    }

    /// The faster one of the measured times (milliseconds), where they differ by half or more.
    #[test]
    fn the_choice_is_the_faster_one() {
        for (rows, t, solves, factorise, solve, iterate) in [
            (1_024, 1.0, 1, 0.69, 0.03, 0.31),
            (1_024, 10.0, 10, 0.69, 0.03, 0.86),
            (16_384, 10.0, 1, 14.7, 0.9, 18.5),
            (16_384, 100.0, 1, 14.7, 0.9, 55.9),
            (65_536, 1.0, 1, 86.0, 3.4, 15.9),
            (65_536, 1.0, 15, 86.0, 3.4, 15.9),
            (160_000, 10.0, 1, 256.0, 17.0, 119.5),
            (160_000, 1000.0, 1, 256.0, 17.0, 1992.0),
            (640_000, 1.0, 1, 1777.0, 125.0, 494.0),
            (640_000, 100.0, 1, 1650.0, 125.0, 4746.0),
        ] {
            let work = mesh(rows, t, solves);
            let (direct, iterative) = (factorise + solves as f64 * solve, solves as f64 * iterate);
            if f64::max(direct / iterative, iterative / direct) > 1.5 {
                let is_direct = work.prefers_factorisation();
                assert_eq!(is_direct, direct < iterative, "{rows} rows, t = {t} h², {solves}");
            }
        }
    }
}
