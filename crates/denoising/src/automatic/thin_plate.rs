//! Thin-plate smoothing with the random-walk Laplacian.

use fairing_mesh::TriMesh;
use fairing_mesh::vec3::{add, scale, sub};
use fairing_sparse::{Cholesky, SparseMatrix};
use rayon::prelude::*;

use crate::DenoiseError;
use crate::conjugate_gradients::conjugate_gradients;

/// The relative residual of the displacements, which are of the size of the
/// noise: what is left over is far below it.
const TOLERANCE: f64 = 1e-4;

/// Iterations after which a direct solution is quicker. With weights of one
/// the condition number is below 2.3 λ and some hundred iterations do; small
/// weights make it large.
const ITERATIONS: usize = 400;

/// The relative residual that a direct solution must reach.
const DIRECT: f64 = 1e-6;

/// The rows of L, each an average over some neighbours minus the vertex, and
/// its columns; and the weights of the data.
pub(super) struct ThinPlate {
    /// One per vertex, positive; one at first.
    pub(super) weights: Vec<f64>,
    offsets: Vec<u32>,
    items: Vec<u32>,
    /// One over the length of each row, zero for an empty one.
    shares: Vec<f64>,
    column_offsets: Vec<u32>,
    columns: Vec<u32>,
}

impl ThinPlate {
    /// The rows of border vertices see the neighbours along the border only.
    pub(super) fn new(mesh: &TriMesh) -> Self {
        let topology = mesh.topology();
        let count = mesh.vertex_count();
        let (mut offsets, mut items) = (vec![0u32], vec![]);
        for v in 0..count as u32 {
            let border = topology.is_boundary_vertex(v);
            items.extend(topology.neighbors(v).iter().copied().filter(|&w| {
                !border || topology.edge_between(v, w).is_some_and(|e| topology.is_boundary_edge(e))
            }));
            offsets.push(items.len() as u32);
        }
        let shares = offsets
            .windows(2)
            .map(|w| if w[1] > w[0] { 1.0 / f64::from(w[1] - w[0]) } else { 0.0 })
            .collect();
        let mut column_offsets = vec![0u32; count + 1];
        for &w in &items {
            column_offsets[w as usize + 1] += 1;
        }
        for v in 0..count {
            column_offsets[v + 1] += column_offsets[v];
        }
        let mut next = column_offsets.clone();
        let mut columns = vec![0; items.len()];
        for v in 0..count {
            for &w in &items[offsets[v] as usize..offsets[v + 1] as usize] {
                columns[next[w as usize] as usize] = v as u32;
                next[w as usize] += 1;
            }
        }
        Self { weights: vec![1.0; count], offsets, items, shares, column_offsets, columns }
    }

    fn row(&self, v: usize) -> &[u32] {
        &self.items[self.offsets[v] as usize..self.offsets[v + 1] as usize]
    }

    fn column(&self, v: usize) -> &[u32] {
        &self.columns[self.column_offsets[v] as usize..self.column_offsets[v + 1] as usize]
    }

    /// `LᵀL x`.
    fn bend(&self, x: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let bends: Vec<[f64; 3]> = (0..x.len())
            .into_par_iter()
            .map(|v| {
                let sum = self.row(v).iter().fold([0.0; 3], |s, &w| add(s, x[w as usize]));
                let own = if self.shares[v] > 0.0 { x[v] } else { [0.0; 3] };
                sub(scale(sum, self.shares[v]), own)
            })
            .collect();
        (0..x.len())
            .into_par_iter()
            .map(|v| {
                self.column(v).iter().fold(scale(bends[v], -1.0), |s, &u| {
                    add(s, scale(bends[u as usize], self.shares[u as usize]))
                })
            })
            .collect()
    }

