//! Meshes made by formula: closed and open, smooth and sharp.
//!
//! All are manifold, without isolated vertices or degenerate faces, and turn
//! counter-clockwise seen from outside (the open ones seen from the side that
//! their documentation names). Vertices come in a documented order. What is
//! random takes a seed.

mod grid;
mod icosphere;
mod plane;
mod torus;

pub use icosphere::icosphere;
pub use plane::{Diagonals, plane};
pub use torus::torus;

use crate::TriMesh;

/// A mesh from positions and faces that its maker vouches for.
fn made(positions: Vec<[f64; 3]>, faces: Vec<[u32; 3]>) -> TriMesh {
    match TriMesh::new(positions, faces) {
        Ok(mesh) => mesh,
        Err(error) => panic!("the parameters of a shape give no mesh: {error}"),
    }
}
