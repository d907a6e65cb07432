//! Forward and backward substitution with a supernodal factor, for several right-hand sides at
//! once.
//!
//! Right-hand sides are rows of `B` numbers. Each value of the factor is loaded once for all `B`,
//! and four columns of a supernode update each row together. Eight right-hand sides are bound by
//! arithmetic, one by memory.
//!
//! Independent subtrees run in parallel, on copies of the rows they touch; their contributions to
//! the top are added in the order of the subtrees. The subtrees do not depend on the number of
//! threads, and neither does the result.

use fairing_watch::parallel::map_each;

use crate::direct::supernodes::Supernodes;
use crate::parallel::{self, Kernel, fused};

/// Columns of a supernode processed together.
const GROUP: usize = 4;

/// Solves A x = b in place, A = L D Lᵀ, rows in the order of the factor.
pub(crate) fn solve<const B: usize>(nodes: &Supernodes, values: &[f64], x: &mut [[f64; B]]) {
    assert_eq!(nodes.columns(), x.len(), "one row for each column");
    let factor = FactorView { nodes, values };
    let shared = &*x;
    let locals: Vec<Vec<[f64; B]>> = map_each(nodes.parts(), |part| {
        let mut local = vec![[0.0; B]; part.columns.len() + part.outside.len()];
        local[..part.columns.len()].copy_from_slice(&shared[part.columns.clone()]);
        let offset = part.columns.start;
        let nodes = part.nodes.clone();
        parallel::dispatch(Forward { factor, nodes, offset, x: &mut local });
        local
    });
    for (part, local) in nodes.parts().iter().zip(&locals) {
        for (&row, add) in part.outside.iter().zip(&local[part.columns.len()..]) {
            let target = &mut x[row as usize];
            for lane in 0..B {
                target[lane] += add[lane];
            }
        }
    }
    let top = nodes.top().iter().map(to_usize as fn(&u32) -> usize);
    parallel::dispatch(Forward { factor, nodes: top.clone(), offset: 0, x: &mut *x });
    parallel::dispatch(Backward { factor, nodes: top.rev(), offset: 0, x: &mut *x });
    let shared = &*x;
    let locals = map_each(nodes.parts().iter().zip(locals), |(part, mut local)| {
        for (&row, outside) in part.outside.iter().zip(&mut local[part.columns.len()..]) {
            *outside = shared[row as usize];
        }
        let offset = part.columns.start;
        let nodes = part.nodes.clone().rev();
        parallel::dispatch(Backward { factor, nodes, offset, x: &mut local });
        local
    });
    for (part, local) in nodes.parts().iter().zip(&locals) {
        x[part.columns.clone()].copy_from_slice(&local[..part.columns.len()]);
    }
}

fn to_usize(s: &u32) -> usize {
    *s as usize
}

/// L x = b over some supernodes.
struct Forward<'a, const B: usize, I> {
    factor: FactorView<'a>,
    nodes: I,
    offset: usize,
    x: &'a mut [[f64; B]],
}

impl<const B: usize, I: Iterator<Item = usize>> Kernel for Forward<'_, B, I> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for s in self.nodes {
            self.factor.forward(s, self.offset, self.x);
        }
    }
}

/// D Lᵀ x = b over some supernodes.
struct Backward<'a, const B: usize, I> {
    factor: FactorView<'a>,
    nodes: I,
    offset: usize,
    x: &'a mut [[f64; B]],
}

impl<const B: usize, I: Iterator<Item = usize>> Kernel for Backward<'_, B, I> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for s in self.nodes {
            self.factor.backward(s, self.offset, self.x);
        }
    }
}

#[derive(Clone, Copy)]
struct FactorView<'a> {
    nodes: &'a Supernodes,
    values: &'a [f64],
}

