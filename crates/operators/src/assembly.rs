//! Vertex-by-vertex matrices assembled by rows, in parallel.
//!
//! The pattern comes from the corners at each vertex; a row gathers what the
//! corners give it, in ascending order of faces. There are no triplets to
//! sort, memory is that of the matrix, and the sums do not depend on threads.
//! Linear in corners, for bounded valence.

use std::ops::Range;

use fairing_mesh::{Incidence, TriMesh};
use fairing_sparse::SparseMatrix;
use rayon::prelude::*;

use crate::corners::{next, previous};
use crate::error::OperatorError;
use crate::fan::Fan;

/// Rows handed to a thread at a time: large enough to hide the hand-over,
/// small enough to even out rows of different length.
const ROWS_PER_TASK: usize = 2048;

/// What a corner adds to the row of its vertex.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CornerEntries {
    pub(crate) diagonal: f64,
    /// In the column of the next corner of the face.
    pub(crate) next: f64,
    /// In the column of the previous corner of the face.
    pub(crate) previous: f64,
}

/// Rows up to this length keep the places of their corners' entries in bytes.
const SHORT_ROW: usize = 256;

/// Where the entries of a vertex-by-vertex matrix are: the diagonal, and a
/// pair of entries for each edge. Columns ascend within a row.
#[derive(Debug, Clone)]
pub(crate) struct Pattern {
    offsets: Vec<u32>,
    columns: Vec<u32>,
    /// For each corner, in the order of the incidence, the places in the row
    /// of the entries for the next and for the previous corner of its face;
    /// unused in long rows. A table for each task.
    slots: Vec<Vec<[u8; 2]>>,
}

/// The rows that a task finds.
struct Block {
    lengths: Vec<u32>,
    columns: Vec<u32>,
    slots: Vec<[u8; 2]>,
}

impl Block {
    fn of(mesh: &TriMesh, rows: Range<usize>) -> Self {
        let vertices = mesh.faces().as_flattened();
        let incidence = mesh.incidence();
        let corners = corner_range(incidence, &rows).len();
        let mut lengths = Vec::with_capacity(rows.len());
        // Up to twice as many where many edges have one face only.
        let mut columns = Vec::with_capacity(corners + 2 * rows.len());
        let mut slots = Vec::with_capacity(corners);
        let mut fan = Fan::default();
        for v in rows {
            let v = v as u32;
            fan.of(vertices, incidence, v);
            lengths.push(fan.neighbors.len() as u32 + 1);
            let below = position(&fan.neighbors, v);
            columns.extend_from_slice(&fan.neighbors[..below]);
            columns.push(v);
            columns.extend_from_slice(&fan.neighbors[below..]);
            let slot = |rank: u32| (rank + u32::from(rank as usize >= below)) as u8;
            slots.extend(fan.ranks.iter().map(|r| r.map(slot)));
        }
        Self { lengths, columns, slots }
    }
}

impl Pattern {
    pub(crate) fn of(mesh: &TriMesh) -> Result<Self, OperatorError> {
        let n = mesh.vertex_count();
        let entries = n.saturating_add(mesh.face_count().saturating_mul(6));
        if u32::try_from(entries).is_err() {
            return Err(OperatorError::TooLarge { entries });
        }
        // Computed here, not by whichever thread comes first.
        mesh.incidence();
        let blocks: Vec<Block> =
            row_ranges(n).into_par_iter().map(|rows| Block::of(mesh, rows)).collect();
        let mut offsets = Vec::with_capacity(n + 1);
        offsets.push(0);
        let mut total = 0;
        let mut columns = Vec::with_capacity(blocks.iter().map(|b| b.columns.len()).sum());
        let mut slots = Vec::with_capacity(blocks.len());
        for block in blocks {
            for length in block.lengths {
                total += length;
                offsets.push(total);
            }
            columns.extend_from_slice(&block.columns);
            slots.push(block.slots);
        }
        Ok(Self { offsets, columns, slots })
    }

    /// The matrix whose rows sum what `entries` says of each corner at their
    /// vertex.
    pub(crate) fn fill<F>(mut self, mesh: &TriMesh, entries: F) -> SparseMatrix
    where
        F: Fn(u32) -> CornerEntries + Sync,
    {
        let vertices = mesh.faces().as_flattened();
        let incidence = mesh.incidence();
        let slots = std::mem::take(&mut self.slots);
        self.fill_rows(|v, columns, values| {
            let corners = incidence.corners(v);
            let mut diagonal = 0.0;
            if columns.len() <= SHORT_ROW {
                let task = v as usize / ROWS_PER_TASK;
                let starts = [task * ROWS_PER_TASK, v as usize].map(|v| incidence.offsets()[v]);
                let slots = &slots[task][(starts[1] - starts[0]) as usize..];
                for (&c, slot) in corners.iter().zip(slots) {
                    let e = entries(c);
                    diagonal += e.diagonal;
                    values[slot[0] as usize] += e.next;
                    values[slot[1] as usize] += e.previous;
                }
            } else {
                for &c in corners {
                    let e = entries(c);
                    diagonal += e.diagonal;
                    values[position(columns, vertices[next(c) as usize])] += e.next;
                    values[position(columns, vertices[previous(c) as usize])] += e.previous;
                }
            }
            values[position(columns, v)] = diagonal;
        })
    }

