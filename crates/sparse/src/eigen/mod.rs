//! The generalised symmetric eigenproblem S φ = λ M φ: smallest eigenpairs, measured and counted.
//!
//! S is symmetric positive semi-definite, M lumped or consistent mass. Large problems run block Lanczos on
//! (S − σM)⁻¹ M with full orthogonalisation and thick restart, and in slices of the spectrum for many pairs;
//! small ones a dense decomposition. Source: \[grimes1994\], \[wu2000\].

mod basis;
mod certificate;
mod components;
mod dense;
mod lanczos;
mod nullspace;
mod operator;
mod polish;
mod problem;
mod projected;
mod run;
mod shift;
mod slices;
mod solve;
mod within;

use ndarray::Array2;

use crate::direct::cholesky::CholeskyError;
use crate::mass::MassError;

pub use components::{eigenpairs_within, smallest_eigenpairs};

/// How much larger than the tolerance a measured residual may be: eigenvalues of a multiple group are measured
/// with the residual of their neighbours.
const SLACK: f64 = 10.0;

/// How to solve an eigenproblem.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct EigenOptions {
    /// Largest residual ‖S φ − λ M φ‖ in the M⁻¹ norm, as a share of the largest wanted eigenvalue, of a
    /// vector with φᵀMφ = 1: what the iteration aims at. [`EigenOptions::residual_limit`] says what is returned.
    pub tolerance: f64,
    /// Seed of the starting vectors.
    pub seed: u64,
    /// Blocks of eight vectors to spend before giving up, in each slice.
    pub max_blocks: usize,
    /// Whether to count the eigenvalues by an extra factorisation.
    pub count: Count,
    /// Problems with at most this many rows are solved densely; so are up to four times as many rows if a
    /// quarter of the eigenvalues is wanted.
    pub dense_rows: usize,
    /// Most eigenpairs of one Lanczos run; more are taken slice by slice.
    pub slice: usize,
    /// What decomposes dense problems.
    pub dense: DenseSolver,
}

/// What decomposes a dense problem.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum DenseSolver {
    /// The backend of this crate, on M^(−1/2) S M^(−1/2).
    #[default]
    Builtin,
    /// The LAPACK of the system, on the pair (S, M).
    #[cfg(feature = "lapack")]
    Lapack,
}

/// Whether the number of eigenvalues is checked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Count {
    /// By the inertia of S − σM with σ just above the last eigenvalue: none has been missed.
    Certified,
    /// Not checked: saves a factorisation.
    Unchecked,
}

impl Default for EigenOptions {
    fn default() -> Self {
        Self {
            tolerance: 1e-9,
            seed: 0,
            max_blocks: 2000,
            count: Count::Certified,
            dense_rows: 400,
            slice: 320,
            dense: DenseSolver::default(),
        }
    }
}

impl EigenOptions {
    /// The bound on measured residuals: those of all pairs returned are within ten times the tolerance times the
    /// largest eigenvalue wanted, or, where tiny masses or huge weights leave more than that to rounding, within
    /// 64 ε ‖|S| |φ| + |λ| M |φ|‖ in the M⁻¹ norm.
    ///
    /// The first is one number for all pairs: beside a huge eigenvalue it says little about a small one, whose
    /// residual does. The second belongs to each vector.
    pub fn residual_limit(&self, largest: f64) -> f64 {
        SLACK * self.tolerance * largest
    }
}

/// What is known about the eigenvalues after those asked for.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Beyond {
    /// Eigenvalues after the last that were found as well, ascending: a solver continues to the next gap.
    pub values: Vec<f64>,
    /// No others lie below this, as surely as `certified` says. Infinite if there are no others.
    pub clear_below: f64,
}

impl Beyond {
    /// Values that follow, ascending, and the bound below which there are no others.
    pub fn new(values: Vec<f64>, clear_below: f64) -> Self {
        Self { values, clear_below }
    }
}

/// Eigenpairs of S φ = λ M φ.
///
/// An eigenvalue is off by no more than its residual r, and by about r² divided by the distance to the next
/// eigenvalue where that is larger than r; rounding adds some ε φᵀ|S|φ. A vector is off by an angle of about r
/// divided by that distance. Between processors, which round in another order, results differ by as much.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct EigenPairs {
    /// Eigenvalues, ascending. Those of the constants of each component that S maps to zero are exactly 0.
    pub values: Vec<f64>,
    /// `n × k`, one eigenvector in a column, φᵢᵀ M φⱼ = δᵢⱼ, zero outside its component of S and M. Signs and bases of multiple eigenvalues are
    /// arbitrary but reproducible.
    pub vectors: Array2<f64>,
    /// ‖S φ − λ M φ‖ in the M⁻¹ norm of each pair, in units of λ, measured on the vectors returned, with S as the
    /// Laplacian of its entries off the diagonal. Where rounding of the entries counts, with weights far apart, some
    /// ε φᵀ diag(S) φ is added: λ is within this of an eigenvalue of the exact matrix.
    pub residuals: Vec<f64>,
    /// Whether inertia (or a dense decomposition) proves that no smaller eigenvalue was missed. Not so where the
    /// pivots of the count grew so much that it could be wrong. It says nothing about how exact the pairs are:
    /// `residuals` do, and their bound is [`EigenOptions::residual_limit`], certified or not.
    pub certified: bool,
    /// The eigenvalues after the last.
    pub beyond: Beyond,
}

impl EigenPairs {
    /// No pairs of a problem with this number of rows.
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

/// Why there are no eigenpairs.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EigenError {
    /// More eigenpairs were asked for than there are rows.
    #[error("{wanted} eigenpairs were requested, but the matrix has {rows} rows")]
    TooMany {
        /// Eigenpairs wanted.
        wanted: usize,
        /// Rows of the problem.
        rows: usize,
    },
    /// The mass does not fit.
    #[error(transparent)]
    Mass(#[from] MassError),
    /// S − σM could not be factorised. A negative or zero pivot means that S is not positive semi-definite.
    #[error("S − σM with σ = {shift:e} cannot be factorised")]
    Factor {
        /// σ, in units of λ.
        shift: f64,
        /// What failed.
        source: CholeskyError,
    },
    /// The consistent mass is not positive definite.
    #[error("the consistent mass is not positive definite")]
    ConsistentMass(#[source] CholeskyError),
    /// Fewer pairs converged than were wanted.
    #[error("{converged} of {wanted} eigenpairs converged within {blocks} blocks")]
    NotConverged {
        /// Pairs that met the tolerance.
        converged: usize,
        /// Pairs wanted.
        wanted: usize,
        /// Blocks spent.
        blocks: usize,
    },
    /// Inertia counts another number of eigenvalues than were found, even after new starting vectors.
    #[error("{found} eigenvalues found below {shift:e}, inertia counts {counted}")]
    Miscounted {
        /// Eigenvalues found.
        found: usize,
        /// Eigenvalues counted.
        counted: usize,
        /// Where, in units of λ.
        shift: f64,
    },
    /// The dense decomposition did not converge.
    #[error("the dense decomposition of {rows} rows did not converge")]
    Dense {
        /// Rows of the problem.
        rows: usize,
    },
    /// An interval without order or with ends that are not finite.
    #[error("the interval from {from:e} to {to:e} is empty or not finite")]
    Interval {
        /// Lower end.
        from: f64,
        /// Upper end.
        to: f64,
    },
}
