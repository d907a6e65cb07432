//! The pattern of a supernodal factor, divided into independent subtrees.

use std::ops::Range;

use crate::matrix::Rows;

/// Groups of columns with the same row pattern in a lower triangular factor.
///
/// Supernode `s` holds the columns `range(s)` and, below its dense triangle, the rows `rows(s)`.
/// Its values are stored by columns in `values(s)`, `range(s).len() + rows(s).len()` per column.
#[derive(Debug, Clone)]
pub(crate) struct Supernodes {
    begin: Vec<usize>,
    row_start: Vec<usize>,
    value_start: Vec<usize>,
    rows: Vec<u32>,
    parents: Vec<Option<u32>>,
    entry_start: Vec<usize>,
    entries: Vec<(u32, u32)>,
    parts: Vec<Part>,
    top: Vec<u32>,
}

/// A subtree of the elimination tree: consecutive supernodes whose columns touch only their own
/// rows and the rows of the last supernode.
///
/// Sweeps work on a copy of these rows, the part's own rows first; the rows of its supernodes are
/// numbered accordingly.
#[derive(Debug, Clone)]
pub(crate) struct Part {
    /// Its supernodes.
    pub(crate) nodes: Range<usize>,
    /// Its columns, equal to its own rows.
    pub(crate) columns: Range<usize>,
    /// The other rows it touches, all in columns of the top.
    pub(crate) outside: Vec<u32>,
}

/// A part holds at most one over this of the factor. The parts must not depend on the number of
/// threads.
const LARGEST_PART: usize = 16;
/// Subtrees with less than one over this of the factor stay in the top: a task would cost more than
/// it saves.
const SMALLEST_PART: usize = 200;
/// Factors with fewer values are not divided.
const WORTH_CUTTING: usize = 200_000;

impl Supernodes {
    /// The pattern of the factor of a matrix: supernodes in ascending order, each given by its
    /// columns and rows.
    pub(crate) fn new<'a>(
        nodes: impl Iterator<Item = (Range<usize>, &'a [u32])>,
        matrix: Rows<'_>,
        (order, inverse): (&[u32], &[u32]),
    ) -> Self {
        let mut all = Self {
            begin: vec![0],
            row_start: vec![0],
            value_start: vec![0],
            rows: vec![],
            parents: vec![],
            entry_start: vec![],
            entries: vec![],
            parts: vec![],
            top: vec![],
        };
        let mut values = 0;
        for (columns, rows) in nodes {
            values += columns.len() * (columns.len() + rows.len());
            all.value_start.push(values);
            all.begin.push(columns.end);
            all.rows.extend_from_slice(rows);
            all.row_start.push(all.rows.len());
        }
        all.parents = all.find_parents();
        all.find_entries(matrix, order, inverse);
        all.cut();
        all
    }

    /// The parent of a supernode in the elimination tree.
    pub(crate) fn parent(&self, s: usize) -> Option<usize> {
        self.parents[s].map(|p| p as usize)
    }

    /// The entries of the matrix in a column of the factor: the place in the column, and the index
    /// of the value in the matrix.
    pub(crate) fn entries_of(&self, column: usize) -> &[(u32, u32)] {
        &self.entries[self.entry_start[column]..self.entry_start[column + 1]]
    }

    /// The number of values of a factor.
    pub(crate) fn value_count(&self) -> usize {
        self.value_start[self.len()]
    }

