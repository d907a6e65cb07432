//! Random models of no family, for training.

use std::f64::consts::TAU;

use fairing_mesh::TriMesh;
use glam::DVec3;

use super::build::{Build, Proportions, Triangulation, sized};
use super::polyhedron::{Polyhedron, polyhedron};
use super::random_smooth;
use super::sheets::bent;
use super::solid::Solid;
use fairing_shapes::icosphere;
use fairing_shapes::outline::polygon;

/// A kind of random model. Families resemble parts that people make; random models resemble
/// nothing in particular.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum RandomModel {
    /// A terrain of plane triangles at random slopes: creases of all angles, convex and concave,
    /// that meet in corners. It has a border.
    Facets,
    /// A smooth terrain of waves, from long and flat to short and steep. It has a border.
    Swell,
    /// A closed model of plane triangles, without a flat angle between them.
    Gem,
    /// Steps of all heights and widths along two directions. It has a border.
    Terraces,
    /// A tube of varying section around a closed curve.
    Tube,
    /// A level set of a sum of waves inside a ball: smooth, with many handles.
    Sponge,
    /// Boxes, balls, cylinders and rings, added and taken away, with rounded creases.
    Blend,
    /// A plate with raised or sunken blots and winding ridges of one width, on a part of it. It has
    /// a border.
    Labyrinth,
}

fairing_parameters::named!(RandomModel, "kind of random model",
    Facets: "facets",
    Swell: "swell",
    Gem: "gem",
    Terraces: "terraces",
    Tube: "tube",
    Sponge: "sponge",
    Blend: "blend",
    Labyrinth: "labyrinth",
);

impl RandomModel {
    /// A model with about this many faces, oriented outwards or upwards.
    ///
    /// # Panics
    ///
    /// As for [`Family::mesh`](super::Family::mesh).
    pub fn mesh(self, faces: usize, triangulation: Triangulation, seed: u64) -> TriMesh {
        let make = match self {
            Self::Facets => facets,
            Self::Swell => swell,
            Self::Gem => gem,
            Self::Terraces => terraces,
            Self::Tube => random_smooth::tube,
            Self::Sponge => random_smooth::sponge,
            Self::Blend => random_smooth::blend,
            Self::Labyrinth => labyrinth,
        };
        sized(make, faces, triangulation, seed)
    }
}

fn facets(build: Build) -> TriMesh {
    let mut random = build.proportions();
    let cells = random.count(2, 7) as usize;
    let step = 2.0 / cells as f64;
    let height = 0.5 * step * random.between(0.1, 1.2);
    let row = cells + 1;
    let corners = (0..row * row)
        .map(|k| {
            let inner = |i: usize| i > 0 && i < cells;
            let (i, j) = (k % row, k / row);
            let [x, y] = [i, j].map(|i| {
                let shift = if inner(i) { random.between(-0.28, 0.28) } else { 0.0 };
                step * (i as f64 + shift) - 1.0
            });
            [x, y, random.between(-height, height)]
        })
        .collect();
    let mut triangles = vec![];
    for (i, j) in (0..cells).flat_map(|j| (0..cells).map(move |i| (i, j))) {
        let a = j * row + i;
        let [b, c, d] = [a + 1, a + row + 1, a + row];
        match random.count(0, 1) {
            0 => triangles.extend([vec![a, b, c], vec![a, c, d]]),
            _ => triangles.extend([vec![a, b, d], vec![b, c, d]]),
        }
    }
    let mut solid = Solid::new(build);
    polyhedron(&mut solid, &Polyhedron { corners, faces: triangles });
    solid.finished()
}

