//! Models built from faces that meet in their edges.

use fairing_mesh::TriMesh;
use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::build::Triangulation;
use super::build::made;
use fairing_shapes::outline::Piece;
use fairing_shapes::patch::{Patch, fill, fill_scattered};

/// The longer side over the shorter of stretched triangles.
const ASPECT: f64 = 3.0;

/// The factor on the length of edges along straight lines where
/// triangles are stretched.
const ALONG_LINES: f64 = 2.0;

/// A model as it grows: corners, curves between them that are sampled once, and
/// faces whose borders are curves. So every crease is a line of mesh edges.
pub(super) struct Solid {
    spacing: f64,
    triangulation: Triangulation,
    rng: ChaCha8Rng,
    positions: Vec<[f64; 3]>,
    faces: Vec<[u32; 3]>,
    /// The factor on lengths if the model is bent afterwards.
    stretch: Option<Stretch>,
}

/// Lengths after bending over lengths before, at a point before.
type Stretch = Box<dyn Fn([f64; 3]) -> f64>;

/// The vertices of a curve, its ends included.
pub(super) type Curve = Vec<u32>;

/// A face of a model, laid out in the plane so that counter-clockwise there is
/// counter-clockwise seen from outside.
pub(super) struct Chart<'a> {
    /// The position of a point of the border.
    pub(super) to_plane: Box<dyn Fn([f64; 3]) -> [f64; 2] + 'a>,
    pub(super) to_space: Box<dyn Fn([f64; 2]) -> [f64; 3] + 'a>,
    /// `true` if lengths in the chart are lengths in space.
    pub(super) isometric: bool,
}

impl Chart<'_> {
    /// The plane through `origin` with this outward normal, its y axis along
    /// `up` as far as that lies in the plane.
    pub(super) fn plane(
        origin: impl Into<DVec3>,
        normal: impl Into<DVec3>,
        up: impl Into<DVec3>,
    ) -> Self {
        let (origin, normal, up) = (origin.into(), normal.into(), up.into());
        let y = up - (normal * up.dot(normal));
        let y = y * (1.0 / y.length());
        let x = y.cross(normal);
        Self {
            to_plane: Box::new(move |p| {
                let d = DVec3::from(p) - origin;
                [d.dot(x), d.dot(y)]
            }),
            to_space: Box::new(move |[s, t]| [0, 1, 2].map(|k| origin[k] + s * x[k] + t * y[k])),
            isometric: true,
        }
    }

    /// Lengths in space over lengths in the plane, the mean over directions.
    fn scale_at(&self, [x, y]: [f64; 2], step: f64) -> f64 {
        let at = |x, y| DVec3::from((self.to_space)([x, y]));
        let p = at(x, y);
        let along = at(x + step, y) - p;
        let across = at(x, y + step) - p;
        (along.cross(across).length() / (step * step)).sqrt()
    }
}

/// The curve from its other end.
pub(super) fn reversed(curve: &[u32]) -> Curve {
    curve.iter().rev().copied().collect()
}

/// The closed border that follows these curves, the end of each the start of
/// the next.
pub(super) fn joined(curves: &[&[u32]]) -> Curve {
    curves.iter().flat_map(|c| &c[..c.len() - 1]).copied().collect()
}

impl Solid {
    /// An empty solid, whose edges are to be about `spacing` long.
    pub(super) fn new(build: super::build::Build) -> Self {
        let super::build::Build { spacing, triangulation, seed, .. } = build;
        let rng = ChaCha8Rng::seed_from_u64(seed);
        Self { spacing, triangulation, rng, positions: vec![], faces: vec![], stretch: None }
    }

    /// The same, for a sheet that is built in the plane z = 0 and then bent by `map`.
    pub(super) fn flat(
        build: super::build::Build,
        map: impl Fn([f64; 2]) -> [f64; 3] + 'static,
    ) -> Self {
        let stretch = move |[x, y, _]: [f64; 3]| {
            const STEP: f64 = 1e-4;
            let at = |x, y| DVec3::from(map([x, y]));
            let p = at(x, y);
            let along = at(x + STEP, y) - p;
            let across = at(x, y + STEP) - p;
            (along.cross(across).length() / (STEP * STEP)).sqrt()
        };
        let mut solid = Self::new(build);
        solid.stretch = Some(Box::new(stretch));
        solid
    }

    pub(super) fn finished(self) -> TriMesh {
        made(self.positions, self.faces)
    }

    pub(super) fn at(&self, v: u32) -> [f64; 3] {
        self.positions[v as usize]
    }

    pub(super) fn corner(&mut self, p: [f64; 3]) -> u32 {
        self.positions.push(p);
        self.positions.len() as u32 - 1
    }

