//! Sparse symmetric kernels: products, Cholesky, conjugate gradients, eigenpairs.
//!
//! Nothing here knows geometry. Matrices are [`SparseMatrix`] (CSR, `u32` indices, ascending columns);
//! a symmetric matrix holds both triangles. Blocks of vectors are row-major: `[[f64; 3]]` for three
//! columns, `n × k` `ndarray` arrays for more. No result depends on the number of threads.

#![cfg_attr(test, expect(clippy::disallowed_methods, reason = "tests do not need the same bits"))]

mod backend;
mod cg;
mod cholesky;
mod dissection;
mod eigen;
mod factor;
mod incomplete;
mod ldlt;
mod mass;
mod matrix;
mod method;
mod ordering;
mod product;
mod reduce;
mod simd;
mod supernodes;
mod sweeps;
mod symmetry;

pub use cg::{CgError, CgOptions, CgSolution, ConjugateGradient, Preconditioner};
pub use cholesky::{Cholesky, CholeskyError, SymbolicCholesky};
pub use eigen::{
    Beyond, Count, DenseSolver, EigenError, EigenOptions, EigenPairs, EigenProgress, EigenWatch,
    eigenpairs_within, smallest_eigenpairs, smallest_eigenpairs_with,
};
pub use ldlt::{Inertia, Ldlt};
pub use mass::{Mass, MassError, combine};
pub use matrix::SparseMatrix;
pub use method::{Method, Workload, shifted_condition};
pub use ndarray;
pub use ordering::Ordering;
pub use product::{multiply, multiply_block, multiply_into, multiply_points, multiply_points_into};
pub use sprs;
