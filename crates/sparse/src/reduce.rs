//! Passes over rows with sums whose order does not depend on the number of threads.
//!
//! Rows are cut into fixed chunks; each chunk is summed from front to back, and the sums of the chunks are
//! added in order, whoever computed them.

use rayon::prelude::*;

/// Rows of one chunk.
const CHUNK: usize = 4096;

/// Adds up `work(first row, chunk)` over the chunks of one mutable array, lane by lane.
pub(crate) fn sum1<A: Send, const B: usize>(
    a: &mut [A],
    work: impl Fn(usize, &mut [A]) -> [f64; B] + Sync,
) -> [f64; B] {
    if a.len() <= CHUNK {
        return work(0, a);
    }
    let parts: Vec<_> =
        a.par_chunks_mut(CHUNK).enumerate().map(|(c, a)| work(c * CHUNK, a)).collect();
    total(&parts)
}

/// Adds up `work(first row, chunk, chunk)` over the chunks of two mutable arrays, lane by lane.
pub(crate) fn sum2<A: Send, C: Send, const B: usize>(
    a: &mut [A],
    b: &mut [C],
    work: impl Fn(usize, &mut [A], &mut [C]) -> [f64; B] + Sync,
) -> [f64; B] {
    if a.len() <= CHUNK {
        return work(0, a, b);
    }
    let parts: Vec<_> = a
        .par_chunks_mut(CHUNK)
        .zip(b.par_chunks_mut(CHUNK))
        .enumerate()
        .map(|(c, (a, b))| work(c * CHUNK, a, b))
        .collect();
    total(&parts)
}

/// Σᵢ aᵢ bᵢ, lane by lane.
pub(crate) fn dot<const B: usize>(a: &[[f64; B]], b: &[[f64; B]]) -> [f64; B] {
    let chunk = |(a, b): (&[[f64; B]], &[[f64; B]])| {
        let mut sum = [0.0; B];
        for (a, b) in a.iter().zip(b) {
            for lane in 0..B {
                sum[lane] += a[lane] * b[lane];
            }
        }
        sum
    };
    if a.len() <= CHUNK {
        return chunk((a, b));
    }
    let parts: Vec<_> = a.par_chunks(CHUNK).zip(b.par_chunks(CHUNK)).map(chunk).collect();
    total(&parts)
}

fn total<const B: usize>(parts: &[[f64; B]]) -> [f64; B] {
    parts.iter().fold([0.0; B], |sum, part| std::array::from_fn(|lane| sum[lane] + part[lane]))
}

/// Σᵢ wᵢ aᵢ², lane by lane.
pub(crate) fn weighted_square<const B: usize>(a: &[[f64; B]], weights: &[f64]) -> [f64; B] {
    let chunk = |(a, w): (&[[f64; B]], &[f64])| {
        let mut sum = [0.0; B];
        for (a, w) in a.iter().zip(w) {
            for lane in 0..B {
                sum[lane] += w * a[lane] * a[lane];
            }
        }
        sum
    };
    if a.len() <= CHUNK {
        return chunk((a, weights));
    }
    let parts: Vec<_> = a.par_chunks(CHUNK).zip(weights.par_chunks(CHUNK)).map(chunk).collect();
    total(&parts)
}
