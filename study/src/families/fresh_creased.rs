//! Fresh models with creases.

use std::collections::HashMap;
use std::f64::consts::{FRAC_PI_2, TAU};

use fairing_mesh::TriMesh;
use glam::DVec3;

use super::build::{Build, Proportions};
use super::extrude::extrude_with;
use super::polyhedron::{Polyhedron, meeting, polyhedron};
use super::revolve::{Ring, revolve};
use super::solid::{Chart, Curve, Solid, joined, reversed};
use fairing_shapes::outline::{Piece, polygon};

/// A roof along x, the lower roof of a wing that meets it in valleys, and a
/// chimney astride the ridge.
pub(super) fn house(build: Build) -> TriMesh {
    let mut random = build.proportions();
    let depth = random.between(0.6, 0.75);
    let slope = libm::tan(random.between(12.0, 25.0f64).to_radians());
    let front = depth + random.between(0.35, 0.5);
    let (middle, half) = (random.between(-0.45, -0.25), random.between(0.28, 0.38));
    let (floor, eaves) = (-0.6, random.between(0.0, 0.2));
    let fraction = random.between(0.6, 0.85);
    let (ridge, low_ridge) = (eaves + slope * depth, eaves + fraction * slope * depth);
    let (left, right) = (middle - half, middle + half);
    let plan = [
        [-1.0, -depth],
        [left, -depth],
        [left, -front],
        [right, -front],
        [right, -depth],
        [1.0, -depth],
        [1.0, depth],
        [-1.0, depth],
    ];
    let mut corners: Vec<[f64; 3]> =
        [floor, eaves].iter().flat_map(|&z| plan.map(|[x, y]| [x, y, z])).collect();
    corners.extend([[-1.0, 0.0, ridge], [1.0, 0.0, ridge]]);
    // Where the roof of the wing is as high as the other, which it meets.
    corners.extend([[middle, -front, low_ridge], [middle, (fraction - 1.0) * depth, low_ridge]]);
    let (at, wide, deep) =
        (random.between(0.45, 0.6), random.between(0.13, 0.18), random.between(0.15, 0.22));
    let (a, b, foot) = (at - wide, at + wide, ridge - slope * deep);
    let top = ridge + random.between(0.2, 0.3);
    corners.extend([[a, 0.0, ridge], [b, 0.0, ridge]]);
    for z in [foot, top] {
        corners.extend([[a, -deep, z], [b, -deep, z], [b, deep, z], [a, deep, z]]);
    }
    let mut solid = Solid::new(build);
    polyhedron(&mut solid, &Polyhedron { corners, faces: house_faces() });
    solid.finished()
}

/// The loops of corners of the faces of a house: 0 to 7 are on the floor, 8 to
/// 15 above them, 16 and 17 are the ends of the ridge, 18 and 19 those of the
/// lower one, 20 to 29 belong to the chimney.
fn house_faces() -> Vec<Vec<usize>> {
    let mut faces: Vec<Vec<usize>> = vec![(0..8).rev().collect()];
    for i in 0..8 {
        let next = (i + 1) % 8;
        // Under the gables walls have five corners.
        let tip: &[usize] = match i {
            2 => &[18],
            5 => &[17],
            7 => &[16],
            _ => &[],
        };
        faces.push([&[i, next, 8 + next], tip, &[8 + i]].concat());
    }
    let others: [&[usize]; 9] = [
        &[8, 9, 19, 12, 13, 17, 21, 23, 22, 20, 16],
        &[14, 15, 16, 20, 25, 24, 21, 17],
        &[9, 10, 18, 19],
        &[11, 12, 19, 18],
        &[22, 23, 27, 26],
        &[23, 21, 24, 28, 27],
        &[24, 25, 29, 28],
        &[25, 20, 22, 26, 29],
        &[26, 27, 28, 29],
    ];
    faces.extend(others.map(<[usize]>::to_vec));
    faces
}

/// Polygons above each other, each turned against the one below, and two
/// triangles to a side between them, which fold inwards in every other storey.
pub(super) fn tower(build: Build) -> TriMesh {
    let mut random = build.proportions();
    let sides = random.count(5, 7) as usize;
    let storeys = random.count(3, 4) as usize;
    let step = TAU / sides as f64;
    let inwards = random.count(0, 1) as usize;
    let (mut corners, mut faces) = (vec![], vec![(0..sides).rev().collect::<Vec<_>>()]);
    let mut angle = 0.0;
    for k in 0..=storeys {
        let z = 1.8 * k as f64 / storeys as f64 - 0.9;
        let radius = random.between(0.6, 0.9);
        for i in 0..sides {
            let (s, c) = libm::sincos(angle + step * i as f64);
            corners.push([radius * c, radius * s, z]);
        }
        if k == storeys {
            break;
        }
        let left = random.count(0, 1) == 1;
        let turn = random.between(0.25, 0.5) * step;
        angle += if left { turn } else { -turn };
        // The longer diagonal folds inwards.
        let rising = left == (k % 2 == inwards);
        for i in 0..sides {
            let [a, b] = [i, (i + 1) % sides].map(|i| k * sides + i);
            let [c, d] = [a + sides, b + sides];
            faces.extend(if rising {
                [vec![a, b, d], vec![a, d, c]]
            } else {
                [vec![a, b, c], vec![b, d, c]]
            });
        }
    }
    faces.push((storeys * sides..(storeys + 1) * sides).collect());
    let mut solid = Solid::new(build);
    polyhedron(&mut solid, &Polyhedron { corners, faces });
    solid.finished()
}

