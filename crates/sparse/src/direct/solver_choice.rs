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
use crate::mass::Mass;
use crate::matrix::{Rows, SparseMatrix};

/// A kind of solver for symmetric positive definite systems.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum SolverChoice {
    /// Sparse Cholesky: [`Cholesky`](crate::Cholesky).
    Direct,
    /// Conjugate gradients with the diagonal as preconditioner:
    /// [`ConjugateGradient`](crate::ConjugateGradient).
    Iterative,
}

/// Properties of the systems to solve that decide between the solvers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Workload {
    /// Rows of the matrix.
    pub rows: usize,
    /// Entries of the matrix.
    pub entries: usize,
    /// Entries of its Cholesky factor if known, as from
    /// [`SymbolicCholesky::factor_entries`](crate::SymbolicCholesky::factor_entries); `None`
    /// assumes those of a surface mesh, n (5.5 log₂ n − 35) for n rows.
    pub factor_entries: Option<usize>,
    /// Condition κ of the matrix scaled to a unit diagonal; [`shifted_condition`] estimates it for
    /// M + tS.
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
/// Upper end of the spectrum of D⁻¹S on closed triangle meshes.
const JACOBI_BOUND: f64 = 1.5;

impl Workload {
    /// The workload of α M + β S, the matrix that [`combine`](crate::combine) returns for the same
    /// arguments, to a residual of 10⁻¹⁰.
    pub fn combined(
        alpha: f64,
        mass: Mass<'_>,
        beta: f64,
        s: &SparseMatrix,
        solves: usize,
    ) -> Self {
        Self {
            rows: s.rows(),
            entries: s.nnz(),
            factor_entries: None,
            condition: shifted_condition(mass, beta / alpha, s),
            tolerance: 1e-10,
            solves,
        }
    }

    /// Expected iterations of conjugate gradients in one solve: 0.9 · ½ √κ ln (2/ε), at most one
    /// per row.
    pub fn iterations(&self) -> f64 {
        let digits = libm::log(2.0 / self.tolerance.clamp(f64::EPSILON, 1.0));
        (EARLY * 0.5 * self.condition.max(1.0).sqrt() * digits).clamp(1.0, self.rows.max(1) as f64)
    }

    /// Estimated time of the analysis, one factorisation and all solves, in nanoseconds.
    pub fn direct_cost(&self) -> f64 {
        let n = self.rows as f64;
        let guess = ordering::usual_fill(self.rows);
        let entries = self.factor_entries.map_or(guess, |e| e as f64);
        // Factorisation work grows with the square of the column lengths.
        let fuller = (entries / guess.max(1.0)).powi(2);
        let factorise = n * (FACTORISE.0 + FACTORISE.1 * n.sqrt()) * fuller;
        factorise + self.solves as f64 * SOLVE * entries
    }

    /// Estimated time of all solves by conjugate gradients, in nanoseconds.
    pub fn iterative_cost(&self) -> f64 {
        self.solves as f64 * self.iterations() * ITERATE * self.entries as f64
    }
}

impl SolverChoice {
    /// The solver with the smaller estimated time.
    ///
    /// # Examples
    ///
    /// ```
    /// use fairing_sparse::{SolverChoice, Workload};
    /// let step = Workload {
    ///     rows: 10_000,
    ///     entries: 70_000,
    ///     factor_entries: None,
    ///     condition: 6.0,
    ///     tolerance: 1e-10,
    ///     solves: 1,
    /// };
    /// // A factorisation pays for one long step of a flow or for many, but not for a short one.
    /// assert_eq!(SolverChoice::choose(&step), SolverChoice::Iterative);
    /// let long = Workload { condition: 6000.0, ..step };
    /// assert_eq!(SolverChoice::choose(&long), SolverChoice::Direct);
    /// assert_eq!(SolverChoice::choose(&Workload { solves: 50, ..step }), SolverChoice::Direct);
    /// ```
    pub fn choose(work: &Workload) -> Self {
        if work.iterative_cost() < work.direct_cost() { Self::Iterative } else { Self::Direct }
    }
}

/// An estimate of κ for M + tS scaled to a unit diagonal: 3/2 (1 + t q) with q the ninth decile of
/// Sᵢᵢ / Mᵢᵢ.
///
/// On an equilateral mesh with edges h, Sᵢᵢ / Mᵢᵢ = 4/h². The rows beyond the decile add few
/// iterations, like isolated eigenvalues. Infinite if t or a quotient is.
///
/// # Panics
///
/// Panics if the mass has fewer rows than S.
pub fn shifted_condition(mass: Mass<'_>, t: f64, stiffness: &SparseMatrix) -> f64 {
    let mass = mass.diagonal();
    let diagonal = Rows::new(stiffness).diagonal();
    let mut quotients: Vec<f64> =
        (0..diagonal.len()).map(|i| (diagonal[i] / mass[i]).max(0.0)).collect();
    if quotients.is_empty() {
        return 1.0;
    }
    let place = quotients.len() * 9 / 10;
    let (_, decile, _) = quotients.select_nth_unstable_by(place, f64::total_cmp);
    (JACOBI_BOUND * (1.0 + t * *decile)).max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mesh(rows: usize, t: f64, solves: usize) -> Workload {
        Workload {
            rows,
            entries: 7 * rows,
            factor_entries: None,
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
            let faster =
                if direct < iterative { SolverChoice::Direct } else { SolverChoice::Iterative };
            if f64::max(direct / iterative, iterative / direct) > 1.5 {
                assert_eq!(
                    SolverChoice::choose(&work),
                    faster,
                    "{rows} rows, t = {t} h², {solves}"
                );
            }
        }
    }

    /// A factor known to be fuller than a mesh's moves the choice.
    #[test]
    fn fill_counts() {
        let work = Workload { rows: 20_000, entries: 140_000, ..mesh(20_000, 100.0, 1) };
        assert_eq!(SolverChoice::choose(&work), SolverChoice::Direct);
        let full = Workload { factor_entries: Some(20_000 * 400), ..work };
        assert_eq!(SolverChoice::choose(&full), SolverChoice::Iterative);
    }

    #[test]
    fn conditions_follow_the_step() {
        // Path of four: Sᵢᵢ = 1, 2, 2, 1.
        let mut t = sprs::TriMatI::<f64, u32>::new((4, 4));
        for i in 0..3 {
            for (a, b, v) in [(i, i, 1.0), (i + 1, i + 1, 1.0), (i, i + 1, -1.0), (i + 1, i, -1.0)]
            {
                t.add_triplet(a, b, v);
            }
        }
        let s: SparseMatrix = t.to_csr();
        let m = [2.0; 4];
        assert_eq!(shifted_condition(Mass::Lumped(&m), 0.0, &s), 1.5);
        assert_eq!(shifted_condition(Mass::Lumped(&m), 5.0, &s), 1.5 * 6.0);
        let work = Workload::combined(2.0, Mass::Lumped(&m), 10.0, &s, 1);
        assert_eq!((work.rows, work.entries, work.condition), (4, 10, 9.0));
    }
}
