//! Fresh models without creases, or thin ones.

use std::f64::consts::TAU;

use fairing_mesh::TriMesh;

use super::build::Build;
use super::models::{level_set, ring, soft_max};
use super::revolve::revolve;
use super::sheets::bent;
use super::solid::Solid;
use fairing_shapes::outline::{Piece, circle};

/// cos(count φ + turn) away from the axis, φ the angle around it; smooth on the axis as well.
fn lobes([x, y]: [f64; 2], count: f64, turn: f64) -> f64 {
    const CORE: f64 = 0.2;
    let square = x * x + y * y;
    let fraction = libm::pow(square / (square + CORE * CORE), 0.5 * count);
    fraction * libm::cos(count * libm::atan2(y, x) + turn)
}

/// From 0 up to 1 as t goes from 0 to 1, without a kink.
fn smooth_step(t: f64) -> f64 {
    let t = t.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// A belly, a neck and a lip, with lobes that wind around: r²/ρ² + (z/h)⁶ = 1, ρ the radius at
/// the height and angle.
pub(super) fn vase(build: Build) -> TriMesh {
    let mut random = build.proportions();
    let (mean, swell) = (random.between(0.45, 0.52), random.between(0.14, 0.2));
    let (pace, phase) = (random.between(2.8, 3.8), random.between(0.0, TAU));
    let count = f64::from(random.count(3, 5));
    let (lobe, twist) = (random.between(0.06, 0.12), random.between(-2.0, 2.0));
    let half = random.between(0.9, 1.0);
    let field = move |[x, y, z]: [f64; 3]| {
        let round = mean + swell * libm::sin(pace * z + phase);
        let radius = round * (1.0 + lobe * lobes([x, y], count, twist * z));
        let (r, h) = ((x * x + y * y) / (radius * radius), z / half);
        0.5 * ((r + (h * h) * (h * h) * (h * h)).max(1e-12).sqrt() - 1.0)
    };
    level_set(field, 1.05, build)
}

/// A plate of genus 2 or 3 in the plane z = 0, as thick as the root of a product that vanishes
/// on its outline and on those of its holes.
pub(super) fn pretzel(build: Build) -> TriMesh {
    let mut random = build.proportions();
    let count = random.count(2, 3);
    let flat = if count == 2 { random.between(0.65, 0.75) } else { 0.95 };
    let thick = random.between(0.24, 0.34);
    let holes: Vec<([f64; 2], f64)> = (0..count)
        .map(|k| {
            let (s, c) = libm::sincos(TAU * f64::from(k) / f64::from(count));
            let away = random.between(0.43, 0.48);
            ([away * c, away * s], random.between(0.18, 0.25))
        })
        .collect();
    let rising = |t: f64, width: f64| -libm::expm1(-t / width);
    let field = move |[x, y, z]: [f64; 3]| {
        let mut product = rising(1.0 - x * x - (y / flat) * (y / flat), 0.5);
        for ([a, b], radius) in &holes {
            let (dx, dy) = (x - a, y - b);
            product *= rising(dx * dx + dy * dy - radius * radius, 0.12);
        }
        2.0 * (z * z - thick * thick * product)
    };
    level_set(field, 1.05, build)
}

/// A column with flutes, and a moulding at each end of them.
pub(super) fn fluted(build: Build) -> TriMesh {
    let mut random = build.proportions();
    let count = f64::from(random.count(8, 11));
    let depth = random.between(0.05, 0.08);
    let (radius, swell) = (random.between(0.5, 0.58), random.between(-0.06, 0.06));
    let phase = random.between(0.0, TAU);
    let ends = [0; 2].map(|_| (random.between(0.66, 0.74), random.between(0.08, 0.13)));
    let field = move |[x, y, z]: [f64; 3]| {
        let ridge = 0.5 - 0.5 * libm::cos(count * libm::atan2(y, x) + phase);
        // Wide flutes, narrow ridges.
        let flute = 1.0 - ridge * ridge;
        let (place, height) = ends[usize::from(z > 0.0)];
        let above = (z.abs() - place) / 0.075;
        let here = smooth_step((place - 0.1 - z.abs()) / 0.15);
        let round = radius + swell * libm::cos(2.0 * z) + height * libm::exp(-0.5 * above * above);
        let side = libm::hypot(x, y).max(1e-3) - round + depth * here * flute;
        soft_max(14.0, side, z.abs() - 0.95)
    };
    level_set(field, 1.0, build)
}

/// A ring of rounded square section with the blocks of a tread on its outer side, between slanted
/// grooves across it and one around it.
pub(super) fn tyre(build: Build) -> TriMesh {
    let mut random = build.proportions();
    let count = f64::from(random.count(9, 12));
    let depth = random.between(0.04, 0.06);
    let (slant, place) = (random.between(-1.5, 1.5), random.between(-0.15, 0.15));
    let (major, minor) = (0.72, random.between(0.24, 0.28));
    let at = move |u: f64, v: f64| {
        // The angle around the section, from the outer side.
        let angle = TAU * (v - libm::round(v));
        let (sv, cv) = libm::sincos(angle);
        let across = 0.5 + 0.5 * libm::cos(TAU * count * u + 2.0 * slant * angle);
        let t = (angle - place) / 0.3;
        let groove = 1.0 - (1.0 - across * across * across) * (1.0 - libm::exp(-t * t));
        let tread = smooth_step((1.3 - angle.abs()) / 0.4);
        let square = (sv * sv * sv * sv + cv * cv * cv * cv).sqrt().sqrt();
        let r = minor / square - depth * tread * groove;
        let (su, cu) = libm::sincos(TAU * u);
        let s = major + r * cv;
        [s * cu, s * su, r * sv]
    };
    ring(at, [TAU * major, 8.0 * minor], build)
}

/// A flat ring whose outer border waves up and down, and twice as often near its end.
pub(super) fn ruffle(build: Build) -> TriMesh {
    let mut random = build.proportions();
    let inner = random.between(0.25, 0.4);
    let count = f64::from(random.count(5, 8));
    let [steep, steeper] = [random.between(0.9, 1.3), random.between(0.3, 0.6)];
    let [a, b] = [0; 2].map(|_| random.between(0.0, TAU));
    let map = move |[x, y]: [f64; 2]| {
        let t = (libm::hypot(x, y) - inner) / (1.0 - inner);
        let angle = libm::atan2(y, x);
        let wave = steep / count * libm::sin(count * angle + a);
        let finer = 0.5 * steeper / count * libm::sin(2.0 * count * angle + b);
        [x, y, t * t * (wave + t * t * finer)]
    };
    let outlines = [circle([0.0; 2], 1.0, 4, false), circle([0.0; 2], inner, 4, true)];
    bent(build, &outlines, map)
}

/// A part of a spherical shell about an edge thick, on a flat foot.
pub(super) fn bowl(build: Build) -> TriMesh {
    let mut random = build.proportions();
    let outer = random.between(0.85, 1.0);
    let inner = outer - random.between(0.1, 0.13);
    let low = -random.between(55.0, 70.0f64).to_radians();
    let high = random.between(-20.0, 30.0f64).to_radians();
    let on = |radius: f64, angle: f64| {
        let (s, c) = libm::sincos(angle);
        [radius * c, radius * s]
    };
    let arc = |radius: f64, start: f64, end: f64| Piece::Arc {
        centre: [0.0; 2],
        radius,
        start,
        sweep: end - start,
    };
    let line = |from: [f64; 2], to: [f64; 2]| Piece::Line { from, to };
    let [foot, floor] = [outer, inner].map(|radius| on(radius, low));
    let pieces = [
        line([0.0, foot[1]], foot),
        arc(outer, low, high),
        line(on(outer, high), on(inner, high)),
        arc(inner, high, low),
        line(floor, [0.0, floor[1]]),
    ];
    let mut solid = Solid::new(build);
    revolve(&mut solid, [0.0; 2], &pieces, None);
    solid.finished()
}
