//! A numeric factor with its ordering; right-hand sides and solutions are in the order of the
//! matrix.

use std::sync::Arc;

use fairing_watch::parallel::{for_chunks, for_each};
use ndarray::{ArrayViewMut2, Axis};

use crate::direct::supernodes::Supernodes;
use crate::direct::sweeps;
use crate::parallel::{CHUNK, update};

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
        self.solve_rows(b, |b| [*b], |b, x| *b = x[0]);
    }

    pub(crate) fn solve_points(&self, b: &mut [[f64; 3]]) {
        // The fourth lane pads to a SIMD register.
        let padded = |b: &[f64; 3]| [b[0], b[1], b[2], 0.0];
        self.solve_rows(b, padded, |b, x| b.copy_from_slice(&x[..3]));
    }

    /// Solves in place for rows with `B` columns, read by `read` and written by `write`.
    pub(crate) fn solve_rows<T: Send + Sync, const B: usize>(
        &self,
        b: &mut [T],
        read: impl Fn(&T) -> [f64; B] + Sync,
        write: impl Fn(&mut T, &[f64; B]) + Sync,
    ) {
        assert_eq!(b.len(), self.rows(), "length of the right-hand side");
        let Analysis { order, inverse, .. } = &*self.analysis;
        let mut x = vec![[0.0; B]; b.len()];
        update(&mut x, |k, _| (read(&b[order[k] as usize]), ()));
        self.solve_ordered(&mut x);
        for_chunks(b, CHUNK, |start, b| {
            b.iter_mut().zip(&inverse[start..]).for_each(|(b, &k)| write(b, &x[k as usize]));
        });
    }

    pub(crate) fn solve_block(&self, mut b: ArrayViewMut2<'_, f64>) {
        assert_eq!(b.nrows(), self.rows(), "rows of the right-hand side");
        for_each(b.axis_chunks_iter_mut(Axis(1), LANES), |mut b| {
            let width = b.ncols();
            let order = &self.analysis.order;
            let mut x = vec![[0.0; LANES]; order.len()];
            for (lanes, &row) in x.iter_mut().zip(order) {
                for j in 0..width {
                    lanes[j] = b[[row as usize, j]];
                }
            }
            self.solve_ordered(&mut x);
            for (lanes, &row) in x.iter().zip(order) {
                for j in 0..width {
                    b[[row as usize, j]] = lanes[j];
                }
            }
        });
    }

    /// Solves in place for rows in the order of the factor.
    pub(crate) fn solve_ordered<const B: usize>(&self, x: &mut [[f64; B]]) {
        sweeps::solve(&self.analysis.nodes, &self.values, x);
    }
}

/// Everything about a factor except its values.
#[derive(Debug)]
pub(crate) struct Analysis {
    pub(crate) nodes: Supernodes,
    /// `order[k]`: the row of the matrix that is eliminated k-th.
    pub(crate) order: Vec<u32>,
    /// The place of each row in `order`.
    pub(crate) inverse: Vec<u32>,
    pub(crate) starts: Vec<u32>,
    pub(crate) columns: Vec<u32>,
}
