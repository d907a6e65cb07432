//! Regions of the plane filled with triangles.

use rand_chacha::ChaCha8Rng;

use super::delaunay::{delaunay, scatter};

/// Triangles of a region: its border points come first, as they were given.
pub struct Patch {
    /// The points inside, numbered after the border.
    pub inner: Vec<[f64; 2]>,
    /// The triangles, counter-clockwise.
    pub faces: Vec<[u32; 3]>,
}

/// Fills the region with these borders (the outer one counter-clockwise, holes
/// clockwise; neighbours about `spacing` apart) with a triangular lattice,
/// which a few rounds of averaging fit to the border.
pub fn fill(borders: &[Vec<[f64; 2]>], spacing: f64) -> Patch {
    let mut region = Region::new(borders, 1e-9 * spacing * spacing);
    let [low, high] = region.bounds();
    let rows = ((high[1] - low[1]) / (spacing * 0.75f64.sqrt())).round().max(1.0);
    let step = (high[1] - low[1]) / rows;
    for j in 1..rows as usize {
        let shift = if j % 2 == 1 { 0.5 } else { 0.0 };
        for i in 0..((high[0] - low[0]) / spacing).ceil() as usize + 1 {
            let p = [low[0] + (i as f64 + shift) * spacing, low[1] + j as f64 * step];
            if region.is_clear(p, 0.6 * spacing) && region.is_inside(p) {
                region.points.push(p);
            }
        }
    }
    region.averaged(4)
}

/// Fills the region with random points, neighbours about `size` apart
/// where they are, and averages them `rounds` times.
pub fn fill_scattered(
    borders: &[Vec<[f64; 2]>],
    size: impl Fn([f64; 2]) -> f64,
    rounds: usize,
    rng: &mut ChaCha8Rng,
) -> Patch {
    // Points thrown so that none is closer than r to another are 1.25 r apart
    // in the mean.
    const FRACTION: f64 = 0.8;
    let mut region = Region::new(borders, 0.0);
    let [low, high] = region.bounds();
    let mut smallest = f64::INFINITY;
    for p in &region.points {
        smallest = smallest.min(size(*p));
    }
    for k in 0..256 {
        let at =
            |k: usize, axis: usize| low[axis] + (k as f64 + 0.5) / 16.0 * (high[axis] - low[axis]);
        let p = [at(k % 16, 0), at(k / 16, 1)];
        if region.is_inside(p) {
            smallest = smallest.min(size(p));
        }
    }
    region.least_area = 1e-9 * smallest * smallest;
    let inside = |p: [f64; 2]| {
        (0..2).all(|k| low[k] < p[k] && p[k] < high[k])
            && region.is_clear(p, 0.6 * size(p))
            && region.is_inside(p)
    };
    let square = [low[0].min(low[1]), high[0].max(high[1])];
    let mut points = region.points.clone();
    let spacing = |p| FRACTION * size(p);
    scatter(&mut points, square, FRACTION * smallest, spacing, inside, rng);
    region.points = points;
    region.averaged(rounds)
}

/// A region that is being filled.
struct Region {
    /// The border, then the points inside.
    points: Vec<[f64; 2]>,
    edges: Vec<[u32; 2]>,
    segments: Vec<[[f64; 2]; 2]>,
    bands: Bands,
    /// Twice the area below which a triangle is a line.
    least_area: f64,
}

impl Region {
    fn new(borders: &[Vec<[f64; 2]>], least_area: f64) -> Self {
        let points: Vec<[f64; 2]> = borders.concat();
        let mut edges = vec![];
        for border in borders {
            let first = edges.len() as u32;
            let n = border.len() as u32;
            edges.extend((0..n).map(|i| [first + i, first + (i + 1) % n]));
        }
        let segments: Vec<_> = edges.iter().map(|e| e.map(|v| points[v as usize])).collect();
        let bands = Bands::new(&segments);
        Self { points, edges, segments, bands, least_area }
    }

