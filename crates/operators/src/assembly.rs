//! Vertex-by-vertex matrices assembled by rows, in parallel.
//!
//! The pattern comes from the corners at each vertex; a row gathers what the
//! corners give it, in ascending order of faces. There are no triplets to
//! sort, memory is that of the matrix, and the sums do not depend on threads.
//! Linear in corners, for bounded valence.

use std::ops::Range;

use fairing_mesh::TriMesh;
use fairing_sparse::SparseMatrix;
use rayon::prelude::*;

use crate::error::OperatorError;
use crate::fan::Fan;

/// Rows handed to a thread at a time at least: enough to hide the hand-over.
const ROWS_PER_TASK: usize = 2048;

/// What a corner adds to the row of its vertex, in the columns of the next and
/// of the previous vertex of its face.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Side {
    vertices: [u32; 2],
    values: [f64; 2],
}

/// What the diagonal of a row is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Diagonal {
    /// The sum of the other entries: rows of masses.
    Sum,
    /// Minus that sum: rows of Laplacians.
    MinusSum,
}

impl Diagonal {
    fn of(self, sum: f64) -> f64 {
        match self {
            Self::Sum => sum,
            // Not −0 where there is nothing.
            Self::MinusSum => 0.0 - sum,
        }
    }
}

/// The `n × n` matrix, for `n` vertices, with a pair of entries for each edge,
/// summed over the faces of the edge: `of_face` says, for a face, what the side
/// opposite each corner adds. Columns ascend, the diagonal is present.
///
/// One pass over the faces writes what they add down at their vertices, so
/// that nothing needs to be looked up there.
///
/// # Errors
///
/// The first of `of_face`; [`OperatorError::TooLarge`] beyond 2³² entries.
pub(crate) fn sum_sides(
    mesh: &TriMesh,
    diagonal: Diagonal,
    of_face: impl Fn(usize) -> Result<[f64; 3], OperatorError>,
) -> Result<SparseMatrix, OperatorError> {
    let sides = sides_at_vertices(mesh, of_face)?;
    let starts = mesh.incidence().offsets();
    let at = |v: u32| &sides[starts[v as usize] as usize..starts[v as usize + 1] as usize];
    let gather = |fan: &mut Fan, v: u32| fan.gather(at(v).iter().map(|side| side.vertices));
    let fill = |v: u32, fan: &Fan, place: usize, row: &mut [f64]| {
        let mut sum = 0.0;
        for (side, ranks) in at(v).iter().zip(&fan.ranks) {
            for (&rank, value) in ranks.iter().zip(side.values) {
                row[rank as usize + usize::from(rank as usize >= place)] += value;
                sum += value;
            }
        }
        row[place] = diagonal.of(sum);
    };
    Ok(assemble_rows(mesh.vertex_count(), gather, fill))
}

/// [`sum_sides`], written into a matrix that it made of the same faces: the
/// same bits.
///
/// # Errors
///
/// The first of `of_face`; [`OperatorError::Connectivity`] for the first
/// vertex with an edge that the matrix does not have. The matrix is as it was
/// then.
pub(crate) fn fill_sides(
    mesh: &TriMesh,
    diagonal: Diagonal,
    of_face: impl Fn(usize) -> Result<[f64; 3], OperatorError>,
    matrix: &mut SparseMatrix,
) -> Result<(), OperatorError> {
    let sides = sides_at_vertices(mesh, of_face)?;
    let starts = mesh.incidence().offsets();
    let (offsets, columns) = (matrix.indptr().into_raw_storage().to_vec(), matrix.indices());
    let fill = |v: usize, columns: &[u32], row: &mut [f64]| -> Option<()> {
        let mut sum = 0.0;
        for side in &sides[starts[v] as usize..starts[v + 1] as usize] {
            for (&w, value) in side.vertices.iter().zip(side.values) {
                let place = position(columns, w);
                if columns.get(place) != Some(&w) {
                    return None;
                }
                row[place] += value;
                sum += value;
            }
        }
        *row.get_mut(position(columns, v as u32))? = diagonal.of(sum);
        Some(())
    };
    let block = |rows: Range<usize>| -> Result<Vec<f64>, usize> {
        let first = offsets[rows.start] as usize;
        let mut values = vec![0.0; offsets[rows.end] as usize - first];
        for v in rows {
            let (start, end) = (offsets[v] as usize, offsets[v + 1] as usize);
            fill(v, &columns[start..end], &mut values[start - first..end - first]).ok_or(v)?;
        }
        Ok(values)
    };
    let blocks: Vec<_> = row_ranges(mesh.vertex_count()).into_par_iter().map(block).collect();
    let blocks: Result<Vec<_>, usize> = blocks.into_iter().collect();
    let blocks = blocks.map_err(|v| OperatorError::Connectivity { vertex: v as u32 })?;
    let mut rest = matrix.data_mut();
    for block in blocks {
        let (now, later) = rest.split_at_mut(block.len());
        now.copy_from_slice(&block);
        rest = later;
    }
    Ok(())
}

