//! L D Lᵀ factorisation of symmetric matrices that may be indefinite, and their inertia.

use ndarray::ArrayViewMut2;

use crate::direct::factor::Factor;
use crate::order::larger;

/// The numbers of negative, zero and positive eigenvalues of a symmetric matrix.
///
/// By Sylvester's law of inertia these are the signs of D in A = L D Lᵀ. For A = S − σM with M
/// positive definite, `negative` counts the eigenvalues of S φ = λ M φ below σ.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct Inertia {
    /// Negative eigenvalues.
    pub negative: usize,
    /// Zero eigenvalues; none if the factorisation succeeded.
    pub zero: usize,
    /// Positive eigenvalues.
    pub positive: usize,
}

/// A factorised symmetric matrix, A = L D Lᵀ with a diagonal D.
///
/// Made by
/// [`SymbolicCholesky::factorize_indefinite`](crate::SymbolicCholesky::factorize_indefinite).
#[derive(Debug, Clone)]
pub struct Ldlt {
    factor: Factor,
    inertia: Inertia,
    growth: f64,
}

impl Ldlt {
    /// A factor with its inertia and growth; `largest` holds the largest absolute entry of each row
    /// of A.
    pub(crate) fn new(factor: Factor, largest: &[f64]) -> Self {
        let analysis = &factor.analysis;
        let mut inertia = Inertia { negative: 0, zero: 0, positive: 0 };
        for pivot in analysis.nodes.diagonal(&factor.values) {
            if pivot < 0.0 {
                inertia.negative += 1;
            } else {
                inertia.positive += 1;
            }
        }
        let sums = analysis.nodes.eliminated(&factor.values);
        let growth = sums
            .iter()
            .zip(&analysis.order)
            .map(|(sum, &row)| sum / largest[row as usize])
            .fold(1.0, larger);
        Self { growth, factor, inertia }
    }

    /// The numbers of negative, zero and positive eigenvalues.
    pub fn inertia(&self) -> Inertia {
        self.inertia
    }

    /// The growth factor: the largest, over the rows i, of Σₖ lᵢₖ² |dₖ| divided by the largest
    /// entry of row i of A. At least 1, and 1 for a definite matrix.
    ///
    /// The computed factor is that of A + E with |Eᵢⱼ| below a few ε g √(aᵢ aⱼ), where aᵢ is the
    /// largest entry of row i: without pivoting, a growth of g costs about log₁₀ g of the sixteen
    /// digits. Each row is measured separately, so that a few huge entries do not hide growth in
    /// other rows.
    pub fn growth(&self) -> f64 {
        self.growth
    }

    pub(crate) fn into_factor(self) -> Factor {
        self.factor
    }

    /// The number of rows of the matrix.
    pub fn rows(&self) -> usize {
        self.factor.rows()
    }

    /// x with A x = b.
    ///
    /// # Panics
    ///
    /// Panics if `b` has another length than A has rows.
    pub fn solve(&self, b: &[f64]) -> Vec<f64> {
        let mut x = b.to_vec();
        self.factor.solve_vector(&mut x);
        x
    }

    /// X with A X = B for points, one in a row: `n × 3`.
    ///
    /// # Panics
    ///
    /// Panics if `b` has another length than A has rows.
    pub fn solve_points(&self, b: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let mut x = b.to_vec();
        self.factor.solve_points(&mut x);
        x
    }

    /// `b` ← A⁻¹ b for an `n × k` block.
    ///
    /// # Panics
    ///
    /// Panics if `b` has another number of rows than A.
    pub fn solve_block_in_place(&self, b: ArrayViewMut2<'_, f64>) {
        self.factor.solve_block(b);
    }
}
