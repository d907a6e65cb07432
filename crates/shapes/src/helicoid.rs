//! Helicoids.

use std::f64::consts::TAU;

use super::grid::{Diagonals, grid_faces};
use super::made::made;
use fairing_mesh::TriMesh;

/// Parameters of [`helicoid`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HelicoidOptions {
    /// The rise c, in mesh units per radian.
    pub rise: f64,
    /// The range of v, the distance from the axis (negative beyond it).
    pub radii: [f64; 2],
    /// The number of turns of u, from 0 on.
    pub turns: f64,
    /// Squares along v.
    pub across: u32,
    /// Squares along u.
    pub along: u32,
}

impl Default for HelicoidOptions {
    fn default() -> Self {
        Self { rise: 0.5, radii: [-1.0, 1.0], turns: 1.0, across: 24, along: 48 }
    }
}

/// The helicoid
///
/// ```text
/// x(u, v) = (v cos u, v sin u, c u),    H = 0,    K = −c² / (v² + c²)²
/// ```
///
/// with vertex `j·(across + 1) + i` at `v` growing with `i` and `u` with `j`;
/// its outward side is ∂v × ∂u, upwards where `v` is positive. One boundary
/// loop.
///
/// # Panics
///
/// Unless rise, turns and the range of radii are positive and finite and there
/// are squares both ways; for an extent outside of
/// [`EXTENTS`](fairing_mesh::EXTENTS).
pub fn helicoid(shape: &HelicoidOptions) -> TriMesh {
    let &HelicoidOptions { rise, radii: [from, to], turns, across, along } = shape;
    assert!(rise > 0.0 && rise.is_finite() && turns > 0.0 && turns.is_finite(), "{shape:?}");
    assert!(from < to && from.is_finite() && to.is_finite(), "{shape:?}");
    assert!(across > 0 && along > 0, "{shape:?}");
    let mut positions = vec![];
    for j in 0..=along {
        let u = TAU * turns * f64::from(j) / f64::from(along);
        let (s, c) = libm::sincos(u);
        for i in 0..=across {
            let v = from + (to - from) * f64::from(i) / f64::from(across);
            positions.push([v * c, v * s, rise * u]);
        }
    }
    made(positions, grid_faces(across, along, Diagonals::Regular, |i, j| j * (across + 1) + i))
}
