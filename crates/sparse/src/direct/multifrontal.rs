//! Numeric factorisation A = L D Lᵀ by the multifrontal method.
//!
//! Each supernode has a dense front of its columns and the rows below: the entries of A in its
//! columns, and the rests of its children in the elimination tree. After the columns are
//! eliminated, the rest of the front is passed to the parent. Independent subtrees run in parallel,
//! and so do the products of large fronts above them; both are divided in the same way for any
//! number of threads, so the result does not depend on it. Source: [duff1983].
//!
//! [duff1983]: https://doi.org/10.1145/356044.356047

use std::sync::{Mutex, PoisonError};

use fairing_watch::parallel::map_each;

use crate::direct::backend::Stop;
use crate::direct::dense::Panel;
use crate::direct::supernodes::{Part, Supernodes};

/// A front whose columns are eliminated.
struct Rest<'a> {
    node: usize,
    rows: &'a [u32],
}

/// Writes the columns of L into `values`, which are zero before, by supernodes, with D on the
/// diagonal. `entries` are the values of A, each multiplied by `scale`.
///
/// # Errors
///
/// The column and value of a pivot that is not positive if `definite`, or is zero.
pub(crate) fn factorize(
    nodes: &Supernodes,
    entries: &[f64],
    scale: f64,
    definite: bool,
    values: &mut [f64],
) -> Result<(), Stop> {
    let matrix = Matrix { nodes, entries, scale, definite };
    let (mut parts, mut top) = (vec![], vec![]);
    let mut left = values;
    let mut take = |range: std::ops::Range<usize>| {
        let (own, after) = std::mem::take(&mut left).split_at_mut(range.len());
        left = after;
        own
    };
    let mut nodes_of_top = nodes.top().iter().map(|s| *s as usize).peekable();
    for part in nodes.parts() {
        while let Some(s) = nodes_of_top.next_if(|s| *s < part.nodes.start) {
            top.push((s, take(nodes.values(s))));
        }
        let range = nodes.values(part.nodes.start).start..nodes.values(part.nodes.end - 1).end;
        parts.push((part, take(range)));
    }
    for s in nodes_of_top {
        top.push((s, take(nodes.values(s))));
    }
    // Fresh memory costs as much as the arithmetic of a small part.
    let spare: Mutex<Vec<Work<'_>>> = Mutex::default();
    let spare = || spare.lock().unwrap_or_else(PoisonError::into_inner);
    let done = map_each(parts, |(part, values)| {
        let mut work = spare().pop().unwrap_or_default();
        let rest = matrix.part(part, values, &mut work)?;
        spare().push(work);
        Ok((part, rest))
    });
    // The first failure in the order of elimination.
    let done: Result<Vec<(&Part, Vec<f64>)>, Stop> = done.into_iter().collect();
    let mut done = done?.into_iter().peekable();
    let mut work = spare().pop().unwrap_or_default();
    for (s, values) in top {
        fairing_watch::check();
        while let Some((part, rest)) = done.next_if(|(part, _)| part.nodes.start < s) {
            work.open.push(Rest { node: part.nodes.end - 1, rows: &part.outside });
            work.stack.extend(rest);
        }
        matrix.eliminate(s, 0, nodes.rows(s), values, &mut work)?;
    }
    debug_assert!(work.open.iter().all(|rest| nodes.parent(rest.node).is_none()), "postorder");
    Ok(())
}

/// The matrix to factorise.
#[derive(Clone, Copy)]
struct Matrix<'a> {
    nodes: &'a Supernodes,
    entries: &'a [f64],
    scale: f64,
    definite: bool,
}

/// Fronts whose parents are still to come, and memory to use again.
#[derive(Default)]
struct Work<'a> {
    open: Vec<Rest<'a>>,
    /// The lower triangles of their rests, by columns, in the same order.
    stack: Vec<f64>,
    /// The rest of the current front: the lower triangle of a square.
    below: Vec<f64>,
    places: Vec<usize>,
    scaled: Vec<f64>,
}

impl<'a> Matrix<'a> {
    /// Eliminates the supernodes of an independent subtree; returns the rest of the last.
    fn part(
        self,
        part: &'a Part,
        mut values: &mut [f64],
        work: &mut Work<'a>,
    ) -> Result<Vec<f64>, Stop> {
        let nodes = self.nodes;
        for s in part.nodes.clone() {
            let (own, after) = values.split_at_mut(nodes.values(s).len());
            values = after;
            self.eliminate(s, part.columns.start, nodes.rows(s), own, work)?;
        }
        work.open.clear();
        Ok(work.stack.drain(..).collect())
    }

    /// Eliminates one supernode; its rows are counted from `offset`.
    fn eliminate(
        self,
        s: usize,
        offset: usize,
        rows: &'a [u32],
        values: &mut [f64],
        work: &mut Work<'a>,
    ) -> Result<(), Stop> {
        let columns = self.nodes.range(s);
        let (width, height) = (columns.len(), columns.len() + rows.len());
        for (k, column) in columns.clone().zip(values.chunks_exact_mut(height)) {
            for &(place, entry) in self.nodes.entries_of(k) {
                column[place as usize] = self.scale * self.entries[entry as usize];
            }
        }
        if work.below.len() < rows.len() * rows.len() {
            work.below.resize(rows.len() * rows.len(), 0.0);
        }
        for j in 0..rows.len() {
            work.below[j * rows.len() + j..(j + 1) * rows.len()].fill(0.0);
        }
        while let Some(child) = work.open.pop_if(|rest| self.nodes.parent(rest.node) == Some(s)) {
            places(child.rows, columns.start - offset, width, rows, &mut work.places);
            let start = work.stack.len() - triangle(child.rows.len());
            let below = &mut work.below[..rows.len() * rows.len()];
            add(&work.stack[start..], &work.places, values, width, height, below);
            work.stack.truncate(start);
        }
        Panel { values, width, height }
            .eliminate(&mut work.below[..rows.len() * rows.len()], self.definite, &mut work.scaled)
            .map_err(|(column, pivot)| (columns.start + column, pivot))?;
        work.open.push(Rest { node: s, rows });
        for j in 0..rows.len() {
            work.stack.extend_from_slice(&work.below[j * rows.len() + j..(j + 1) * rows.len()]);
        }
        Ok(())
    }
}

/// The number of entries of a triangle, with its diagonal.
fn triangle(rows: usize) -> usize {
    rows * (rows + 1) / 2
}

/// The places of a child's rows in the front of its parent; all of them are there.
fn places(child: &[u32], start: usize, width: usize, rows: &[u32], out: &mut Vec<usize>) {
    out.clear();
    let mut i = 0;
    for &row in child {
        if (row as usize) < start + width {
            out.push(row as usize - start);
        } else {
            while rows[i] < row {
                i += 1;
            }
            out.push(width + i);
        }
    }
}

/// Adds the rest of a child, a lower triangle by columns, to the front of its parent.
fn add(
    rest: &[f64],
    places: &[usize],
    values: &mut [f64],
    width: usize,
    height: usize,
    below: &mut [f64],
) {
    let rows = height - width;
    let mut rest = rest;
    for (j, &place) in places.iter().enumerate() {
        let (column, after) = rest.split_at(places.len() - j);
        rest = after;
        let (target, first) = match place.checked_sub(width) {
            None => (&mut values[place * height..(place + 1) * height], 0),
            Some(place) => (&mut below[place * rows..(place + 1) * rows], width),
        };
        for (&i, value) in places[j..].iter().zip(column) {
            target[i - first] += value;
        }
    }
}
