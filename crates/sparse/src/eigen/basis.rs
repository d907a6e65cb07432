//! Bases of vectors in blocks of eight, and the products that orthogonalisation needs.
//!
//! A block stores eight vectors interleaved, eight numbers for each row of the problem. A pass over
//! the basis reads it once, in pieces that stay in the cache together with the other block:
//! orthogonalisation runs at memory bandwidth. Partial sums belong to fixed segments of rows and
//! are added in order.

use fairing_watch::parallel::{for_chunks, for_each, map_ranges};

use crate::direct::factor::LANES;
use crate::parallel::{self, Kernel, fused};

/// Eight interleaved vectors.
pub(crate) type Block = Vec<[f64; LANES]>;
/// Inner products of two blocks: `[i][j]` for vector i of the left and j of the right.
pub(crate) type Small = [[f64; LANES]; LANES];

/// Rows that fit the first-level cache.
const PIECE: usize = 256;
/// Rows of one partial sum.
const SEGMENT: usize = 32 * PIECE;
/// Rows that fit the second-level cache for some thirty blocks of a basis.
const SHARED: usize = 2 * PIECE;

/// Uᵀ W for every block U of the basis.
pub(crate) fn products(basis: &[Block], w: &[[f64; LANES]]) -> Vec<Small> {
    weighted_products(basis, None, w)
}

/// Uᵀ D W for every block U of the basis, D diagonal, by default the identity. D W is never stored:
/// fresh memory for a block costs as much as a product.
pub(crate) fn weighted_products(
    basis: &[Block],
    weights: Option<&[f64]>,
    w: &[[f64; LANES]],
) -> Vec<Small> {
    let parts: Vec<Vec<Small>> = map_ranges(w.len(), SEGMENT, |rows| {
        let mut sums = vec![[[0.0; LANES]; LANES]; basis.len()];
        let from = rows.start;
        let weights = weights.map(|d| &d[rows.clone()]);
        parallel::dispatch(Products { basis, from, weights, w: &w[rows], sums: &mut sums });
        sums
    });
    let mut total = vec![[[0.0; LANES]; LANES]; basis.len()];
    for part in parts {
        for (total, part) in
            total.iter_mut().flatten().flatten().zip(part.iter().flatten().flatten())
        {
            *total += part;
        }
    }
    total
}

/// The diagonal of Wᵀ D W.
pub(crate) fn weighted_squares(weights: &[f64], w: &[[f64; LANES]]) -> [f64; LANES] {
    let parts: Vec<[f64; LANES]> = map_ranges(w.len(), SEGMENT, |rows| {
        parallel::dispatch(Squares { weights: &weights[rows.clone()], w: &w[rows] })
    });
    parts.iter().fold([0.0; LANES], |sum, part| std::array::from_fn(|j| sum[j] + part[j]))
}

/// W ← W − Σ U C over the blocks U of the basis.
pub(crate) fn subtract(basis: &[Block], coefficients: &[Small], w: &mut [[f64; LANES]]) {
    for_chunks(w, SEGMENT, |from, w| {
        parallel::dispatch(Subtract { basis, coefficients, from, w });
    });
}

/// Σ U C over the blocks U of the basis, where `coefficients(u, j)` is C for block u and result
/// block j.
pub(crate) fn combine(
    basis: &[Block],
    count: usize,
    coefficients: impl Fn(usize, usize) -> Small + Sync,
) -> Vec<Block> {
    let Some(first) = basis.first() else { return vec![] };
    let coefficients: Vec<Vec<Small>> = (0..count)
        .map(|j| (0..basis.len()).map(|u| coefficients(u, j).map(|row| row.map(|c| -c))).collect())
        .collect();
    let mut results = vec![vec![[0.0; LANES]; first.len()]; count];
    // Segment by segment for all results, so that the basis is read from memory once.
    let mut segments: Vec<Vec<&mut [[f64; LANES]]>> = vec![];
    for result in &mut results {
        for (k, piece) in result.chunks_mut(SHARED).enumerate() {
            if segments.len() == k {
                segments.push(vec![]);
            }
            segments[k].push(piece);
        }
    }
    for_each(segments.into_iter().enumerate(), |(k, pieces)| {
        for (w, coefficients) in pieces.into_iter().zip(&coefficients) {
            parallel::dispatch(Subtract { basis, coefficients, from: k * SHARED, w });
        }
    });
    results
}

/// W ← W C.
pub(crate) fn transform(w: &mut [[f64; LANES]], c: &Small) {
    for_chunks(w, SEGMENT, |_, w| {
        parallel::dispatch(Transform { w, c });
    });
}