    /// Finds the places of the entries on and below the diagonal, before rows are renumbered.
    fn find_entries(&mut self, matrix: Rows<'_>, order: &[u32], inverse: &[u32]) {
        self.entries.reserve_exact((matrix.columns.len() + order.len()) / 2);
        self.entry_start.push(0);
        for s in 0..self.len() {
            let (columns, rows) = (self.range(s), self.row_start[s]..self.row_start[s + 1]);
            for k in columns.clone() {
                let row = order[k] as usize;
                for (entry, &j) in matrix.range(row).zip(matrix.row(row).0) {
                    let i = inverse[j as usize];
                    let place = match (i as usize).checked_sub(columns.end) {
                        _ if (i as usize) < k => continue,
                        None => i as usize - columns.start,
                        Some(_) => {
                            columns.len() + self.rows[rows.clone()].partition_point(|r| *r < i)
                        }
                    };
                    self.entries.push((place as u32, entry as u32));
                }
                self.entry_start.push(self.entries.len());
            }
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.begin.len() - 1
    }

    pub(crate) fn columns(&self) -> usize {
        self.begin[self.len()]
    }

    /// The independent subtrees, in ascending order.
    pub(crate) fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// The supernodes outside all parts, in ascending order.
    pub(crate) fn top(&self) -> &[u32] {
        &self.top
    }

    pub(crate) fn range(&self, s: usize) -> Range<usize> {
        self.begin[s]..self.begin[s + 1]
    }

    /// Rows below the triangle, numbered as in the matrix for the top and as in the copy for a
    /// part.
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

    /// Changes the diagonal of the factor with these values.
    pub(crate) fn diagonal_mut(&self, values: &mut [f64], change: impl Fn(f64) -> f64) {
        for s in 0..self.len() {
            let width = self.range(s).len();
            let height = width + self.rows(s).len();
            let block = &mut values[self.values(s)];
            block.iter_mut().step_by(height + 1).take(width).for_each(|d| *d = change(*d));
        }
    }

    /// Σₖ lᵢₖ² |dₖ| for each row i of the factor of L D Lᵀ with these values, D on the diagonal of
    /// L.
    pub(crate) fn eliminated(&self, values: &[f64]) -> Vec<f64> {
        let mut sums = vec![0.0; self.columns()];
        for part in &self.parts {
            for s in part.nodes.clone() {
                let own = part.columns.len();
                self.add_eliminated(s, values, &mut sums, |local| match local.checked_sub(own) {
                    None => part.columns.start + local,
                    Some(outside) => part.outside[outside] as usize,
                });
            }
        }
        for &s in &self.top {
            self.add_eliminated(s as usize, values, &mut sums, |row| row);
        }
        sums
    }

    fn add_eliminated(
        &self,
        s: usize,
        values: &[f64],
        sums: &mut [f64],
        place: impl Fn(usize) -> usize,
    ) {
        let columns = self.range(s);
        let rows = self.rows(s);
        let (width, height) = (columns.len(), columns.len() + rows.len());
        let block = &values[self.values(s)];
        let mut local = vec![0.0; height];
        for j in 0..width {
            let column = &block[j * height..(j + 1) * height];
            let pivot = column[j].abs();
            local[j] += pivot;
            for (sum, l) in local[j + 1..].iter_mut().zip(&column[j + 1..]) {
                *sum += l * l * pivot;
            }
        }
        for (j, sum) in local[..width].iter().enumerate() {
            sums[columns.start + j] += sum;
        }
        for (&row, sum) in rows.iter().zip(&local[width..]) {
            sums[place(row as usize)] += sum;
        }
    }

    /// The number of entries on and below the diagonal, including explicit zeros.
    pub(crate) fn entries(&self) -> usize {
        (0..self.len())
            .map(|s| {
                let width = self.range(s).len();
                width * (width + 1) / 2 + width * self.rows(s).len()
            })
            .sum()
    }

    /// Finds the parts and renumbers their rows.
    fn cut(&mut self) {
        let total = self.value_count();
        if total < WORTH_CUTTING {
            self.top = (0..self.len() as u32).collect();
            return;
        }
        let (mut first, mut weight): (Vec<usize>, Vec<usize>) =
            (0..self.len()).map(|s| (s, self.values(s).len())).unzip();
        for s in 0..self.len() {
            if let Some(p) = self.parent(s) {
                first[p] = first[p].min(first[s]);
                weight[p] += weight[s];
            }
        }
        let largest = total / LARGEST_PART;
        for s in 0..self.len() {
            let maximal = self.parent(s).is_none_or(|p| weight[p] > largest);
            if maximal && weight[s] <= largest && weight[s] >= total / SMALLEST_PART {
                self.parts.push(Part {
                    nodes: first[s]..s + 1,
                    columns: self.begin[first[s]]..self.begin[s + 1],
                    outside: self.rows(s).to_vec(),
                });
            }
        }
        let mut next = 0;
        for part in &self.parts {
            self.top.extend(next as u32..part.nodes.start as u32);
            next = part.nodes.end;
            for row in &mut self.rows[self.row_start[part.nodes.start]..self.row_start[next]] {
                *row = if (*row as usize) < part.columns.end {
                    *row - part.columns.start as u32
                } else {
                    // The root of a subtree touches all outside rows of the subtree.
                    let place = part.outside.partition_point(|r| r < row);
                    (part.columns.len() + place) as u32
                };
            }
        }
        self.top.extend(next as u32..self.len() as u32);
    }

    /// The parent of each supernode: the one that holds its first row below the triangle.
    fn find_parents(&self) -> Vec<Option<u32>> {
        (0..self.len())
            .map(|s| {
                let row = *self.rows(s).first()? as usize;
                Some((self.begin.partition_point(|&b| b <= row) - 1) as u32)
            })
            .collect()
    }
}
