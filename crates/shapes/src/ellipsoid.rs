//! Ellipsoids.

use super::icosphere::icosphere;
use super::made::made;
use fairing_mesh::TriMesh;

/// The ellipsoid x²/a² + y²/b² + z²/c² = 1 for `axes` (a, b, c): the icosphere
/// of the level, stretched; same vertices and faces. Volume 4π/3 abc.
///
/// # Panics
///
/// Unless the half-axes are positive and finite; for an extent outside of
/// [`EXTENTS`](fairing_mesh::EXTENTS); above level 13.
pub fn ellipsoid(axes: [f64; 3], level: u32) -> TriMesh {
    assert!(axes.iter().all(|&a| a > 0.0 && a.is_finite()), "half-axes {axes:?}");
    let sphere = icosphere(level);
    let positions = sphere.positions().iter().map(|p| [0, 1, 2].map(|k| axes[k] * p[k])).collect();
    made(positions, sphere.faces().to_vec())
}
