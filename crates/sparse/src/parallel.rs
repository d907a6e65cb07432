//! Passes over rows in parallel, with sums that do not depend on the number of threads, and kernels
//! compiled for the widest vectors of the processor.
//!
//! Rows are divided into fixed chunks of [`CHUNK`]. Each chunk is summed from front to back, and
//! the sums of the chunks are added in order, whichever thread computed them.

use fairing_watch::parallel::{for_each, map_ranges};

/// Rows of one chunk: large enough to hide scheduling, small enough to balance.
pub const CHUNK: usize = 4096;

/// A summand of a parallel pass: nothing, a number, or an array or a pair of
/// summands.
pub trait Sum: Copy + Send {
    /// The empty sum.
    const ZERO: Self;

    /// Adds a term.
    fn add(&mut self, term: Self);
}

impl Sum for () {
    const ZERO: Self = ();

    #[inline(always)]
    fn add(&mut self, (): Self) {}
}

impl Sum for f64 {
    const ZERO: Self = 0.0;

    #[inline(always)]
    fn add(&mut self, term: Self) {
        *self += term;
    }
}

impl<T: Sum, const N: usize> Sum for [T; N] {
    const ZERO: Self = [T::ZERO; N];

    #[inline(always)]
    fn add(&mut self, term: Self) {
        for (sum, term) in self.iter_mut().zip(term) {
            sum.add(term);
        }
    }
}

impl<A: Sum, B: Sum> Sum for (A, B) {
    const ZERO: Self = (A::ZERO, B::ZERO);

    #[inline(always)]
    fn add(&mut self, term: Self) {
        self.0.add(term.0);
        self.1.add(term.1);
    }
}

/// Replaces every row by `f(i, yᵢ)` and returns the sum of the second values that `f` returns.
///
/// # Examples
///
/// ```
/// use fairing_sparse::parallel::update;
/// let mut y = vec![[1.0], [2.0], [3.0]];
/// let squares: f64 = update(&mut y, |_, [y]| ([2.0 * y], y * y));
/// assert_eq!((squares, y[2]), (14.0, [6.0]));
/// ```
pub fn update<T, S, F>(y: &mut [T], f: F) -> S
where
    T: Copy + Send,
    S: Sum,
    F: Fn(usize, T) -> (T, S) + Sync,
{
    let chunk = |first: usize, y: &mut [T]| {
        let mut sum = S::ZERO;
        for (k, y) in y.iter_mut().enumerate() {
            let (value, term) = f(first + k, *y);
            *y = value;
            sum.add(term);
        }
        sum
    };
    if y.len() <= CHUNK {
        return chunk(0, y);
    }
    let mut sums = vec![S::ZERO; y.len().div_ceil(CHUNK)];
    let chunks = y.chunks_mut(CHUNK).zip(&mut sums).enumerate();
    for_each(chunks, |(c, (y, sum))| *sum = chunk(c * CHUNK, y));
    total(&sums)
}

/// Calls `f(i, aᵢ, bᵢ)` for every row of two arrays of equal length.
#[inline]
pub fn update_both<A, B, F>(a: &mut [A], b: &mut [B], f: F)
where
    A: Send,
    B: Send,
    F: Fn(usize, &mut A, &mut B) + Sync,
{
    let chunk = |first: usize, a: &mut [A], b: &mut [B]| {
        for (k, (a, b)) in a.iter_mut().zip(b).enumerate() {
            f(first + k, a, b);
        }
    };
    if a.len() <= CHUNK {
        return chunk(0, a, b);
    }
    let chunks = a.chunks_mut(CHUNK).zip(b.chunks_mut(CHUNK)).enumerate();
    for_each(chunks, |(c, (a, b))| chunk(c * CHUNK, a, b));
}

/// `Σᵢ f(i)` over `count` rows.
pub fn sum<S: Sum>(count: usize, f: impl Fn(usize) -> S + Sync) -> S {
    let chunk = |range: std::ops::Range<usize>| {
        let mut sum = S::ZERO;
        for i in range {
            sum.add(f(i));
        }
        sum
    };
    if count <= CHUNK {
        return chunk(0..count);
    }
    total(&map_ranges(count, CHUNK, chunk))
}

fn total<S: Sum>(parts: &[S]) -> S {
    let mut total = S::ZERO;
    for &part in parts {
        total.add(part);
    }
    total
}

/// A kernel. Its `call` and all functions it calls must be `#[inline(always)]`, which closures
/// cannot be: a function that is not inlined is compiled for the oldest processor, where a fused
/// multiply-add is a function call.
pub(crate) use pulp::NullaryFnOnce as Kernel;

/// Calls the kernel with the processor's vector instructions enabled.
pub(crate) fn dispatch<K: Kernel>(kernel: K) -> K::Output {
    pulp::Arch::new().dispatch(kernel)
}

/// `a b + c`, rounded once; in WebAssembly, which has no instruction for it, rounded twice, a
/// hundred times as fast as an emulation.
#[cfg(feature = "solvers")]
#[inline(always)]
pub(crate) fn fused(a: f64, b: f64, c: f64) -> f64 {
    if cfg!(target_arch = "wasm32") { a * b + c } else { a.mul_add(b, c) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// With several chunks, the last one incomplete, every row is visited once with its own index,
    /// and sums have the same bits for any number of threads.
    #[test]
    fn passes_visit_every_row_once() {
        for n in [0, 1, CHUNK, 2 * CHUNK + 17, 20 * CHUNK + 17] {
            let run = |threads: usize| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                pool.install(|| {
                    let mut y: Vec<f64> = (0..n).map(|i| 1.0 / (1 + i) as f64).collect();
                    let mut z = vec![0.0; n];
                    let sums: [f64; 2] = update(&mut y, |i, y| (y * y, [y, i as f64]));
                    update_both(&mut y, &mut z, |i, y, z| *z = *y + i as f64);
                    (sum(n, |i| [z[i], 1.0]), sums, z)
                })
            };
            let (totals, sums, z) = run(1);
            assert_eq!(sums[1], (n * n.saturating_sub(1) / 2) as f64);
            assert_eq!(totals[1], n as f64);
            assert!((0..n).all(|i| z[i] == (1.0 / (1 + i) as f64).powi(2) + i as f64));
            for threads in [2, 3, 8] {
                assert_eq!(run(threads), (totals, sums, z.clone()), "{n} {threads}");
            }
        }
    }
}
