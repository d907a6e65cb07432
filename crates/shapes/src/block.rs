//! A machined part: sharp edges, fillets, a chamfer, a hole and a curved top.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::made;
use super::patch::fill;
use fairing_mesh::TriMesh;

/// A piece of the outline: a straight line or an arc, with the material on
/// its left.
#[derive(Clone, Copy)]
enum Piece {
    Line {
        from: [f64; 2],
        to: [f64; 2],
    },
    /// From angle `start` over `sweep`, negative clockwise.
    Arc {
        centre: [f64; 2],
        radius: f64,
        start: f64,
        sweep: f64,
    },
}

impl Piece {
    fn length(self) -> f64 {
        match self {
            Self::Line { from, to } => libm::hypot(to[0] - from[0], to[1] - from[1]),
            Self::Arc { radius, sweep, .. } => radius * sweep.abs(),
        }
    }

    /// The point at a share `t` of the length.
    fn at(self, t: f64) -> [f64; 2] {
        match self {
            Self::Line { from, to } => [0, 1].map(|k| from[k] + t * (to[k] - from[k])),
            Self::Arc { centre, radius, start, sweep } => {
                let (s, c) = libm::sincos(start + t * sweep);
                [centre[0] + radius * c, centre[1] + radius * s]
            }
        }
    }
}

/// An L with one corner rounded outwards, the inner corner filled with a
/// fillet, one corner cut off, four left sharp; and a round hole.
fn outlines() -> [Vec<Piece>; 2] {
    let line = |from, to| Piece::Line { from, to };
    let outer = vec![
        line([0.0, 0.0], [4.0, 0.0]),
        line([4.0, 0.0], [4.0, 1.2]),
        line([4.0, 1.2], [2.4, 1.2]),
        Piece::Arc { centre: [2.4, 1.8], radius: 0.6, start: 3.0 * FRAC_PI_2, sweep: -FRAC_PI_2 },
        line([1.8, 1.8], [1.8, 2.3]),
        Piece::Arc { centre: [1.1, 2.3], radius: 0.7, start: 0.0, sweep: FRAC_PI_2 },
        line([1.1, 3.0], [0.5, 3.0]),
        line([0.5, 3.0], [0.0, 2.5]),
        line([0.0, 2.5], [0.0, 0.0]),
    ];
    let arc = |start| Piece::Arc { centre: [0.9, 1.3], radius: 0.5, start, sweep: -PI / 2.0 };
    let hole = (0..4).map(|i| arc(TAU - f64::from(i) * FRAC_PI_2)).collect();
    [outer, hole]
}

/// The height of the top, an arch over the longer side.
fn top(x: f64) -> f64 {
    1.4 - 0.05 * (x - 1.0) * (x - 1.0)
}

/// A machined part of size 4 × 3 × 1.4 in nearly equal triangles, in the place
/// of scanned or modelled CAD parts: an L-shaped outline with a sharp rim, a
/// convex and a concave fillet, a chamfer and a round hole (genus 1), pulled
/// up to a gently arched top. Vertices lie exactly on its planes, cylinders
/// and creases.
///
/// `spacing` is the distance of neighbours: 0.08 gives about 7 thousand
/// vertices. Vertices come as: the lower outline, counter-clockwise from the
/// origin, and hole; the upper ones; the inside of the bottom and of the top;
/// the upright lines between the pieces of the outline; the walls.
///
/// # Panics
///
/// Unless 0.005 ≤ `spacing` ≤ 0.3.
pub fn cad_block(spacing: f64) -> TriMesh {
    assert!((0.005..=0.3).contains(&spacing), "spacing {spacing} is not in [0.005, 0.3]");
    let steps = |length: f64| (length / spacing).round().max(2.0) as u32;
    let outlines = outlines();
    let borders: Vec<Vec<[f64; 2]>> = outlines
        .iter()
        .map(|pieces| {
            let samples = |&piece: &Piece| {
                let n = steps(piece.length());
                (0..n).map(move |i| piece.at(f64::from(i) / f64::from(n)))
            };
            pieces.iter().flat_map(samples).collect()
        })
        .collect();

    let rim: Vec<[f64; 2]> = borders.concat();
    let count = rim.len() as u32;
    let mut positions: Vec<[f64; 3]> = rim.iter().map(|p| [p[0], p[1], 0.0]).collect();
    positions.extend(rim.iter().map(|p| [p[0], p[1], top(p[0])]));
    let lid = fill(&borders, spacing);
    let inner = lid.inner.len() as u32;
    positions.extend(lid.inner.iter().map(|p| [p[0], p[1], 0.0]));
    positions.extend(lid.inner.iter().map(|p| [p[0], p[1], top(p[0])]));
    let lower = |v: u32| if v < count { v } else { v + count };
    let upper = |v: u32| if v < count { v + count } else { v + count + inner };
    let mut faces = vec![];
    faces.extend(lid.faces.iter().map(|f| [f[0], f[2], f[1]].map(lower)));
    faces.extend(lid.faces.iter().map(|f| f.map(upper)));

    // The upright line at the start of each piece.
    let mut first = 0;
    let mut walls = vec![];
    for (pieces, border) in outlines.iter().zip(&borders) {
        let mut at = 0;
        let mut uprights = vec![];
        for &piece in pieces {
            let [x, y] = piece.at(0.0);
            let n = steps(top(x));
            let start = positions.len() as u32;
            positions.extend((1..n).map(|i| [x, y, top(x) * f64::from(i) / f64::from(n)]));
            uprights.push((first + at, start..start + n - 1));
            at += steps(piece.length());
        }
        for (k, &piece) in pieces.iter().enumerate() {
            let next = (k + 1) % pieces.len();
            walls.push((piece, uprights[k].clone(), uprights[next].clone()));
        }
        first += border.len() as u32;
    }
    for (piece, (from, left), (to, right)) in walls {
        let (length, n) = (piece.length(), steps(piece.length()));
        // Counter-clockwise in the unrolled wall: arc length and height.
        let along = |i: u32| length * f64::from(i) / f64::from(n);
        let mut border: Vec<(u32, f64)> = (0..n).map(|i| (from + i, along(i))).collect();
        border.push((to, length));
        border.extend(right.map(|v| (v, length)));
        border.push((to + count, length));
        border.extend((0..n).rev().map(|i| (from + count + i, along(i))));
        border.extend(left.rev().map(|v| (v, 0.0)));
        let outline = border.iter().map(|&(v, s)| [s, positions[v as usize][2]]).collect();
        let wall = fill(&[outline], spacing);
        let base = positions.len() as u32;
        positions.extend(wall.inner.iter().map(|&[s, z]| {
            let [x, y] = piece.at(s / length);
            [x, y, z]
        }));
        let known = border.len() as u32;
        let id = |v: u32| if v < known { border[v as usize].0 } else { base + v - known };
        faces.extend(wall.faces.iter().map(|f| f.map(id)));
    }
    made(positions, faces)
}
