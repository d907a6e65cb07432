//! Even meshes of smooth implicit surfaces.

use rayon::prelude::*;

use super::grid::made;
use fairing_mesh::TriMesh;
use glam::DVec3;

/// Step of the central differences of a field of size about 1: the cube root
/// of the unit roundoff balances truncation against cancellation.
const STEP: f64 = 1e-5;

/// Rounds of tangential averaging; more no longer change the angles much.
const ROUNDS: usize = 12;

/// The surface `field` = 0 inside the cube `[−half, half]³`, negative inside,
/// in nearly equal triangles about `2 half / resolution` wide, with vertices
/// on the surface to about 1e-12.
///
/// Surface nets (a vertex in each cell of a grid that the surface passes, a
/// square around each edge that it cuts) of the nodes inside, made
/// well-composed so that the net is a manifold; then vertices averaged along
/// the surface and put back onto it by Newton's method. Vertices and faces
/// follow the cells: z slowest, then y, x. Sources: [gibson1998],
/// [latecki1997].
///
/// [gibson1998]: https://doi.org/10.1007/BFb0056277
/// [latecki1997]: https://doi.org/10.1006/gmip.1997.0422
pub fn implicit(field: impl Fn([f64; 3]) -> f64 + Sync, half: f64, resolution: usize) -> TriMesh {
    let grid = Grid { n: resolution, half, cell: 2.0 * half / resolution as f64 };
    let nodes = (resolution + 1).pow(3);
    let values: Vec<f64> =
        (0..nodes).into_par_iter().map(|node| field(grid.point(grid.steps(node)))).collect();
    let inside = well_composed(&values, resolution);
    let (ids, positions) = grid.vertices(&inside, &field);
    let faces = grid.faces(&inside, &ids, &positions);
    relaxed(&made(positions, faces), &field, grid.cell)
}

/// A grid of n³ cells over the cube; nodes and cells are numbered x first.
struct Grid {
    n: usize,
    half: f64,
    cell: f64,
}

impl Grid {
    /// The number of the node, or of the cell that begins at it.
    fn at(&self, [i, j, k]: [usize; 3]) -> usize {
        (k * (self.n + 1) + j) * (self.n + 1) + i
    }

    /// The steps to a node along each axis.
    fn steps(&self, node: usize) -> [usize; 3] {
        let side = self.n + 1;
        [node % side, node / side % side, node / side.pow(2)]
    }

    fn point(&self, steps: [usize; 3]) -> [f64; 3] {
        steps.map(|k| k as f64 * self.cell - self.half)
    }

    /// A vertex on the surface for each cell that it passes, and the number of
    /// the vertex of each cell.
    fn vertices(
        &self,
        inside: &[bool],
        field: &impl Fn([f64; 3]) -> f64,
    ) -> (Vec<u32>, Vec<[f64; 3]>) {
        let mut ids = vec![u32::MAX; inside.len()];
        let mut positions = vec![];
        for cell in (0..inside.len()).map(|node| self.steps(node)) {
            let [i, j, k] = cell;
            if cell.contains(&self.n) {
                continue;
            }
            let corners = (0..8)
                .filter(|b| inside[self.at([i + (b & 1), j + (b >> 1 & 1), k + (b >> 2)])])
                .count();
            if corners != 0 && corners != 8 {
                ids[self.at(cell)] = positions.len() as u32;
                let middle = self.point(cell).map(|x| x + 0.5 * self.cell);
                positions.push(onto(field, middle, self.cell));
            }
        }
        (ids, positions)
    }

    /// A square, cut in two, around each edge of the grid that the surface
    /// cuts.
    fn faces(&self, inside: &[bool], ids: &[u32], positions: &[[f64; 3]]) -> Vec<[u32; 3]> {
        let mut faces = vec![];
        for node in (0..inside.len()).map(|node| self.steps(node)) {
            let [i, j, k] = node;
            if node.contains(&0) || node.contains(&self.n) {
                continue;
            }
            let here = inside[self.at(node)];
            // The cells around the edge to the next node along each axis,
            // counter-clockwise seen from that node.
            let around = [
                [[i, j - 1, k - 1], [i, j, k - 1], [i, j, k], [i, j - 1, k]],
                [[i - 1, j, k - 1], [i - 1, j, k], [i, j, k], [i, j, k - 1]],
                [[i - 1, j - 1, k], [i, j - 1, k], [i, j, k], [i - 1, j, k]],
            ];
            let next = [[i + 1, j, k], [i, j + 1, k], [i, j, k + 1]];
            for axis in 0..3 {
                if inside[self.at(next[axis])] == here {
                    continue;
                }
                let mut q = around[axis].map(|cell| ids[self.at(cell)]);
                if !here {
                    q.reverse();
                }
                let [a, b, c, d] = q.map(|v| DVec3::from(positions[v as usize]));
                faces.extend(super::grid::square(q, a.distance(c) <= b.distance(d)));
            }
        }
        faces
    }
}

