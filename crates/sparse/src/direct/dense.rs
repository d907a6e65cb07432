//! Elimination in dense fronts: the columns of a supernode, and what they subtract from the rows
//! below.
//!
//! Matrices are stored by columns; of symmetric ones only the lower triangle counts.

use fairing_watch::parallel::for_each;

use crate::direct::backend::{self, NEGLIGIBLE, Stop, stops};
use crate::parallel::{self, Kernel, fused};

/// Columns eliminated together.
const BLOCK: usize = 64;
/// Columns of a task.
const TILE: usize = 64;
/// Products with fewer multiplications run on one thread.
const PARALLEL: usize = 4_000_000;
/// Fronts at most this wide and high are eliminated by plain loops, without calls of the backend.
const SMALL: (usize, usize) = (16, 96);
/// The columns of a supernode: `width` columns of `height` numbers, the rows of the columns first.
pub(crate) struct Panel<'a> {
    pub(crate) values: &'a mut [f64],
    pub(crate) width: usize,
    pub(crate) height: usize,
}

impl Panel<'_> {
    /// Replaces the columns by those of L, with D on the diagonal, and subtracts L D Lᵀ from
    /// `below`, the square matrix of the remaining rows.
    ///
    /// The work is divided in the same way for any number of threads.
    ///
    /// # Errors
    ///
    /// The first pivot that is not positive if `definite`, or is zero.
    pub(crate) fn eliminate(
        self,
        below: &mut [f64],
        definite: bool,
        scaled: &mut Vec<f64>,
    ) -> Result<(), Stop> {
        let Self { values, width, height } = self;
        if width <= SMALL.0 && height <= SMALL.1 {
            return parallel::dispatch(Small { values, width, height, below, definite });
        }
        for start in (0..width).step_by(BLOCK) {
            let end = (start + BLOCK).min(width);
            let (done, rest) = values.split_at_mut(end * height);
            let block = &mut done[start * height + start..];
            backend::eliminate_block(block, end - start, height, definite)
                .map_err(|(column, pivot)| (start + column, pivot))?;
            let columns = &done[start * height..];
            // Column k of L D, from the first row after the block.
            scale(columns, end - start, height, start, end..height, scaled);
            subtract(rest, height, end, columns, end - start, end, scaled);
        }
        let rows = height - width;
        if rows > 0 {
            scale(values, width, height, 0, width..height, scaled);
            subtract(below, rows, 0, values, width, width, scaled);
        }
        Ok(())
    }
}

/// The given rows of L D, row by row.
fn scale(
    columns: &[f64],
    width: usize,
    height: usize,
    first: usize,
    rows: std::ops::Range<usize>,
    out: &mut Vec<f64>,
) {
    out.clear();
    for k in 0..width {
        let column = &columns[k * height..(k + 1) * height];
        let pivot = column[first + k];
        out.extend(column[rows.clone()].iter().map(|l| l * pivot));
    }
}

/// Subtracts L (L D)ᵀ from the lower triangle of `target`, whose columns have `height` numbers, of
/// which the first `skip` do not count. The rows of L begin at `from`.
fn subtract(
    target: &mut [f64],
    height: usize,
    skip: usize,
    l: &[f64],
    width: usize,
    from: usize,
    scaled: &[f64],
) {
    let rows = height - skip;
    let l_height = l.len() / width;
    let tile = |(t, target): (usize, &mut [f64])| {
        let first = t * TILE;
        let columns = target.len() / height;
        backend::subtract_product(
            (&mut target[skip + first..], height),
            (&l[from + first..], l_height),
            (&scaled[first..], rows),
            [rows - first, columns, width],
        );
    };
    if rows * rows * width > PARALLEL {
        for_each(target.chunks_mut(TILE * height).enumerate(), tile);
    } else {
        target.chunks_mut(TILE * height).enumerate().for_each(tile);
    }
}

/// [`Panel::eliminate`] for small fronts.
struct Small<'a> {
    values: &'a mut [f64],
    width: usize,
    height: usize,
    below: &'a mut [f64],
    definite: bool,
}

/// Columns of L that are subtracted together.
const GROUP: usize = 4;

