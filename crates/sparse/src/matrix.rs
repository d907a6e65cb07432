//! The sparse matrix of the workspace and a borrowed look at its rows.

/// A sparse matrix of the workspace: CSR, `f64` values, `u32` indices, columns ascending in each row.
pub type SparseMatrix = sprs::CsMatI<f64, u32>;

/// The three arrays of a CSR matrix.
#[derive(Clone, Copy)]
pub(crate) struct Rows<'a> {
    pub(crate) starts: &'a [u32],
    pub(crate) columns: &'a [u32],
    pub(crate) values: &'a [f64],
}

impl<'a> Rows<'a> {
    /// Borrows the arrays. A CSC matrix shows its columns: the same for symmetric matrices, which are all
    /// this crate factorises; products check the storage themselves.
    pub(crate) fn of(matrix: &'a SparseMatrix) -> Self {
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