fn swell(build: Build) -> TriMesh {
    const WAVES: u32 = 5;
    let mut random = build.proportions();
    let steepest = random.between(0.05, 1.2);
    let waves: Vec<([f64; 2], f64, f64)> = (0..WAVES)
        .map(|_| {
            let frequency = TAU / random.log_between(0.35, 4.0);
            let (s, c) = libm::sincos(random.between(0.0, TAU));
            let height = steepest / (f64::from(WAVES) * frequency);
            ([c * frequency, s * frequency], random.between(0.0, TAU), 2.0 * height)
        })
        .collect();
    let map = move |[x, y]: [f64; 2]| {
        let height =
            |(k, phase, a): &([f64; 2], f64, f64)| a * libm::sin(k[0] * x + k[1] * y + phase);
        [x, y, waves.iter().map(height).sum()]
    };
    let [a, b] = [0; 2].map(|_| random.between(0.5, 1.0));
    bent(build, &[polygon(&[[-a, -b], [a, -b], [a, b], [-a, b]])], map)
}

/// Waves of one length and all directions cross zero along winding lines. Cut off below and above,
/// they are blots, pits or ridges with flanks of any slope.
fn labyrinth(build: Build) -> TriMesh {
    const WAVES: usize = 5;
    let mut random = build.proportions();
    let waves = |random: &mut Proportions, length: f64| -> Vec<([f64; 2], f64)> {
        let frequency = TAU / length;
        (0..WAVES)
            .map(|_| {
                let (s, c) = libm::sincos(random.between(0.0, TAU));
                ([c * frequency, s * frequency], random.between(0.0, TAU))
            })
            .collect()
    };
    let length = random.log_between(0.12, 0.6);
    let fine = waves(&mut random, length);
    let part = random.log_between(1.0, 3.0);
    let wide = waves(&mut random, part);
    // Of mean square one.
    let sum = |waves: &[([f64; 2], f64)], [x, y]: [f64; 2]| -> f64 {
        let terms = waves.iter().map(|(k, phase)| libm::sin(k[0] * x + k[1] * y + phase));
        terms.sum::<f64>() / libm::sqrt(0.5 * WAVES as f64)
    };
    let (level, flank) = (random.between(-1.0, 1.0), random.between(0.1, 1.0));
    let (height, bare) = (length * random.between(0.05, 0.4), random.between(-2.5, 0.5));
    let sign = if random.count(0, 1) == 0 { 1.0 } else { -1.0 };
    let step = |t: f64| {
        let t = t.clamp(0.0, 1.0);
        t * t * (3.0 - 2.0 * t)
    };
    let exact = |p: [f64; 2]| {
        let here = step((sum(&wide, p) - bare) / 0.5);
        sign * height * here * step(0.5 + (sum(&fine, p) - level) / flank)
    };
    // Bilinear between nodes: triangulating takes millions of heights.
    let side = |i: u32, cells: u32, half: f64| half * (2.0 * f64::from(i) / f64::from(cells) - 1.0);
    let [columns, rows] = [256u32, 180];
    let heights: Vec<f64> = (0..=rows)
        .flat_map(|j| (0..=columns).map(move |i| [side(i, columns, 1.0), side(j, rows, 0.7)]))
        .map(exact)
        .collect();
    let map = move |[x, y]: [f64; 2]| {
        let cell = |t: f64, cells: u32| {
            let t = (t * f64::from(cells)).clamp(0.0, f64::from(cells));
            let k = (t as u32).min(cells - 1);
            (k as usize, t - f64::from(k))
        };
        let ((i, s), (j, t)) = (cell(0.5 * (x + 1.0), columns), cell(0.5 * (y / 0.7 + 1.0), rows));
        let row = columns as usize + 1;
        let at = |i: usize, j: usize| heights[j * row + i];
        let low = at(i, j) * (1.0 - s) + at(i + 1, j) * s;
        let high = at(i, j + 1) * (1.0 - s) + at(i + 1, j + 1) * s;
        [x, y, low * (1.0 - t) + high * t]
    };
    bent(build, &[polygon(&[[-1.0, -0.7], [1.0, -0.7], [1.0, 0.7], [-1.0, 0.7]])], map)
}

