//! Sparse symmetric kernels: products, Cholesky, conjugate gradients, eigenpairs.

/// A sparse matrix of the workspace: CSR, `f64` values, `u32` indices.
pub type SparseMatrix = sprs::CsMatI<f64, u32>;
