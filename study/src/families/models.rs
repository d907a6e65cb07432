//! Smooth models in each kind of triangulation.

use std::f64::consts::{PI, TAU};

use fairing_mesh::TriMesh;

use super::build::made;
use super::build::{Build, Triangulation};
use fairing_shapes::implicit::{implicit, onto};
use fairing_shapes::jittered;

/// The surface `field` = 0, negative inside, which lies in `[−reach, reach]³`; the
/// gradient of the field is about 1.
pub(super) fn level_set(
    field: impl Fn([f64; 3]) -> f64 + Sync,
    reach: f64,
    build: Build,
) -> TriMesh {
    // The two outermost layers of nodes have to be outside.
    let half = reach + 2.5 * build.spacing;
    // A net over a grid has edges a little longer than its cells.
    let resolution = (2.0 * half / (0.95 * build.spacing)).round() as usize;
    // The net is made of a squeezed model, and then pulled back.
    let pulled = move |p: [f64; 3]| match build.triangulation {
        Triangulation::Anisotropic => [0.75 * p[0], 0.75 * p[1], 1.8 * p[2]],
        Triangulation::Graded => p.map(|t| t + 0.52 * half / PI * libm::sin(PI * t / half)),
        _ => p,
    };
    let wide = if build.triangulation == Triangulation::Anisotropic { half / 0.75 } else { half };
    let squeezed = |p: [f64; 3]| field(pulled(p));
    let net = implicit(squeezed, wide, resolution);
    if build.triangulation == Triangulation::Irregular {
        let back = |p| onto(&field, p, build.spacing);
        return jittered(&jittered(&net, 0.4, build.seed, back), 0.4, build.seed + 1, back);
    }
    made(net.positions().iter().map(|&p| pulled(p)).collect(), net.faces().to_vec())
}

/// The larger of two values, rounded where they are within about 1 / k of each other.
pub(super) fn soft_max(k: f64, a: f64, b: f64) -> f64 {
    let (low, high) = (a.min(b), a.max(b));
    high + libm::log1p(libm::exp(k * (low - high))) / k
}

/// The closed surface `at(u, v)` of period one in both, u along and v around
/// (counter-clockwise seen from outside for u to the right and v upwards),
/// where `along` and `around` are the lengths of its mean circles.
pub(super) fn ring(
    at: impl Fn(f64, f64) -> [f64; 3],
    [along, around]: [f64; 2],
    build: Build,
) -> TriMesh {
    let stretched = build.triangulation == Triangulation::Anisotropic;
    let aspect: f64 = if stretched { 3.0 } else { 1.0 };
    let edge = [build.spacing * aspect.sqrt(), build.spacing / aspect.sqrt()];
    // Rows half an edge apart from each other, an even number of them.
    let columns = 2 * (0.5 * along / (edge[0] * 0.75f64.sqrt())).round().max(2.0) as u32;
    let rows = (around / edge[1]).round().max(6.0) as u32;
    let mut random = build.proportions();
    let mut positions = vec![];
    for i in 0..columns {
        for j in 0..rows {
            let mut u = f64::from(i) / f64::from(columns);
            let mut v = (f64::from(j) + 0.5 * f64::from(i % 2)) / f64::from(rows);
            match build.triangulation {
                Triangulation::Irregular => {
                    u += random.between(-0.28, 0.28) / f64::from(columns);
                    v += random.between(-0.28, 0.28) / f64::from(rows);
                }
                // The derivatives are from 0.48 to 1.52.
                Triangulation::Graded => {
                    u += 0.52 / TAU * libm::sin(TAU * u);
                    v += 0.52 / TAU * libm::sin(TAU * v);
                }
                _ => {}
            }
            positions.push(at(u, v));
        }
    }
    let id = |i: u32, j: u32| i % columns * rows + j % rows;
    let mut faces = vec![];
    for i in 0..columns {
        for j in 0..rows {
            // In odd columns vertices are half an edge further.
            let (a, b) = (id(i, j), id(i, j + 1));
            let (c, d) = (id(i + 1, j), id(i + 1, j + 1));
            if i % 2 == 0 {
                faces.extend([[a, c, b], [c, d, b]]);
            } else {
                faces.extend([[a, d, b], [a, c, d]]);
            }
        }
    }
    made(positions, faces)
}
