//! The Möbius band.

use std::f64::consts::TAU;

use super::grid::{Diagonals, grid_faces};
use super::made::made;
use fairing_mesh::TriMesh;

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
