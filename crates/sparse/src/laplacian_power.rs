//! Powers of a Laplacian.

use crate::double::{self, Double};
use crate::matrix::{SparseMatrix, principal_submatrix};

/// `S (M⁻¹S)ᵏ⁻¹` for a symmetric `S` with zero row sums and a positive diagonal `M`.
///
/// # Examples
///
/// ```
/// use fairing_sparse::{LaplacianPower, SparseMatrix};
/// let s = SparseMatrix::new((2, 2), vec![0, 2, 4], vec![0, 1, 0, 1], vec![1.0, -1.0, -1.0, 1.0]);
/// let bilaplacian = LaplacianPower::new(&s, &[1.0, 0.5], 2);
/// assert_eq!(bilaplacian.matrix().get(0, 1), Some(&-3.0));
/// assert_eq!(bilaplacian.apply(&[[1.0, 7.0, 0.0], [0.0, 7.0, 1.0]])[0], [3.0, 0.0, -3.0]);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct LaplacianPower<'a> {
    stiffness: &'a SparseMatrix,
    mass: &'a [f64],
    order: u32,
}

impl<'a> LaplacianPower<'a> {
    /// The power k = `order`.
    ///
    /// # Panics
    ///
    /// Panics if S is not square and CSR, if the number of masses differs from the number of rows,
    /// or if the order is 0.
    pub fn new(stiffness: &'a SparseMatrix, mass: &'a [f64], order: u32) -> Self {
        let n = mass.len();
        assert!(stiffness.is_csr(), "the matrix must be stored by rows");
        assert_eq!((stiffness.rows(), stiffness.cols()), (n, n), "sizes of the operands");
        assert!(order > 0, "the order is one at least");
        Self { stiffness, mass, order }
    }

    /// The matrix, symmetric up to rounding.
    pub fn matrix(&self) -> SparseMatrix {
        let mut walk = self.stiffness.clone();
        for (i, mut row) in walk.outer_iterator_mut().enumerate() {
            for (_, value) in row.iter_mut() {
                *value /= self.mass[i];
            }
        }
        let mut product = self.stiffness.clone();
        for _ in 1..self.order {
            product = &product * &walk;
        }
        product
    }

    /// The rows and columns `keep` of [`Self::matrix`], without the others: the time depends on the
    /// neighbourhoods of these rows, but for passes over S.
    ///
    /// # Panics
    ///
    /// Panics unless `keep` holds rows in ascending order, each once.
    pub fn principal(&self, keep: &[u32]) -> SparseMatrix {
        if self.order == 1 {
            return principal_submatrix(self.stiffness, keep);
        }
        assert!(keep.windows(2).all(|pair| pair[0] < pair[1]), "the rows that are kept ascend");
        let shape = (keep.len(), self.mass.len());
        let offsets = (0..=keep.len() as u32).collect();
        let rows = SparseMatrix::new(shape, offsets, keep.to_vec(), vec![1.0; keep.len()]);
        let mut product = self.stiffness * &rows.transpose_view().to_csr();
        for factor in 1..self.order {
            for (mut row, mass) in product.outer_iterator_mut().zip(self.mass) {
                row.iter_mut().for_each(|(_, value)| *value /= mass);
            }
            product = if factor + 1 == self.order {
                &(&rows * self.stiffness) * &product
            } else {
                self.stiffness * &product
            };
        }
        product
    }

    /// The product with points, computed in double-double arithmetic and rounded at the end. Rows
    /// of `S` act on differences, so that constants vanish exactly.
    ///
    /// # Panics
    ///
    /// Panics unless there is one point for each row.
    pub fn apply(&self, x: &[[f64; 3]]) -> Vec<[f64; 3]> {
        assert_eq!(x.len(), self.mass.len(), "one point for each row");
        let mut y: Vec<[Double; 3]> = x.iter().map(|p| p.map(|x| (x, 0.0))).collect();
        for factor in 0..self.order {
            let last = factor + 1 == self.order;
            y = self
                .stiffness
                .outer_iterator()
                .enumerate()
                .map(|(i, row)| {
                    let mut sum = [(0.0, 0.0); 3];
                    for (j, &s) in row.iter().filter(|&(j, _)| j != i) {
                        for k in 0..3 {
                            let difference = double::sum(y[j][k], double::negative(y[i][k]));
                            sum[k] = double::sum(sum[k], double::times(difference, s));
                        }
                    }
                    if last { sum } else { sum.map(|s| double::over(s, self.mass[i])) }
                })
                .collect();
        }
        y.into_iter().map(|p| p.map(|(high, low)| high + low)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Applied to integers of 50 bits, powers of a graph Laplacian with powers of two as masses
    /// give integers of up to 70 bits, and cancellation makes them small again: the result is
    /// exact, rounded once.
    #[test]
    fn powers_are_rounded_once() {
        // The triangles of a torus of 11 by 7 vertices.
        let n = 77usize;
        let mut t = sprs::TriMatI::<f64, u32>::new((n, n));
        for (y, x) in (0..7).flat_map(|y| (0..11).map(move |x| (y, x))) {
            for (dx, dy) in [(1, 0), (0, 1), (1, 1)] {
                let (a, b) = (y * 11 + x, (y + dy) % 7 * 11 + (x + dx) % 11);
                for (i, j, s) in [(a, b, -1.0), (b, a, -1.0), (a, a, 1.0), (b, b, 1.0)] {
                    t.add_triplet(i, j, s);
                }
            }
        }
        let stiffness: SparseMatrix = t.to_csr();
        let mass: Vec<f64> = (0..n).map(|v| [1.0, 0.5, 0.25][v % 3]).collect();
        let mut state = 1u64;
        let mut integer = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            i128::from(state >> 14)
        };
        let x: Vec<[i128; 3]> = (0..n).map(|_| [0; 3].map(|_| integer())).collect();
        for order in 1..=4 {
            let mut exact = x.clone();
            for factor in 0..order {
                exact = (0..n)
                    .map(|i| {
                        let row = stiffness.outer_view(i).unwrap();
                        let over = if factor + 1 == order { 1 } else { (1.0 / mass[i]) as i128 };
                        let entry = |k: usize| {
                            row.iter().map(|(j, &s)| s as i128 * exact[j][k]).sum::<i128>() * over
                        };
                        [entry(0), entry(1), entry(2)]
                    })
                    .collect();
            }
            let points: Vec<[f64; 3]> = x.iter().map(|p| p.map(|x| x as f64)).collect();
            let found = LaplacianPower::new(&stiffness, &mass, order).apply(&points);
            let expected: Vec<[f64; 3]> = exact.iter().map(|p| p.map(|x| x as f64)).collect();
            assert_eq!(found, expected, "order {order}");
            let power = LaplacianPower::new(&stiffness, &mass, order);
            let keep = [3, 4, 5, 14, 15, 40, 76];
            let part = principal_submatrix(&power.matrix(), &keep);
            assert_eq!(power.principal(&keep).to_dense(), part.to_dense(), "order {order}");
        }
    }
}
