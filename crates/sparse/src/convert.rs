//! Matrices of other crates, each behind a feature of its name.

#[cfg(any(feature = "faer", feature = "nalgebra"))]
use crate::{SparseError, SparseMatrix, from_csr};

/// The same matrix for faer.
///
/// # Examples
///
/// ```
/// use fairing_sparse::{from_faer, from_triplets, to_faer};
///
/// let matrix = from_triplets((2, 3), &[(0, 0, 2.0), (1, 0, -1.0), (1, 2, 5.0)])?;
/// let theirs = to_faer(&matrix);
/// assert_eq!(theirs.val_of_row(1), [-1.0, 5.0]);
/// assert_eq!(from_faer(theirs.as_ref())?, matrix);
/// # Ok::<(), fairing_sparse::SparseError>(())
/// ```
#[cfg(feature = "faer")]
pub fn to_faer(matrix: &SparseMatrix) -> faer::sparse::SparseRowMat<u32, f64> {
    use faer::sparse::{SparseRowMat, SymbolicSparseRowMat};
    let (shape, (offsets, columns, values)) = (matrix.shape(), parts(matrix));
    let pattern = SymbolicSparseRowMat::new_checked(shape.0, shape.1, offsets, None, columns);
    SparseRowMat::new(pattern, values)
}

/// The same matrix from faer.
///
/// # Errors
///
/// As for [`from_csr`].
#[cfg(feature = "faer")]
pub fn from_faer(
    matrix: faer::sparse::SparseRowMatRef<'_, u32, f64>,
) -> Result<SparseMatrix, SparseError> {
    let pattern = matrix.symbolic();
    let (mut columns, mut values, mut offsets) = (vec![], vec![], vec![0]);
    for row in 0..pattern.nrows() {
        columns.extend_from_slice(pattern.col_idx_of_row_raw(row));
        values.extend_from_slice(matrix.val_of_row(row));
        offsets.push(checked(columns.len())?);
    }
    from_csr((pattern.nrows(), pattern.ncols()), offsets, columns, values)
}

/// The same matrix for nalgebra.
///
/// # Examples
///
/// ```
/// use fairing_sparse::{from_nalgebra, from_triplets, to_nalgebra};
///
/// let matrix = from_triplets((2, 3), &[(0, 0, 2.0), (1, 0, -1.0), (1, 2, 5.0)])?;
/// let theirs = to_nalgebra(&matrix);
/// assert_eq!(theirs.row(1).values(), [-1.0, 5.0]);
/// assert_eq!(from_nalgebra(&theirs)?, matrix);
/// # Ok::<(), fairing_sparse::SparseError>(())
/// ```
#[cfg(feature = "nalgebra")]
pub fn to_nalgebra(matrix: &SparseMatrix) -> nalgebra_sparse::CsrMatrix<f64> {
    let (offsets, columns, values) = parts(matrix);
    let wide = |all: Vec<u32>| all.into_iter().map(|k| k as usize).collect();
    let (rows, cols) = matrix.shape();
    nalgebra_sparse::CsrMatrix::try_from_csr_data(rows, cols, wide(offsets), wide(columns), values)
        .expect("rows of ascending columns")
}

/// The same matrix from nalgebra.
///
/// # Errors
///
/// As for [`from_csr`].
#[cfg(feature = "nalgebra")]
pub fn from_nalgebra(
    matrix: &nalgebra_sparse::CsrMatrix<f64>,
) -> Result<SparseMatrix, SparseError> {
    let (offsets, columns, values) = matrix.csr_data();
    let narrow = |all: &[usize]| all.iter().map(|&k| checked(k)).collect::<Result<Vec<u32>, _>>();
    let shape = (matrix.nrows(), matrix.ncols());
    from_csr(shape, narrow(offsets)?, narrow(columns)?, values.to_vec())
}

/// Offsets, columns and values of the rows.
#[cfg(any(feature = "faer", feature = "nalgebra"))]
fn parts(matrix: &SparseMatrix) -> (Vec<u32>, Vec<u32>, Vec<f64>) {
    matrix.to_csr().into_raw_storage()
}

#[cfg(any(feature = "faer", feature = "nalgebra"))]
fn checked(entries: usize) -> Result<u32, SparseError> {
    u32::try_from(entries).map_err(|_| SparseError::TooManyEntries { entries })
}
