//! Tests of the public interface, in one binary.

#![expect(clippy::disallowed_methods, reason = "tests do not need the same bits")]

mod cholesky;
mod conjugate_gradient;
mod conversions;
mod eigenpairs;
#[cfg(feature = "lapack")]
mod lapack;
mod matrices;
