//! Connected components of a graph given by the neighbours of its rows.

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