/// What `of_face` says of the sides of the faces, in the order of the corners
/// at each vertex.
fn sides_at_vertices(
    mesh: &TriMesh,
    of_face: impl Fn(usize) -> Result<[f64; 3], OperatorError>,
) -> Result<Vec<Side>, OperatorError> {
    check_size(mesh)?;
    let mut next = mesh.incidence().offsets().to_vec();
    let mut sides = vec![Side::default(); 3 * mesh.face_count()];
    for (f, &[a, b, c]) in mesh.faces().iter().enumerate() {
        let [at_a, at_b, at_c] = of_face(f)?;
        for (v, vertices, values) in
            [(a, [b, c], [at_c, at_b]), (b, [c, a], [at_a, at_c]), (c, [a, b], [at_b, at_a])]
        {
            let slot = &mut next[v as usize];
            sides[*slot as usize] = Side { vertices, values };
            *slot += 1;
        }
    }
    Ok(sides)
}

/// The `n × n` matrix with an entry for each vertex, and a pair for each edge,
/// whose rows `row(fan, place, values)` writes over zeros; the diagonal is at
/// `place`, the neighbours in the order of the fan before and after it.
pub(crate) fn assemble<F>(mesh: &TriMesh, row: F) -> Result<SparseMatrix, OperatorError>
where
    F: Fn(&Fan, usize, &mut [f64]) + Sync,
{
    check_size(mesh)?;
    let incidence = mesh.incidence();
    let gather = |fan: &mut Fan, v: u32| fan.gather(incidence.sides(v).iter().copied());
    Ok(assemble_rows(mesh.vertex_count(), gather, |_, fan, place, values| row(fan, place, values)))
}

fn check_size(mesh: &TriMesh) -> Result<(), OperatorError> {
    let entries = mesh.vertex_count().saturating_add(mesh.face_count().saturating_mul(6));
    match u32::try_from(entries) {
        Ok(_) => Ok(()),
        Err(_) => Err(OperatorError::TooLarge { entries }),
    }
}

fn assemble_rows<G, F>(n: usize, gather: G, fill: F) -> SparseMatrix
where
    G: Fn(&mut Fan, u32) + Sync,
    F: Fn(u32, &Fan, usize, &mut [f64]) + Sync,
{
    let blocks: Vec<Block> =
        row_ranges(n).into_par_iter().map(|rows| Block::of(rows, &gather, &fill)).collect();
    Block::join(n, blocks)
}

/// Rows that a task assembles.
#[derive(Default)]
struct Block {
    lengths: Vec<u32>,
    columns: Vec<u32>,
    values: Vec<f64>,
}

impl Block {
    fn of<G, F>(rows: Range<usize>, gather: &G, fill: &F) -> Self
    where
        G: Fn(&mut Fan, u32),
        F: Fn(u32, &Fan, usize, &mut [f64]),
    {
        // On closed meshes a row has seven entries in the mean.
        let entries = 7 * rows.len() + rows.len() / 8;
        let mut block = Self {
            lengths: Vec::with_capacity(rows.len()),
            columns: Vec::with_capacity(entries),
            values: Vec::with_capacity(entries),
        };
        let mut fan = Fan::default();
        for v in rows {
            let v = v as u32;
            gather(&mut fan, v);
            let place = position(&fan.neighbors, v);
            let (before, after) = fan.neighbors.split_at(place);
            block.lengths.push(fan.neighbors.len() as u32 + 1);
            block.columns.extend_from_slice(before);
            block.columns.push(v);
            block.columns.extend_from_slice(after);
            let start = block.values.len();
            block.values.resize(block.columns.len(), 0.0);
            fill(v, &fan, place, &mut block.values[start..]);
        }
        block
    }

    fn join(n: usize, mut blocks: Vec<Self>) -> SparseMatrix {
        let mut offsets = Vec::with_capacity(n + 1);
        offsets.push(0);
        let mut total = 0;
        offsets.extend(blocks.iter().flat_map(|b| &b.lengths).map(|length| {
            total += length;
            total
        }));
        let mut first = if blocks.is_empty() { Self::default() } else { blocks.remove(0) };
        let rest: usize = blocks.iter().map(|b| b.columns.len()).sum();
        first.columns.reserve_exact(rest);
        first.values.reserve_exact(rest);
        for block in blocks {
            first.columns.extend_from_slice(&block.columns);
            first.values.extend_from_slice(&block.values);
        }
        SparseMatrix::new((n, n), offsets, first.columns, first.values)
    }
}

