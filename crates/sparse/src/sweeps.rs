//! Forward and backward substitution with a supernodal factor, for several right-hand sides at once.
//!
//! Right-hand sides are rows of `B` numbers. A number of the factor, once loaded, serves all `B`; four columns
//! of a supernode share each row they touch. With eight right-hand sides this runs at the speed of the
//! arithmetic, with one at the speed of the memory.

use crate::supernodes::Supernodes;

/// Columns of a supernode taken together.
const GROUP: usize = 4;

/// What stands on the diagonal of a factor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Diagonal {
    /// L Lᵀ: the diagonal of L.
    Factor,
    /// L D Lᵀ: D, with ones on the diagonal of L.
    Pivots,
}

/// Solves A x = b in place, A = L Lᵀ or L D Lᵀ, rows in the order of the factor.
pub(crate) fn solve<const B: usize>(
    nodes: &Supernodes,
    values: &[f64],
    diagonal: Diagonal,
    x: &mut [[f64; B]],
) {
    debug_assert_eq!(nodes.columns(), x.len());
    pulp::Arch::new().dispatch(Sweep { nodes, values, diagonal, x });
}

struct Sweep<'a, const B: usize> {
    nodes: &'a Supernodes,
    values: &'a [f64],
    diagonal: Diagonal,
    x: &'a mut [[f64; B]],
}

impl<const B: usize> pulp::NullaryFnOnce for Sweep<'_, B> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for s in 0..self.nodes.len() {
            forward(self.nodes, s, &self.values[self.nodes.values(s)], self.diagonal, self.x);
        }
        if self.diagonal == Diagonal::Pivots {
            for (x, d) in self.x.iter_mut().zip(self.nodes.diagonal(self.values)) {
                *x = x.map(|x| x / d);
            }
        }
        for s in (0..self.nodes.len()).rev() {
            backward(self.nodes, s, &self.values[self.nodes.values(s)], self.diagonal, self.x);
        }
    }
}

/// One supernode of L x = b: solves its triangle, takes its columns off the rows below.
#[inline(always)]
fn forward<const B: usize>(
    nodes: &Supernodes,
    s: usize,
    block: &[f64],
    diagonal: Diagonal,
    x: &mut [[f64; B]],
) {
    let (range, rows) = (nodes.range(s), nodes.rows(s));
    let width = range.len();
    let height = width + rows.len();
    let mut j = 0;
    while j + GROUP <= width {
        forward_group::<B, GROUP>(block, height, width, j, range.start, rows, diagonal, x);
        j += GROUP;
    }
    while j < width {
        forward_group::<B, 1>(block, height, width, j, range.start, rows, diagonal, x);
        j += 1;
    }
}

#[inline(always)]
#[expect(clippy::too_many_arguments, reason = "the pieces of one supernode, hot and inlined")]
fn forward_group<const B: usize, const G: usize>(
    block: &[f64],
    height: usize,
    width: usize,
    j: usize,
    start: usize,
    rows: &[u32],
    diagonal: Diagonal,
    x: &mut [[f64; B]],
) {
    let mut top = [[0.0; B]; G];
    for g in 0..G {
        let mut value = x[start + j + g];
        for before in 0..g {
            let l = block[(j + before) * height + j + g];
            value = subtract(value, l, &top[before]);
        }
        if diagonal == Diagonal::Factor {
            let d = block[(j + g) * height + j + g];
            value = value.map(|v| v / d);
        }
        x[start + j + g] = value;
        top[g] = value;
    }
    let columns: [&[f64]; G] = std::array::from_fn(|g| &block[(j + g) * height..][..height]);
    for i in j + G..width {
        let mut value = x[start + i];
        for g in 0..G {
            value = subtract(value, columns[g][i], &top[g]);
        }
        x[start + i] = value;
    }
    let columns: [&[f64]; G] = std::array::from_fn(|g| &columns[g][width..][..rows.len()]);
    for (i, &row) in rows.iter().enumerate() {
        let target = &mut x[row as usize];
        let mut value = *target;
        for g in 0..G {
            value = subtract(value, columns[g][i], &top[g]);
        }
        *target = value;
    }
}

/// One supernode of Lᵀ x = b: takes the rows below off its columns, solves its triangle.
#[inline(always)]
fn backward<const B: usize>(
    nodes: &Supernodes,
    s: usize,
    block: &[f64],
    diagonal: Diagonal,
    x: &mut [[f64; B]],
) {
    let (range, rows) = (nodes.range(s), nodes.rows(s));
    let width = range.len();
    let height = width + rows.len();
    let grouped = width - width % GROUP;
    for j in (grouped..width).rev() {
        backward_group::<B, 1>(block, height, width, j, range.start, rows, diagonal, x);
    }
    for j in (0..grouped).step_by(GROUP).rev() {
        backward_group::<B, GROUP>(block, height, width, j, range.start, rows, diagonal, x);
    }
}

#[inline(always)]
#[expect(clippy::too_many_arguments, reason = "the pieces of one supernode, hot and inlined")]
fn backward_group<const B: usize, const G: usize>(
    block: &[f64],
    height: usize,
    width: usize,
    j: usize,
    start: usize,
    rows: &[u32],
    diagonal: Diagonal,
    x: &mut [[f64; B]],
) {
    let columns: [&[f64]; G] = std::array::from_fn(|g| &block[(j + g) * height..][..height]);
    let mut sums: [[f64; B]; G] = std::array::from_fn(|g| x[start + j + g]);
    for i in j + G..width {
        let value = x[start + i];
        for g in 0..G {
            sums[g] = subtract(sums[g], columns[g][i], &value);
        }
    }
    let below: [&[f64]; G] = std::array::from_fn(|g| &columns[g][width..][..rows.len()]);
    for (i, &row) in rows.iter().enumerate() {
        let value = x[row as usize];
        for g in 0..G {
            sums[g] = subtract(sums[g], below[g][i], &value);
        }
    }
    for g in (0..G).rev() {
        for after in g + 1..G {
            let l = columns[g][j + after];
            sums[g] = subtract(sums[g], l, &x[start + j + after]);
        }
        if diagonal == Diagonal::Factor {
            let d = columns[g][j + g];
            sums[g] = sums[g].map(|v| v / d);
        }
        x[start + j + g] = sums[g];
    }
}

/// y − l x.
#[inline(always)]
fn subtract<const B: usize>(mut y: [f64; B], l: f64, x: &[f64; B]) -> [f64; B] {
    for lane in 0..B {
        y[lane] = (-l).mul_add(x[lane], y[lane]);
    }
    y
}
