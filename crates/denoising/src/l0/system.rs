//! The edge operators of L0 minimisation, and the matrix of a step.

use fairing_mesh::TriMesh;
use fairing_watch::parallel;
use glam::DVec3;

use crate::faces::{Hinge, Hinges};

/// `I + β DᵀD + α RᵀR` by rows, with a fixed pattern: all corners of the
/// hinges at a vertex.
pub(super) struct System {
    offsets: Vec<u32>,
    columns: Vec<u32>,
    values: Vec<f64>,
    /// The index of the diagonal of each row.
    diagonal: Vec<u32>,
    /// The index to which each pair of corners of a hinge is added, row by row.
    slots: Vec<[u32; 16]>,
}

/// The least number of rows for a thread.
const ROWS: usize = 2048;

impl System {
    pub(super) fn new(stencils: &Stencils) -> Self {
        let n = stencils.offsets.len() - 1;
        let rows: Vec<Vec<u32>> = parallel::map(n, ROWS, |v| {
            let corners = stencils.at(v).flat_map(|(e, _)| stencils.corners[e]);
            let mut row: Vec<u32> = corners.chain([v as u32]).collect();
            row.sort_unstable();
            row.dedup();
            row
        });
        let mut offsets = vec![0u32; n + 1];
        for (v, row) in rows.iter().enumerate() {
            offsets[v + 1] = offsets[v] + row.len() as u32;
        }
        let columns = rows.concat();
        // Every pair of corners of a hinge is in the pattern.
        let slot = |i: u32, j: u32| {
            let start = offsets[i as usize];
            start + rows[i as usize].partition_point(|&c| c < j) as u32
        };
        let diagonal = (0..n as u32).map(|v| slot(v, v)).collect();
        let slots = parallel::map(stencils.corners.len(), 64, |i| {
            let c = &stencils.corners[i];
            std::array::from_fn(|k| slot(c[k / 4], c[k % 4]))
        });
        Self { values: vec![0.0; columns.len()], offsets, columns, diagonal, slots }
    }

    /// Takes new coefficients of D, β and α.
    pub(super) fn fill(&mut self, weights: &[[f64; 4]], beta: f64, alpha: f64) {
        self.values.fill(0.0);
        for &d in &self.diagonal {
            self.values[d as usize] = 1.0;
        }
        for (slots, w) in self.slots.iter().zip(weights) {
            for (k, &slot) in slots.iter().enumerate() {
                let (i, j) = (k / 4, k % 4);
                self.values[slot as usize] += beta * w[i] * w[j] + alpha * FOLD[i] * FOLD[j];
            }
        }
    }

    pub(super) fn diagonal(&self) -> Vec<f64> {
        self.diagonal.iter().map(|&d| self.values[d as usize]).collect()
    }

    /// Row `v` of the product with x.
    #[inline]
    pub(super) fn row(&self, v: usize, x: &[[f64; 3]]) -> [f64; 3] {
        let row = self.offsets[v] as usize..self.offsets[v + 1] as usize;
        let mut sum = [0.0; 3];
        for (&c, &a) in self.columns[row.clone()].iter().zip(&self.values[row]) {
            let x = x[c as usize];
            for k in 0..3 {
                sum[k] += a * x[k];
            }
        }
        sum
    }
}

/// The regulariser's coefficients.
pub(super) const FOLD: [f64; 4] = [1.0, -1.0, 1.0, -1.0];

/// The four corners of each hinge, and the hinges at each vertex.
pub(super) struct Stencils {
    /// Ends at 0 and 2, the opposite corners at 1 and 3.
    pub(super) corners: Vec<[u32; 4]>,
    pub(super) offsets: Vec<u32>,
    /// `4 × hinge + place`, ascending at each vertex.
    places: Vec<u32>,
}

impl Stencils {
    pub(super) fn new(mesh: &TriMesh, hinges: &Hinges) -> Self {
        let corners: Vec<[u32; 4]> = hinges
            .all
            .iter()
            .map(|&Hinge { faces, ends: [a, b] }| {
                let [c, d] = faces.map(|f| {
                    let [i, j, k] = mesh.faces()[f as usize];
                    // The corner that is neither end.
                    [i, j, k].into_iter().find(|&v| v != a && v != b).unwrap_or(i)
                });
                [a, c, b, d]
            })
            .collect();
        let mut offsets = vec![0u32; mesh.vertex_count() + 1];
        for &v in corners.as_flattened() {
            offsets[v as usize + 1] += 1;
        }
        for v in 0..mesh.vertex_count() {
            offsets[v + 1] += offsets[v];
        }
        let mut next = offsets.clone();
        let mut places = vec![0; corners.len() * 4];
        for (place, &v) in corners.as_flattened().iter().enumerate() {
            places[next[v as usize] as usize] = place as u32;
            next[v as usize] += 1;
        }
        Self { corners, offsets, places }
    }