fn gem(build: Build) -> TriMesh {
    let mut random = build.proportions();
    let coarse = icosphere(random.count(0, 1));
    let most = random.between(0.02, 0.4);
    let corners = (coarse.positions().iter())
        .map(|&p| (DVec3::from(p) * libm::exp(random.between(-most, most))).into())
        .collect();
    let faces = coarse.faces().iter().map(|f| f.map(|v| v as usize).to_vec()).collect();
    let mut solid = Solid::new(build);
    polyhedron(&mut solid, &Polyhedron { corners, faces });
    solid.finished()
}

/// The height at a cell of a grid is the sum of one of its column and one of its row. So no two
/// cells that meet in a corner are both above, or both below, the two between them.
fn terraces(build: Build) -> TriMesh {
    let mut random = build.proportions();
    let step = random.log_between(0.02, 0.15);
    // Even steps along one direction and odd ones along the other: no two corners above a
    // node of the grid are closer than one step.
    let mut cuts = |least: u32| {
        let cells = random.count(1, 6) as usize;
        let widths: Vec<f64> = (0..cells).map(|_| random.between(0.3, 1.0)).collect();
        let total: f64 = widths.iter().sum();
        let (mut at, mut heights, mut height) = (vec![-1.0], vec![], 0.0);
        for (k, w) in widths.iter().enumerate() {
            at.push(at[k] + 2.0 * w / total);
            heights.push(height);
            let up = f64::from(least + 2 * random.count(0, 1)) * step;
            height += if random.count(0, 1) == 0 { up } else { -up };
        }
        (at, heights)
    };
    let ((xs, along), (ys, across)) = (cuts(2), cuts(1));
    stepped(build, [&xs, &ys], |i, j| along[i] + across[j])
}

/// The tops of the cells between these coordinates, and the walls between them.
fn stepped(build: Build, [xs, ys]: [&[f64]; 2], height: impl Fn(usize, usize) -> f64) -> TriMesh {
    let (columns, rows) = (xs.len() - 1, ys.len() - 1);
    // The corners above a node of the grid, from the lowest.
    let mut corners: Vec<[f64; 3]> = vec![];
    let mut above: Vec<Vec<usize>> = vec![];
    for j in 0..=rows {
        for i in 0..=columns {
            let mut heights: Vec<f64> = vec![];
            for (a, b) in [(i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)] {
                if (1..=columns).contains(&a) && (1..=rows).contains(&b) {
                    heights.push(height(a - 1, b - 1));
                }
            }
            heights.sort_by(f64::total_cmp);
            heights.dedup();
            above.push((corners.len()..corners.len() + heights.len()).collect());
            corners.extend(heights.iter().map(|&z| [xs[i], ys[j], z]));
        }
    }
    let between = |i: usize, j: usize, low: f64, high: f64| -> Vec<usize> {
        let all = above[j * (columns + 1) + i].iter().copied();
        all.filter(|&c| (low..=high).contains(&corners[c][2])).collect()
    };
    let mut faces = vec![];
    for j in 0..rows {
        for i in 0..columns {
            let z = height(i, j);
            let at = |a: usize, b: usize| between(i + a, j + b, z, z)[0];
            faces.push(vec![at(0, 0), at(1, 0), at(1, 1), at(0, 1)]);
        }
    }
    // A wall stands on the line from node `a` to node `b`, with a cell on its left and one on its
    // right.
    let mut wall = |a: [usize; 2], b: [usize; 2], left: f64, right: f64| {
        if left == right {
            return;
        }
        let (low, high) = (left.min(right), left.max(right));
        let [from, to] = if left < right { [b, a] } else { [a, b] };
        // Seen from the lower side, the higher cell is behind.
        let mut face = between(from[0], from[1], low, high);
        face.reverse();
        face.extend(between(to[0], to[1], low, high));
        faces.push(face);
    };
    for j in 0..rows {
        for i in 0..columns {
            if i + 1 < columns {
                wall([i + 1, j], [i + 1, j + 1], height(i, j), height(i + 1, j));
            }
            if j + 1 < rows {
                wall([i + 1, j + 1], [i, j + 1], height(i, j), height(i, j + 1));
            }
        }
    }
    let mut solid = Solid::new(build);
    polyhedron(&mut solid, &Polyhedron { corners, faces });
    solid.finished()
}
