//! The sparse matrix type, its constructors, and a borrowed view of its rows.

use crate::error::SparseError;

/// A sparse matrix of the workspace: CSR, `f64` values, `u32` indices, columns ascending in each
/// row.
///
/// [`from_csr`] and [`from_triplets`] make one, or say what is wrong with the given numbers;
/// `into_raw_storage` takes one apart into offsets, columns and values.
pub type SparseMatrix = sprs::CsMatI<f64, u32>;

/// The matrix of these rows: row i has the columns `columns[offsets[i]..offsets[i + 1]]`,
/// ascending, and the values in the same places.
///
/// # Errors
///
/// [`SparseError`].
///
/// # Examples
///
/// ```
/// use fairing_sparse::from_csr;
/// let matrix = from_csr((2, 2), vec![0, 2, 3], vec![0, 1, 1], vec![2.0, -1.0, 2.0])?;
/// assert_eq!(matrix.get(0, 1), Some(&-1.0));
/// let error = from_csr((2, 2), vec![0, 2, 3], vec![1, 0, 1], vec![2.0; 3]).unwrap_err();
/// assert_eq!(error.to_string(), "column 0 of row 0 does not come after the one before it");
/// # Ok::<(), fairing_sparse::SparseError>(())
/// ```
pub fn from_csr(
    shape: (usize, usize),
    offsets: Vec<u32>,
    columns: Vec<u32>,
    values: Vec<f64>,
) -> Result<SparseMatrix, SparseError> {
    if columns.len() != values.len() {
        return Err(SparseError::Columns { found: values.len(), expected: columns.len() });
    }
    let wrong = |place: usize| {
        let found = offsets.get(place).copied().unwrap_or_default();
        SparseError::Offsets { place, found }
    };
    if offsets.len() != shape.0 + 1 {
        return Err(wrong(offsets.len().min(shape.0 + 1)));
    }
    if offsets[0] != 0 || offsets[shape.0] as usize != columns.len() {
        return Err(wrong(if offsets[0] == 0 { shape.0 } else { 0 }));
    }
    if let Some(row) = offsets.windows(2).position(|pair| pair[1] < pair[0]) {
        return Err(wrong(row + 1));
    }
    for row in 0..shape.0 {
        let range = offsets[row] as usize..offsets[row + 1] as usize;
        let mut before = None;
        for (&column, &value) in columns[range.clone()].iter().zip(&values[range]) {
            check_entry(shape, (row, column, value))?;
            if before >= Some(column) {
                return Err(SparseError::Order { row, column });
            }
            before = Some(column);
        }
    }
    Ok(SparseMatrix::new(shape, offsets, columns, values))
}

/// The matrix of these entries, each a row, a column and a value; entries of the same place are
/// added in their order.
///
/// # Errors
///
/// [`SparseError`].
///
/// # Examples
///
/// ```
/// use fairing_sparse::from_triplets;
/// let matrix = from_triplets((2, 2), &[(1, 0, 3.0), (0, 0, 1.0), (1, 0, 0.5)])?;
/// assert_eq!((matrix.nnz(), matrix.get(1, 0)), (2, Some(&3.5)));
/// # Ok::<(), fairing_sparse::SparseError>(())
/// ```
#[doc(alias = "coo")]
pub fn from_triplets(
    shape: (usize, usize),
    triplets: &[(u32, u32, f64)],
) -> Result<SparseMatrix, SparseError> {
    if u32::try_from(triplets.len()).is_err() {
        return Err(SparseError::TooManyEntries { entries: triplets.len() });
    }
    for &(row, column, value) in triplets {
        check_entry(shape, (row as usize, column, value))?;
    }
    let mut sorted = triplets.to_vec();
    // Stable: entries of one place keep their order.
    sorted.sort_by_key(|&(row, column, _)| (row, column));
    let (mut columns, mut values) = (vec![], vec![]);
    let mut offsets = vec![0u32; shape.0 + 1];
    for same in sorted.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        offsets[same[0].0 as usize + 1] += 1;
        columns.push(same[0].1);
        values.push(same.iter().map(|entry| entry.2).sum());
    }
    for row in 0..shape.0 {
        offsets[row + 1] += offsets[row];
    }
    Ok(SparseMatrix::new(shape, offsets, columns, values))
}

fn check_entry(
    shape: (usize, usize),
    (row, column, value): (usize, u32, f64),
) -> Result<(), SparseError> {
    if row >= shape.0 || column as usize >= shape.1 {
        return Err(SparseError::Outside { row, column, shape });
    }
    if !value.is_finite() {
        return Err(SparseError::NotFinite { row, column: column as usize, value });
    }
    Ok(())
}

