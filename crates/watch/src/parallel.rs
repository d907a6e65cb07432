//! Loops on all threads of the current pool.
//!
//! A loop is divided into pieces that do not depend on the number of threads. The pieces run as
//! boxed closures, so that the thread pool is compiled once and not for every loop.

use std::ops::Range;

use rayon::prelude::*;

/// A piece of a loop.
type Task<'a> = Box<dyn FnOnce() + Send + 'a>;

/// Pieces of one loop at most, enough to balance them.
const MAX_PIECES: usize = 256;

/// Calls every task once, in any order.
fn run(tasks: Vec<Task<'_>>) {
    if tasks.len() < 2 {
        return tasks.into_iter().for_each(|task| task());
    }
    tasks.into_par_iter().with_max_len(1).for_each(|task| task());
}

/// Calls `f` with every item, each a task of its own, in any order.
pub fn for_each<T: Send>(items: impl IntoIterator<Item = T>, f: impl Fn(T) + Sync) {
    let f = &f;
    run(items.into_iter().map(|item| Box::new(move || f(item)) as Task<'_>).collect());
}

/// `f` of every item, each a task of its own, in the order of the items.
pub fn map_each<I: Send, T: Send>(
    items: impl IntoIterator<Item = I>,
    f: impl Fn(I) -> T + Sync,
) -> Vec<T> {
    let items: Vec<I> = items.into_iter().collect();
    let mut results: Vec<Option<T>> = items.iter().map(|_| None).collect();
    for_each(results.iter_mut().zip(items), |(result, item)| *result = Some(f(item)));
    results.into_iter().flatten().collect()
}

/// `f` of consecutive ranges of `size` numbers that cover `0..count`, in their order.
pub fn map_ranges<T: Send>(
    count: usize,
    size: usize,
    f: impl Fn(Range<usize>) -> T + Sync,
) -> Vec<T> {
    let ranges = (0..count).step_by(size.max(1));
    map_each(ranges, |start| f(start..count.min(start + size)))
}

/// `f(i)` for i in `0..count`; a task has at least `least` of them.
///
/// # Examples
///
/// ```
/// let squares = fairing_watch::parallel::map(1000, 100, |i| i * i);
/// assert_eq!(squares[999], 998_001);
/// ```
pub fn map<T: Send>(count: usize, least: usize, f: impl Fn(usize) -> T + Sync) -> Vec<T> {
    map_with(count, least, || (), |(), i| f(i))
}

/// [`map`] with working memory, which each task initialises once: results must not depend on what
/// it holds.
pub fn map_with<W, T: Send>(
    count: usize,
    least: usize,
    init: impl Fn() -> W + Sync,
    f: impl Fn(&mut W, usize) -> T + Sync,
) -> Vec<T> {
    let piece = |range: Range<usize>| {
        let mut work = init();
        range.map(|i| f(&mut work, i)).collect::<Vec<T>>()
    };
    let size = least.max(count.div_ceil(MAX_PIECES));
    if count <= size {
        return piece(0..count);
    }
    let mut all = Vec::with_capacity(count);
    for mut piece in map_ranges(count, size, piece) {
        all.append(&mut piece);
    }
    all
}

/// Returns true if `f` holds for all i in `0..count`; a task has `size` of them.
pub fn all(count: usize, size: usize, f: impl Fn(usize) -> bool + Sync) -> bool {
    map_ranges(count, size, |mut range| range.all(&f)).into_iter().all(|holds| holds)
}

/// `f(i)` for i in `0..count`; a task has at least `least` of them.
///
/// # Errors
///
/// That of the least i for which `f` fails.
pub fn try_map<T: Send, E: Send>(
    count: usize,
    least: usize,
    f: impl Fn(usize) -> Result<T, E> + Sync,
) -> Result<Vec<T>, E> {
    let size = least.max(count.div_ceil(MAX_PIECES));
    let pieces = map_ranges(count, size, |range| range.map(&f).collect::<Result<Vec<T>, E>>());
    let mut all = Vec::with_capacity(count);
    for piece in pieces {
        all.append(&mut piece?);
    }
    Ok(all)
}

/// Calls `f(start, chunk)` for consecutive chunks of `size` elements; the first of them has the
/// index `start`.
///
/// # Panics
///
/// Panics if `size` is zero.
pub fn for_chunks<T: Send>(y: &mut [T], size: usize, f: impl Fn(usize, &mut [T]) + Sync) {
    for_each(y.chunks_mut(size).enumerate(), |(c, chunk)| f(c * size, chunk));
}

/// Rows of one task of [`for_rows`] at least.
const ROWS: usize = 1024;

/// Calls `f(i, yᵢ)` for every element.
pub fn for_rows<T: Send>(y: &mut [T], f: impl Fn(usize, &mut T) + Sync) {
    let size = ROWS.max(y.len().div_ceil(MAX_PIECES));
    for_chunks(y, size, |start, chunk| (start..).zip(chunk).for_each(|(i, y)| f(i, y)));
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every index is visited once and in its place, in pools of any size.
    #[test]
    fn loops_visit_everything_once() {
        for threads in [1, 2, 5] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                for count in [0, 1, 7, 1000, 100_003] {
                    let all: Vec<usize> = (0..count).collect();
                    assert_eq!(map(count, 10, |i| i), all);
                    assert_eq!(try_map(count, 10, Ok::<_, ()>), Ok(all.clone()));
                    assert_eq!(map_ranges(count, 9, |r| r.len()).iter().sum::<usize>(), count);
                    let mut y = vec![0; count];
                    for_chunks(&mut y, 13, |start, chunk| {
                        chunk.iter_mut().enumerate().for_each(|(k, y)| *y += start + k);
                    });
                    assert_eq!(y, all);
                    for_rows(&mut y, |i, y| *y += 2 * i);
                    assert!(super::all(count, 7, |i| y[i] == 3 * i));
                    assert_eq!(super::all(count, 7, |i| i != count / 2), count == 0);
                }
            });
        }
    }

    #[test]
    fn the_first_failure_is_returned() {
        let odd_above = |i: usize| if i > 500 && i % 2 == 1 { Err(i) } else { Ok(i) };
        assert_eq!(try_map(10_000, 3, odd_above), Err(501));
    }
}
