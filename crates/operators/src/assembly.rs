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

/// Where the entries of a vertex-by-vertex matrix are: the diagonal, and a
/// pair of entries for each edge. Columns ascend within a row.
#[derive(Debug, Clone)]
pub(crate) struct Pattern {
    offsets: Vec<u32>,
    columns: Vec<u32>,
}

impl Pattern {
    pub(crate) fn of(mesh: &TriMesh) -> Result<Self, OperatorError> {
        let n = mesh.vertex_count();
        let entries = n.saturating_add(mesh.face_count().saturating_mul(6));
        if u32::try_from(entries).is_err() {
            return Err(OperatorError::TooLarge { entries });
        }
        let vertices = mesh.faces().as_flattened();
        let incidence = mesh.incidence();
        let blocks: Vec<(Vec<u32>, Vec<u32>)> = row_ranges(n)
            .into_par_iter()
            .map(|rows| {
                let corner_count = corner_range(incidence, &rows).len();
                let mut lengths = Vec::with_capacity(rows.len());
                // Twice as many on a mesh of boundary edges only.
                let mut columns = Vec::with_capacity(corner_count + 2 * rows.len());
                let mut row = Vec::new();
                for v in rows {
                    closed_ring(vertices, incidence, v as u32, &mut row);
                    lengths.push(row.len() as u32);
                    columns.extend_from_slice(&row);
                }
                (lengths, columns)
            })
            .collect();

        let mut offsets = Vec::with_capacity(n + 1);
        offsets.push(0);
        let mut total = 0;
        let mut columns = Vec::with_capacity(blocks.iter().map(|(_, c)| c.len()).sum());
        for (lengths, block) in blocks {
            for length in lengths {
                total += length;
                offsets.push(total);
            }
            columns.extend_from_slice(&block);
        }
        Ok(Self { offsets, columns })
    }

    /// The matrix whose rows sum what `entries` says of each corner at their
    /// vertex.
    pub(crate) fn fill<F>(self, mesh: &TriMesh, entries: F) -> SparseMatrix
    where
        F: Fn(u32) -> CornerEntries + Sync,
    {
        let vertices = mesh.faces().as_flattened();
        let incidence = mesh.incidence();
        self.fill_rows(|v, columns, values| {
            let find = |w: u32| position(columns, w);
            let mut diagonal = 0.0;
            for &c in incidence.corners(v) {
                let e = entries(c);
                diagonal += e.diagonal;
                values[find(vertices[next(c) as usize])] += e.next;
                values[find(vertices[previous(c) as usize])] += e.previous;
            }
            values[find(v)] = diagonal;
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
                row(
                    v as u32,
                    &columns[range.clone()],
                    &mut block[range.start - start..range.end - start],
                );
            }
        });
        SparseMatrix::new((n, n), self.offsets, self.columns, values)
    }
}

/// The place of column `w` in a row that has it.
#[inline]
pub(crate) fn position(columns: &[u32], w: u32) -> usize {
    if columns.len() > 32 {
        return columns.partition_point(|&c| c < w);
    }
    // Without a branch in the loop: rows are short.
    columns.iter().map(|&c| usize::from(c < w)).sum()
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

/// Writes vertex `v` and its neighbours into `row`, ascending.
#[inline]
fn closed_ring(vertices: &[u32], incidence: &Incidence, v: u32, row: &mut Vec<u32>) {
    row.clear();
    row.push(v);
    let corners = incidence.corners(v);
    if corners.len() > 32 {
        for &c in corners {
            row.push(vertices[next(c) as usize]);
            row.push(vertices[previous(c) as usize]);
        }
        row.sort_unstable();
        row.dedup();
        return;
    }
    for &c in corners {
        insert(row, vertices[next(c) as usize]);
        insert(row, vertices[previous(c) as usize]);
    }
}

/// Inserts into a short ascending list, unless it is there.
#[inline]
fn insert(row: &mut Vec<u32>, w: u32) {
    let at: usize = row.iter().map(|&c| usize::from(c < w)).sum();
    if row.get(at) != Some(&w) {
        row.insert(at, w);
    }
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
        let n = 100;
        let faces: Vec<[u32; 3]> = (1..n).map(|i| [0, i, i % (n - 1) + 1]).collect();
        let mesh = TriMesh::new(vec![[0.0; 3]; n as usize], faces).unwrap();
        let m = Pattern::of(&mesh).unwrap().fill(&mesh, |_| CornerEntries {
            diagonal: 1.0,
            next: 2.0,
            previous: 3.0,
        });
        assert_eq!(m.get(0, 0), Some(&99.0));
        for j in 1..n as usize {
            assert_eq!(m.get(0, j), Some(&5.0));
            assert_eq!(m.get(j, 0), Some(&5.0));
        }
        assert_eq!(m.nnz(), 100 + 2 * (99 + 99));
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