/// The place of column `w` in an ascending row, or where it would be.
#[inline]
fn position(columns: &[u32], w: u32) -> usize {
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

/// Tasks of equal numbers of rows, a few for each thread; one for one thread,
/// which need not join anything.
fn row_ranges(n: usize) -> Vec<Range<usize>> {
    let threads = rayon::current_num_threads();
    let tasks = if threads > 1 { 4 * threads } else { 1 };
    let rows = n.div_ceil(tasks).max(ROWS_PER_TASK);
    (0..n).step_by(rows).map(|start| start..(start + rows).min(n)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_is_the_closed_ring_of_its_vertex() {
        let positions = vec![[0.0; 3]; 6];
        let mesh = TriMesh::new(positions, vec![[0, 4, 2], [4, 0, 1], [4, 1, 2]]).unwrap();
        let m = assemble(&mesh, |fan, place, row| row[place] = fan.ranks.len() as f64).unwrap();
        assert_eq!(*m.indptr().raw_storage(), [0, 4, 8, 12, 13, 17, 18]);
        assert_eq!(m.indices(), [0, 1, 2, 4, 0, 1, 2, 4, 0, 1, 2, 4, 3, 0, 1, 2, 4, 5]);
        for (v, faces) in [2.0, 2.0, 2.0, 0.0, 3.0, 0.0].into_iter().enumerate() {
            assert_eq!(m.get(v, v), Some(&faces));
        }
    }

    /// What face 0 says of its sides 12, 20, 01, and face 1 of 21, 13, 32.
    #[test]
    fn sides_go_to_their_two_entries() {
        let mesh = TriMesh::new(vec![[0.0; 3]; 5], vec![[0, 1, 2], [3, 2, 1]]).unwrap();
        let of_face = |f| Ok([[1.0, 2.0, 4.0], [8.0, 16.0, 32.0]][f]);
        let m = sum_sides(&mesh, Diagonal::MinusSum, of_face).unwrap();
        let expected = [
            [-6.0, 4.0, 2.0, 0.0, 0.0],
            [4.0, -29.0, 9.0, 16.0, 0.0],
            [2.0, 9.0, -43.0, 32.0, 0.0],
            [0.0, 16.0, 32.0, -48.0, 0.0],
            [0.0; 5],
        ];
        assert_eq!(m.to_dense(), ndarray::arr2(&expected));
        let sum = sum_sides(&mesh, Diagonal::Sum, of_face).unwrap();
        assert_eq!(sum.get(1, 1), Some(&29.0));
    }

    #[test]
    fn a_hub_has_a_long_row() {
        let n = 400;
        let faces: Vec<[u32; 3]> = (1..n).map(|i| [0, i, i % (n - 1) + 1]).collect();
        let mesh = TriMesh::new(vec![[0.0; 3]; n as usize], faces).unwrap();
        let m = sum_sides(&mesh, Diagonal::Sum, |_| Ok([1.0, 2.0, 3.0])).unwrap();
        assert_eq!(m.get(0, 0), Some(&(5.0 * 399.0)));
        for j in 1..n as usize {
            assert_eq!(m.get(0, j), Some(&5.0));
            assert_eq!(m.get(j, 0), Some(&5.0));
        }
        assert_eq!(m.nnz(), 400 + 2 * (399 + 399));
    }

    /// Tasks differ with the number of threads, rows do not.
    #[test]
    fn threads_do_not_matter() {
        let mesh = fairing_shapes::icosphere(5);
        let sum = || {
            let of_face = |f| Ok([f as f64, 0.3 * (f % 7) as f64, -0.1]);
            sum_sides(&mesh, Diagonal::Sum, of_face)
        };
        let on = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        assert_eq!(on(1).install(sum), on(3).install(sum));
    }

    #[test]
    fn a_mesh_without_faces_has_a_zero_diagonal() {
        let mesh = TriMesh::new(vec![[0.0; 3]; 3], vec![]).unwrap();
        let m = sum_sides(&mesh, Diagonal::MinusSum, |_| Ok([1.0; 3])).unwrap();
        assert_eq!(m.nnz(), 3);
        assert!(m.data().iter().all(|&x| x == 0.0 && x.is_sign_positive()));
    }
}
