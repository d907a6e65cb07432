//! Smooth models at random.

use std::f64::consts::TAU;

use fairing_mesh::TriMesh;
use glam::DVec3;

use super::build::{Build, Proportions};
use super::models::{level_set, ring, soft_max};

/// Points of a curve that are looked at for its bends.
const POINTS: usize = 256;

pub(super) fn tube(build: Build) -> TriMesh {
    let mut random = build.proportions();
    // Of six curves that with the most room.
    let mut axis = closed_curve(&mut random);
    let mut most = largest_radius(&axis);
    for _ in 1..6 {
        let other = closed_curve(&mut random);
        let found = largest_radius(&other);
        if found >= most {
            (axis, most) = (other, found);
        }
    }
    let radius = most * random.between(0.3, 0.85);
    let (lobes, waves) = (f64::from(random.count(2, 4)), f64::from(random.count(1, 6)));
    let turns = f64::from(random.count(0, 2));
    let [lobed, waved] = [0.2, 0.25].map(|most| random.between(-most, most).max(0.0));
    let frames = Frames::new(&axis);
    let at = move |u: f64, v: f64| {
        let around = libm::sin(TAU * (lobes * v + turns * u));
        let along = libm::sin(TAU * waves * u);
        let radius = radius * (1.0 + lobed * around) * (1.0 + waved * along);
        frames.at(u, v, radius).to_array()
    };
    let length: f64 = (0..POINTS).map(|i| axis.at(i).distance(axis.at(i + 1))).sum();
    ring(at, [length, TAU * radius], build)
}

/// A closed curve of a few harmonics; its points.
struct Axis(Vec<DVec3>);

impl Axis {
    fn at(&self, i: usize) -> DVec3 {
        self.0[i % POINTS]
    }
}

fn closed_curve(random: &mut Proportions) -> Axis {
    let mut terms: Vec<(f64, DVec3, DVec3)> = vec![];
    for k in 1..=3 {
        let size = if k == 1 { 1.0 } else { random.between(0.0, 0.9) / f64::from(k) };
        let [a, b] = [0; 2].map(|_| random.direction() * size);
        terms.push((f64::from(k), a, b));
    }
    let points: Vec<DVec3> = (0..POINTS)
        .map(|i| {
            let t = TAU * i as f64 / POINTS as f64;
            terms.iter().fold(DVec3::ZERO, |sum, (k, a, b)| {
                let (s, c) = libm::sincos(k * t);
                sum + (*a * c + *b * s)
            })
        })
        .collect();
    let reach = points.iter().map(|&p| p.length()).fold(0.0, f64::max);
    Axis(points.iter().map(|&p| p * (1.0 / reach)).collect())
}

/// The radius of the thickest tube around a curve that neither folds nor meets itself: the least
/// radius of a circle through a point of the curve that touches it at another.
fn largest_radius(axis: &Axis) -> f64 {
    let mut least = f64::INFINITY;
    for i in 0..POINTS {
        let tangent = axis.at(i + 1) - axis.at(i + POINTS - 1);
        let tangent = tangent * (1.0 / tangent.length().max(1e-12));
        for j in (0..POINTS).filter(|&j| j != i) {
            let d = axis.at(j) - axis.at(i);
            let off = d.cross(tangent).length();
            least = least.min(0.5 * d.dot(d) / off.max(1e-12));
        }
    }
    least
}

/// Axes across a closed curve that turn as little as they can: unlike those of
/// [`Tube`](super::tube::Tube) they need no bend of the curve.
struct Frames {
    points: Vec<DVec3>,
    normals: Vec<DVec3>,
}

impl Frames {
    fn new(axis: &Axis) -> Self {
        let tangent = |i: usize| {
            let t = axis.at(i + 1) - axis.at(i + POINTS - 1);
            t * (1.0 / t.length())
        };
        let across = |v: DVec3, t: DVec3| {
            let v = v - (t * v.dot(t));
            v * (1.0 / v.length())
        };
        let first = tangent(0);
        let axis_aside = if first.x.abs() < 0.6 { DVec3::X } else { DVec3::Y };
        let mut normals = vec![across(axis_aside, first)];
        for i in 1..=POINTS {
            normals.push(across(normals[i - 1], tangent(i)));
        }
        // The angle missing to a whole turn is spread over the curve.
        let (start, end) = (normals[0], normals[POINTS]);
        let missing = libm::atan2(end.cross(start).dot(first), end.dot(start));
        for (i, n) in normals.iter_mut().enumerate() {
            let (s, c) = libm::sincos(missing * i as f64 / POINTS as f64);
            *n = *n * c + tangent(i).cross(*n) * s;
        }
        let points = (0..=POINTS).map(|i| axis.at(i)).collect();
        Self { points, normals }
    }

