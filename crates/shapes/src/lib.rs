#![doc = include_str!("../README.md")]
//!
//! # Overview
//!
//! All shapes are manifold, without isolated vertices or degenerate faces. Their faces turn
//! counter-clockwise seen from outside, those of open shapes seen from the side that their
//! documentation names. Vertices come in a documented order. Random shapes take a seed.
//!
//! Invalid parameters are programming errors and panic, as documented for each function.

#![cfg_attr(test, expect(clippy::disallowed_methods, reason = "tests do not need the same bits"))]

mod block;
mod creature;
mod cube;
mod cylinder;
mod delaunay;
mod flower;
mod grid;
mod helicoid;
pub mod implicit;
mod jitter;
pub mod outline;
pub mod patch;
mod plane;
mod rings;
mod sphere;
mod torus;

pub use block::cad_block;
pub use creature::creature;
pub use cube::cube;
pub use cylinder::{Ends, cylinder};
pub use flower::flower;
pub use grid::Diagonals;
pub use helicoid::moebius;
pub use helicoid::{HelicoidOptions, helicoid};
pub use jitter::{jittered, onto_ellipsoid, onto_sphere, onto_torus};
pub use plane::{irregular_plane, jittered_plane, plane};
pub use sphere::{bumpy_sphere, ellipsoid, icosphere, octahedron, uv_sphere};
pub use torus::torus;

#[cfg(test)]
mod tests;
