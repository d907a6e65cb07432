#![doc = include_str!("../README.md")]
//!
//! # Overview
//!
//! Each flow is one function with one options struct; [`Method`] is the enum of all flows, for
//! programs. Flows that take steps accept an optional [`Observer`], which sees every step and can
//! end the flow. All return a [`Smoothed`] mesh, or a [`FlowError`] with the last good mesh; no
//! coordinate returned is NaN or infinite.
//!
//! Flows diffuse with the negative semi-definite Laplacian `L = −M⁻¹S`; a [`Diffusion`] defines its
//! weights and the length of a step.

#![cfg_attr(test, expect(clippy::disallowed_methods, reason = "tests do not need the same bits"))]

mod engine;
mod flows;
mod method;

pub use engine::constraints::{Boundary, Constraints, SoftConstraint};
pub use engine::diffusion::{Diffusion, Time};
pub use engine::error::{FlowError, FlowFailure};
pub use engine::outcome::{Approach, Report, Smoothed};

pub use engine::updated::Update;
pub use engine::volume::Volume;
pub use flows::conformal::{ConformalizedMcf, conformalized_mean_curvature_flow};
pub use flows::explicit::{Explicit, Stability, explicit, largest_eigenvalue, stable_limit};
pub use flows::hc::{Hc, hc};
pub use flows::implicit::{Implicit, implicit};
pub use flows::low_pass::{LowPass, Transfer, low_pass};

pub use engine::run::{Observer, Step};
pub use flows::region::{FairRegion, fair_region, repair_fair};
pub use flows::scale_dependent::{ScaleDependent, scale_dependent};
pub use flows::taubin::{Taubin, taubin};
pub use flows::windowed_sinc::{Window, WindowedSinc, windowed_sinc};
pub use method::Method;
