//! Connected parts of a graph without the rows whose values are given.

use std::ops::Range;

use fairing_watch::parallel::map_ranges;

use crate::components::components;
use crate::graph_laplacian::GraphLaplacian;
use crate::order::larger;
use crate::parallel::{CHUNK, Sum};

/// The largest number of parts over which values are gathered in parallel.
const FEW: usize = 16;

/// Connected parts of the rows whose values are not given.
#[derive(Debug, Clone)]
pub(super) struct Parts {
    /// The part of each row; the number of parts for rows of given values.
    label: Vec<u32>,
    /// The first row of each part.
    first: Vec<u32>,
    /// True for each part without a neighbour of given value; false for the rows of given values,
    /// which count as one more part.
    floating: Vec<bool>,
}

impl Parts {
    pub(super) fn new(laplacian: &GraphLaplacian, given: &[bool]) -> Self {
        let neighbors = |i: usize| laplacian.neighbors(i).iter().copied();
        let (count, label) = components(given.len(), |i| given[i], neighbors);
        let (mut first, mut floating) = (vec![0; count + 1], vec![true; count + 1]);
        floating[count] = false;
        for (i, &part) in label.iter().enumerate().rev() {
            first[part as usize] = i as u32;
            floating[part as usize] &= !neighbors(i).any(|j| given[j as usize]);
        }
        first.truncate(count);
        Self { label, first, floating }
    }

    /// The first row of each part, without the rows of given values.
    pub(super) fn firsts(&self) -> &[u32] {
        &self.first
    }

    /// The number of parts; the rows of given values count as one more.
    pub(super) fn count(&self) -> usize {
        self.floating.len()
    }

    /// The part of row `i`.
    #[inline(always)]
    pub(super) fn part(&self, i: usize) -> usize {
        self.label[i] as usize
    }

    /// Returns true if the value of row `i` is given.
    #[inline(always)]
    pub(super) fn is_given(&self, i: usize) -> bool {
        self.part(i) + 1 == self.floating.len()
    }

    /// Returns true if no value in the part or next to it is given.
    #[inline(always)]
    pub(super) fn floats(&self, part: usize) -> bool {
        self.floating[part]
    }

    /// The sum over each part of `f(part, row)`.
    pub(super) fn sums<S: Sum + Sync>(&self, f: impl Fn(usize, usize) -> S + Sync) -> Vec<S> {
        let add = |mut sum: S, term: S| {
            sum.add(term);
            sum
        };
        self.gather(S::ZERO, add, &f)
    }

    /// The largest value of `f(part, row)` in each part and column, at least zero.
    pub(super) fn largest<const N: usize>(
        &self,
        f: impl Fn(usize, usize) -> [f64; N] + Sync,
    ) -> Vec<[f64; N]> {
        let join = |a: [f64; N], b: [f64; N]| std::array::from_fn(|k| larger(a[k], b[k]));
        self.gather([0.0; N], join, &f)
    }

    fn gather<T: Copy + Send + Sync>(
        &self,
        zero: T,
        join: fn(T, T) -> T,
        f: &(dyn Fn(usize, usize) -> T + Sync),
    ) -> Vec<T> {
        let gather = |rows: Range<usize>| {
            let mut all = vec![zero; self.count()];
            let mut i = rows.start;
            // Consecutive rows are mostly of one part, whose value stays in registers.
            for run in self.label[rows].chunk_by(|a, b| a == b) {
                let part = run[0] as usize;
                all[part] = (i..i + run.len()).fold(all[part], |all, i| join(all, f(part, i)));
                i += run.len();
            }
            all
        };
        if self.count() > FEW {
            return gather(0..self.label.len());
        }
        let chunks = map_ranges(self.label.len(), CHUNK, gather);
        let mut total = vec![zero; self.count()];
        for chunk in chunks {
            for (total, value) in total.iter_mut().zip(chunk) {
                *total = join(*total, value);
            }
        }
        total
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Few parts are gathered by chunks of rows, many parts by one thread.
    #[test]
    fn parts_are_gathered_over_all_chunks() {
        let n = 2 * CHUNK + 77;
        for count in [3, 2 * FEW as u32] {
            let label: Vec<u32> = (0..n as u32).map(|i| (i / 200 + i % 2) % count).collect();
            let floating = vec![false; count as usize];
            let parts = Parts { label: label.clone(), first: vec![], floating };
            let sums = parts.sums(|_, i| [i as f64, 1.0]);
            let largest = parts.largest(|part, i| [(part + i) as f64]);
            for (part, (sums, [largest])) in sums.into_iter().zip(largest).enumerate() {
                let own = || (0..n).filter(|&i| label[i] as usize == part);
                // Whole numbers: the order of a sum does not matter.
                assert_eq!(sums, [own().sum::<usize>() as f64, own().count() as f64]);
                assert_eq!(Some(largest), own().next_back().map(|i| (part + i) as f64));
            }
        }
    }
}
