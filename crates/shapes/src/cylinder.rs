//! Cylinders.

use std::f64::consts::TAU;

use super::grid::{Diagonals, grid_faces, made};
use super::rings;
use fairing_mesh::TriMesh;

/// The ends of a cylinder: open or with lids.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Ends {
    /// Flat lids: a closed model with two sharp rims.
    #[default]
    Closed,
    /// No lids: two boundary loops.
    Open,
}

/// The cylinder x² + y² = `radius`², 0 ≤ z ≤ `height`, with `around` vertices
/// in a ring and `along` rows of squares; outward is away from the axis.
///
/// Vertex `j·around + i` of the side is at angle 2π i / around and height
/// j/along · `height`. Lids follow, the lower one first: rings inwards, then
/// the centre.
///
/// # Panics
///
/// If `around` is below 3 or `along` zero, or unless both lengths are positive
/// and finite; for an extent outside of [`EXTENTS`](fairing_mesh::EXTENTS).
pub fn cylinder(radius: f64, height: f64, around: u32, along: u32, ends: Ends) -> TriMesh {
    assert!(around >= 3 && along >= 1, "{around} × {along} squares make no cylinder");
    assert!(
        radius > 0.0 && height > 0.0 && radius.is_finite() && height.is_finite(),
        "radius {radius}, height {height}"
    );
    let mut positions = vec![];
    for j in 0..=along {
        let z = height * f64::from(j) / f64::from(along);
        for i in 0..around {
            let (s, c) = libm::sincos(TAU * f64::from(i) / f64::from(around));
            positions.push([radius * c, radius * s, z]);
        }
    }
    let mut faces = grid_faces(around, along, Diagonals::Regular, |i, j| j * around + i % around);
    if ends == Ends::Closed {
        for (row, z) in [(0, 0.0), (along, height)] {
            let border: Vec<u32> = (row * around..(row + 1) * around).collect();
            let (points, lid) = rings::disc(&border, positions.len() as u32);
            positions.extend(points.iter().map(|&[r, turn]| {
                let (s, c) = libm::sincos(TAU * turn);
                [radius * r * c, radius * r * s, z]
            }));
            // The lower lid looks down.
            faces.extend(lid.iter().map(|&[a, b, c]| if row == 0 { [a, c, b] } else { [a, b, c] }));
        }
    }
    made(positions, faces)
}
