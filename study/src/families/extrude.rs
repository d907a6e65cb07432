//! Outlines pulled up to models.

use super::solid::{Chart, Curve, Solid, joined, reversed};
use fairing_shapes::outline::Piece;

/// Adds the model over the outlines (the outer one counter-clockwise, holes
/// clockwise) between the heights `bottom` and `top`. The lid has further
/// holes with the borders `rings`.
pub(super) fn extrude(
    solid: &mut Solid,
    outlines: &[Vec<Piece>],
    bottom: impl Fn([f64; 2]) -> f64,
    top: impl Fn([f64; 2]) -> f64,
    rings: &[Curve],
) {
    extrude_with(solid, outlines, bottom, top, &[vec![], rings.to_vec()]);
}

/// The same, with the borders of further holes in the floor and in the lid.
pub(super) fn extrude_with(
    solid: &mut Solid,
    outlines: &[Vec<Piece>],
    bottom: impl Fn([f64; 2]) -> f64,
    top: impl Fn([f64; 2]) -> f64,
    [below, above]: &[Vec<Curve>; 2],
) {
    let lower = |p: [f64; 2]| [p[0], p[1], bottom(p)];
    let upper = |p: [f64; 2]| [p[0], p[1], top(p)];
    let (mut floor, mut lid) = (vec![], vec![]);
    for pieces in outlines {
        let [rim, high] = walls(solid, pieces, &lower, &upper);
        floor.push(rim);
        lid.push(high);
    }
    let downwards = Chart {
        to_plane: Box::new(|p| [-p[0], p[1]]),
        to_space: Box::new(|q| lower([-q[0], q[1]])),
        isometric: false,
    };
    let upwards =
        Chart { to_plane: Box::new(|p| [p[0], p[1]]), to_space: Box::new(upper), isometric: false };
    floor.extend_from_slice(below);
    lid.extend_from_slice(above);
    solid.face(&floor.iter().map(|b| reversed(b)).collect::<Vec<_>>(), &downwards);
    solid.face(&lid, &upwards);
}

/// The walls over an outline, and its lower and upper rim.
fn walls(
    solid: &mut Solid,
    pieces: &[Piece],
    lower: &dyn Fn([f64; 2]) -> [f64; 3],
    upper: &dyn Fn([f64; 2]) -> [f64; 3],
) -> [Curve; 2] {
    let n = pieces.len();
    let starts: Vec<[u32; 2]> = pieces
        .iter()
        .map(|piece| [lower, upper].map(|lift| solid.corner(lift(piece.at(0.0)))))
        .collect();
    let uprights: Vec<Curve> = starts.iter().map(|s| solid.line(s[0], s[1])).collect();
    let mut rims: [Vec<Curve>; 2] = [vec![], vec![]];
    for (i, &piece) in pieces.iter().enumerate() {
        for (k, lift) in [lower, upper].into_iter().enumerate() {
            let curve = solid.piece((starts[i][k], starts[(i + 1) % n][k]), piece, lift);
            rims[k].push(curve);
        }
    }
    for (i, &piece) in pieces.iter().enumerate() {
        let border = joined(&[
            &rims[0][i],
            &uprights[(i + 1) % n],
            &reversed(&rims[1][i]),
            &reversed(&uprights[i]),
        ]);
        let length = piece.length();
        let chart = Chart {
            to_plane: Box::new(move |p| [length * piece.fraction([p[0], p[1]]), p[2]]),
            to_space: Box::new(move |[s, z]| {
                let [x, y] = piece.at(s / length);
                [x, y, z]
            }),
            isometric: true,
        };
        solid.face(&[border], &chart);
    }
    rims.map(|curves| joined(&curves.iter().map(Vec::as_slice).collect::<Vec<_>>()))
}
