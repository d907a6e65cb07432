//! Connected components of a graph given by the neighbours of its rows, and those whose constants a
//! matrix maps to zero.

use crate::matrix::Rows;

/// The label of a row that is left out.
const OUT: u32 = u32::MAX;

/// The number of components of the rows `0..rows`, and the component of each row, numbered in the
/// order of their first rows. Rows for which `is_out` is true belong to none, and have the number
/// of components as their label.
pub(crate) fn components<I: IntoIterator<Item = u32>>(
    rows: usize,
    is_out: impl Fn(usize) -> bool,
    neighbors: impl Fn(usize) -> I,
) -> (usize, Vec<u32>) {
    let (mut label, mut count) = (vec![OUT; rows], 0);
    let mut open = Vec::new();
    for seed in 0..rows {
        if label[seed] != OUT || is_out(seed) {
            continue;
        }
        label[seed] = count;
        open.push(seed);
        while let Some(i) = open.pop() {
            for j in neighbors(i) {
                let j = j as usize;
                if label[j] == OUT && !is_out(j) {
                    label[j] = count;
                    open.push(j);
                }
            }
        }
        count += 1;
    }
    for label in &mut label {
        *label = (*label).min(count);
    }
    (count as usize, label)
}

/// A row sum counts as zero within this many ε, per entry, of the sum of the absolute entries:
/// assembly rounds every entry and every addition. With a larger bound, a small pinned part with
/// weak ties to the rest would count as a component of its own.
const ROUNDINGS: f64 = 4.0;

/// The component of every row in the graph of S, numbered by first row, or `None` if a row of the
/// component has a nonzero sum (pinned rows, potentials).
pub(crate) fn constant_components(rows: Rows<'_>) -> (usize, Vec<Option<u32>>) {
    let (count, component) = components(rows.count(), |_| false, |i| rows.nonzeros(i));
    let mut constant = vec![true; count];
    for (i, &component) in component.iter().enumerate() {
        constant[component as usize] &= row_sum(rows.row(i).1) == 0.0;
    }
    let mut count = 0;
    let names: Vec<Option<u32>> = constant
        .iter()
        .map(|&balanced| {
            balanced.then(|| {
                count += 1;
                count - 1
            })
        })
        .collect();
    (count as usize, component.iter().map(|&c| names[c as usize]).collect())
}

/// The sum of every row, exactly zero if zero up to rounding.
pub(crate) fn row_sums(rows: Rows<'_>) -> Vec<f64> {
    (0..rows.count()).map(|i| row_sum(rows.row(i).1)).collect()
}

fn row_sum(values: &[f64]) -> f64 {
    let size: f64 = values.iter().map(|v| v.abs()).sum();
    let rounding = ROUNDINGS * values.len() as f64 * f64::EPSILON * size;
    let sum = values.iter().sum::<f64>();
    if sum.abs() <= rounding { 0.0 } else { sum }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::matrix::SparseMatrix;

    /// Components {0, 2}, {1}, {3, 4}; the last has a pinned row.
    #[test]
    fn pinned_components_have_no_constants() {
        let mut t = sprs::TriMatI::<f64, u32>::new((5, 5));
        for (i, j, v) in [
            (0, 0, 1.0),
            (0, 2, -1.0),
            (2, 0, -1.0),
            (2, 2, 1.0),
            (3, 3, 2.0),
            (3, 4, -1.0),
            (4, 3, -1.0),
            (4, 4, 1.0),
        ] {
            t.add_triplet(i, j, v);
        }
        let matrix: SparseMatrix = t.to_csr();
        let (count, names) = constant_components(Rows::new(&matrix));
        assert_eq!((count, names), (2, vec![Some(0), Some(1), Some(0), None, None]));
    }

    /// Two rows tied to each other by 10¹² and to a pinned row by 1 are pinned; a tie of the size
    /// of rounding does not count.
    #[test]
    fn weak_ties_are_ties() {
        for (tie, count) in [(1.0, 0), (1e-4, 1)] {
            let values = vec![1e12 + tie, -1e12, -1e12, 1e12];
            let matrix = SparseMatrix::new((2, 2), vec![0, 2, 4], vec![0, 1, 0, 1], values);
            assert_eq!(constant_components(Rows::new(&matrix)).0, count, "{tie}");
        }
    }
}