/// The nodes where the field is negative, and a few more: no square of the
/// grid keeps only two opposite corners inside or outside, and no cube only
/// two opposite ones. Of the nodes that prevent this the one closest to the
/// surface becomes an inner one, until there is none.
fn well_composed(values: &[f64], n: usize) -> Vec<bool> {
    let mut inside: Vec<bool> = values.iter().map(|&f| f < 0.0).collect();
    let strides = [1, n + 1, (n + 1) * (n + 1)];
    // Corners as sums of strides; in each pattern the first two are opposite.
    let mut patterns: Vec<Vec<usize>> = vec![];
    for (a, b) in [(0, 1), (1, 2), (0, 2)] {
        let [s, t] = [strides[a], strides[b]];
        patterns.push(vec![0, s + t, s, t]);
        patterns.push(vec![s, t, 0, s + t]);
    }
    let corner = |b: usize| (0..3).map(|k| (b >> k & 1) * strides[k]).sum();
    for b in 0..4 {
        let rest = (0..8).filter(|&c| c != b && c != 7 - b);
        patterns.push([b, 7 - b].into_iter().chain(rest).map(corner).collect());
    }
    loop {
        let mut changed = false;
        // The outermost nodes are outside, and cells beyond them not needed.
        for start in 0..values.len() - strides.iter().sum::<usize>() {
            for pattern in &patterns {
                let is = |p: usize| inside[start + p];
                let split = |value: bool| {
                    pattern[..2].iter().all(|&p| is(p) == value)
                        && pattern[2..].iter().all(|&p| is(p) != value)
                };
                let candidates = match (split(true), split(false)) {
                    (true, _) => &pattern[2..],
                    (_, true) => &pattern[..2],
                    _ => continue,
                };
                let nearest = candidates
                    .iter()
                    .min_by(|&&p, &&q| values[start + p].total_cmp(&values[start + q]));
                if let Some(&p) = nearest {
                    inside[start + p] = true;
                    changed = true;
                }
            }
        }
        if !changed {
            return inside;
        }
    }
}

/// Vertices averaged along the surface.
fn relaxed(mesh: &TriMesh, field: &(impl Fn([f64; 3]) -> f64 + Sync), cell: f64) -> TriMesh {
    let topology = mesh.topology();
    let mut x = mesh.positions().to_vec();
    for _ in 0..ROUNDS {
        x = (0..x.len())
            .into_par_iter()
            .map(|v| {
                let ring = topology.neighbors(v as u32);
                let sum: DVec3 = ring.iter().map(|&w| DVec3::from(x[w as usize])).sum();
                let pull = sum * (1.0 / ring.len() as f64) - DVec3::from(x[v]);
                let g = gradient(field, x[v]);
                let along = pull.dot(g) / g.dot(g);
                onto(field, (DVec3::from(x[v]) + 0.6 * (pull - along * g)).to_array(), cell)
            })
            .collect();
    }
    made(x, mesh.faces().to_vec())
}

/// A point of the surface `field` = 0 near `p`: Newton's method along the gradient, no step longer
/// than half a cell.
pub fn onto(field: &impl Fn([f64; 3]) -> f64, mut p: [f64; 3], cell: f64) -> [f64; 3] {
    for _ in 0..12 {
        let (f, g) = (field(p), gradient(field, p));
        let step = g * (f / g.dot(g).max(1e-12));
        let length = step.length();
        p = (DVec3::from(p) - (0.5 * cell / length.max(1e-300)).min(1.0) * step).to_array();
        if length < 1e-14 {
            break;
        }
    }
    p
}

fn gradient(field: &impl Fn([f64; 3]) -> f64, p: [f64; 3]) -> DVec3 {
    let slope = |k: usize| {
        let (mut a, mut b) = (p, p);
        a[k] -= STEP;
        b[k] += STEP;
        (field(b) - field(a)) / (2.0 * STEP)
    };
    DVec3::new(slope(0), slope(1), slope(2))
}