    /// Counter-clockwise seen from outside for u to the right and v upwards.
    fn at(&self, u: f64, v: f64, radius: f64) -> DVec3 {
        let u = u.rem_euclid(1.0) * POINTS as f64;
        let i = (u as usize).min(POINTS - 1);
        let t = u - i as f64;
        let before = (i + POINTS - 1) % POINTS;
        let after = (i + 2) % POINTS;
        // A cubic through the points with the slopes of neighbours.
        let [a, b] = [self.points[i], self.points[i + 1]];
        let slopes = [(b - self.points[before]), (self.points[after] - a)];
        let (t2, t3) = (t * t, t * t * t);
        let weights = [2.0 * t3 - 3.0 * t2 + 1.0, 3.0 * t2 - 2.0 * t3];
        let tangents = [0.5 * (t3 - 2.0 * t2 + t), 0.5 * (t3 - t2)];
        let here =
            (a * weights[0] + b * weights[1]) + (slopes[0] * tangents[0] + slopes[1] * tangents[1]);
        let along = slopes[0] * (1.0 - t) + slopes[1] * t;
        let along = along * (1.0 / along.length());
        let normal = self.normals[i] * (1.0 - t) + self.normals[i + 1] * t;
        let normal = normal - (along * normal.dot(along));
        let normal = normal * (1.0 / normal.length());
        let (s, c) = libm::sincos(TAU * v);
        let across = normal.cross(along);
        here + (normal * (radius * c) + across * (radius * s))
    }
}

pub(super) fn sponge(build: Build) -> TriMesh {
    const WAVES: usize = 12;
    let mut random = build.proportions();
    let middle = TAU / random.between(0.8, 2.5);
    let waves: Vec<(DVec3, f64)> = (0..WAVES)
        .map(|_| {
            let frequency = middle * random.between(0.7, 1.3);
            (random.direction() * frequency, random.between(0.0, TAU))
        })
        .collect();
    let level = random.between(-0.4, 0.4);
    let gain = 1.0 / (middle * (0.5 * WAVES as f64).sqrt());
    let field = move |p: [f64; 3]| {
        let p = DVec3::from(p);
        let sum: f64 = waves.iter().map(|(k, phase)| libm::sin(k.dot(p) + phase)).sum();
        soft_max(10.0, gain * (sum + level), p.length().max(1e-3) - 1.0)
    };
    level_set(field, 1.1, build)
}

/// A solid in a place of its own.
struct Primitive {
    kind: u32,
    centre: DVec3,
    axes: [DVec3; 3],
    size: [f64; 3],
}

impl Primitive {
    /// At a distance from the origin, and of sizes, between these.
    fn new(random: &mut Proportions, away: [f64; 2], sizes: [f64; 2]) -> Self {
        Self {
            kind: random.count(0, 3),
            centre: random.direction() * random.between(away[0], away[1]),
            axes: random.axes(),
            size: [(); 3].map(|()| random.between(sizes[0], sizes[1])),
        }
    }

    /// About the distance from it, negative inside, with creases rounded over about 1 / k.
    fn field(&self, p: DVec3, k: f64) -> f64 {
        let d = p - self.centre;
        let [x, y, z] = self.axes.map(|a| a.dot(d));
        let [a, b, c] = self.size;
        let round = libm::hypot(x, y).max(1e-3);
        match self.kind {
            0 => soft_max(k, soft_max(k, x.abs() - a, y.abs() - b), z.abs() - c),
            1 => d.length().max(1e-3) - a,
            2 => soft_max(k, round - a, z.abs() - c),
            _ => libm::hypot(round - a, z).max(1e-3) - 0.45 * a,
        }
    }
}

pub(super) fn blend(build: Build) -> TriMesh {
    /// The radius of a ball that is always there.
    const CORE: f64 = 0.3;
    let mut random = build.proportions();
    let k = 1.0 / random.log_between(0.02, 0.15);
    let first = Primitive::new(&mut random, [0.0, 0.1], [0.5, 0.7]);
    let others: Vec<(bool, Primitive)> = (0..random.count(1, 4))
        .map(|_| (random.count(0, 1) == 0, Primitive::new(&mut random, [0.4, 0.8], [0.15, 0.4])))
        .collect();
    let field = move |p: [f64; 3]| {
        let p = DVec3::from(p);
        let distance = p.length().max(1e-3);
        let mut value = first.field(p, k);
        for (added, other) in &others {
            let there = other.field(p, k);
            value = if *added { -soft_max(k, -value, -there) } else { soft_max(k, value, -there) };
        }
        value = -soft_max(k, -value, CORE - distance);
        soft_max(k, value, distance - 1.1)
    };
    level_set(field, 1.15, build)
}
