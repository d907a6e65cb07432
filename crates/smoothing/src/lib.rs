//! Smoothing flows and denoisers for triangle meshes.
//!
//! Each flow is one function with one options struct: [`explicit`], [`implicit`]. All take an optional
//! [`Observer`], which sees every step and can end the flow, and return a [`Smoothed`] mesh or a [`FlowError`] with
//! the last good mesh; none ever returns a coordinate that is not a number.
//!
//! A flow diffuses along the negative semi-definite Laplacian `L = −M⁻¹S`; the [`Diffusion`] says with which
//! weights and how far in one step, in the unit that belongs to them.

mod arrangement;
mod assemble;
mod conjugate;
mod constraints;
pub mod denoise;
mod diffusion;
mod error;
mod explicit;
mod implicit;
mod laplacian;
mod outcome;
mod run;
mod series;
mod sliding;
mod spectrum;
mod stability;
mod step;
mod volume;

pub use constraints::{Boundary, Constraints, SoftConstraint};
pub use diffusion::{Diffusion, Time};
pub use error::{FlowError, FlowFailure};
pub use explicit::{Explicit, explicit};
pub use implicit::{Implicit, Update, implicit};
pub use outcome::{Approach, Report, Smoothed};
pub use stability::{Stability, stable_limit};
pub use step::{Observer, Step};
pub use volume::Volume;
