//! Helicoids, and the Möbius band.

use std::f64::consts::TAU;

use fairing_mesh::TriMesh;

use super::grid::{Diagonals, grid_faces, made};

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

/// The Möbius band of half-width `w` around the unit circle,
///
/// ```text
/// x(u, v) = ((1 + v cos u/2) cos u, (1 + v cos u/2) sin u, v sin u/2),    |v| ≤ w
/// ```
///
/// with `around` squares along u and `across` along v: vertex
/// `j·around + i`. One boundary loop; not orientable, so that the faces across
/// the seam at u = 0 turn against each other.
///
/// # Panics
///
/// If `around` is below 3 (below 5 faces would share corners across the seam)
/// or `across` zero, or unless 0 < `w` < 1.
pub fn moebius(w: f64, around: u32, across: u32) -> TriMesh {
    assert!(around >= 3 && across >= 1, "{around} × {across} squares make no band");
    assert!(0.0 < w && w < 1.0, "half-width {w}");
    let mut positions = vec![];
    for j in 0..=across {
        let v = w * (2.0 * f64::from(j) / f64::from(across) - 1.0);
        for i in 0..around {
            let u = TAU * f64::from(i) / f64::from(around);
            let r = 1.0 + v * libm::cos(u / 2.0);
            positions.push([r * libm::cos(u), r * libm::sin(u), v * libm::sin(u / 2.0)]);
        }
    }
    // After a turn, v has changed its sign.
    let id = |i, j| if i == around { (across - j) * around } else { j * around + i };
    made(positions, grid_faces(around, across, Diagonals::Regular, id))
}
