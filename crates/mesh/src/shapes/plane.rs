//! Flat rectangles.

pub use super::grid::Diagonals;

use super::grid::grid_faces;
use super::made;
use crate::TriMesh;

/// The unit square 0 ≤ x, y ≤ 1, z = 0, in `columns × rows` small rectangles
/// cut into two faces each; counter-clockwise seen from +z.
///
/// Vertex `j·(columns + 1) + i` is at `(i / columns, j / rows, 0)`.
///
/// # Panics
///
/// If `columns` or `rows` is zero.
pub fn plane(columns: u32, rows: u32, diagonals: Diagonals) -> TriMesh {
    assert!(columns > 0 && rows > 0, "a plane of {columns} × {rows} rectangles is empty");
    let mut positions = Vec::with_capacity((columns as usize + 1) * (rows as usize + 1));
    for j in 0..=rows {
        for i in 0..=columns {
            positions.push([
                f64::from(i) / f64::from(columns),
                f64::from(j) / f64::from(rows),
                0.0,
            ]);
        }
    }
    made(positions, grid_faces(columns, rows, diagonals, |i, j| j * (columns + 1) + i))
}