    /// The hinges at vertex `v`, and which of their corners it is.
    pub(super) fn at(&self, v: usize) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.places[self.offsets[v] as usize..self.offsets[v + 1] as usize]
            .iter()
            .map(|&p| (p as usize / 4, p as usize % 4))
    }

    /// The coefficients of the area-based edge operator at the given
    /// positions; zero for a hinge whose edge or faces have no size.
    pub(super) fn edge_operators(&self, positions: &[[f64; 3]]) -> Vec<[f64; 4]> {
        parallel::map(self.corners.len(), 64, |i| {
            let corners = &self.corners[i];
            let [p1, p2, p3, p4] = corners.map(|v| DVec3::from(positions[v as usize]));
            let edge = p3 - p1;
            let area = |p: DVec3| 0.5 * (p - p1).cross(edge).length();
            let (a2, a4) = (area(p2), area(p4));
            let scale = edge.dot(edge) * (a2 + a4);
            if scale.is_nan() || scale <= f64::MIN_POSITIVE {
                return [0.0; 4];
            }
            // Where the feet of p₂ and p₄ lie along the edge, from p₃.
            let (t2, t4) = ((p3 - p2).dot(edge), (p3 - p4).dot(edge));
            let (s2, s4) = ((p2 - p1).dot(edge), (p4 - p1).dot(edge));
            [
                -(a4 * t2 + a2 * t4) / scale,
                a4 / (a2 + a4),
                -(a4 * s2 + a2 * s4) / scale,
                a2 / (a2 + a4),
            ]
        })
    }

    /// `Dᵀ values`.
    pub(super) fn transpose(&self, weights: &[[f64; 4]], values: &[DVec3]) -> Vec<DVec3> {
        parallel::map(self.offsets.len() - 1, 64, |v| {
            self.at(v).map(|(e, k)| weights[e][k] * values[e]).sum()
        })
    }
}

/// `Σ w x` over four corners.
pub(super) fn combine(corners: &[u32; 4], weights: &[f64; 4], x: &[[f64; 3]]) -> DVec3 {
    (0..4).map(|k| weights[k] * DVec3::from(x[corners[k] as usize])).sum()
}

#[cfg(test)]
mod tests {
    use fairing_shapes as shapes;
    use glam::DVec3;

    use super::*;
    use crate::faces::Hinges;

    /// Against the sum over hinges, also where two faces share all their corners.
    #[test]
    fn the_matrix_is_the_sum_over_hinges() {
        let pillow = fairing_mesh::TriMesh::new(
            vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            vec![[0, 1, 2], [0, 2, 1]],
        )
        .unwrap();
        for mesh in [shapes::cad_block(0.3), pillow] {
            let stencils = Stencils::new(&mesh, &Hinges::new(&mesh));
            let weights = stencils.edge_operators(mesh.positions());
            let (beta, alpha) = (3.0, 0.7);
            let mut system = System::new(&stencils);
            system.fill(&weights, 1.0, 1.0);
            system.fill(&weights, beta, alpha);
            let x: Vec<[f64; 3]> =
                (0..mesh.vertex_count()).map(|v| [v as f64, 1.0, (v * v) as f64]).collect();
            let mut expected = x.clone();
            for (corners, w) in stencils.corners.iter().zip(&weights) {
                for (w, factor) in [(w, beta), (&FOLD, alpha)] {
                    let bend = factor * combine(corners, w, &x);
                    for (k, &v) in corners.iter().enumerate() {
                        let expected = &mut expected[v as usize];
                        *expected = (DVec3::from(*expected) + w[k] * bend).to_array();
                    }
                }
            }
            let size = expected.as_flattened().iter().fold(0.0, |m: f64, x| m.max(x.abs()));
            let product: Vec<_> = (0..x.len()).map(|v| system.row(v, &x)).collect();
            for (a, b) in product.as_flattened().iter().zip(expected.as_flattened()) {
                assert!((a - b).abs() <= 1e-12 * size, "{a} {b}");
            }
            let unit: Vec<[f64; 3]> =
                (0..mesh.vertex_count()).map(|v| [f64::from(u8::from(v == 1)), 0.0, 0.0]).collect();
            assert_eq!(system.row(1, &unit)[0], system.diagonal()[1]);
        }
    }
}
