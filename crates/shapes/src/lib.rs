//! Meshes made by formula: closed and open, smooth and sharp.
//!
//! All are manifold, without isolated vertices or degenerate faces, and turn
//! counter-clockwise seen from outside (the open ones seen from the side that
//! their documentation names). Vertices come in a documented order. What is
//! random takes a seed.
//!
//! Parameters that make no such mesh are a mistake in the program that passes
//! them, and panic as documented.
//!
//! ```
//! use fairing_shapes as shapes;
//!
//! let sphere = shapes::icosphere(4);
//! assert_eq!(sphere.vertex_count(), 2562);
//! let torus = shapes::torus(1.0, 0.4, 64, 24);
//! assert_eq!(torus.topology().edges().len(), 3 * torus.vertex_count());
//! // The same seed gives the same mesh.
//! assert_eq!(shapes::irregular_plane(0.1, 7), shapes::irregular_plane(0.1, 7));
//! ```

#![cfg_attr(test, expect(clippy::disallowed_methods, reason = "tests do not need the same bits"))]

mod block;
mod creature;
mod cube;
mod cylinder;
mod delaunay;
mod ellipsoid;
mod flower;
mod grid;
mod helicoid;
mod icosphere;
pub mod implicit;
mod jitter;
mod made;
mod moebius;
mod octahedron;
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
pub use ellipsoid::ellipsoid;
pub use flower::flower;
pub use grid::Diagonals;
pub use helicoid::{HelicoidOptions, helicoid};
pub use icosphere::icosphere;
pub use jitter::{jittered, onto_ellipsoid, onto_sphere, onto_torus};
pub use moebius::moebius;
pub use octahedron::octahedron;
pub use plane::{irregular_plane, jittered_plane, plane};
pub use sphere::{bumpy_sphere, uv_sphere};
pub use torus::torus;

#[cfg(test)]
mod tests;
