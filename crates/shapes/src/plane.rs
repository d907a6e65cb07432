//! Flat squares.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::delaunay::{delaunay, scatter};
use super::grid::{Diagonals, grid_faces, made};
use fairing_mesh::TriMesh;

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

/// [`plane`] with regular diagonals and each vertex moved by a random fraction of
/// up to ±`amount` of the rectangle, in x and in y; border vertices slide
/// along the border and corners stay.
///
/// # Panics
///
/// As [`plane`]; unless 0 ≤ `amount` < ¼, because beyond ¼ a face may turn over.
pub fn jittered_plane(columns: u32, rows: u32, amount: f64, seed: u64) -> TriMesh {
    assert!((0.0..0.25).contains(&amount), "amount {amount} is not in [0, 1/4)");
    let regular = plane(columns, rows, Diagonals::Regular);
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let steps = [amount / f64::from(columns), amount / f64::from(rows)];
    let mut positions = regular.positions().to_vec();
    for p in &mut positions {
        for k in 0..2 {
            let shift = steps[k] * rng.random_range(-1.0..=1.0);
            if p[k] > 0.0 && p[k] < 1.0 {
                p[k] += shift;
            }
        }
    }
    made(positions, regular.faces().to_vec())
}

/// The unit square as the Delaunay triangulation of points at random, no two
/// closer than 0.7 × `spacing`, with evenly spaced points on the border;
/// counter-clockwise seen from +z.
///
/// The border comes first, counter-clockwise from the origin, then the points
/// inside in the order in which they were found.
///
/// # Panics
///
/// Unless 1e-4 ≤ `spacing` ≤ ½.
pub fn irregular_plane(spacing: f64, seed: u64) -> TriMesh {
    assert!((1e-4..=0.5).contains(&spacing), "spacing {spacing} is not in [1e-4, 1/2]");
    let n = (1.0 / spacing).round() as u32;
    let mut points = vec![];
    for side in 0..4 {
        for i in 0..n {
            let t = f64::from(i) / f64::from(n);
            points.push([[t, 0.0], [1.0, t], [1.0 - t, 1.0], [0.0, 1.0 - t]][side]);
        }
    }
    let near = 0.7 * spacing;
    let clear = |p: [f64; 2]| p.iter().all(|&x| x.min(1.0 - x) > 0.5 * near);
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    scatter(&mut points, [0.0, 1.0], near, |_| near, clear, &mut rng);
    let faces = delaunay(&points, &[]);
    made(points.iter().map(|p| [p[0], p[1], 0.0]).collect(), faces)
}