    /// Where `(W + λ LᵀL) x = W p` moves p, with the weights W of the data:
    /// the displacement d = x − p, from
    ///
    /// ```text
    /// (W + λ LᵀL) d = −λ LᵀL p
    /// ```
    ///
    /// which is of the size of the noise wherever the mesh lies. `start` is
    /// a guess. By conjugate gradients, or directly where they are slow.
    ///
    /// # Errors
    ///
    /// [`DenoiseError::NotSolved`] if neither reaches its tolerance.
    pub(super) fn displacements(
        &self,
        p: &[[f64; 3]],
        strength: f64,
        start: Vec<[f64; 3]>,
    ) -> Result<Vec<[f64; 3]>, DenoiseError> {
        let apply = |x: &[[f64; 3]]| -> Vec<[f64; 3]> {
            let mut bend = self.bend(x);
            bend.par_iter_mut().enumerate().for_each(|(v, b)| {
                *b = add(scale(x[v], self.weights[v]), scale(*b, strength));
            });
            bend
        };
        let diagonal: Vec<f64> = (0..p.len())
            .into_par_iter()
            .map(|v| {
                let own = if self.shares[v] > 0.0 { 1.0 } else { 0.0 };
                let others: f64 =
                    self.column(v).iter().map(|&u| self.shares[u as usize].powi(2)).sum();
                self.weights[v] + strength * (own + others)
            })
            .collect();
        let b: Vec<[f64; 3]> = self.bend(p).into_iter().map(|x| scale(x, -strength)).collect();
        let (d, residual) = conjugate_gradients(apply, &diagonal, &b, start, TOLERANCE, ITERATIONS);
        if residual <= TOLERANCE {
            return Ok(d);
        }
        let not_solved =
            |residual| DenoiseError::NotSolved { step: 0, iterations: ITERATIONS, residual };
        let matrix = self.matrix(strength);
        let factor = Cholesky::new(&matrix).map_err(|_| not_solved(residual))?;
        let d = factor.solve_points(&b);
        // The residual of the direct solution: no iteration from there.
        let (d, residual) = conjugate_gradients(apply, &diagonal, &b, d, 0.0, 0);
        if residual <= DIRECT { Ok(d) } else { Err(not_solved(residual)) }
    }

    /// `W + λ LᵀL`.
    fn matrix(&self, strength: f64) -> SparseMatrix {
        let count = self.weights.len();
        let (mut starts, mut indices, mut values) = (vec![0u32], vec![], vec![]);
        let mut sums = vec![0.0; count];
        for v in 0..count {
            // Row v of LᵀL: the rows of L that see v, each times its entry.
            let mut touched: Vec<u32> = vec![v as u32];
            sums[v] = self.weights[v];
            let own = if self.shares[v] > 0.0 { -1.0 } else { 0.0 };
            let seen = std::iter::once((v as u32, own))
                .chain(self.column(v).iter().map(|&u| (u, self.shares[u as usize])));
            for (u, entry) in seen.filter(|(_, entry)| *entry != 0.0) {
                let share = self.shares[u as usize];
                let row = self.row(u as usize).iter().map(|&w| (w, share));
                for (w, other) in row.chain([(u, -1.0)]) {
                    if !touched.contains(&w) {
                        touched.push(w);
                    }
                    sums[w as usize] += strength * entry * other;
                }
            }
            touched.sort_unstable();
            for w in touched {
                indices.push(w);
                values.push(std::mem::take(&mut sums[w as usize]));
            }
            starts.push(indices.len() as u32);
        }
        SparseMatrix::new((count, count), starts, indices, values)
    }
}

#[cfg(test)]
mod tests {
    use fairing_mesh::vec3::norm;
    use fairing_shapes as shapes;

    use super::*;

    /// The direct solution and that of conjugate gradients are the same, on an
    /// open mesh with uneven weights.
    #[test]
    fn both_solutions_agree() {
        let mesh = shapes::jittered_plane(12, 9, 0.2, 2);
        let mut plate = ThinPlate::new(&mesh);
        for (v, w) in plate.weights.iter_mut().enumerate() {
            *w = 0.2 + 0.1 * (v % 7) as f64;
        }
        let p = mesh.positions();
        let iterated = plate.displacements(p, 5.0, vec![[0.0; 3]; p.len()]).unwrap();
        let b: Vec<[f64; 3]> = plate.bend(p).into_iter().map(|x| scale(x, -5.0)).collect();
        let direct = Cholesky::new(&plate.matrix(5.0)).unwrap().solve_points(&b);
        let length = |x: &[[f64; 3]]| x.iter().map(|x| norm(*x).powi(2)).sum::<f64>().sqrt();
        let difference: Vec<[f64; 3]> =
            iterated.iter().zip(&direct).map(|(a, b)| sub(*a, *b)).collect();
        // No eigenvalue is below the least weight.
        let bound = TOLERANCE * length(&b) / 0.2;
        assert!(length(&difference) <= bound, "{} above {bound}", length(&difference));
        assert!(bound < 0.1 * length(&direct), "{bound} of {}", length(&direct));
    }
}
