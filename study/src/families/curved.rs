//! Models with creases and curved faces.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use fairing_mesh::TriMesh;

use super::build::Build;
use super::extrude::extrude;
use super::revolve::{Ring, revolve};
use super::solid::{Chart, Curve, Solid, joined, reversed};
use fairing_shapes::outline::{Piece, circle, polygon, rounded};

/// The pieces of a line through these points.
fn path(points: &[[f64; 2]]) -> Vec<Piece> {
    points.windows(2).map(|w| Piece::Line { from: w[0], to: w[1] }).collect()
}

pub(super) fn gear(build: Build) -> TriMesh {
    let mut random = build.proportions();
    let teeth = random.count(8, 12);
    let root = random.between(0.72, 0.8);
    let step = TAU / f64::from(teeth);
    let on = |radius: f64, angle: f64| {
        let (s, c) = libm::sincos(angle);
        [radius * c, radius * s]
    };
    let arc = |radius, start: f64, end: f64| Piece::Arc {
        centre: [0.0; 2],
        radius,
        start,
        sweep: end - start,
    };
    let mut outer = vec![];
    for k in 0..teeth {
        let a = |fraction: f64| step * (f64::from(k) + fraction);
        outer.push(arc(root, a(0.0), a(0.36)));
        outer.push(Piece::Line { from: on(root, a(0.36)), to: on(1.0, a(0.5)) });
        outer.push(arc(1.0, a(0.5), a(0.86)));
        outer.push(Piece::Line { from: on(1.0, a(0.86)), to: on(root, a(1.0)) });
    }
    let hole = circle([0.0; 2], random.between(0.25, 0.4), 4, true);
    let half = random.between(0.2, 0.35);
    let mut solid = Solid::new(build);
    extrude(&mut solid, &[outer, hole], move |_| -half, move |_| half, &[]);
    solid.finished()
}

pub(super) fn bracket(build: Build) -> TriMesh {
    let mut random = build.proportions();
    let mut radius = |mean: f64| mean * random.between(0.7, 1.3);
    let outer = rounded(&[
        ([-1.0, -0.8], radius(0.1)),
        ([1.0, -0.8], radius(0.3)),
        ([1.0, -0.1], radius(0.2)),
        ([0.1, -0.1], radius(0.4)),
        ([-0.1, 0.8], radius(0.15)),
        ([-0.5, 0.8], 0.0),
        ([-1.0, 0.4], radius(0.25)),
    ]);
    let hole = circle([-0.5, -0.25], random.between(0.18, 0.28), 4, true);
    let slot = rounded(&[
        ([0.2, -0.6], 0.12),
        ([0.2, -0.3], 0.12),
        ([0.75, -0.3], 0.12),
        ([0.75, -0.6], 0.12),
    ]);
    let half = random.between(0.3, 0.45);
    let mut solid = Solid::new(build);
    extrude(&mut solid, &[outer, hole, slot], move |_| -half, move |_| half, &[]);
    solid.finished()
}

pub(super) fn turned(build: Build) -> TriMesh {
    let mut random = build.proportions();
    let neck = random.between(0.32, 0.45);
    let wide = random.between(0.65, 0.8);
    let fillet = 0.7 - neck;
    let end = random.between(0.25, 0.4);
    let mut pieces = path(&[[0.0, -1.0], [0.7, -1.0], [0.7, -0.2 - fillet]]);
    pieces.push(Piece::Arc {
        centre: [0.7, -0.2],
        radius: fillet,
        start: -FRAC_PI_2,
        sweep: -FRAC_PI_2,
    });
    pieces.extend(path(&[[neck, -0.2], [neck, 0.2], [wide, 0.5]]));
    pieces.push(Piece::Arc {
        centre: [wide - end, 0.5],
        radius: end,
        start: 0.0,
        sweep: FRAC_PI_2,
    });
    pieces.extend(path(&[[wide - end, 0.5 + end], [0.0, 0.5 + end]]));
    let mut solid = Solid::new(build);
    revolve(&mut solid, [0.0; 2], &pieces, None);
    solid.finished()
}

