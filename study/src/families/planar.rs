//! Models with plane faces.

use std::f64::consts::TAU;

use fairing_mesh::TriMesh;
use glam::DVec3;

use super::build::Build;
use super::extrude::extrude;
use super::polyhedron::{Polyhedron, convex, polyhedron};
use super::solid::Solid;
use fairing_shapes::outline::polygon;

pub(super) fn stairs(build: Build) -> TriMesh {
    let mut random = build.proportions();
    let steps = random.count(3, 5);
    let tilt = random.between(0.05, 0.25);
    let mut corners = vec![[-1.0, -0.7], [1.0, -0.7]];
    for k in 0..steps {
        let (x, next) = (f64::from(k), f64::from(k + 1));
        let n = f64::from(steps);
        let y = -0.7 + 1.4 * next / n;
        corners.push([1.0 - 1.6 * x / n, y]);
        if k + 1 < steps {
            corners.push([1.0 - 1.6 * next / n, y]);
        }
    }
    // The back leans over.
    corners.push([-0.75, 0.7]);
    let mut solid = Solid::new(build);
    let top = move |[x, y]: [f64; 2]| 0.6 + tilt * (x - 0.5 * y);
    extrude(&mut solid, &[polygon(&corners)], |_| -0.5, top, &[]);
    solid.finished()
}

pub(super) fn frame(build: Build) -> TriMesh {
    let mut random = build.proportions();
    let [a, b, c] = [0.15, 0.1, 0.3].map(|x| x + random.between(0.0, 0.15));
    let outer = [
        [-1.0 + a, -0.8],
        [1.0 - b, -0.8],
        [1.0, -0.8 + b],
        [1.0, 0.8 - c],
        [1.0 - c, 0.8],
        [-1.0, 0.8],
        [-1.0, -0.8 + a],
    ];
    let turn = random.between(0.1, 0.7);
    let (s, co) = libm::sincos(turn);
    let (w, h) = (random.between(0.3, 0.5), random.between(0.25, 0.4));
    // Clockwise.
    let hole =
        [[-w, -h], [-w, h], [w, h], [w, -h]].map(|[x, y]| [co * x - s * y - 0.05, s * x + co * y]);
    let tilt = random.between(-0.2, 0.2);
    let mut solid = Solid::new(build);
    let outlines = [polygon(&outer), polygon(&hole)];
    extrude(&mut solid, &outlines, |_| -0.3, move |[x, y]| 0.3 + tilt * x + 0.1 * y, &[]);
    solid.finished()
}

pub(super) fn crystal(build: Build) -> TriMesh {
    let mut random = build.proportions();
    let count = random.count(12, 16) as usize;
    let body = loop {
        let mut planes: Vec<(DVec3, f64)> = vec![];
        let mut tries = 0;
        while planes.len() < count && tries < 2000 {
            let n = random.direction();
            // At least 34° between any two.
            if planes.iter().all(|(m, _)| m.dot(n) < 0.83) {
                planes.push((n, random.between(0.8, 1.0)));
            }
            tries += 1;
        }
        let found = convex(&planes, 0.16);
        if let Some(body) =
            found.filter(|b| b.corners.iter().all(|p| DVec3::from(*p).length_squared() < 2.6))
        {
            break body;
        }
    };
    let mut solid = Solid::new(build);
    polyhedron(&mut solid, &body);
    solid.finished()
}

pub(super) fn star(build: Build) -> TriMesh {
    let mut random = build.proportions();
    let height = random.between(0.35, 0.6);
    let golden = 0.5 * (1.0 + 5f64.sqrt());
    let length = (1.0 + golden * golden).sqrt();
    let mut planes = vec![];
    for axis in 0..3 {
        for (s, t) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
            let mut n = DVec3::ZERO;
            n[axis] = s / length;
            n[(axis + 1) % 3] = t * golden / length;
            planes.push((n, 0.75));
        }
    }
    let Some(Polyhedron { mut corners, faces }) = convex(&planes, 1e-3) else {
        unreachable!("twelve planes at the same distance bound a dodecahedron")
    };
    let mut triangles = vec![];
    for face in &faces {
        let sum = face.iter().fold(DVec3::ZERO, |s, &c| s + DVec3::from(corners[c]));
        let middle = sum * (1.0 / face.len() as f64);
        let apex = corners.len();
        corners.push((middle * ((0.75 + height) / 0.75)).into());
        for i in 0..face.len() {
            triangles.push(vec![face[i], face[(i + 1) % face.len()], apex]);
        }
    }
    let mut solid = Solid::new(build);
    polyhedron(&mut solid, &Polyhedron { corners, faces: triangles });
    solid.finished()
}

pub(super) fn prism(build: Build) -> TriMesh {
    let mut random = build.proportions();
    let sides = random.count(13, 18) as usize;
    let slope = random.between(15.0, 28.0f64).to_radians();
    let radius = 0.9;
    let ring = |z: f64| {
        (0..sides).map(move |i| {
            let (s, c) = libm::sincos(TAU * i as f64 / sides as f64);
            [radius * c, radius * s, z]
        })
    };
    let mut corners: Vec<[f64; 3]> = ring(-0.6).chain(ring(0.5)).collect();
    corners.push([0.0, 0.0, 0.5 + radius * libm::tan(slope)]);
    let mut faces = vec![(0..sides).rev().collect::<Vec<_>>()];
    for i in 0..sides {
        let next = (i + 1) % sides;
        faces.push(vec![i, next, sides + next, sides + i]);
        faces.push(vec![sides + i, sides + next, 2 * sides]);
    }
    let mut solid = Solid::new(build);
    polyhedron(&mut solid, &Polyhedron { corners, faces });
    solid.finished()
}
