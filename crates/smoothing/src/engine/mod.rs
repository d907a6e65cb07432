//! Parts common to all flows: kernels over positions, solvers, constraints, the loop over steps,
//! and errors.

pub(crate) mod arrangement;
pub(crate) mod assemble;
pub(crate) mod constraints;
pub(crate) mod diffusion;
pub(crate) mod error;
pub(crate) mod implicit_steps;
pub(crate) mod outcome;
pub(crate) mod resolvent;
pub(crate) mod response;
pub(crate) mod run;
pub(crate) mod series;
pub(crate) mod sliding;
pub(crate) mod updated;
pub(crate) mod volume;