/// A hexagonal head that a cone chamfers below, and a shank with a fillet, a
/// groove and a chamfered end upwards from it.
pub(super) fn bolt(build: Build) -> TriMesh {
    let mut random = build.proportions();
    let corner = 0.9;
    let inner = corner * random.between(0.6, 0.7);
    let slope = libm::tan(random.between(20.0, 35.0f64).to_radians());
    let low = -0.9;
    let high = low + random.between(0.4, 0.55);
    let shank = random.between(0.33, 0.42);
    let fillet = random.between(0.1, 0.2);
    let groove = random.between(0.35, 0.55);
    let (deep, chamfer) = (random.between(0.1, 0.14), random.between(0.1, 0.16));
    let end = 1.0;
    let mut pieces = vec![Piece::Arc {
        centre: [shank + fillet, high + fillet],
        radius: fillet,
        start: -FRAC_PI_2,
        sweep: -FRAC_PI_2,
    }];
    let points = [
        [shank, high + fillet],
        [shank, groove],
        [shank - deep, groove + deep],
        [shank - deep, groove + deep + 0.12],
        [shank, groove + deep + 0.12],
        [shank, end - chamfer],
        [shank - chamfer, end],
        [0.0, end],
    ];
    pieces.extend(points.windows(2).map(|w| Piece::Line { from: w[0], to: w[1] }));
    let mut solid = Solid::new(build);
    let disc = [Piece::Line { from: [0.0, low], to: [inner, low] }];
    let [_, below] = revolve(&mut solid, [0.0; 2], &disc, None);
    let above = Ring::new(&mut solid, [0.0; 2], pieces[0].at(0.0));
    let rings = [below.border(), above.border()].map(|ring| vec![ring]);
    revolve(&mut solid, [0.0; 2], &pieces, Some(above));
    let hexagon: [[f64; 2]; 6] = std::array::from_fn(|i| {
        let (s, c) = libm::sincos(TAU * i as f64 / 6.0);
        [corner * c, corner * s]
    });
    let cone = move |[x, y]: [f64; 2]| low + slope * (libm::hypot(x, y) - inner);
    extrude_with(&mut solid, &[polygon(&hexagon)], cone, move |_| high, &rings);
    solid.finished()
}

/// A sphere that bounds a model, from inside or from outside.
#[derive(Clone, Copy)]
struct Ball {
    /// The direction from the middle of the model.
    out: DVec3,
    centre: DVec3,
    radius: f64,
    /// `true` if the model is outside of the ball.
    hollow: bool,
}

impl Ball {
    /// At this distance from the origin towards `out`.
    fn new(out: DVec3, distance: f64, radius: f64, hollow: bool) -> Self {
        let away = if hollow { distance + radius } else { distance - radius };
        Self { out, centre: (out * away), radius, hollow }
    }

    /// The stereographic projection from the point opposite to the middle of the side. It keeps
    /// angles, and lengths in the middle.
    fn chart(self) -> Chart<'static> {
        let Self { out, centre, radius, hollow } = self;
        let (plane, middle) = (
            Chart::plane(DVec3::ZERO, out, away_from(out)),
            (out * (if hollow { -1.0 } else { 1.0 })),
        );
        let lift = Chart::plane(DVec3::ZERO, out, away_from(out)).to_space;
        Chart {
            to_plane: Box::new(move |p| {
                let q = (DVec3::from(p) - centre) * (1.0 / radius);
                let factor = 2.0 * radius / (1.0 + q.dot(middle));
                (plane.to_plane)(q.into()).map(|x| factor * x)
            }),
            to_space: Box::new(move |q| {
                let [x, y] = q.map(|t| 0.5 * t / radius);
                let square = x * x + y * y;
                let side = DVec3::from(lift([x, y])) * 2.0;
                let sum = side + middle * (1.0 - square);
                (centre + sum * (radius / (1.0 + square))).into()
            }),
            isometric: false,
        }
    }
}

/// The axis with the least component of a direction.
fn away_from(n: DVec3) -> DVec3 {
    let mut axis = DVec3::ZERO;
    let least = (0..3).min_by(|&i, &j| n[i].abs().total_cmp(&n[j].abs())).unwrap_or(0);
    axis[least] = 1.0;
    axis
}

