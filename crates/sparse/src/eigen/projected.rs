//! The small dense problem of a Rayleigh–Ritz step: the operator in the basis.

use crate::direct::backend;
use crate::direct::factor::LANES;
use crate::eigen::basis::Small;

/// T = Vᵀ M A V for the blocks of V so far, symmetric, and the coupling of the last block to the
/// next.
#[derive(Debug, Default)]
pub(crate) struct Projected {
    /// `columns[j][i]`: block (i, j) of T for i ≤ j.
    columns: Vec<Vec<Small>>,
    /// A V = V T + Q R Eᵀ: `coupling[i]` is the part of R in the columns of block i; all but the
    /// last are zero, except right after a restart.
    pub(crate) coupling: Vec<Small>,
}

/// Eigenpairs of T.
pub(crate) struct Ritz {
    /// Eigenvalues θ, ascending.
    pub(crate) values: Vec<f64>,
    vectors: Vec<f64>,
}

impl Ritz {
    pub(crate) fn vector(&self, i: usize) -> &[f64] {
        let n = self.values.len();
        &self.vectors[i * n..(i + 1) * n]
    }
}

pub(crate) const ZERO: Small = [[0.0; LANES]; LANES];

impl Projected {
    /// The state after a restart: T = diag(θ), and the coupling of the kept vectors to the next
    /// block.
    pub(crate) fn restarted(values: &[f64], coupling: Vec<Small>) -> Self {
        let columns = (0..values.len() / LANES)
            .map(|j| {
                let mut column = vec![ZERO; j + 1];
                for i in 0..LANES {
                    column[j][i][i] = values[j * LANES + i];
                }
                column
            })
            .collect();
        Self { columns, coupling }
    }

    pub(crate) fn len(&self) -> usize {
        self.columns.len() * LANES
    }

    /// Appends the column of the newest block: Vᵀ M A v for all blocks up to and with v, and R.
    pub(crate) fn push(&mut self, column: Vec<Small>, coupling: Small) {
        self.coupling = vec![ZERO; self.columns.len()];
        self.coupling.push(coupling);
        self.columns.push(column);
    }

    /// All eigenpairs of T.
    pub(crate) fn solve(&self) -> Result<Ritz, backend::NoConvergence> {
        let n = self.len();
        let mut t = vec![0.0; n * n];
        for (j, column) in self.columns.iter().enumerate() {
            for (i, block) in column.iter().enumerate() {
                for (a, row) in block.iter().enumerate() {
                    for (b, &value) in row.iter().enumerate() {
                        let (r, c) = (i * LANES + a, j * LANES + b);
                        if i < j {
                            t[c * n + r] = value;
                            t[r * n + c] = value;
                        } else {
                            // Rounding makes the diagonal block slightly asymmetric.
                            t[c * n + r] += 0.5 * value;
                            t[r * n + c] += 0.5 * value;
                        }
                    }
                }
            }
        }
        let (values, vectors) = backend::symmetric_eigen(n, &t)?;
        Ok(Ritz { values, vectors })
    }

    /// R Eᵀ y: the coefficients of A V y − V T y in the next block.
    pub(crate) fn overhang(&self, y: &[f64]) -> [f64; LANES] {
        let mut z = [0.0; LANES];
        for (r, y) in self.coupling.iter().zip(y.chunks_exact(LANES)) {
            for a in 0..LANES {
                for b in 0..LANES {
                    z[a] += r[a][b] * y[b];
                }
            }
        }
        z
    }
}
