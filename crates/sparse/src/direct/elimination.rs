//! Elimination of a graph Laplacian without subtractions.
//!
//! A matrix `D + S` of a diagonal D ≥ 0 and a Laplacian S with positive weights is given by D and
//! the weights alone. Eliminating a vertex joins its neighbours by new edges and distributes its
//! entry of D among them:
//!
//! ```text
//! p = dₖ + Σⱼ wₖⱼ,    wᵢⱼ ← wᵢⱼ + wₖᵢ wₖⱼ / p,    dᵢ ← dᵢ + wₖᵢ dₖ / p
//! ```
//!
//! All terms are positive, so every number keeps its relative accuracy, however small D is and
//! however much the weights differ: no diagonal is stored, in which small terms of a row would be
//! lost. Source: \[alfa2002\].

use fairing_watch::check;

/// Rows between two checks for cancellation.
const ROWS: usize = 4096;

/// The factor, as fractions of pivots; it solves by two sweeps of additions.
#[derive(Debug, Clone)]
pub(crate) struct Elimination {
    /// The elimination order: row `order[k]` is eliminated k-th.
    order: Vec<u32>,
    starts: Vec<usize>,
    /// Positions in the order, each after that of the row.
    columns: Vec<u32>,
    /// `w/p` for each column.
    fractions: Vec<f64>,
    pivots: Vec<f64>,
}

impl Elimination {
    /// Eliminates the rows in the given order, from their off-diagonal weights and D, `added`.
    ///
    /// # Errors
    ///
    /// The row and value of the first pivot that is not positive: a weight is negative, or D
    /// vanishes on a connected part.
    pub(crate) fn new<R: Iterator<Item = (u32, f64)>>(
        order: Vec<u32>,
        weights: impl Fn(usize) -> R,
        mut added: Vec<f64>,
    ) -> Result<Self, (usize, f64)> {
        let n = order.len();
        let mut place = vec![0u32; n];
        for (k, &row) in order.iter().enumerate() {
            place[row as usize] = k as u32;
        }
        // Each edge is kept with the end that is eliminated first.
        let mut later: Vec<Vec<(u32, f64)>> = Vec::with_capacity(n);
        for (k, &row) in order.iter().enumerate() {
            let placed = weights(row as usize).map(|(j, w)| (place[j as usize], w));
            let mut edges: Vec<(u32, f64)> = placed.filter(|&(j, _)| j as usize > k).collect();
            edges.sort_unstable_by_key(|&(j, _)| j);
            later.push(edges);
        }
        let (mut starts, mut pivots) = (vec![0], Vec::with_capacity(n));
        let (mut columns, mut fractions) = (Vec::new(), Vec::new());
        let mut merged = Vec::new();
        for k in 0..n {
            if k % ROWS == 0 {
                check();
            }
            let edges = std::mem::take(&mut later[k]);
            let own = added[order[k] as usize];
            let pivot = own + edges.iter().map(|(_, w)| w).sum::<f64>();
            if !(pivot > 0.0 && pivot.is_finite()) {
                return Err((order[k] as usize, pivot));
            }
            for (a, &(i, w)) in edges.iter().enumerate() {
                let fraction = w / pivot;
                added[order[i as usize] as usize] += fraction * own;
                merge(&later[i as usize], &edges[a + 1..], fraction, &mut merged);
                std::mem::swap(&mut later[i as usize], &mut merged);
                columns.push(i);
                fractions.push(fraction);
            }
            starts.push(columns.len());
            pivots.push(pivot);
        }
        Ok(Self { order, starts, columns, fractions, pivots })
    }

    /// Overwrites `b` with the solution.
    pub(crate) fn solve_in_place<const N: usize>(&self, b: &mut [[f64; N]]) {
        let mut x: Vec<[f64; N]> = self.order.iter().map(|&row| b[row as usize]).collect();
        let row = |k: usize| {
            let range = self.starts[k]..self.starts[k + 1];
            self.columns[range.clone()].iter().zip(&self.fractions[range])
        };
        for k in 0..x.len() {
            let own = x[k];
            for (&i, fraction) in row(k) {
                for (x, own) in x[i as usize].iter_mut().zip(own) {
                    *x += fraction * own;
                }
            }
        }
        for k in (0..x.len()).rev() {
            let mut value = x[k].map(|x| x / self.pivots[k]);
            for (&i, fraction) in row(k) {
                for (value, x) in value.iter_mut().zip(x[i as usize]) {
                    *value += fraction * x;
                }
            }
            x[k] = value;
        }
        for (&row, x) in self.order.iter().zip(x) {
            b[row as usize] = x;
        }
    }
}

/// The sum of a row and of a multiple of another, both ascending.
fn merge(a: &[(u32, f64)], b: &[(u32, f64)], factor: f64, sum: &mut Vec<(u32, f64)>) {
    sum.clear();
    let mut a = a.iter().peekable();
    for &(j, w) in b {
        while let Some(&&(i, v)) = a.peek().filter(|(i, _)| *i < j) {
            sum.push((i, v));
            a.next();
        }
        let own = a.next_if(|(i, _)| *i == j).map_or(0.0, |(_, v)| *v);
        sum.push((j, own + factor * w));
    }
    sum.extend(a);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// On a path whose weights alternate between 1 and 10⁻²⁰, held at its first vertex by 10⁻³⁰,
    /// the potential of a source at the far end is the sum of all resistances, to the last digits.
    #[test]
    fn small_weights_keep_their_digits() {
        let n = 1001;
        let weight = |k: usize| if k.is_multiple_of(2) { 1.0 } else { 1e-20 };
        let row = |i: usize| {
            let before = (i > 0).then(|| (i as u32 - 1, weight(i - 1)));
            before.into_iter().chain((i + 1 < n).then(|| (i as u32 + 1, weight(i))))
        };
        let mut held = vec![0.0; n];
        held[0] = 1e-30;
        // Every third row first, so that edges are added.
        let mut order: Vec<u32> = (0..n as u32).filter(|i| i % 3 == 1).collect();
        order.extend((0..n as u32).filter(|i| i % 3 != 1));
        let factor = Elimination::new(order, row, held).unwrap();
        let mut x = vec![[0.0]; n];
        x[n - 1] = [1.0];
        factor.solve_in_place(&mut x);
        let mut exact = 1e30;
        for (k, [x]) in x.iter().enumerate() {
            assert!((x / exact - 1.0).abs() < 1e-13, "{k}: {x:e} {exact:e}");
            exact += 1.0 / weight(k);
        }
    }

    #[test]
    fn a_part_that_nothing_holds_is_named() {
        let row = |i: usize| [(1 - i as u32, 1.0)].into_iter();
        let failed = Elimination::new(vec![1, 0], row, vec![0.0; 2]);
        assert_eq!(failed.map(|_| ()), Err((0, 0.0)));
    }
}