/// The rows and columns `keep` of a square matrix, which ascend: row i of the result is row
/// `keep[i]`.
///
/// # Panics
///
/// Panics if the matrix is not CSR and square, or if `keep` does not ascend within it.
///
/// # Examples
///
/// ```
/// use fairing_sparse::{from_triplets, principal_submatrix};
/// let matrix = from_triplets((3, 3), &[(0, 0, 1.0), (0, 1, 2.0), (0, 2, 3.0), (2, 0, 4.0)])?;
/// let ends = principal_submatrix(&matrix, &[0, 2]);
/// assert_eq!((ends.get(0, 1), ends.get(1, 0)), (Some(&3.0), Some(&4.0)));
/// # Ok::<(), fairing_sparse::SparseError>(())
/// ```
pub fn principal_submatrix(matrix: &SparseMatrix, keep: &[u32]) -> SparseMatrix {
    assert!(matrix.is_csr() && matrix.rows() == matrix.cols(), "a square matrix stored by rows");
    assert!(keep.windows(2).all(|pair| pair[0] < pair[1]), "the rows that are kept ascend");
    const NONE: u32 = u32::MAX;
    let mut place = vec![NONE; matrix.rows()];
    for (row, &old) in keep.iter().enumerate() {
        place[old as usize] = row as u32;
    }
    kept(matrix, keep, |old| Some(place[old as usize]).filter(|place| *place != NONE))
}

/// The rows and columns `keep`, with the place of each column that is kept.
pub(crate) fn kept(
    matrix: &SparseMatrix,
    keep: &[u32],
    place: impl Fn(u32) -> Option<u32>,
) -> SparseMatrix {
    let rows = Rows::new(matrix);
    let mut offsets = Vec::with_capacity(keep.len() + 1);
    offsets.push(0);
    let (mut columns, mut values) = (vec![], vec![]);
    for &old in keep {
        let (row_columns, row_values) = rows.row(old as usize);
        for (&j, &value) in row_columns.iter().zip(row_values) {
            if let Some(place) = place(j) {
                columns.push(place);
                values.push(value);
            }
        }
        offsets.push(columns.len() as u32);
    }
    SparseMatrix::new((keep.len(), keep.len()), offsets, columns, values)
}

/// The three arrays of a CSR matrix.
#[derive(Clone, Copy)]
pub(crate) struct Rows<'a> {
    pub(crate) starts: &'a [u32],
    pub(crate) columns: &'a [u32],
    pub(crate) values: &'a [f64],
}

impl<'a> Rows<'a> {
    /// Borrows the arrays. A CSC matrix shows its columns: the same for symmetric matrices, which
    /// are all this crate factorises; products check the storage themselves.
    pub(crate) fn new(matrix: &'a SparseMatrix) -> Self {
        Self {
            starts: matrix.indptr().into_raw_storage(),
            columns: matrix.indices(),
            values: matrix.data(),
        }
    }

    pub(crate) fn count(&self) -> usize {
        self.starts.len() - 1
    }

    pub(crate) fn range(&self, row: usize) -> std::ops::Range<usize> {
        self.starts[row] as usize..self.starts[row + 1] as usize
    }

    pub(crate) fn row(&self, row: usize) -> (&'a [u32], &'a [f64]) {
        let range = self.range(row);
        (&self.columns[range.clone()], &self.values[range])
    }

    /// The columns of the entries of a row that are not zero.
    #[cfg(feature = "solvers")]
    pub(crate) fn nonzeros(&self, row: usize) -> impl Iterator<Item = u32> + use<'a> {
        let (columns, values) = self.row(row);
        columns.iter().zip(values).filter(|(_, v)| **v != 0.0).map(|(&j, _)| j)
    }

    /// The diagonal; zero where it has no entry.
    pub(crate) fn diagonal(&self) -> Vec<f64> {
        (0..self.count())
            .map(|i| {
                let (columns, values) = self.row(i);
                columns.binary_search(&(i as u32)).map_or(0.0, |k| values[k])
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each way in which rows are no matrix has its error, and nothing panics.
    #[test]
    fn rows_that_are_no_matrix_are_refused() {
        let make = |offsets: &[u32], columns: &[u32], values: &[f64]| {
            from_csr((2, 3), offsets.to_vec(), columns.to_vec(), values.to_vec())
        };
        assert!(make(&[0, 1, 2], &[2, 0], &[1.0, 2.0]).is_ok());
        for (result, said) in [
            (make(&[0, 2], &[0, 1], &[1.0; 2]), "offset 2 is 0"),
            (make(&[0, 1, 2, 2], &[0, 1], &[1.0; 2]), "offset 3 is 2"),
            (make(&[], &[], &[]), "offset 0 is 0"),
            (make(&[1, 1, 2], &[0, 1], &[1.0; 2]), "offset 0 is 1"),
            (make(&[0, 1, 1], &[0, 1], &[1.0; 2]), "offset 2 is 1"),
            (make(&[0, 3, 2], &[0, 1], &[1.0; 2]), "offset 2 is 2"),
            (make(&[0, 1, 2], &[0, 1], &[1.0; 3]), "3 values for 2 columns"),
            (make(&[0, 1, 2], &[0, 3], &[1.0; 2]), "row 1, column 3 is outside of a 2 × 3"),
            (make(&[0, 2, 2], &[1, 1], &[1.0; 2]), "column 1 of row 0 does not come after"),
            (make(&[0, 1, 2], &[0, 1], &[1.0, f64::NAN]), "entry (1, 1) is NaN"),
            (from_triplets((2, 3), &[(2, 0, 1.0)]), "row 2, column 0 is outside"),
            (from_triplets((2, 3), &[(0, 0, f64::INFINITY)]), "entry (0, 0) is inf"),
        ] {
            let error = result.unwrap_err().to_string();
            assert!(error.contains(said), "{error}");
        }
        assert_eq!(from_triplets((0, 0), &[]).unwrap().nnz(), 0);
    }
}
