//! Incomplete Cholesky factorisation on the pattern of the matrix, IC(0), as a preconditioner.

use crate::matrix::Rows;

/// L with L Lᵀ ≈ A, on the lower triangle of A; rows hold the diagonal last.
#[derive(Debug, Clone)]
pub(crate) struct IncompleteCholesky {
    starts: Vec<usize>,
    columns: Vec<u32>,
    values: Vec<f64>,
}

/// First share of the diagonal added when a pivot fails; it doubles until none does.
const FIRST_SHIFT: f64 = 1e-3;

impl IncompleteCholesky {
    /// Factorises A, with a growing share of its diagonal added while pivots break down (Manteuffel's shift:
    /// positive off-diagonal entries can spoil them). `None` if even a dominant diagonal does not help, which
    /// takes a diagonal entry that is not positive.
    pub(crate) fn new(rows: Rows<'_>) -> Option<Self> {
        if rows.diagonal().iter().any(|d| d.is_nan() || *d <= 0.0) {
            return None;
        }
        let mut shift = 0.0;
        loop {
            if let Some(factor) = Self::shifted(rows, shift) {
                return Some(factor);
            }
            shift = if shift == 0.0 { FIRST_SHIFT } else { 2.0 * shift };
            if shift > 1e6 {
                return None;
            }
        }
    }

    fn shifted(rows: Rows<'_>, shift: f64) -> Option<Self> {
        let n = rows.count();
        let mut starts = Vec::with_capacity(n + 1);
        let (mut columns, mut values) = (vec![], vec![]);
        starts.push(0);
        for i in 0..n {
            let (row_columns, row_values) = rows.row(i);
            for (&j, &a) in row_columns.iter().zip(row_values).filter(|(j, _)| **j as usize <= i) {
                columns.push(j);
                values.push(if j as usize == i { a * (1.0 + shift) } else { a });
            }
            starts.push(columns.len());
        }
        // place[j]: where row i holds column j, while row i is worked on.
        let mut place = vec![usize::MAX; n];
        for i in 0..n {
            let row = starts[i]..starts[i + 1];
            let diagonal = row.end - 1;
            for k in row.clone() {
                place[columns[k] as usize] = k;
            }
            for k in row.start..diagonal {
                let j = columns[k] as usize;
                let above = starts[j]..starts[j + 1] - 1;
                let mut value = values[k];
                for q in above.clone() {
                    if let Some(l) = values.get(place[columns[q] as usize]) {
                        value -= l * values[q];
                    }
                }
                value /= values[above.end];
                values[k] = value;
                values[diagonal] -= value * value;
            }
            for k in row {
                place[columns[k] as usize] = usize::MAX;
            }
            if values[diagonal].is_nan() || values[diagonal] <= 0.0 {
                return None;
            }
            values[diagonal] = values[diagonal].sqrt();
        }
        Some(Self { starts, columns, values })
    }

    /// x ← (L Lᵀ)⁻¹ x.
    pub(crate) fn solve_in_place<const B: usize>(&self, x: &mut [[f64; B]]) {
        let n = x.len();
        for i in 0..n {
            let (row, diagonal) = (self.starts[i]..self.starts[i + 1] - 1, self.starts[i + 1] - 1);
            let mut sum = x[i];
            for k in row {
                let (l, from) = (self.values[k], &x[self.columns[k] as usize]);
                for lane in 0..B {
                    sum[lane] -= l * from[lane];
                }
            }
            x[i] = sum.map(|s| s / self.values[diagonal]);
        }
        for i in (0..n).rev() {
            let (row, diagonal) = (self.starts[i]..self.starts[i + 1] - 1, self.starts[i + 1] - 1);
            let value = x[i].map(|s| s / self.values[diagonal]);
            x[i] = value;
            for k in row {
                let (l, to) = (self.values[k], &mut x[self.columns[k] as usize]);
                for lane in 0..B {
                    to[lane] -= l * value[lane];
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::matrix::SparseMatrix;

    /// A path has no fill, so the incomplete factor is the complete one.
    #[test]
    fn exact_without_fill() {
        let mut t = sprs::TriMatI::<f64, u32>::new((5, 5));
        for i in 0..5 {
            t.add_triplet(i, i, 3.0);
            if i > 0 {
                t.add_triplet(i, i - 1, -1.0);
                t.add_triplet(i - 1, i, -1.0);
            }
        }
        let matrix: SparseMatrix = t.to_csr();
        let factor = IncompleteCholesky::new(Rows::of(&matrix)).unwrap();
        let mut x: Vec<[f64; 1]> =
            crate::multiply(&matrix, &[1.0, 2.0, 3.0, 4.0, 5.0]).into_iter().map(|v| [v]).collect();
        factor.solve_in_place(&mut x);
        for (i, x) in x.iter().enumerate() {
            assert!((x[0] - (i + 1) as f64).abs() < 1e-14, "{x:?}");
        }
    }
}
