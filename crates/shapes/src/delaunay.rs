//! Delaunay triangulations in the plane, and scattered points for them.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};

/// The Delaunay triangles of the points, counter-clockwise, keeping the edges
/// given.
///
/// # Panics
///
/// If points coincide or edges cross: the shapes that call this place them
/// apart.
pub(super) fn delaunay(points: &[[f64; 2]], edges: &[[u32; 2]]) -> Vec<[u32; 3]> {
    let vertices: Vec<_> = points.iter().map(|p| Point2::new(p[0], p[1])).collect();
    let edges = edges.iter().map(|e| e.map(|v| v as usize)).collect();
    match ConstrainedDelaunayTriangulation::<Point2<f64>>::bulk_load_cdt(vertices, edges) {
        Ok(triangulation) => {
            assert_eq!(triangulation.num_vertices(), points.len(), "two points coincide");
            triangulation
                .inner_faces()
                .map(|f| f.vertices().map(|v| v.fix().index() as u32))
                .collect()
        }
        Err(error) => panic!("the points of a shape have no triangulation: {error}"),
    }
}

/// Throws darts at `[lo, hi]²` and keeps those in `inside` that stay clear of
/// all kept before (`points` included) by the spacing where they land;
/// appends them to `points`.
///
/// Stops after ten misses in a row for each point, and a thousand: then gaps
/// wider than twice the spacing are rare.
pub(super) fn scatter(
    points: &mut Vec<[f64; 2]>,
    [lo, hi]: [f64; 2],
    smallest: f64,
    spacing: impl Fn([f64; 2]) -> f64,
    inside: impl Fn([f64; 2]) -> bool,
    rng: &mut ChaCha8Rng,
) {
    // Buckets of the smallest spacing; darts look as far as theirs reaches.
    let cells = ((hi - lo) / smallest).ceil().max(1.0) as usize;
    let cell = |x: f64| (((x - lo) / (hi - lo) * cells as f64).max(0.0) as usize).min(cells - 1);
    let mut buckets: Vec<Vec<u32>> = vec![vec![]; cells * cells];
    for (i, p) in points.iter().enumerate() {
        buckets[cell(p[1]) * cells + cell(p[0])].push(i as u32);
    }
    let mut misses = 0;
    while misses < 10 * points.len() + 1000 {
        let p = [rng.random_range(lo..hi), rng.random_range(lo..hi)];
        let reach = spacing(p);
        let mut free = inside(p);
        if free {
            'search: for j in cell(p[1] - reach)..=cell(p[1] + reach) {
                for i in cell(p[0] - reach)..=cell(p[0] + reach) {
                    for &q in &buckets[j * cells + i] {
                        let q = points[q as usize];
                        if (p[0] - q[0]).hypot(p[1] - q[1]) < reach {
                            free = false;
                            break 'search;
                        }
                    }
                }
            }
        }
        if free {
            misses = 0;
            buckets[cell(p[1]) * cells + cell(p[0])].push(points.len() as u32);
            points.push(p);
        } else {
            misses += 1;
        }
    }
}