struct Products<'a> {
    basis: &'a [Block],
    from: usize,
    weights: Option<&'a [f64]>,
    w: &'a [[f64; LANES]],
    sums: &'a mut [Small],
}

impl Kernel for Products<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let mut from = self.from;
        let mut weighted = [[0.0; LANES]; PIECE];
        for (k, w) in self.w.chunks(PIECE).enumerate() {
            let w = match self.weights {
                None => w,
                Some(weights) => {
                    let weights = &weights[k * PIECE..][..w.len()];
                    let weighted = &mut weighted[..w.len()];
                    for ((out, w), d) in weighted.iter_mut().zip(w).zip(weights) {
                        for j in 0..LANES {
                            out[j] = d * w[j];
                        }
                    }
                    &*weighted
                }
            };
            for (u, sum) in self.basis.iter().zip(&mut *self.sums) {
                product_piece(&u[from..from + w.len()], w, sum);
            }
            from += w.len();
        }
    }
}

struct Squares<'a> {
    weights: &'a [f64],
    w: &'a [[f64; LANES]],
}

impl Kernel for Squares<'_> {
    type Output = [f64; LANES];

    #[inline(always)]
    fn call(self) -> [f64; LANES] {
        let mut sum = [0.0; LANES];
        for (w, d) in self.w.iter().zip(self.weights) {
            for j in 0..LANES {
                sum[j] = fused(d * w[j], w[j], sum[j]);
            }
        }
        sum
    }
}

struct Subtract<'a> {
    basis: &'a [Block],
    coefficients: &'a [Small],
    from: usize,
    w: &'a mut [[f64; LANES]],
}

impl Kernel for Subtract<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let mut from = self.from;
        for w in self.w.chunks_mut(PIECE) {
            for (u, c) in self.basis.iter().zip(self.coefficients) {
                subtract_piece(&u[from..from + w.len()], c, w);
            }
            from += w.len();
        }
    }
}

struct Transform<'a> {
    w: &'a mut [[f64; LANES]],
    c: &'a Small,
}

impl Kernel for Transform<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for w in self.w {
            let mut sum = [0.0; LANES];
            for i in 0..LANES {
                for j in 0..LANES {
                    sum[j] = fused(w[i], self.c[i][j], sum[j]);
                }
            }
            *w = sum;
        }
    }
}

#[inline(always)]
fn product_piece(u: &[[f64; LANES]], w: &[[f64; LANES]], sum: &mut Small) {
    // Two halves, so that the sums fit in sixteen registers.
    const HALF: usize = LANES / 2;
    for half in [0, HALF] {
        let mut sums = [[0.0; LANES]; HALF];
        sums.copy_from_slice(&sum[half..half + HALF]);
        for (u, w) in u.iter().zip(w) {
            for i in 0..HALF {
                for j in 0..LANES {
                    sums[i][j] = fused(u[half + i], w[j], sums[i][j]);
                }
            }
        }
        sum[half..half + HALF].copy_from_slice(&sums);
    }
}

#[inline(always)]
fn subtract_piece(u: &[[f64; LANES]], c: &Small, w: &mut [[f64; LANES]]) {
    for (u, w) in u.iter().zip(w) {
        let mut value = *w;
        for i in 0..LANES {
            for j in 0..LANES {
                value[j] = fused(-u[i], c[i][j], value[j]);
            }
        }
        *w = value;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Small integers: all sums are exact, pieces and segments included.
    #[test]
    fn products_match_plain_loops() {
        let rows = SEGMENT + PIECE + 3;
        let block = |k: usize| -> Block {
            (0..rows)
                .map(|r| std::array::from_fn(|i| ((r * 3 + i * 5 + k) % 7) as f64 - 3.0))
                .collect()
        };
        let basis = [block(0), block(4)];
        let w = block(2);
        let c = products(&basis, &w);
        let mut rest = w.clone();
        subtract(&basis, &c, &mut rest);
        let joined = combine(&basis, 1, |u, _| c[u]);
        for i in 0..LANES {
            for j in 0..LANES {
                for u in 0..2 {
                    let expected: f64 = (0..rows).map(|r| basis[u][r][i] * w[r][j]).sum();
                    assert_eq!(c[u][i][j], expected);
                }
            }
        }
        for r in [0, 1, PIECE, SEGMENT - 1, SEGMENT, rows - 1] {
            for j in 0..LANES {
                let sum: f64 = (0..2)
                    .map(|u| (0..LANES).map(|i| basis[u][r][i] * c[u][i][j]).sum::<f64>())
                    .sum();
                assert_eq!(rest[r][j], w[r][j] - sum);
                assert_eq!(joined[0][r][j], sum);
            }
        }
    }
}
