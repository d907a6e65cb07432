//! A numeric factor with its ordering; right-hand sides and solutions are in the order of the
//! matrix.

use std::sync::Arc;

use ndarray::{ArrayViewMut2, Axis};
use rayon::prelude::*;

use crate::direct::supernodes::Supernodes;
use crate::direct::sweeps;

/// Right-hand sides of a block that are solved in one sweep.
pub(crate) const LANES: usize = 8;

/// L, with D on its diagonal.
#[derive(Clone)]
pub(crate) struct Factor {
    pub(crate) analysis: Arc<Analysis>,
    pub(crate) values: Vec<f64>,
}

impl std::fmt::Debug for Factor {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Factor")
            .field("rows", &self.rows())
            .field("numbers", &self.values.len())
            .finish()
    }
}

impl Factor {
    pub(crate) fn rows(&self) -> usize {
        self.analysis.order.len()
    }

    pub(crate) fn solve_vector(&self, b: &mut [f64]) {
        assert_eq!(b.len(), self.rows(), "length of the right-hand side");
        self.solve_permuted::<1>(|row, lanes| lanes[0] = b[row])
            .zip_order(&self.analysis.order, |row, lanes| b[row] = lanes[0]);
    }

    pub(crate) fn solve_points(&self, b: &mut [[f64; 3]]) {
        assert_eq!(b.len(), self.rows(), "length of the right-hand side");
        // The fourth lane pads to a SIMD register.
        self.solve_permuted::<4>(|row, lanes| lanes[..3].copy_from_slice(&b[row]))
            .zip_order(&self.analysis.order, |row, lanes| b[row].copy_from_slice(&lanes[..3]));
    }

    pub(crate) fn solve_block(&self, mut b: ArrayViewMut2<'_, f64>) {
        assert_eq!(b.nrows(), self.rows(), "rows of the right-hand side");
        b.axis_chunks_iter_mut(Axis(1), LANES).into_par_iter().for_each(|mut b| {
            let width = b.ncols();
            self.solve_permuted::<LANES>(|row, lanes| {
                for j in 0..width {
                    lanes[j] = b[[row, j]];
                }
            })
            .zip_order(&self.analysis.order, |row, lanes| {
                for j in 0..width {
                    b[[row, j]] = lanes[j];
                }
            });
        });
    }

    /// Solves in place for rows in the order of the factor.
    pub(crate) fn solve_ordered<const B: usize>(&self, x: &mut [[f64; B]]) {
        sweeps::solve(&self.analysis.nodes, &self.values, x);
    }

    /// Solves for right-hand sides written by `gather(row, lanes)`; the solution is in the order of
    /// the factor.
    pub(crate) fn solve_permuted<const B: usize>(
        &self,
        gather: impl Fn(usize, &mut [f64; B]),
    ) -> Permuted<B> {
        let mut x = vec![[0.0; B]; self.rows()];
        for (x, &row) in x.iter_mut().zip(&self.analysis.order) {
            gather(row as usize, x);
        }
        sweeps::solve(&self.analysis.nodes, &self.values, &mut x);
        Permuted { x }
    }
}

/// A solution in the order of the factor.
pub(crate) struct Permuted<const B: usize> {
    x: Vec<[f64; B]>,
}

impl<const B: usize> Permuted<B> {
    /// Calls `scatter(row, lanes)` for every row.
    pub(crate) fn zip_order(&self, order: &[u32], mut scatter: impl FnMut(usize, &[f64; B])) {
        for (x, &row) in self.x.iter().zip(order) {
            scatter(row as usize, x);
        }
    }
}

/// Everything about a factor except its values.
#[derive(Debug)]
pub(crate) struct Analysis {
    pub(crate) nodes: Supernodes,
    /// `order[k]`: the row of the matrix that is eliminated k-th.
    pub(crate) order: Vec<u32>,
    pub(crate) starts: Vec<u32>,
    pub(crate) columns: Vec<u32>,
}
