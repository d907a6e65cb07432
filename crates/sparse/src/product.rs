//! Products of a CSR matrix with one, three or k dense columns, row-major, near memory bandwidth.
//!
//! Rows are cut into fixed chunks that threads share; a row is always summed in the order of its
//! columns, so that results do not depend on the number of threads.

use fairing_watch::parallel::for_chunks;
use ndarray::{Array2, ArrayView2};

use crate::matrix::{Rows, SparseMatrix};

/// Rows of one parallel task: some 100 kB of matrix, well above the cost of a task.
const CHUNK: usize = 2048;

/// A x.
///
/// # Panics
///
/// Panics if A is not CSR or `x` has another length than A has columns.
#[doc(alias = "spmv")]
pub fn multiply(matrix: &SparseMatrix, x: &[f64]) -> Vec<f64> {
    let mut y = vec![0.0; matrix.rows()];
    multiply_into(matrix, x, &mut y);
    y
}

/// `y` ← A x, for loops that keep their vectors.
///
/// # Panics
///
/// Panics if A is not CSR or a length does not fit.
pub fn multiply_into(matrix: &SparseMatrix, x: &[f64], y: &mut [f64]) {
    check(matrix, x.len(), y.len());
    let rows = Rows::new(matrix);
    each_chunk(y, |i, y| {
        let (columns, values) = rows.row(i);
        *y = columns.iter().zip(values).map(|(&j, &a)| a * x[j as usize]).sum();
    });
}

/// A X for points, one in a row: `n × 3`.
///
/// # Panics
///
/// Panics if A is not CSR or `x` has another length than A has columns.
pub fn multiply_points(matrix: &SparseMatrix, x: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let mut y = vec![[0.0; 3]; matrix.rows()];
    multiply_points_into(matrix, x, &mut y);
    y
}

/// `y` ← A X for points, for loops that keep their vectors.
///
/// # Panics
///
/// Panics if A is not CSR or a length does not fit.
pub fn multiply_points_into(matrix: &SparseMatrix, x: &[[f64; 3]], y: &mut [[f64; 3]]) {
    check(matrix, x.len(), y.len());
    multiply_lanes(Rows::new(matrix), x, y);
}

/// A X for an `n × k` block.
///
/// # Panics
///
/// Panics if A is not CSR or X has another number of rows than A has columns.
pub fn multiply_block(matrix: &SparseMatrix, x: ArrayView2<'_, f64>) -> Array2<f64> {
    let k = x.ncols();
    let mut y = Array2::zeros((matrix.rows(), k));
    check(matrix, x.nrows(), y.nrows());
    if k == 0 {
        return y;
    }
    let x = x.as_standard_layout();
    let rows = Rows::new(matrix);
    // The array was made above in standard layout, and so was the copy: both are contiguous.
    if let (Some(x), Some(y)) = (x.as_slice(), y.as_slice_mut()) {
        let mut chunks: Vec<_> = y.chunks_mut(k).collect();
        each_chunk(&mut chunks, |i, y| {
            let (columns, values) = rows.row(i);
            for (&j, &a) in columns.iter().zip(values) {
                let from = j as usize * k;
                for (y, x) in y.iter_mut().zip(&x[from..from + k]) {
                    *y += a * x;
                }
            }
        });
    }
    y
}

/// `y` ← A X for `B` columns, row by row.
pub(crate) fn multiply_lanes<const B: usize>(rows: Rows<'_>, x: &[[f64; B]], y: &mut [[f64; B]]) {
    each_chunk(y, |i, y| {
        let (columns, values) = rows.row(i);
        let mut sum = [0.0; B];
        for (&j, &a) in columns.iter().zip(values) {
            let x = &x[j as usize];
            for lane in 0..B {
                sum[lane] += a * x[lane];
            }
        }
        *y = sum;
    });
}

fn check(matrix: &SparseMatrix, x: usize, y: usize) {
    assert!(matrix.is_csr(), "the matrix must be stored by rows");
    assert_eq!((matrix.cols(), matrix.rows()), (x, y), "sizes of the operands");
}

/// Calls `work(i, &mut y[i])` for every row, in parallel for matrices worth it.
fn each_chunk<T: Send>(y: &mut [T], work: impl Fn(usize, &mut T) + Sync) {
    if y.len() <= CHUNK {
        return y.iter_mut().enumerate().for_each(|(i, y)| work(i, y));
    }
    for_chunks(y, CHUNK, |start, y| {
        for (i, y) in y.iter_mut().enumerate() {
            work(start + i, y);
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::Array2;
    use proptest::prelude::*;

    fn arbitrary_matrix() -> impl Strategy<Value = SparseMatrix> {
        (1usize..40, 1usize..40).prop_flat_map(|(rows, columns)| {
            proptest::collection::vec((0..rows, 0..columns, -9i32..9), 0..200).prop_map(
                move |entries| {
                    let mut t = sprs::TriMatI::<f64, u32>::new((rows, columns));
                    for (i, j, v) in entries {
                        t.add_triplet(i, j, f64::from(v));
                    }
                    t.to_csr()
                },
            )
        })
    }

    proptest! {
        /// Small integers: every sum is exact, so all kernels agree to the bit with the dense
        /// product.
        #[test]
        fn kernels_agree_with_the_dense_product(matrix in arbitrary_matrix()) {
            let (n, m) = (matrix.rows(), matrix.cols());
            let x = Array2::from_shape_fn((m, 5), |(i, j)| ((7 * i + 3 * j) % 11) as f64 - 5.0);
            let dense = matrix.to_dense().dot(&x);
            prop_assert_eq!(&multiply_block(&matrix, x.view()), &dense);
            let points: Vec<[f64; 3]> = (0..m).map(|i| [x[[i, 0]], x[[i, 1]], x[[i, 2]]]).collect();
            let y = multiply_points(&matrix, &points);
            let single = multiply(&matrix, &x.column(4).to_vec());
            for i in 0..n {
                prop_assert_eq!(y[i], [dense[[i, 0]], dense[[i, 1]], dense[[i, 2]]]);
                prop_assert_eq!(single[i], dense[[i, 4]]);
            }
        }
    }

    /// More rows than a chunk: the parallel path numbers rows like the serial one.
    #[test]
    fn parallel_rows_keep_their_places() {
        let n = 3 * CHUNK + 17;
        let matrix = SparseMatrix::new(
            (n, n),
            (0..=n as u32).collect(),
            (0..n as u32).rev().collect(),
            vec![2.0; n],
        );
        let x: Vec<f64> = (0..n).map(|i| i as f64).collect();
        let y = multiply(&matrix, &x);
        assert!((0..n).all(|i| y[i] == 2.0 * (n - 1 - i) as f64));
    }
}
