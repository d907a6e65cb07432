//! A machined part: sharp edges, fillets, a chamfer, a hole and a curved top.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::ops::Range;

use super::grid::made;
use super::outline::Piece;
use super::patch::fill;
use fairing_mesh::TriMesh;

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

/// A machined part of size 4 × 3 × 1.4 in nearly equal triangles, a stand-in for scanned or
/// modelled CAD parts: an L-shaped outline with a sharp rim, a convex and a concave fillet, a
/// chamfer and a round hole (genus 1), pulled up to a gently arched top. Vertices lie exactly on
/// its planes, cylinders and creases.
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
    let outlines = outlines();
    let mut builder = Builder { spacing, rim: 0, positions: vec![], faces: vec![] };
    let borders = outlines.each_ref().map(|pieces| builder.sampled(pieces));
    builder.add_lids(&borders);
    // The upright line at the start of each piece.
    let mut first = 0;
    let mut walls = vec![];
    for (pieces, border) in outlines.iter().zip(&borders) {
        let uprights = builder.add_uprights(pieces, first);
        for (k, &piece) in pieces.iter().enumerate() {
            let next = (k + 1) % pieces.len();
            walls.push((piece, uprights[k].clone(), uprights[next].clone()));
        }
        first += border.len() as u32;
    }
    for (piece, left, right) in walls {
        builder.add_wall(piece, left, right);
    }
    made(builder.positions, builder.faces)
}

/// A vertex of the lower outline, and the vertices between it and the upper
/// one above it.
type Upright = (u32, Range<u32>);

/// The block as it grows.
struct Builder {
    spacing: f64,
    /// The number of vertices of the lower outline and hole; the upper ones
    /// follow in the same order.
    rim: u32,
    positions: Vec<[f64; 3]>,
    faces: Vec<[u32; 3]>,
}

impl Builder {
    /// The number of edges along this length.
    fn steps(&self, length: f64) -> u32 {
        (length / self.spacing).round().max(2.0) as u32
    }

    /// The vertices along an outline.
    fn sampled(&self, pieces: &[Piece]) -> Vec<[f64; 2]> {
        let samples = |&piece: &Piece| {
            let n = self.steps(piece.length());
            (0..n).map(move |i| piece.at(f64::from(i) / f64::from(n)))
        };
        pieces.iter().flat_map(samples).collect()
    }

    /// The bottom and the top, with their rims.
    fn add_lids(&mut self, borders: &[Vec<[f64; 2]>]) {
        let rim: Vec<[f64; 2]> = borders.concat();
        let lid = fill(borders, self.spacing);
        let (count, inner) = (rim.len() as u32, lid.inner.len() as u32);
        self.rim = count;
        for points in [&rim, &lid.inner] {
            self.positions.extend(points.iter().map(|p| [p[0], p[1], 0.0]));
            self.positions.extend(points.iter().map(|p| [p[0], p[1], top(p[0])]));
        }
        let lower = |v: u32| if v < count { v } else { v + count };
        let upper = |v: u32| if v < count { v + count } else { v + count + inner };
        self.faces.extend(lid.faces.iter().map(|f| [f[0], f[2], f[1]].map(lower)));
        self.faces.extend(lid.faces.iter().map(|f| f.map(upper)));
    }

    /// The upright lines at the starts of the pieces of an outline whose
    /// vertices begin at `first`.
    fn add_uprights(&mut self, pieces: &[Piece], mut first: u32) -> Vec<Upright> {
        let mut uprights = vec![];
        for &piece in pieces {
            let [x, y] = piece.at(0.0);
            let n = self.steps(top(x));
            let start = self.positions.len() as u32;
            self.positions.extend((1..n).map(|i| [x, y, top(x) * f64::from(i) / f64::from(n)]));
            uprights.push((first, start..start + n - 1));
            first += self.steps(piece.length());
        }
        uprights
    }

    /// The wall along a piece, between its uprights.
    fn add_wall(&mut self, piece: Piece, (from, left): Upright, (to, right): Upright) {
        let (length, n, rim) = (piece.length(), self.steps(piece.length()), self.rim);
        // Counter-clockwise in the unrolled wall: arc length and height.
        let along = |i: u32| length * f64::from(i) / f64::from(n);
        let mut border: Vec<(u32, f64)> = (0..n).map(|i| (from + i, along(i))).collect();
        border.push((to, length));
        border.extend(right.map(|v| (v, length)));
        border.push((to + rim, length));
        border.extend((0..n).rev().map(|i| (from + rim + i, along(i))));
        border.extend(left.rev().map(|v| (v, 0.0)));
        let outline = border.iter().map(|&(v, s)| [s, self.positions[v as usize][2]]).collect();
        let wall = fill(&[outline], self.spacing);
        let base = self.positions.len() as u32;
        self.positions.extend(wall.inner.iter().map(|&[s, z]| {
            let [x, y] = piece.at(s / length);
            [x, y, z]
        }));
        let known = border.len() as u32;
        let id = |v: u32| if v < known { border[v as usize].0 } else { base + v - known };
        self.faces.extend(wall.faces.iter().map(|f| f.map(id)));
    }
}