pub(super) fn grooves(build: Build) -> TriMesh {
    let mut random = build.proportions();
    let on = |radius: f64, angle: f64| {
        let (s, c) = libm::sincos(angle);
        [radius * c, radius * s]
    };
    let cap = random.between(68.0, 76.0f64).to_radians();
    let arc = |start: f64, end: f64| Piece::Arc {
        centre: [0.0; 2],
        radius: 1.0,
        start,
        sweep: end - start,
    };
    let mut pieces = path(&[[0.0, -libm::sin(cap)], on(1.0, -cap)]);
    let mut at = -cap;
    for (k, middle) in [-38.0f64, -4.0, 34.0].into_iter().enumerate() {
        let middle = (middle + random.between(-4.0, 4.0)).to_radians();
        let half = random.between(5.0, 9.0f64).to_radians();
        let depth = random.between(0.12, 0.2);
        pieces.push(arc(at, middle - half));
        let floor = 1.0 - depth;
        // A sharp groove, then flat ones.
        let [a, b] = [on(1.0, middle - half), on(1.0, middle + half)];
        pieces.extend(if k == 0 {
            path(&[a, on(floor, middle), b])
        } else {
            path(&[a, on(floor, middle - half), on(floor, middle + half), b])
        });
        at = middle + half;
    }
    pieces.push(arc(at, cap));
    pieces.extend(path(&[on(1.0, cap), [0.0, libm::sin(cap)]]));
    let mut solid = Solid::new(build);
    revolve(&mut solid, [0.0; 2], &pieces, None);
    solid.finished()
}

pub(super) fn bosses(build: Build) -> TriMesh {
    let mut random = build.proportions();
    let mut solid = Solid::new(build);
    let h = 0.15;
    let wide = random.between(0.36, 0.44);
    let frustum = path(&[[wide, h], [random.between(0.15, 0.3), 0.65], [0.0, 0.65]]);
    let cone = path(&[[random.between(0.32, 0.4), h], [0.0, random.between(0.55, 0.85)]]);
    let depth = random.between(-0.08, 0.02);
    let sink = path(&[[0.38, h], [0.2, depth], [0.0, depth]]);
    // A dome that meets the plate at an angle, flat at its end.
    let (r, start) = (0.42, random.between(0.0, 0.6));
    let s = libm::sin(start);
    let top = [r * libm::cos(1.3), h - r * s + r * libm::sin(1.3)];
    let mut dome =
        vec![Piece::Arc { centre: [0.0, h - r * s], radius: r, start, sweep: 1.3 - start }];
    dome.extend(path(&[top, [0.0, top[1]]]));
    let places = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]];
    let mut rings = vec![];
    for (centre, profile) in places.into_iter().zip([frustum, cone, sink, dome]) {
        let ring = Ring::new(&mut solid, centre, profile[0].at(0.0));
        rings.push(ring.border());
        revolve(&mut solid, centre, &profile, Some(ring));
    }
    let plate = polygon(&[[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]);
    extrude(&mut solid, &[plate], |_| -0.25, move |_| h, &rings);
    solid.finished()
}

pub(super) fn lobes(build: Build) -> TriMesh {
    let mut random = build.proportions();
    let count = random.count(5, 7);
    let turn = random.between(15.0, 30.0f64).to_radians();
    let side = TAU / f64::from(count);
    // Half of what each arc turns by, its chord being a side of the polygon.
    let half = 0.5 * (side - turn);
    let radius = libm::sin(0.5 * side) / libm::sin(half) * 0.9;
    let away = 0.9 * libm::cos(0.5 * side) - radius * libm::cos(half);
    let outline = (0..count).map(|k| {
        let middle = side * (f64::from(k) + 0.5);
        let (s, c) = libm::sincos(middle);
        Piece::Arc { centre: [away * c, away * s], radius, start: middle - half, sweep: 2.0 * half }
    });
    let crown = random.between(0.1, 0.3);
    let top = move |[x, _]: [f64; 2]| 0.7 - crown * x * x;
    let mut solid = Solid::new(build);
    extrude(&mut solid, &[outline.collect()], |_| -0.7, top, &[]);
    solid.finished()
}