/// The intersection of five balls without a sixth one: a cube with spherical
/// sides, one of them hollow.
pub(super) fn cushion(build: Build) -> TriMesh {
    let mut random = build.proportions();
    let balls: [Ball; 6] = std::array::from_fn(|k| side_ball(&mut random, k));
    let mut solid = Solid::new(build);
    // Bit k of the number of a corner says on which side along axis k it is.
    let around = |corner: usize| [0, 1, 2].map(|k| balls[2 * k + (corner >> k & 1)]);
    let ids: [u32; 8] =
        std::array::from_fn(|corner| solid.corner(common_point(around(corner), corner).into()));
    let mut edges: HashMap<(usize, usize), Curve> = HashMap::new();
    for corner in 0..8usize {
        for k in (0..3).filter(|k| corner >> k & 1 == 0) {
            let other = corner | 1 << k;
            let beside = around(corner);
            let pair = [beside[(k + 1) % 3], beside[(k + 2) % 3]];
            let arc = common_arc(pair, [ids[corner], ids[other]].map(|v| solid.at(v)));
            let curve = solid.curve(ids[corner], ids[other], arc);
            edges.insert((other, corner), reversed(&curve));
            edges.insert((corner, other), curve);
        }
    }
    for (k, ball) in balls.iter().enumerate() {
        let (axis, side) = (k / 2, k % 2);
        let [u, v] = [1, 2].map(|j| 1 << ((axis + j) % 3));
        let mut corners = [0, u, u | v, v].map(|c| c | side << axis);
        if side == 0 {
            corners.reverse();
        }
        let sides: [&[u32]; 4] =
            std::array::from_fn(|i| edges[&(corners[i], corners[(i + 1) % 4])].as_slice());
        solid.face(&[joined(&sides)], &ball.chart());
    }
    solid.finished()
}

/// The ball of a side of the cushion: along axis k / 2, towards + for odd k.
fn side_ball(random: &mut Proportions, k: usize) -> Ball {
    let mut out = [(); 3].map(|()| random.between(-0.12, 0.12));
    out[k / 2] = if k % 2 == 1 { 1.0 } else { -1.0 };
    let distance = random.between(0.85, 1.0);
    let hollow = k == 5;
    let least = if hollow { 2.2 } else { 1.6 };
    let radius = distance * random.between(least, 3.5);
    let distance = if hollow { 0.6 * distance } else { distance };
    let out = DVec3::from(out);
    Ball::new(out * (1.0 / out.length()), distance, radius, hollow)
}

/// The point near a corner of the cube that three spheres share, by Newton's method.
fn common_point(balls: [Ball; 3], corner: usize) -> DVec3 {
    let side = |k: u32| if corner >> k & 1 == 1 { 0.7 } else { -0.7 };
    let mut p = DVec3::new(side(0), side(1), side(2));
    for _ in 0..30 {
        let planes = balls.map(|b| {
            let d = p - b.centre;
            (d * (1.0 / d.length()), b.radius - d.length())
        });
        let Some(step) = meeting(planes) else { break };
        p += step;
    }
    p
}

/// The arc that two spheres share between two of their common points.
fn common_arc([a, b]: [Ball; 2], [from, to]: [[f64; 3]; 2]) -> impl Fn(f64) -> [f64; 3] {
    let between = b.centre - a.centre;
    let square = between.dot(between);
    let fraction = 0.5 * (1.0 + (a.radius * a.radius - b.radius * b.radius) / square);
    let middle = a.centre + between * fraction;
    let [u, v] = [from, to].map(|p| DVec3::from(p) - middle);
    let angle = libm::atan2(u.cross(v).length(), u.dot(v));
    move |t| {
        let [s, r] = [1.0 - t, t].map(|t| libm::sin(t * angle) / libm::sin(angle));
        (middle + (u * s + v * r)).into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::families::Triangulation;

    /// No face spans a crease: its corners lie on one of the six spheres.
    #[test]
    fn faces_of_the_cushion_lie_on_its_spheres() {
        for (seed, triangulation) in (0..).zip(Triangulation::ALL) {
            let build = Build { spacing: 0.11, triangulation, seed };
            let mesh = cushion(build);
            let mut random = build.proportions();
            let balls: [Ball; 6] = std::array::from_fn(|k| side_ball(&mut random, k));
            let mut used = [false; 6];
            for f in 0..mesh.face_count() {
                let on = |b: &Ball| {
                    let away =
                        mesh.triangle(f).map(|p| DVec3::from(p).distance(b.centre) - b.radius);
                    away.iter().all(|d| d.abs() < 1e-12)
                };
                let ball = balls.iter().position(on).unwrap();
                used[ball] = true;
                // It faces away from the centre, towards it on the hollow side.
                let n = DVec3::from(mesh.area_vector(f));
                let out = n.dot(DVec3::from(mesh.triangle(f)[0]) - balls[ball].centre);
                assert_eq!(out < 0.0, balls[ball].hollow, "{triangulation}: face {f}");
            }
            assert_eq!(used, [true; 6]);
        }
    }
}
