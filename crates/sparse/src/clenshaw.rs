//! Clenshaw's recurrence over a graph, several terms at a time while rows are in cache.
//!
//! A term reads and writes every row once, and a large graph does not fit in cache, so terms taken
//! one after another are bound by memory bandwidth. But row `i` of term `k` needs term `k − 1` only
//! at the neighbours of `i`. If neighbouring rows are at most the *bandwidth* of the matrix apart,
//! a block of rows can proceed to the next term as soon as the following block has finished the
//! current one. Blocks therefore run in waves, each one term behind the next, and one pass over
//! memory serves a whole batch of terms.
//!
//! Each thread takes a part of the rows. At the end of a part every term stops one block earlier
//! than the term before; the triangles missing between two parts are filled in afterwards. Every
//! value is computed by the same operations however the rows are divided, so the result does not
//! depend on threads, parts or blocks.

use std::ops::Range;

use fairing_watch::parallel::for_each;

use crate::graph_laplacian::{Factors, GraphLaplacian, Padded};
use crate::parallel::{self, Kernel};

/// Bytes available to the active blocks of a batch: most of one core's second-level cache.
const CACHE: usize = 1 << 20;

/// Bytes per row: three points, and the row's neighbours with their weights.
const ROW: usize = 160;

/// The largest number of terms in a batch: more save hardly any memory traffic.
const MAX_TERMS: usize = 16;

/// The smallest number of terms for which a batch pays.
const MIN_TERMS: usize = 3;

/// The smallest number of rows in a block.
const MIN_BLOCK: usize = 128;

/// The recurrence `bₖ = cₖ x + 2 T bₖ₊₁ − bₖ₊₂` with `T = 1 + s L`, from the highest k down to 0,
/// where the factor 2 is dropped.
#[derive(Clone, Copy)]
pub(crate) struct Clenshaw<'a> {
    pub(crate) laplacian: &'a GraphLaplacian,
    pub(crate) x: &'a [Padded],
    pub(crate) coefficients: &'a [f64],
    pub(crate) scale: f64,
}

impl Clenshaw<'_> {
    /// `b₀`.
    pub(crate) fn evaluate(self) -> Vec<Padded> {
        let n = self.x.len();
        let (mut last, mut before) = (vec![[0.0; 4]; n], vec![[0.0; 4]; n]);
        let block = self.laplacian.bandwidth().max(MIN_BLOCK);
        // Two more blocks than terms are active: one ahead of the first and one behind the last.
        let batch = (CACHE / (ROW * block)).saturating_sub(2).min(MAX_TERMS);
        let batch = if batch < MIN_TERMS || n < 2 * block { 1 } else { batch };
        let terms = self.coefficients.len();
        let mut done = 0;
        fairing_watch::stage("terms of the series", terms as u64);
        while done < terms {
            let count = batch.min(terms - done);
            let batch = Batch { recurrence: self, done, count, block };
            batch.run(&mut last, &mut before);
            if !count.is_multiple_of(2) {
                std::mem::swap(&mut last, &mut before);
            }
            done += count;
            fairing_watch::advance(count as u64);
        }
        last
    }

    /// Computes the term after the first `done` on some rows; slices begin with row `offset`.
    #[inline(always)]
    fn term(
        self,
        done: usize,
        rows: Range<usize>,
        offset: usize,
        last: &[Padded],
        before: &mut [Padded],
    ) {
        let k = self.coefficients.len() - 1 - done;
        let twice = if k == 0 { 1.0 } else { 2.0 };
        let factors = Factors { point: self.coefficients[k], own: twice, l: twice * self.scale };
        let points = &self.x[rows.clone()];
        let out = &mut before[rows.start - offset..rows.end - offset];
        self.laplacian.recur(rows, offset, last, points, out, factors);
    }
}

/// Consecutive terms computed in one pass over memory.
#[derive(Clone, Copy)]
struct Batch<'a> {
    recurrence: Clenshaw<'a>,
    /// Terms before this batch.
    done: usize,
    /// Terms in this batch.
    count: usize,
    /// Rows of a block, at least the bandwidth.
    block: usize,
}

impl Batch<'_> {
    /// Computes the terms alternately from `last` into `before` and back.
    fn run(self, last: &mut [Padded], before: &mut [Padded]) {
        let n = last.len();
        // Half a part must hold the triangle at its end and one more block, which that reads.
        let smallest = 2 * (self.count + 1) * self.block;
        let parts = (n / smallest).clamp(1, rayon::current_num_threads().max(1));
        let ends: Vec<usize> = (0..=parts).map(|q| q * n / parts).collect();
        let middles: Vec<usize> = ends.windows(2).map(|e| (e[0] + e[1]) / 2).collect();
        for_each(split(last, before, &ends), |piece| {
            parallel::dispatch(Trapezoid { batch: self, piece, n });
        });
        let between = split(last, before, &middles);
        for_each(between.into_iter().zip(&ends[1..]), |(piece, &end)| {
            parallel::dispatch(Triangle { batch: self, piece, end });
        });
    }

    /// Term `t` of the batch on some rows of a piece.
    #[inline(always)]
    fn term(self, t: usize, rows: Range<usize>, piece: &mut Piece<'_>) {
        if rows.is_empty() {
            return;
        }
        let Piece { offset, last, before } = piece;
        let (from, to) = if t.is_multiple_of(2) { (last, before) } else { (before, last) };
        self.recurrence.term(self.done + t, rows, *offset, from, to);
    }
}

