//! Smoothing flows for triangle meshes.
//!
//! Each flow is one function with one options struct; [`Method`] holds them all for programs. Those that take steps
//! take an optional [`Observer`], which sees every step and can end the flow. All return a [`Smoothed`] mesh or a
//! [`FlowError`] with the last good mesh; none ever returns a coordinate that is not a number.
//!
//! A flow diffuses along the negative semi-definite Laplacian `L = −M⁻¹S`; the [`Diffusion`] says with which
//! weights and how far in one step, in the unit that belongs to them.

#![cfg_attr(test, expect(clippy::disallowed_methods, reason = "tests do not need the same bits"))]

mod arrangement;
mod assemble;
mod clenshaw;
mod collapse;
mod conformal;
mod conjugate;
mod constraints;
mod cotangents;
mod diffusion;
mod direct;
mod double;
mod error;
mod explicit;
mod hc;
mod implicit;
mod laplacian;
mod low_pass;
mod method;
mod outcome;
mod parts;
mod region;
mod resolvent;
mod response;
mod run;
mod scale_dependent;
mod series;
mod sliding;
mod spectrum;
mod stability;
mod step;
mod taubin;
mod unit_scale;
mod volume;
mod windowed_sinc;

pub use conformal::{ConformalizedMcf, conformalized_mean_curvature_flow};
pub use constraints::{Boundary, Constraints, SoftConstraint};
pub use diffusion::{Diffusion, Operator, Time};
pub use error::{FlowError, FlowFailure};
pub use explicit::{Explicit, explicit};
pub use hc::{Hc, hc};
pub use implicit::{Implicit, Update, implicit};
pub use low_pass::{LowPass, Transfer, low_pass};
pub use method::Method;
pub use outcome::{Approach, Report, Smoothed};
pub use region::{FairRegion, FairingWeights, fair_region};
pub use scale_dependent::{ScaleDependent, scale_dependent};
pub use spectrum::largest_eigenvalue;
pub use stability::{Stability, stable_limit};
pub use step::{Observer, Step};
pub use taubin::{Taubin, taubin};
pub use volume::Volume;
pub use windowed_sinc::{Window, WindowedSinc, windowed_sinc};