/// A cylinder along x, and one of smaller radius along z upwards from it.
pub(super) fn joint(build: Build) -> TriMesh {
    let mut random = build.proportions();
    let wide = random.between(0.45, 0.55);
    let thin = wide * random.between(0.6, 0.9);
    let mut solid = Solid::new(build);
    // Where they meet, in quarters.
    let meeting = move |angle: f64| {
        let (s, c) = libm::sincos(angle);
        [thin * c, thin * s, (wide * wide - thin * thin * s * s).sqrt()]
    };
    let starts: [u32; 4] = std::array::from_fn(|i| solid.corner(meeting(i as f64 * FRAC_PI_2)));
    let quarters: [Curve; 4] = std::array::from_fn(|i| {
        let ends = (starts[i], starts[(i + 1) % 4]);
        solid.curve(ends.0, ends.1, |t| meeting((i as f64 + t) * FRAC_PI_2))
    });
    branch(&mut solid, thin, &quarters);
    let hole = joined(&quarters.each_ref().map(Vec::as_slice));
    trunk(&mut solid, wide, hole);
    solid.finished()
}

/// The cylinder along z above the curve, and its end.
fn branch(solid: &mut Solid, radius: f64, quarters: &[Curve; 4]) {
    let ring = Ring::new(solid, [0.0; 2], [radius, 1.1]);
    let high = ring.clone();
    let Ring::Circle(high) = high else { return };
    let uprights: [Curve; 4] = std::array::from_fn(|i| solid.line(quarters[i][0], high[i][0]));
    for i in 0..4 {
        let next = &uprights[(i + 1) % 4];
        let border = joined(&[&quarters[i], next, &reversed(&high[i]), &reversed(&uprights[i])]);
        let middle = (i as f64 + 0.5) * FRAC_PI_2;
        let (s, c) = libm::sincos(middle);
        let chart = Chart {
            // The angle from the middle, which is within an eighth of a turn.
            to_plane: Box::new(move |[x, y, z]| {
                [radius * libm::atan2(c * y - s * x, c * x + s * y), z]
            }),
            to_space: Box::new(move |[a, z]| {
                let (s, c) = libm::sincos(middle + a / radius);
                [radius * c, radius * s, z]
            }),
            isometric: true,
        };
        solid.face(&[border], &chart);
    }
    revolve(solid, [0.0; 2], &path(&[[radius, 1.1], [0.0, 1.1]]), Some(ring));
}

/// The cylinder along x with a hole in its upper side, and its ends.
fn trunk(solid: &mut Solid, radius: f64, hole: Curve) {
    // Angles from +z towards +y, so that x to the right and the angle upwards
    // turn counter-clockwise seen from outside.
    let on = move |x: f64, angle: f64| {
        let (s, c) = libm::sincos(angle);
        [x, radius * s, radius * c]
    };
    let angles = [-FRAC_PI_2, FRAC_PI_2];
    let corners = [-1.0, 1.0].map(|x| angles.map(|a| solid.corner(on(x, a))));
    let seams = [0, 1].map(|k| solid.line(corners[0][k], corners[1][k]));
    let arcs = [0, 1].map(|side| {
        let x = [-1.0, 1.0][side];
        let [a, b] = corners[side];
        let upper = solid.curve(a, b, |t| on(x, PI * (t - 0.5)));
        let lower = solid.curve(b, a, |t| on(x, PI * (t + 0.5)));
        [upper, lower]
    });
    for half in 0..2 {
        let middle = half as f64 * PI;
        let (low, high) = (&seams[half], &seams[1 - half]);
        let border = joined(&[low, &arcs[1][half], &reversed(high), &reversed(&arcs[0][half])]);
        let side = 1.0 - 2.0 * half as f64;
        let chart = Chart {
            to_plane: Box::new(move |[x, y, z]| [x, radius * libm::atan2(side * y, side * z)]),
            to_space: Box::new(move |[x, a]| on(x, middle + a / radius)),
            isometric: true,
        };
        let mut borders = vec![border];
        if half == 0 {
            borders.push(hole.clone());
        }
        solid.face(&borders, &chart);
    }
    for side in 0..2 {
        let x = [-1.0, 1.0][side];
        let border = joined(&[&arcs[side][0], &arcs[side][1]]);
        let chart = Chart::plane([x, 0.0, 0.0], [x, 0.0, 0.0], [0.0, 0.0, 1.0]);
        solid.face(&[border], &chart);
    }
}
