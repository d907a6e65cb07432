//! Subdivided cubes.

use std::collections::HashMap;

use super::grid::{Diagonals, grid_faces, made};
use fairing_mesh::TriMesh;

/// The cube of side 1 around the origin, each side in `squares × squares`
/// squares cut into two; sides share the vertices of their edges.
///
/// `6·squares² + 2` vertices, in the order in which the sides −x, +x, −y, +y,
/// −z, +z first meet them.
///
/// # Panics
///
/// If `squares` is zero.
pub fn cube(squares: u32, diagonals: Diagonals) -> TriMesh {
    assert!(squares > 0, "a cube needs at least one square on a side");
    let n = squares;
    let mut ids: HashMap<[u32; 3], u32> = HashMap::new();
    let (mut positions, mut faces) = (vec![], vec![]);
    for axis in 0..3 {
        for far in [false, true] {
            // Right and up, so that right × up points outwards.
            let (right, up) = ((axis + 1) % 3, (axis + 2) % 3);
            let (right, up) = if far { (right, up) } else { (up, right) };
            let mut table = Vec::with_capacity((n as usize + 1) * (n as usize + 1));
            for j in 0..=n {
                for i in 0..=n {
                    let mut place = [0; 3];
                    place[axis] = if far { n } else { 0 };
                    place[right] = i;
                    place[up] = j;
                    let id = *ids.entry(place).or_insert_with(|| {
                        positions.push(place.map(|k| f64::from(k) / f64::from(n) - 0.5));
                        positions.len() as u32 - 1
                    });
                    table.push(id);
                }
            }
            faces.extend(grid_faces(n, n, diagonals, |i, j| table[(j * (n + 1) + i) as usize]));
        }
    }
    made(positions, faces)
}
