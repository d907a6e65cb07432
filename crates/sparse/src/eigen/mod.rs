//! The generalised symmetric eigenproblem S φ = λ M φ: the smallest eigenpairs, with measured
//! residuals and inertia counts.
//!
//! S is symmetric positive semi-definite, M a lumped or consistent mass. Large problems use block
//! Lanczos on (S − σM)⁻¹ M with full orthogonalisation and thick restart, in slices of the spectrum
//! for many pairs; small problems use a dense decomposition. Source: [grimes1994], [wu2000].
//!
//! [grimes1994]: https://doi.org/10.1137/S0895479888151111
//! [wu2000]: https://doi.org/10.1137/S0895479898334605

mod basis;
mod certificate;
mod components;
mod dense;
mod lanczos;
mod operator;
mod polish;
mod problem;
mod projected;
mod run;
mod slices;
mod solve;
mod symmetric;

use ndarray::Array2;

pub use components::smallest_eigenpairs;
pub use symmetric::smallest_symmetric_eigenpairs;

/// Allowed ratio of a measured residual to the tolerance: residuals in a group of multiple
/// eigenvalues include those of their neighbours.
const SLACK: f64 = 10.0;

/// Settings of the eigensolver.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct EigenOptions {
    /// Target of the iteration for the residual ‖S φ − λ M φ‖ in the M⁻¹ norm of a vector with φᵀMφ
    /// = 1, relative to the largest wanted eigenvalue. [`EigenOptions::residual_limit`] bounds the
    /// results.
    pub tolerance: f64,
    /// Seed of the starting vectors.
    pub seed: u64,
    /// Maximum number of blocks of eight vectors in each slice.
    pub max_blocks: usize,
    /// Problems with at most this many rows are solved densely, and with up to four times as many
    /// if a quarter of the eigenvalues is wanted.
    pub dense_rows: usize,
    /// Maximum number of eigenpairs of one Lanczos run; further pairs are computed slice by slice.
    pub slice: usize,
}

impl Default for EigenOptions {
    fn default() -> Self {
        Self { tolerance: 1e-9, seed: 0, max_blocks: 2000, dense_rows: 400, slice: 320 }
    }
}

impl EigenOptions {
    /// Bound on the measured residuals of all pairs: ten times the tolerance times the largest
    /// eigenvalue wanted. If tiny masses or huge weights make rounding larger than that, the bound
    /// is 64 ε ‖|S| |φ| + |λ| M |φ|‖ in the M⁻¹ norm instead.
    ///
    /// The first bound is one number for all pairs: next to a huge eigenvalue it says little about
    /// a small one, unlike the residual itself. The second depends on the vector.
    pub fn residual_limit(&self, largest: f64) -> f64 {
        SLACK * self.tolerance * largest
    }
}

/// Known eigenvalues after the requested ones.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Beyond {
    /// Further eigenvalues, ascending: the solver continues to the next gap.
    pub values: Vec<f64>,
    /// No other eigenvalue lies below this bound, with the certainty of `certified`. Infinite if
    /// there are no others.
    pub clear_below: f64,
}

impl Beyond {
    /// Further values, ascending, and the bound below which there are no others.
    pub fn new(values: Vec<f64>, clear_below: f64) -> Self {
        Self { values, clear_below }
    }
}

/// Eigenpairs of S φ = λ M φ.
///
/// The error of an eigenvalue is at most its residual r, and about r² / d if the distance d to the
/// next eigenvalue is larger than r; rounding adds some ε φᵀ|S|φ. The angle error of a vector is
/// about r / d. Results on processors that round in another order differ by as much.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct EigenPairs {
    /// Eigenvalues, ascending; exactly 0 for constants of components that S maps to zero.
    pub values: Vec<f64>,
    /// `n × k`, one eigenvector per column, φᵢᵀ M φⱼ = δᵢⱼ, zero outside its component of S and M.
    /// Signs and bases of multiple eigenvalues are arbitrary but reproducible.
    pub vectors: Array2<f64>,
    /// ‖S φ − λ M φ‖ in the M⁻¹ norm of each pair, in units of λ, measured on the returned vectors,
    /// with S as the Laplacian of its off-diagonal entries. If the rounding of entries matters,
    /// because weights differ widely, some ε φᵀ diag(S) φ is added. λ is within its residual of an
    /// eigenvalue of the exact matrix.
    pub residuals: Vec<f64>,
    /// True if an inertia count or a dense decomposition, both in floating point, verified that no
    /// smaller eigenvalue was missed; false if pivot growth makes the count unreliable. The
    /// accuracy of the pairs is a separate matter: `residuals` obey
    /// [`EigenOptions::residual_limit`], certified or not.
    pub certified: bool,
    /// Known eigenvalues after the last pair.
    pub beyond: Beyond,
}

impl EigenPairs {
    /// Zero pairs of a problem with this number of rows.
    fn none(rows: usize) -> Self {
        Self {
            values: vec![],
            vectors: Array2::zeros((rows, 0)),
            residuals: vec![],
            certified: true,
            beyond: Beyond { values: vec![], clear_below: 0.0 },
        }
    }
}
