//! Check for square, finite, symmetric matrices; factorisations read only one triangle.

use crate::error::SparseError;
use crate::matrix::{Rows, SparseMatrix};

/// The largest difference of two mirrored entries, relative to the larger of their diagonal
/// entries: assembly may sum the same terms in different orders.
const SYMMETRY_TOLERANCE: f64 = 1e-10;

/// Checks shape, values and symmetry in one pass over the entries.
pub(crate) fn check(matrix: &SparseMatrix) -> Result<(), SparseError> {
    if matrix.rows() != matrix.cols() {
        return Err(SparseError::NotSquare { rows: matrix.rows(), columns: matrix.cols() });
    }
    let rows = Rows::new(matrix);
    let n = rows.count();
    let diagonal = rows.diagonal();
    // cursor[j]: the next entry of row j right of its diagonal whose mirror image has not been
    // visited.
    let mut cursor: Vec<u32> = (0..n)
        .map(|i| {
            let before = rows.row(i).0.partition_point(|&j| j as usize <= i);
            rows.starts[i] + before as u32
        })
        .collect();
    for i in 0..n {
        for k in rows.range(i) {
            let (j, value) = (rows.columns[k] as usize, rows.values[k]);
            if !value.is_finite() {
                return Err(SparseError::NotFinite { row: i, column: j, value });
            }
            if j >= i {
                continue;
            }
            let mirror = cursor[j] as usize;
            if mirror >= rows.starts[j + 1] as usize || rows.columns[mirror] as usize != i {
                return Err(SparseError::NotSymmetric { row: i, column: j, difference: value });
            }
            cursor[j] += 1;
            let difference = value - rows.values[mirror];
            let scale = diagonal[i].abs().max(diagonal[j].abs()).max(value.abs());
            if difference.abs() > SYMMETRY_TOLERANCE * scale {
                return Err(SparseError::NotSymmetric { row: i, column: j, difference });
            }
        }
    }
    for j in 0..n {
        if cursor[j] != rows.starts[j + 1] {
            let k = cursor[j] as usize;
            return Err(SparseError::NotSymmetric {
                row: j,
                column: rows.columns[k] as usize,
                difference: rows.values[k],
            });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn matrix(n: usize, triplets: &[(usize, usize, f64)]) -> SparseMatrix {
        let mut t = sprs::TriMatI::<f64, u32>::new((n, n));
        for &(i, j, v) in triplets {
            t.add_triplet(i, j, v);
        }
        t.to_csr()
    }

    #[test]
    fn mirrored_entries_are_required() {
        assert_eq!(check(&matrix(2, &[(0, 0, 1.0), (0, 1, 2.0), (1, 0, 2.0)])), Ok(()));
        for lonely in [[(0, 1, 2.0), (1, 1, 1.0)], [(1, 0, 2.0), (1, 1, 1.0)]] {
            let error = check(&matrix(2, &lonely)).unwrap_err();
            assert!(
                matches!(error, SparseError::NotSymmetric { difference: 2.0, .. }),
                "{error:?}"
            );
        }
        let skew = check(&matrix(2, &[(0, 1, 2.0), (1, 0, -2.0)])).unwrap_err();
        assert_eq!(skew, SparseError::NotSymmetric { row: 1, column: 0, difference: -4.0 });
    }

    #[test]
    fn values_must_be_finite() {
        let error = check(&matrix(2, &[(1, 1, f64::NAN)])).unwrap_err();
        assert!(matches!(error, SparseError::NotFinite { row: 1, column: 1, .. }));
    }
}
