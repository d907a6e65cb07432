//! Tori.

use std::f64::consts::TAU;

use super::grid::{Diagonals, grid_faces, made};
use fairing_mesh::TriMesh;

/// The torus around the z axis with centre-line radius `major` and tube
/// radius `minor`,
///
/// ```text
/// x(u, v) = ((R + r cos v) cos u, (R + r cos v) sin u, r sin v)
/// ```
///
/// sampled at `u = 2π i / around`, `v = 2π j / across`: vertex
/// `j·around + i`. Area 4π²Rr, volume 2π²Rr², genus 1.
///
/// # Panics
///
/// If `around` or `across` is below 3, or unless 0 < `minor` < `major`, both
/// finite; for an extent outside of [`EXTENTS`](fairing_mesh::EXTENTS).
pub fn torus(major: f64, minor: f64, around: u32, across: u32) -> TriMesh {
    assert!(around >= 3 && across >= 3, "a torus of {around} × {across} squares does not close");
    assert!(0.0 < minor && minor < major && major.is_finite(), "radii {major}, {minor}");
    let mut positions = Vec::with_capacity(around as usize * across as usize);
    for j in 0..across {
        let (sv, cv) = libm::sincos(TAU * f64::from(j) / f64::from(across));
        for i in 0..around {
            let (su, cu) = libm::sincos(TAU * f64::from(i) / f64::from(around));
            let r = major + minor * cv;
            positions.push([r * cu, r * su, minor * sv]);
        }
    }
    let id = |i, j| j % across * around + i % around;
    made(positions, grid_faces(around, across, Diagonals::Regular, id))
}
