//! Tests of the public interface, in one binary.

mod cholesky;
mod conjugate_gradient;
mod eigenpairs;
#[cfg(feature = "lapack")]
mod lapack;
mod matrices;
