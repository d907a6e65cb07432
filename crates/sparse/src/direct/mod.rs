//! Direct solvers: orderings, factorisations, solves, and the choice between them and conjugate
//! gradients.
//!
//! Only [`backend`] names the solver backend.

pub(crate) mod backend;
pub(crate) mod cholesky;
mod dense;
mod dissection;
mod elimination;
pub(crate) mod factor;
pub(crate) mod ldlt;
mod multifrontal;
pub(crate) mod ordering;
mod solver_choice;
mod supernodes;
mod sweeps;
mod symmetry;

pub use cholesky::{Cholesky, SymbolicCholesky};
pub(crate) use elimination::Elimination;
pub use ldlt::{Inertia, Ldlt};
pub use ordering::Ordering;
pub use solver_choice::Workload;
