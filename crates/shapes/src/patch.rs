//! Regions of the plane filled with nearly equal triangles.

use super::delaunay::delaunay;

/// Triangles of a region: its border points come first, as they were given.
pub(super) struct Patch {
    /// The points inside, numbered after the border.
    pub(super) inner: Vec<[f64; 2]>,
    pub(super) faces: Vec<[u32; 3]>,
}

/// Fills the region with these borders (the outer one counter-clockwise, holes
/// clockwise; neighbours about `spacing` apart) with a triangular lattice,
/// which a few rounds of averaging fit to the border.
pub(super) fn fill(borders: &[Vec<[f64; 2]>], spacing: f64) -> Patch {
    let mut points: Vec<[f64; 2]> = borders.concat();
    let fixed = points.len();
    let mut edges = vec![];
    for border in borders {
        let first = edges.len() as u32;
        let n = border.len() as u32;
        edges.extend((0..n).map(|i| [first + i, first + (i + 1) % n]));
    }
    let segments: Vec<[[f64; 2]; 2]> =
        edges.iter().map(|e| e.map(|v| points[v as usize])).collect();
    let inside =
        |p: [f64; 2]| segments.iter().filter(|s| left_of_crossing(p, **s)).count() % 2 == 1;

    let low = |k: usize| segments.iter().map(|s| s[0][k]).fold(f64::INFINITY, f64::min);
    let high = |k: usize| segments.iter().map(|s| s[0][k]).fold(f64::NEG_INFINITY, f64::max);
    let rows = ((high(1) - low(1)) / (spacing * 0.75f64.sqrt())).round().max(1.0);
    let step = (high(1) - low(1)) / rows;
    for j in 1..rows as usize {
        let shift = if j % 2 == 1 { 0.5 } else { 0.0 };
        for i in 0..((high(0) - low(0)) / spacing).ceil() as usize + 1 {
            let p = [low(0) + (i as f64 + shift) * spacing, low(1) + j as f64 * step];
            let clear = segments.iter().all(|s| distance_to(p, *s) > 0.6 * spacing);
            if clear && inside(p) {
                points.push(p);
            }
        }
    }

    let triangulate = |points: &[[f64; 2]]| -> Vec<[u32; 3]> {
        let mut faces = delaunay(points, &edges);
        faces.retain(|f| {
            let corners @ [a, b, c] = f.map(|v| points[v as usize]);
            // Border points on a line, but for rounding, leave flat triangles
            // outside of it.
            let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
            area > 1e-9 * spacing * spacing
                && inside([0, 1].map(|k| (corners[0][k] + corners[1][k] + corners[2][k]) / 3.0))
        });
        faces
    };
    let mut faces = triangulate(&points);
    for _ in 0..4 {
        let mut sums = vec![[0.0; 3]; points.len()];
        for f in &faces {
            for k in 0..3 {
                let (v, w) = (f[k] as usize, f[(k + 1) % 3] as usize);
                sums[v] = [sums[v][0] + points[w][0], sums[v][1] + points[w][1], sums[v][2] + 1.0];
            }
        }
        // Inside, each neighbour comes once, from the face on its left.
        for (p, s) in points.iter_mut().zip(&sums).skip(fixed) {
            *p = [0.5 * (p[0] + s[0] / s[2]), 0.5 * (p[1] + s[1] / s[2])];
        }
        faces = triangulate(&points);
    }
    Patch { inner: points.split_off(fixed), faces }
}

/// Whether the segment crosses the ray from `p` along +x.
fn left_of_crossing(p: [f64; 2], [a, b]: [[f64; 2]; 2]) -> bool {
    (a[1] > p[1]) != (b[1] > p[1]) && p[0] < a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
}

fn distance_to(p: [f64; 2], [a, b]: [[f64; 2]; 2]) -> f64 {
    let (d, q) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let t = ((q[0] * d[0] + q[1] * d[1]) / (d[0] * d[0] + d[1] * d[1])).clamp(0.0, 1.0);
    libm::hypot(q[0] - t * d[0], q[1] - t * d[1])
}
