//! Models with details a few edges wide.

use std::f64::consts::{PI, TAU};

use fairing_mesh::TriMesh;
use glam::DVec3;

use super::build::Build;
use super::models::{level_set, ring};
use super::sheets::bent;
use fairing_shapes::outline::polygon;

pub(super) fn relief(build: Build) -> TriMesh {
    let mut random = build.proportions();
    let waves: Vec<(DVec3, f64, f64)> = (0..9)
        .map(|k| {
            // Wave lengths from 1 to 0.4.
            let frequency = [7.0, 11.0, 15.0][k % 3] * random.between(0.9, 1.1);
            let direction = random.direction() * frequency;
            (direction, random.between(0.0, TAU), 0.14 / frequency)
        })
        .collect();
    let field = move |p: [f64; 3]| {
        let p = DVec3::from(p);
        let r = p.length().max(1e-3);
        let q = p * (1.0 / r);
        let waves: f64 = waves
            .iter()
            .map(|(d, phase, a)| a * libm::sin(d[0] * q[0] + d[1] * q[1] + d[2] * q[2] + phase))
            .sum();
        r - 0.95 - waves
    };
    level_set(field, 1.1, build)
}

pub(super) fn weave(build: Build) -> TriMesh {
    let mut random = build.proportions();
    let [along, around] = [f64::from(random.count(9, 12)), f64::from(random.count(4, 5))];
    let height = random.between(0.025, 0.04);
    let (major, minor) = (0.7, 0.32);
    let at = move |u: f64, v: f64| {
        // Bands over and under each other.
        let wave = libm::cos(PI * along * u * 2.0) * libm::cos(TAU * around * v);
        let r = minor + height * wave;
        let (su, cu) = libm::sincos(TAU * u);
        let (sv, cv) = libm::sincos(TAU * v);
        let s = major + r * cv;
        [s * cu, s * su, r * sv]
    };
    ring(at, [TAU * major, TAU * minor], build)
}

pub(super) fn pores(build: Build) -> TriMesh {
    let mut random = build.proportions();
    let count = random.count(30, 45);
    let golden = PI * (3.0 - 5f64.sqrt());
    let pits: Vec<(DVec3, f64, f64)> = (0..count)
        .map(|k| {
            // Points spread over the sphere evenly.
            let z = 1.0 - (2.0 * f64::from(k) + 1.0) / f64::from(count);
            let (s, c) = libm::sincos(golden * f64::from(k));
            let r = (1.0 - z * z).sqrt();
            let width = random.between(0.07, 0.12);
            (DVec3::new(r * c, r * s, z), width, width * random.between(0.7, 1.2))
        })
        .collect();
    let field = move |p: [f64; 3]| {
        let p = DVec3::from(p);
        let deep: f64 = pits
            .iter()
            .map(|(c, width, depth)| {
                let t = p.distance(*c) / width;
                depth * libm::exp(-0.5 * t * t)
            })
            .sum();
        p.length() - 1.0 + deep
    };
    level_set(field, 1.0, build)
}

/// Strokes between the nodes of a lattice, three or four to a letter.
pub(super) fn strokes(build: Build) -> TriMesh {
    let mut random = build.proportions();
    let mut lines: Vec<[[f64; 2]; 2]> = vec![];
    for letter in 0..5 {
        for row in 0..2 {
            let corner = [-1.0 + 0.4 * f64::from(letter), -0.55 + 0.55 * f64::from(row)];
            let node = |i: u32| {
                let (column, line) = (f64::from(i % 2), f64::from(i / 2 % 3));
                [corner[0] + 0.09 + 0.22 * column, corner[1] + 0.08 + 0.19 * line]
            };
            for _ in 0..random.count(3, 4) {
                let a = random.count(0, 5);
                let b = (a + random.count(1, 5)) % 6;
                lines.push([node(a), node(b)]);
            }
        }
    }
    let height = random.between(0.05, 0.08);
    let map = move |p: [f64; 2]| {
        let closest = lines.iter().map(|l| fairing_shapes::patch::distance_to(p, *l));
        // Half width 0.045, and a rounded flank as wide.
        let t = ((0.09 - closest.fold(f64::INFINITY, f64::min)) / 0.055).clamp(0.0, 1.0);
        [p[0], p[1], height * t * t * (3.0 - 2.0 * t)]
    };
    let plate = polygon(&[[-1.05, -0.6], [1.05, -0.6], [1.05, 0.6], [-1.05, 0.6]]);
    bent(build, &[plate], map)
}
