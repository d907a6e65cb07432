//! Sparse symmetric kernels: products, Cholesky, conjugate gradients, eigenpairs, functions of a Laplacian.
//!
//! Nothing here knows geometry. Matrices are [`SparseMatrix`] (CSR, `u32` indices, ascending columns);
//! a symmetric matrix has both triangles. Blocks of vectors are row-major: `[[f64; 3]]` for three
//! columns, `n × k` `ndarray` arrays for more. No result depends on the number of threads.

#![cfg_attr(test, expect(clippy::disallowed_methods, reason = "tests do not need the same bits"))]

mod analysis;
mod backend;
mod cg;
mod chebyshev;
mod cholesky;
mod clenshaw;
mod conjugate_gradient;
mod dissection;
mod double;
mod eigen;
mod extent;
mod factor;
mod graph_laplacian;
mod laplacian_power;
mod ldlt;
mod mass;
mod matrix;
mod ordering;
pub mod passes;
mod product;
mod simd;
mod solver_choice;
mod supernodes;
mod sweeps;
mod symmetry;

pub use cg::{CgError, CgOptions, CgRoom, CgSolution, CgSystem, conjugate_gradients, descend};
pub use chebyshev::ChebyshevSeries;
pub use cholesky::{Cholesky, CholeskyError, SymbolicCholesky};
pub use conjugate_gradient::ConjugateGradient;
pub use eigen::{
    Beyond, Count, DenseSolver, EigenError, EigenOptions, EigenPairs, EigenProgress, EigenWatch,
    eigenpairs_within, smallest_eigenpairs, smallest_eigenpairs_with,
};
pub use graph_laplacian::{GraphLaplacian, GraphNumbers, Padded};
pub use laplacian_power::LaplacianPower;
pub use ldlt::{Inertia, Ldlt};
pub use mass::{Mass, MassError, combine};
pub use matrix::{MatrixError, SparseMatrix, from_csr, from_triplets, principal_submatrix};
pub use ndarray;
pub use ordering::Ordering;
pub use product::{multiply, multiply_block, multiply_into, multiply_points, multiply_points_into};
pub use solver_choice::{SolverChoice, Workload, shifted_condition};
pub use sprs;