    /// The matrix whose rows `row(v, columns, values)` writes over zeros.
    pub(crate) fn fill_rows<F>(self, row: F) -> SparseMatrix
    where
        F: Fn(u32, &[u32], &mut [f64]) + Sync,
    {
        let n = self.offsets.len() - 1;
        let mut values = vec![0.0; self.columns.len()];
        let (offsets, columns) = (&self.offsets, &self.columns);
        blocks(offsets, &mut values).into_par_iter().for_each(|(rows, block)| {
            let start = offsets[rows.start] as usize;
            for v in rows {
                let range = offsets[v] as usize..offsets[v + 1] as usize;
                let values = &mut block[range.start - start..range.end - start];
                row(v as u32, &columns[range], values);
            }
        });
        SparseMatrix::new((n, n), self.offsets, self.columns, values)
    }
}

/// The place of column `w` in an ascending row, or where it would be.
#[inline]
pub(crate) fn position(columns: &[u32], w: u32) -> usize {
    if columns.len() <= 16 {
        return columns.iter().take_while(|&&c| c < w).count();
    }
    columns.partition_point(|&c| c < w)
}

/// The `n × n` matrix that sums entries `(row, column, value)`, every diagonal
/// entry present. Entries of one place are added in their order. Linear for
/// rows of bounded length.
pub(crate) fn sum_entries(
    n: usize,
    entries: &[(u32, u32, f64)],
) -> Result<SparseMatrix, OperatorError> {
    let total = n.saturating_add(entries.len());
    if u32::try_from(total).is_err() {
        return Err(OperatorError::TooLarge { entries: total });
    }
    let mut starts = vec![0usize; n + 1];
    for &(row, ..) in entries {
        starts[row as usize + 1] += 1;
    }
    for row in 0..n {
        starts[row + 1] += starts[row];
    }
    let mut next = starts.clone();
    let mut by_row = vec![(0u32, 0.0); entries.len()];
    for &(row, column, value) in entries {
        by_row[next[row as usize]] = (column, value);
        next[row as usize] += 1;
    }
    let (mut offsets, mut columns, mut values) = (vec![0u32], vec![], vec![]);
    let mut sorted: Vec<(u32, f64)> = vec![];
    for row in 0..n {
        sorted.clear();
        sorted.push((row as u32, 0.0));
        sorted.extend_from_slice(&by_row[starts[row]..starts[row + 1]]);
        sorted.sort_by_key(|&(column, _)| column);
        for same in sorted.chunk_by(|a, b| a.0 == b.0) {
            columns.push(same[0].0);
            values.push(same.iter().map(|e| e.1).sum::<f64>());
        }
        offsets.push(columns.len() as u32);
    }
    Ok(SparseMatrix::new((n, n), offsets, columns, values))
}

fn row_ranges(n: usize) -> Vec<Range<usize>> {
    (0..n).step_by(ROWS_PER_TASK).map(|start| start..(start + ROWS_PER_TASK).min(n)).collect()
}

fn corner_range(incidence: &Incidence, rows: &Range<usize>) -> Range<usize> {
    incidence.offsets()[rows.start] as usize..incidence.offsets()[rows.end] as usize
}

/// Cuts values at the borders of blocks of rows.
fn blocks<'a>(offsets: &[u32], mut values: &'a mut [f64]) -> Vec<(Range<usize>, &'a mut [f64])> {
    row_ranges(offsets.len() - 1)
        .into_iter()
        .map(|rows| {
            let length = (offsets[rows.end] - offsets[rows.start]) as usize;
            let (block, rest) = std::mem::take(&mut values).split_at_mut(length);
            values = rest;
            (rows, block)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pattern_is_the_closed_ring_of_each_vertex() {
        let positions = vec![[0.0; 3]; 6];
        let mesh = TriMesh::new(positions, vec![[0, 4, 2], [4, 0, 1], [4, 1, 2]]).unwrap();
        let pattern = Pattern::of(&mesh).unwrap();
        assert_eq!(pattern.offsets, [0, 4, 8, 12, 13, 17, 18]);
        assert_eq!(pattern.columns, [0, 1, 2, 4, 0, 1, 2, 4, 0, 1, 2, 4, 3, 0, 1, 2, 4, 5]);
    }

    #[test]
    fn a_hub_takes_the_long_way_to_the_same_row() {
        let n = 400;
        let faces: Vec<[u32; 3]> = (1..n).map(|i| [0, i, i % (n - 1) + 1]).collect();
        let mesh = TriMesh::new(vec![[0.0; 3]; n as usize], faces).unwrap();
        let m = Pattern::of(&mesh).unwrap().fill(&mesh, |_| CornerEntries {
            diagonal: 1.0,
            next: 2.0,
            previous: 3.0,
        });
        assert_eq!(m.get(0, 0), Some(&399.0));
        for j in 1..n as usize {
            assert_eq!(m.get(0, j), Some(&5.0));
            assert_eq!(m.get(j, 0), Some(&5.0));
        }
        assert_eq!(m.nnz(), 400 + 2 * (399 + 399));
    }

    #[test]
    fn a_mesh_without_faces_has_a_zero_diagonal() {
        let mesh = TriMesh::new(vec![[0.0; 3]; 3], vec![]).unwrap();
        let m = Pattern::of(&mesh).unwrap().fill(&mesh, |_| CornerEntries {
            diagonal: 1.0,
            next: 1.0,
            previous: 1.0,
        });
        assert_eq!(m.nnz(), 3);
        assert!(m.data().iter().all(|&x| x == 0.0));
    }
}
