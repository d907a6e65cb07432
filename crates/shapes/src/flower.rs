//! An open flower like a lily.

use std::f64::consts::TAU;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::delaunay::{delaunay, scatter};
use super::grid::made;
use fairing_mesh::TriMesh;

/// Four petals around a hollow: an open sheet with one boundary loop and very uneven faces, a
/// stand-in for scanned flowers.
///
/// The sheet is the image of the unit disc (ρ, θ) under
///
/// ```text
/// r = ρ (0.8 + l),    z = 0.7 ρ² − 0.75 ρ⁴ + ½ l,    l = 0.28 cos 4θ · ρ⁴ / (0.2 + ρ⁴)
/// ```
///
/// triangulated over points at random whose distances vary between about ½ and 2 of `spacing`,
/// shorter in some regions than in others. Faces turn counter-clockwise seen from +z. The border
/// comes first, counter-clockwise, then the points inside in the order in which they were found. A
/// spacing of 0.075 gives about 800 vertices.
///
/// # Panics
///
/// Unless 1e-3 ≤ `spacing` ≤ 0.2.
pub fn flower(spacing: f64, seed: u64) -> TriMesh {
    assert!((1e-3..=0.2).contains(&spacing), "spacing {spacing} is not in [1e-3, 0.2]");
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    // Slow waves over the disc make dense and sparse regions.
    let size = |[x, y]: [f64; 2]| {
        let wave = libm::sin(5.0 * x + 1.0) * libm::sin(4.0 * y + 0.5);
        spacing * (0.9 + 0.4 * libm::hypot(x, y) - 0.3 + 0.5 * wave).max(0.45)
    };
    let smallest = 0.45 * spacing;

    let mut turns = vec![];
    let mut turn = 0.0;
    while turn < 1.0 {
        turns.push(turn);
        let (s, c) = libm::sincos(TAU * turn);
        turn += size([c, s]) * rng.random_range(0.8..1.3) / TAU;
    }
    // Stretched so that the last step is like the others.
    let mut points: Vec<[f64; 2]> = turns
        .iter()
        .map(|t| {
            let (s, c) = libm::sincos(TAU * t / turn);
            [c, s]
        })
        .collect();
    let inside = |p: [f64; 2]| libm::hypot(p[0], p[1]) < 1.0 - 0.6 * size(p);
    scatter(&mut points, [-1.0, 1.0], smallest, size, inside, &mut rng);
    let faces = delaunay(&points, &[]);
    made(points.iter().map(|&p| petal(p)).collect(), faces)
}

/// The flower over the unit disc.
fn petal([x, y]: [f64; 2]) -> [f64; 3] {
    let q2 = x * x + y * y;
    let four = libm::cos(4.0 * libm::atan2(y, x));
    let lobes = 0.28 * q2 * q2 / (0.2 + q2 * q2) * four;
    [x * (0.8 + lobes), y * (0.8 + lobes), 0.7 * q2 - 0.75 * q2 * q2 + 0.5 * lobes]
}