    /// The length of edges near a point.
    fn size(&self, p: [f64; 3]) -> f64 {
        let size = match self.triangulation {
            Triangulation::Graded => self.spacing * super::build::grading(p),
            _ => self.spacing,
        };
        self.stretch.as_ref().map_or(size, |stretch| size / stretch(p))
    }

    /// The straight line between two corners.
    pub(super) fn line(&mut self, from: u32, to: u32) -> Curve {
        let (p, q) = (self.at(from), self.at(to));
        let stretch = match self.triangulation {
            Triangulation::Anisotropic => ALONG_LINES,
            _ => 1.0,
        };
        self.sampled(from, to, stretch, |t| [0, 1, 2].map(|k| p[k] + t * (q[k] - p[k])))
    }

    /// The curve `at(t)`, 0 ≤ t ≤ 1, between two corners.
    pub(super) fn curve(&mut self, from: u32, to: u32, at: impl Fn(f64) -> [f64; 3]) -> Curve {
        self.sampled(from, to, 1.0, at)
    }

    /// A piece of an outline, put into space.
    pub(super) fn piece(
        &mut self,
        (from, to): (u32, u32),
        piece: Piece,
        lift: impl Fn([f64; 2]) -> [f64; 3],
    ) -> Curve {
        if piece.is_straight() && self.triangulation == Triangulation::Anisotropic {
            return self.sampled(from, to, ALONG_LINES, |t| lift(piece.at(t)));
        }
        self.curve(from, to, |t| lift(piece.at(t)))
    }

    fn sampled(&mut self, from: u32, to: u32, stretch: f64, at: impl Fn(f64) -> [f64; 3]) -> Curve {
        const PARTS: usize = 96;
        // The number of edges up to each of these parts.
        let mut counts = vec![0.0];
        for k in 0..PARTS {
            let [a, b] = [k, k + 1].map(|k| DVec3::from(at(k as f64 / PARTS as f64)));
            let middle = (0.5 * (a + b)).into();
            counts.push(counts[k] + a.distance(b) / (stretch * self.size(middle)));
        }
        let total = counts[PARTS];
        let n = total.round().max(1.0);
        let mut curve = vec![from];
        let mut k = 0;
        for i in 1..n as usize {
            let shift = match self.triangulation {
                Triangulation::Irregular => self.rng.random_range(-0.2..0.2),
                _ => 0.0,
            };
            let wanted = (i as f64 + shift) / n * total;
            while counts[k + 1] < wanted {
                k += 1;
            }
            let fraction = (wanted - counts[k]) / (counts[k + 1] - counts[k]);
            let p = at((k as f64 + fraction) / PARTS as f64);
            curve.push(self.corner(p));
        }
        curve.push(to);
        curve
    }

    /// Fills a face with these borders, the outer one first.
    pub(super) fn face(&mut self, borders: &[Curve], chart: &Chart<'_>) {
        let long = match self.triangulation {
            Triangulation::Anisotropic => ASPECT,
            _ => 1.0,
        };
        let flat = |p: [f64; 3]| {
            let [x, y] = (chart.to_plane)(p);
            [x, y / long]
        };
        let lifted = |[x, y]: [f64; 2]| (chart.to_space)([x, long * y]);
        let outlines: Vec<Vec<[f64; 2]>> =
            borders.iter().map(|b| b.iter().map(|&v| flat(self.at(v))).collect()).collect();
        let even = chart.isometric
            && self.triangulation != Triangulation::Graded
            && self.stretch.is_none();
        let patch = if even && self.triangulation != Triangulation::Irregular {
            fill(&outlines, self.spacing)
        } else {
            self.scattered(&outlines, chart, long)
        };
        let base = self.positions.len() as u32;
        let border = borders.concat();
        self.positions.extend(patch.inner.iter().map(|&p| lifted(p)));
        let known = border.len() as u32;
        let id = |v: u32| if v < known { border[v as usize] } else { base + v - known };
        self.faces.extend(patch.faces.iter().map(|f| f.map(id)));
    }

    fn scattered(&mut self, outlines: &[Vec<[f64; 2]>], chart: &Chart<'_>, long: f64) -> Patch {
        let extent = outlines[0]
            .iter()
            .flat_map(|p| [(p[0] - outlines[0][0][0]).abs(), (p[1] - outlines[0][0][1]).abs()])
            .fold(0.0, f64::max);
        let mut rng = self.rng.clone();
        let size = |[x, y]: [f64; 2]| {
            let q = [x, long * y];
            let in_space = self.size((chart.to_space)(q));
            if chart.isometric { in_space } else { in_space / chart.scale_at(q, 1e-4 * extent) }
        };
        let rounds = if self.triangulation == Triangulation::Irregular { 1 } else { 5 };
        let patch = fill_scattered(outlines, size, rounds, &mut rng);
        self.rng = rng;
        patch
    }
}
