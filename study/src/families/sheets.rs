//! Thin models and open sheets.

use fairing_mesh::TriMesh;

use super::build::Build;
use super::build::made;
use super::extrude::extrude;
use super::solid::{Chart, Curve, Solid, joined};
use fairing_shapes::outline::{Piece, circle, polygon, rounded};

/// The region with these outlines in the plane, bent by `map`; seen from +z
/// faces turn counter-clockwise before.
pub(super) fn bent(
    build: Build,
    outlines: &[Vec<Piece>],
    map: impl Fn([f64; 2]) -> [f64; 3] + Clone + 'static,
) -> TriMesh {
    let mut solid = Solid::flat(build, map.clone());
    let flat = |p: [f64; 2]| [p[0], p[1], 0.0];
    let mut borders = vec![];
    for pieces in outlines {
        let n = pieces.len();
        let starts: Vec<u32> = pieces.iter().map(|p| solid.corner(flat(p.at(0.0)))).collect();
        let curves: Vec<Curve> = (0..n)
            .map(|i| solid.piece((starts[i], starts[(i + 1) % n]), pieces[i], flat))
            .collect();
        borders.push(joined(&curves.iter().map(Vec::as_slice).collect::<Vec<_>>()));
    }
    solid.face(&borders, &Chart::plane([0.0; 3], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]));
    let mesh = solid.finished();
    let positions = mesh.positions().iter().map(|p| map([p[0], p[1]])).collect();
    made(positions, mesh.faces().to_vec())
}

/// The height of a bent sheet.
fn waves(build: Build, height: f64) -> impl Fn([f64; 2]) -> f64 + Copy + 'static {
    let mut random = build.proportions();
    let [a, b] = [0; 2].map(|_| random.between(1.6, 2.6));
    let [c, d] = [0; 2].map(|_| random.between(0.0, 3.0));
    move |[x, y]| {
        height * libm::sin(a * x + 0.7 * y + c) + 0.6 * height * libm::cos(b * y - 0.5 * x + d)
    }
}

pub(super) fn sheet(build: Build) -> TriMesh {
    let height = waves(build, 0.2);
    let corners = [[-1.0, -0.8], [1.0, -0.8], [1.0, 0.8], [-1.0, 0.8]];
    let outline = rounded(&corners.map(|p| (p, 0.25)));
    let hole = circle([0.2, 0.1], 0.25, 4, true);
    const HALF: f64 = 0.045;
    let mut solid = Solid::new(build);
    extrude(
        &mut solid,
        &[outline, hole],
        move |p| height(p) - HALF,
        move |p| height(p) + HALF,
        &[],
    );
    solid.finished()
}

pub(super) fn cloth(build: Build) -> TriMesh {
    let height = waves(build, 0.25);
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.2, 0.9], [-0.8, 1.1]];
    let hole = circle([-0.3, 0.3], 0.22, 4, true);
    bent(build, &[polygon(&corners), hole], move |p| [p[0], p[1], height(p)])
}

pub(super) fn channel(build: Build) -> TriMesh {
    let mut random = build.proportions();
    let t = 0.1;
    let bend = random.between(0.2, 0.35);
    let (w, left, right) = (0.8, random.between(0.2, 0.7), random.between(0.2, 0.7));
    let outline = rounded(&[
        ([-w, -0.6], bend),
        ([w, -0.6], bend),
        ([w, right], 0.0),
        ([w - t, right], 0.0),
        ([w - t, -0.6 + t], bend - t),
        ([-w + t, -0.6 + t], bend - t),
        ([-w + t, left], 0.0),
        ([-w, left], 0.0),
    ]);
    let half = random.between(0.5, 0.8);
    let mut solid = Solid::new(build);
    extrude(&mut solid, &[outline], move |_| -half, move |_| half, &[]);
    solid.finished()
}

pub(super) fn shell(build: Build) -> TriMesh {
    let mut random = build.proportions();
    // From below, then back along a jagged border.
    let half = random.between(2.0, 2.6);
    let mut corners = vec![[-half, -0.8], [half, -0.8]];
    let teeth = 2 * random.count(5, 8);
    for k in 0..=teeth {
        let x = half - 2.0 * half * f64::from(k) / f64::from(teeth);
        let tip = if k % 2 == 0 { 0.75 } else { 0.45 };
        corners.push([x, tip + random.between(-0.05, 0.05)]);
    }
    let (waist, wave) = (random.between(0.6, 0.75), random.between(0.1, 0.25));
    let map = move |[a, z]: [f64; 2]| {
        let r = waist + wave * libm::sin(2.2 * z + 0.5);
        let (s, c) = libm::sincos(a);
        [r * c, r * s, z]
    };
    bent(build, &[polygon(&corners)], map)
}