/// Consecutive rows of both arrays, starting at row `offset`.
struct Piece<'a> {
    offset: usize,
    last: &'a mut [Padded],
    before: &'a mut [Padded],
}

/// The pieces between consecutive rows of `ends`.
fn split<'a>(last: &'a mut [Padded], before: &'a mut [Padded], ends: &[usize]) -> Vec<Piece<'a>> {
    let first = ends.first().copied().unwrap_or(0);
    let (mut last, mut before) = (&mut last[first..], &mut before[first..]);
    let mut pieces = Vec::with_capacity(ends.len());
    for pair in ends.windows(2) {
        let (l, rest) = last.split_at_mut(pair[1] - pair[0]);
        last = rest;
        let (b, rest) = before.split_at_mut(pair[1] - pair[0]);
        before = rest;
        pieces.push(Piece { offset: pair[0], last: l, before: b });
    }
    pieces
}

/// A part of the rows. Each term ends one block further away from the borders with other parts.
struct Trapezoid<'a> {
    batch: Batch<'a>,
    piece: Piece<'a>,
    /// The number of rows of all parts.
    n: usize,
}

impl Kernel for Trapezoid<'_> {
    type Output = ();

    #[inline(always)]
    fn call(mut self) {
        let Batch { count, block, .. } = self.batch;
        let (start, end) = (self.piece.offset, self.piece.offset + self.piece.last.len());
        let blocks = (end - start).div_ceil(block);
        for wave in 0..blocks + count {
            for t in 0..count.min(wave + 1) {
                let first = start + (wave - t) * block;
                let low = if start == 0 { 0 } else { start + (t + 1) * block };
                let high = if end == self.n { end } else { end - (t + 1) * block };
                let rows = first.max(low)..(first + block).min(high);
                self.batch.term(t, rows, &mut self.piece);
            }
        }
    }
}

/// The rows that the trapezoids on both sides of `end` leave out, more with every term.
struct Triangle<'a> {
    batch: Batch<'a>,
    piece: Piece<'a>,
    end: usize,
}

impl Kernel for Triangle<'_> {
    type Output = ();

    #[inline(always)]
    fn call(mut self) {
        let Batch { count, block, .. } = self.batch;
        for t in 0..count {
            let rows = self.end - (t + 1) * block..self.end + (t + 1) * block;
            self.batch.term(t, rows, &mut self.piece);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The recurrence as in the formula, one term after another.
    fn plainly(of: Clenshaw<'_>) -> Vec<Padded> {
        let n = of.x.len();
        let (mut last, mut before) = (vec![[0.0; 4]; n], vec![[0.0; 4]; n]);
        for done in 0..of.coefficients.len() {
            of.term(done, 0..n, 0, &last, &mut before);
            std::mem::swap(&mut last, &mut before);
        }
        last
    }

    /// A strip of triangles over `length` × `width` vertices, open or closed to a tube; vertex `v`
    /// has the number `stride v` modulo the vertex count.
    fn strip(width: usize, length: usize, closed: bool, stride: usize) -> GraphLaplacian {
        let n = width * length;
        let number = |x: usize, y: usize| (y * width + x % width) * stride % n;
        let mut rows = vec![Vec::new(); n];
        for (y, x) in (0..length).flat_map(|y| (0..width).map(move |x| (y, x))) {
            for (dx, dy) in [(1, 0), (0, 1), (1, 1)] {
                if (closed || x + dx < width) && y + dy < length {
                    let (a, b) = (number(x, y), number(x + dx, y + dy));
                    rows[a].push(b as u32);
                    rows[b].push(a as u32);
                }
            }
        }
        let mut offsets = vec![0];
        offsets.extend(rows.iter().scan(0, |end, row| {
            *end += row.len() as u32;
            Some(*end)
        }));
        GraphLaplacian::uniform(offsets, rows.concat())
    }

    /// Blocks and parts do not change a bit of the result: on graphs that fill several parts, with
    /// a border, and in an order without locality.
    #[test]
    fn blocks_and_parts_do_not_show() {
        let coefficients: Vec<f64> = (0..40).map(|k| 1.0 / f64::from(1 + k * k)).collect();
        for (laplacian, local) in [
            (strip(60, 400, true, 1), true),
            (strip(21, 901, false, 1), true),
            (strip(60, 400, true, 7001), false),
        ] {
            let n = laplacian.len();
            assert_eq!(laplacian.bandwidth() < n / 4, local);
            let x: Vec<Padded> =
                (0..n).map(|i| [(i % 60) as f64, (i / 60) as f64, (i % 7) as f64, 0.0]).collect();
            for terms in [1, 2, 7, 40] {
                let coefficients = &coefficients[..terms];
                let of = Clenshaw { laplacian: &laplacian, x: &x, coefficients, scale: 0.9 };
                let expected = plainly(of);
                for threads in [1, 2, 5] {
                    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
                    let result = pool.unwrap().install(|| of.evaluate());
                    assert!(result == expected, "{terms} terms, {threads} threads");
                }
            }
        }
    }
}
