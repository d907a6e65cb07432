//! The pattern of a supernodal factor: runs of columns that share their rows.

use std::ops::Range;

/// The supernodes of a lower triangular factor, in ascending order.
///
/// Supernode `s` holds the columns `range(s)` and, below its dense triangle, the rows `rows(s)`. Its numbers
/// stand column by column in `values(s)`, with `range(s).len() + rows(s).len()` numbers in a column.
#[derive(Debug, Clone)]
pub(crate) struct Supernodes {
    begin: Vec<usize>,
    row_start: Vec<usize>,
    value_start: Vec<usize>,
    rows: Vec<u32>,
}

impl Default for Supernodes {
    fn default() -> Self {
        Self { begin: vec![0], row_start: vec![0], value_start: vec![0], rows: vec![] }
    }
}

impl Supernodes {
    /// Appends the supernode of the next columns.
    pub(crate) fn push(&mut self, columns: Range<usize>, rows: &[u32]) {
        let values = columns.len() * (columns.len() + rows.len());
        self.value_start.push(self.value_start[self.len()] + values);
        self.begin.push(columns.end);
        self.rows.extend_from_slice(rows);
        self.row_start.push(self.rows.len());
    }

    pub(crate) fn len(&self) -> usize {
        self.begin.len() - 1
    }

    pub(crate) fn columns(&self) -> usize {
        self.begin[self.len()]
    }

    pub(crate) fn range(&self, s: usize) -> Range<usize> {
        self.begin[s]..self.begin[s + 1]
    }

    pub(crate) fn rows(&self, s: usize) -> &[u32] {
        &self.rows[self.row_start[s]..self.row_start[s + 1]]
    }

    pub(crate) fn values(&self, s: usize) -> Range<usize> {
        self.value_start[s]..self.value_start[s + 1]
    }

    /// The diagonal of the factor with these values.
    pub(crate) fn diagonal<'a>(&'a self, values: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        (0..self.len()).flat_map(move |s| {
            let width = self.range(s).len();
            let height = width + self.rows(s).len();
            let block = &values[self.values(s)];
            (0..width).map(move |j| block[j * (height + 1)])
        })
    }

    /// Entries of the factor on and below its diagonal, explicit zeros of the supernodes included.
    pub(crate) fn entries(&self) -> usize {
        (0..self.len())
            .map(|s| {
                let width = self.range(s).len();
                width * (width + 1) / 2 + width * self.rows(s).len()
            })
            .sum()
    }
}
