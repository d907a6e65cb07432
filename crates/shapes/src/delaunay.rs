//! Delaunay triangulations in the plane, and scattered points for them.

use rand::RngExt;
use rand::seq::SliceRandom;
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

/// Darts that miss a cell before it is left.
const DARTS: usize = 24;

/// Throws darts at `[lo, hi]²` and keeps those in `inside` that stay clear of
/// all kept before (`points` included) by the spacing where they land;
/// appends them to `points`.
///
/// `smallest` is at most every spacing. The square is divided into cells with
/// this diagonal, so that a cell with a point is covered by it. In each round
/// every cell without a point gets a dart, in random order; after [`DARTS`]
/// rounds a gap of a tenth of a cell is left once in twelve times, one of half
/// a cell never. The time is proportional to the number of cells.
pub(super) fn scatter(
    points: &mut Vec<[f64; 2]>,
    [lo, hi]: [f64; 2],
    smallest: f64,
    spacing: impl Fn([f64; 2]) -> f64,
    inside: impl Fn([f64; 2]) -> bool,
    rng: &mut ChaCha8Rng,
) {
    let count = ((hi - lo) * std::f64::consts::SQRT_2 / smallest).ceil().max(1.0);
    let side = (hi - lo) / count;
    let count = count as usize;
    let mut grid = Grid { lo, side, count, last: vec![NONE; count * count], before: vec![] };
    for (i, p) in points.iter().enumerate() {
        grid.insert(i, *p);
    }
    let mut open: Vec<u32> = (0..(count * count) as u32).collect();
    for _ in 0..DARTS {
        open.shuffle(rng);
        open.retain(|&cell| {
            if grid.last[cell as usize] != NONE {
                return false;
            }
            let corner = [cell as usize % count, cell as usize / count];
            let p = corner.map(|k| lo + side * (k as f64 + rng.random_range(0.0..1.0)));
            let free = inside(p) && grid.is_clear(points, p, spacing(p));
            if free {
                grid.insert(points.len(), p);
                points.push(p);
            }
            !free
        });
    }
}

/// No point.
const NONE: u32 = u32::MAX;

/// Points in square cells; those of a cell form a list.
struct Grid {
    lo: f64,
    side: f64,
    /// Cells along a side.
    count: usize,
    /// The last point of each cell.
    last: Vec<u32>,
    /// The point before each in its cell.
    before: Vec<u32>,
}

impl Grid {
    fn index(&self, x: f64) -> usize {
        (((x - self.lo) / self.side).max(0.0) as usize).min(self.count - 1)
    }

    fn insert(&mut self, point: usize, p: [f64; 2]) {
        let cell = self.index(p[1]) * self.count + self.index(p[0]);
        self.before.push(std::mem::replace(&mut self.last[cell], point as u32));
    }

    /// Returns `true` if no point is closer than `reach`.
    fn is_clear(&self, points: &[[f64; 2]], p: [f64; 2], reach: f64) -> bool {
        let range = |x: f64| self.index(x - reach)..=self.index(x + reach);
        range(p[1]).all(|j| {
            range(p[0]).all(|i| {
                let mut q = self.last[j * self.count + i];
                while q != NONE {
                    let [x, y] = points[q as usize];
                    let (x, y) = (x - p[0], y - p[1]);
                    if x * x + y * y < reach * reach {
                        return false;
                    }
                    q = self.before[q as usize];
                }
                true
            })
        })
    }
}