    fn bounds(&self) -> [[f64; 2]; 2] {
        let low = |k: usize| self.segments.iter().map(|s| s[0][k]).fold(f64::INFINITY, f64::min);
        let high =
            |k: usize| self.segments.iter().map(|s| s[0][k]).fold(f64::NEG_INFINITY, f64::max);
        [[low(0), low(1)], [high(0), high(1)]]
    }

    fn is_inside(&self, p: [f64; 2]) -> bool {
        let band = &self.bands.segments[self.bands.index(p[1])];
        let crossings = band.iter().filter(|&&s| left_of_crossing(p, self.segments[s as usize]));
        crossings.count() % 2 == 1
    }

    /// Returns `true` if the border is farther than `reach`.
    fn is_clear(&self, p: [f64; 2], reach: f64) -> bool {
        let bands = self.bands.index(p[1] - reach)..=self.bands.index(p[1] + reach);
        let near = self.bands.segments[bands].iter().flatten();
        near.into_iter().all(|&s| distance_to(p, self.segments[s as usize]) > reach)
    }

    fn triangulated(&self) -> Vec<[u32; 3]> {
        let mut faces = delaunay(&self.points, &self.edges);
        faces.retain(|f| {
            let corners @ [a, b, c] = f.map(|v| self.points[v as usize]);
            // Border points on a line, but for rounding, leave flat triangles
            // outside of it.
            let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
            let middle = |k: usize| (corners[0][k] + corners[1][k] + corners[2][k]) / 3.0;
            area > self.least_area && self.is_inside([middle(0), middle(1)])
        });
        faces
    }

    /// The triangles after rounds of moving each inner point towards the mean
    /// of its neighbours.
    fn averaged(mut self, rounds: usize) -> Patch {
        let fixed = self.edges.len();
        let mut faces = self.triangulated();
        for _ in 0..rounds {
            let points = &mut self.points;
            let mut sums = vec![[0.0; 3]; points.len()];
            for f in &faces {
                for k in 0..3 {
                    let (v, w) = (f[k] as usize, f[(k + 1) % 3] as usize);
                    sums[v] =
                        [sums[v][0] + points[w][0], sums[v][1] + points[w][1], sums[v][2] + 1.0];
                }
            }
            // Inside, each neighbour comes once, from the face on its left.
            for (p, s) in points.iter_mut().zip(&sums).skip(fixed) {
                *p = [0.5 * (p[0] + s[0] / s[2]), 0.5 * (p[1] + s[1] / s[2])];
            }
            faces = self.triangulated();
        }
        Patch { inner: self.points.split_off(fixed), faces }
    }
}

/// The segments that reach into each of many horizontal bands.
struct Bands {
    low: f64,
    height: f64,
    segments: Vec<Vec<u32>>,
}

impl Bands {
    fn new(segments: &[[[f64; 2]; 2]]) -> Self {
        let ends = || segments.iter().flatten().map(|p| p[1]);
        let low = ends().fold(f64::INFINITY, f64::min);
        let high = ends().fold(f64::NEG_INFINITY, f64::max);
        let count = segments.len().max(1);
        let mut bands =
            Self { low, height: (high - low) / count as f64, segments: vec![vec![]; count] };
        for (s, [a, b]) in segments.iter().enumerate() {
            for band in bands.index(a[1].min(b[1]))..=bands.index(a[1].max(b[1])) {
                bands.segments[band].push(s as u32);
            }
        }
        bands
    }

    /// The band at this height; the first or last beyond them.
    fn index(&self, y: f64) -> usize {
        (((y - self.low) / self.height).max(0.0) as usize).min(self.segments.len() - 1)
    }
}

/// Returns `true` if the segment crosses the ray from `p` along +x.
fn left_of_crossing(p: [f64; 2], [a, b]: [[f64; 2]; 2]) -> bool {
    (a[1] > p[1]) != (b[1] > p[1]) && p[0] < a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
}

/// The distance of a point from a segment.
pub fn distance_to(p: [f64; 2], [a, b]: [[f64; 2]; 2]) -> f64 {
    let (d, q) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let t = ((q[0] * d[0] + q[1] * d[1]) / (d[0] * d[0] + d[1] * d[1])).clamp(0.0, 1.0);
    libm::hypot(q[0] - t * d[0], q[1] - t * d[1])
}
