//! Smooth models.

use std::f64::consts::TAU;

use fairing_mesh::TriMesh;
use glam::DVec3;

use super::build::Build;
use super::models::{level_set, ring, soft_max};
use super::sheets::bent;
use super::tube::Tube;
use fairing_shapes::outline::{circle, polygon};

pub(super) fn blob(build: Build) -> TriMesh {
    let mut random = build.proportions();
    let mut balls = vec![(DVec3::ZERO, random.between(0.4, 0.55))];
    for _ in 0..random.count(4, 6) {
        let away = random.direction() * random.between(0.45, 0.6);
        balls.push((away, random.between(0.22, 0.4)));
    }
    const SHARPNESS: f64 = 9.0;
    let field = move |p: [f64; 3]| {
        let p = DVec3::from(p);
        let sum: f64 =
            balls.iter().map(|(c, r)| libm::exp(-SHARPNESS * (p.distance(*c) - r))).sum();
        -libm::log(sum) / SHARPNESS
    };
    level_set(field, 1.15, build)
}

/// Eight cells of Schwarz's P surface in a rounded cube: genus 5.
pub(super) fn periodic(build: Build) -> TriMesh {
    let mut random = build.proportions();
    let k = random.between(4.6, 5.2);
    let level = random.between(-0.3, 0.2);
    let field = move |p: [f64; 3]| {
        let [x, y, z] = p.map(|t| libm::cos(k * t));
        let [a, b, c] = p.map(|t| (t * t) * (t * t) * (t * t));
        let cube = libm::cbrt((a + b + c).max(1e-30)).sqrt();
        soft_max(10.0, (x + y + z + level) / k, cube - 1.0)
    };
    level_set(field, 1.0, build)
}

pub(super) fn knot(build: Build) -> TriMesh {
    let mut random = build.proportions();
    let radius = random.between(0.13, 0.19);
    let height = random.between(0.3, 0.45);
    let axis = move |u: f64| {
        let t = TAU * u;
        let (s, c) = libm::sincos(t);
        let (s2, c2) = libm::sincos(2.0 * t);
        [(s + 2.0 * s2) / 3.0, (c - 2.0 * c2) / 3.0, -height * libm::sin(3.0 * t)]
    };
    let tube = Tube::new(axis);
    let lengths = [tube.length(), TAU * radius];
    ring(move |u, v| tube.at(u, v, radius), lengths, build)
}

pub(super) fn minimal(build: Build) -> TriMesh {
    let mut random = build.proportions();
    if build.seed.is_multiple_of(2) {
        let radius = random.between(0.85, 1.1);
        let enneper = |[u, v]: [f64; 2]| {
            let x = u - u * u * u / 3.0 + u * v * v;
            let y = -v + v * v * v / 3.0 - u * u * v;
            let point = DVec3::new(x, y, u * u - v * v);
            (point * 0.7).into()
        };
        return bent(build, &[circle([0.0; 2], radius, 4, false)], enneper);
    }
    let half = random.between(0.95, 1.1);
    let square = polygon(&[[-half, -half], [half, -half], [half, half], [-half, half]]);
    let scherk =
        |[x, y]: [f64; 2]| [0.8 * x, 0.8 * y, 0.8 * libm::log(libm::cos(x) / libm::cos(y))];
    bent(build, &[square], scherk)
}