impl FactorView<'_> {
    /// One supernode of L x = b, for rows counted from `offset`: solves with its triangle, then
    /// subtracts its columns from the rows below.
    #[inline(always)]
    fn forward<const B: usize>(self, s: usize, offset: usize, x: &mut [[f64; B]]) {
        let node = Node::new(self, s, offset);
        let mut j = 0;
        while j + GROUP <= node.width {
            node.forward::<B, GROUP>(j, x);
            j += GROUP;
        }
        while j < node.width {
            node.forward::<B, 1>(j, x);
            j += 1;
        }
    }

    /// One supernode of D Lᵀ x = b: divides by D, subtracts the rows below
    /// from its columns, then solves with its triangle.
    #[inline(always)]
    fn backward<const B: usize>(self, s: usize, offset: usize, x: &mut [[f64; B]]) {
        let node = Node::new(self, s, offset);
        for j in 0..node.width {
            let d = node.block[j * (node.height + 1)];
            let x = &mut x[node.start + j];
            for lane in 0..B {
                x[lane] /= d;
            }
        }
        let grouped = node.width - node.width % GROUP;
        for j in (grouped..node.width).rev() {
            node.backward::<B, 1>(j, x);
        }
        for j in (0..grouped).step_by(GROUP).rev() {
            node.backward::<B, GROUP>(j, x);
        }
    }
}

/// One supernode with its values.
#[derive(Clone, Copy)]
struct Node<'a> {
    block: &'a [f64],
    rows: &'a [u32],
    width: usize,
    height: usize,
    start: usize,
}

impl<'a> Node<'a> {
    #[inline(always)]
    fn new(factor: FactorView<'a>, s: usize, offset: usize) -> Self {
        let (range, rows) = (factor.nodes.range(s), factor.nodes.rows(s));
        Self {
            block: &factor.values[factor.nodes.values(s)],
            rows,
            width: range.len(),
            height: range.len() + rows.len(),
            start: range.start - offset,
        }
    }

    #[inline(always)]
    fn columns<const G: usize>(self, j: usize) -> [&'a [f64]; G] {
        std::array::from_fn(|g| &self.block[(j + g) * self.height..][..self.height])
    }

    /// Columns j … j + G of L x = b.
    #[inline(always)]
    fn forward<const B: usize, const G: usize>(self, j: usize, x: &mut [[f64; B]]) {
        let columns = self.columns::<G>(j);
        let start = self.start;
        let mut top = [[0.0; B]; G];
        for g in 0..G {
            let mut value = x[start + j + g];
            for before in 0..g {
                value = subtract(value, columns[before][j + g], &top[before]);
            }
            x[start + j + g] = value;
            top[g] = value;
        }
        for i in j + G..self.width {
            let mut value = x[start + i];
            for g in 0..G {
                value = subtract(value, columns[g][i], &top[g]);
            }
            x[start + i] = value;
        }
        let below: [&[f64]; G] =
            std::array::from_fn(|g| &columns[g][self.width..][..self.rows.len()]);
        for (i, &row) in self.rows.iter().enumerate() {
            let target = &mut x[row as usize];
            let mut value = *target;
            for g in 0..G {
                value = subtract(value, below[g][i], &top[g]);
            }
            *target = value;
        }
    }

    /// Columns j … j + G of Lᵀ x = b.
    #[inline(always)]
    fn backward<const B: usize, const G: usize>(self, j: usize, x: &mut [[f64; B]]) {
        let columns = self.columns::<G>(j);
        let start = self.start;
        let mut sums: [[f64; B]; G] = std::array::from_fn(|g| x[start + j + g]);
        for i in j + G..self.width {
            let value = x[start + i];
            for g in 0..G {
                sums[g] = subtract(sums[g], columns[g][i], &value);
            }
        }
        let below: [&[f64]; G] =
            std::array::from_fn(|g| &columns[g][self.width..][..self.rows.len()]);
        for (i, &row) in self.rows.iter().enumerate() {
            let value = x[row as usize];
            for g in 0..G {
                sums[g] = subtract(sums[g], below[g][i], &value);
            }
        }
        for g in (0..G).rev() {
            for after in g + 1..G {
                sums[g] = subtract(sums[g], columns[g][j + after], &x[start + j + after]);
            }
            x[start + j + g] = sums[g];
        }
    }
}

/// y − l x.
#[inline(always)]
fn subtract<const B: usize>(mut y: [f64; B], l: f64, x: &[f64; B]) -> [f64; B] {
    for lane in 0..B {
        y[lane] = fused(-l, x[lane], y[lane]);
    }
    y
}
