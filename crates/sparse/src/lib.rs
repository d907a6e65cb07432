#![doc = include_str!("../README.md")]
//!
//! # Overview
//!
//! Matrices are [`SparseMatrix`] (CSR, `u32` indices, ascending columns); a symmetric matrix has
//! both triangles. Blocks of vectors are row-major: `[[f64; 3]]` for three columns, `n × k`
//! `ndarray` arrays for more. No result depends on the number of threads.

#![cfg_attr(docsrs, feature(doc_cfg))]
#![cfg_attr(test, expect(clippy::disallowed_methods, reason = "tests do not need the same bits"))]

mod chebyshev;
mod clenshaw;
#[cfg(feature = "solvers")]
mod components;
mod conjugate_gradients;
mod convert;
#[cfg(feature = "solvers")]
mod direct;
mod double;
#[cfg(feature = "solvers")]
mod eigen;
mod error;
mod graph_laplacian;
#[cfg(feature = "solvers")]
mod graph_system;
mod laplacian_power;
mod mass;
mod matrix;
mod order;
pub mod parallel;
mod product;
mod spectral_bound;

// The oracle of the tests.
#[cfg(feature = "lapack")]
use ndarray_linalg as _;

pub use chebyshev::ChebyshevSeries;
pub use conjugate_gradients::{
    CgOptions, CgSolution, FieldOperator, conjugate_gradients, product_by_rows,
};
#[cfg(feature = "faer")]
pub use convert::{from_faer, to_faer};
#[cfg(feature = "nalgebra")]
pub use convert::{from_nalgebra, to_nalgebra};
#[cfg(feature = "solvers")]
pub use direct::{Cholesky, Inertia, Ldlt, Ordering, SymbolicCholesky, Workload};
#[cfg(feature = "solvers")]
pub use eigen::{
    Beyond, EigenOptions, EigenPairs, smallest_eigenpairs, smallest_symmetric_eigenpairs,
};
pub use error::SparseError;
pub use graph_laplacian::{GraphLaplacian, GraphNumbers};
#[cfg(feature = "solvers")]
pub use graph_system::{GraphSystem, Solved};
pub use laplacian_power::LaplacianPower;
pub use mass::{Mass, combine};
pub use matrix::{SparseMatrix, from_csr, from_triplets, principal_submatrix};
pub use ndarray;
pub use order::{larger, median, smaller, upper_median};
pub use product::{multiply, multiply_block, multiply_into, multiply_points, multiply_points_into};
pub use sprs;
