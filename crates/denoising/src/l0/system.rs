//! The matrix of a step of L0 minimisation.

use rayon::prelude::*;

use super::stencils::{FOLD, Stencils};

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
        let rows: Vec<Vec<u32>> = (0..n)
            .into_par_iter()
            .with_min_len(ROWS)
            .map(|v| {
                let corners = stencils.at(v).flat_map(|(e, _)| stencils.corners[e]);
                let mut row: Vec<u32> = corners.chain([v as u32]).collect();
                row.sort_unstable();
                row.dedup();
                row
            })
            .collect();
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
        let slots = stencils
            .corners
            .par_iter()
            .map(|c| std::array::from_fn(|k| slot(c[k / 4], c[k % 4])))
            .collect();
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

#[cfg(test)]
mod tests {
    use fairing_shapes as shapes;
    use glam::DVec3;

    use super::super::stencils::combine;
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