impl Kernel for Small<'_> {
    type Output = Result<(), Stop>;

    #[inline(always)]
    fn call(self) -> Result<(), Stop> {
        let Self { values, width, height, below, definite } = self;
        for k in 0..width {
            let (done, rest) = values.split_at_mut((k + 1) * height);
            let column = &mut done[k * height + k..];
            let pivot = column[0];
            if stops(pivot, definite) {
                return Err((k, pivot));
            }
            let inverse = 1.0 / pivot;
            for j in 1..width - k {
                let factor = column[j] * inverse;
                let target = &mut rest[(j - 1) * height + k + j..j * height];
                for (t, l) in target.iter_mut().zip(&column[j..]) {
                    *t = fused(-factor, *l, *t);
                }
            }
            for l in &mut column[1..] {
                let value = *l * inverse;
                *l = if value.abs() < NEGLIGIBLE { 0.0 } else { value };
            }
        }
        let rows = height - width;
        let mut k = 0;
        while k + GROUP <= width {
            subtract_columns::<GROUP>(values, k, width, height, below, rows);
            k += GROUP;
        }
        while k < width {
            subtract_columns::<1>(values, k, width, height, below, rows);
            k += 1;
        }
        Ok(())
    }
}

/// Subtracts the products of columns k … k + G of L with D and their transposes.
#[inline(always)]
fn subtract_columns<const G: usize>(
    values: &[f64],
    k: usize,
    width: usize,
    height: usize,
    below: &mut [f64],
    rows: usize,
) {
    let columns: [&[f64]; G] = std::array::from_fn(|g| &values[(k + g) * height + width..][..rows]);
    let pivots: [f64; G] = std::array::from_fn(|g| values[(k + g) * (height + 1)]);
    for j in 0..rows {
        let target = &mut below[j * rows + j..(j + 1) * rows];
        let own: [&[f64]; G] = std::array::from_fn(|g| &columns[g][j..][..target.len()]);
        let factors: [f64; G] = std::array::from_fn(|g| -own[g][0] * pivots[g]);
        for (i, t) in target.iter_mut().enumerate() {
            let mut value = *t;
            for g in 0..G {
                value = fused(factors[g], own[g][i], value);
            }
            *t = value;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt as _, SeedableRng as _};

    /// Panels of all sizes: L D Lᵀ gives the columns back, and what is left below is the Schur
    /// complement.
    #[test]
    fn products_give_the_matrix_back() {
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(1);
        for (width, rows) in [(1, 0), (3, 5), (16, 80), (17, 3), (40, 100), (150, 0), (200, 333)] {
            let height = width + rows;
            let mut full = vec![0.0; height * height];
            for j in 0..height {
                for i in j..height {
                    let sign = if j % 3 == 0 { -1.0 } else { 1.0 };
                    let value = random.random_range(-1.0..1.0);
                    full[j * height + i] =
                        if i == j { sign * (height as f64 + value) } else { value };
                }
            }
            let mut values: Vec<f64> = full[..width * height].to_vec();
            let mut below = vec![0.0; rows * rows];
            for j in 0..rows {
                for i in j..rows {
                    below[j * rows + i] = full[(width + j) * height + width + i];
                }
            }
            let panel = Panel { values: &mut values, width, height };
            panel.eliminate(&mut below, false, &mut vec![]).unwrap();
            let l = |i: usize, k: usize| if i == k { 1.0 } else { values[k * height + i] };
            for j in 0..height {
                for i in j..height {
                    let mut sum: f64 = (0..width.min(j + 1))
                        .map(|k| l(i, k) * values[k * (height + 1)] * l(j, k))
                        .sum();
                    if j >= width {
                        sum += below[(j - width) * rows + i - width];
                    }
                    let error = (sum - full[j * height + i]).abs();
                    assert!(error < 1e-12 * height as f64, "{width} {rows} ({i}, {j}): {error}");
                }
            }
        }
    }

    #[test]
    fn the_first_bad_pivot_ends_the_elimination() {
        for width in [5, 100] {
            let mut values = vec![0.0; width * width];
            for k in 0..width {
                values[k * (width + 1)] = if k == width - 2 { -2.0 } else { 1.0 };
            }
            let mut again = values.clone();
            let panel = Panel { values: &mut values, width, height: width };
            assert_eq!(panel.eliminate(&mut [], true, &mut vec![]), Err((width - 2, -2.0)));
            again[(width - 1) * (width + 1)] = 0.0;
            let panel = Panel { values: &mut again, width, height: width };
            assert_eq!(panel.eliminate(&mut [], false, &mut vec![]), Err((width - 1, 0.0)));
        }
    }
}
