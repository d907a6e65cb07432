//! Vertex-by-vertex matrices assembled by rows, in parallel.
//!
//! The pattern comes from the corners at each vertex; a row gathers the contributions of its
//! corners, in ascending order of faces. No triplets are sorted, no memory beyond the matrix is
//! used, and the sums do not depend on the number of threads. Linear in corners, for bounded
//! valence.

use std::ops::Range;

use fairing_mesh::TriMesh;
use fairing_sparse::SparseMatrix;
use fairing_watch::parallel;

use crate::error::OperatorError;
use crate::fan::Fan;

/// Rows handed to a thread at a time at least: enough to hide the hand-over.
const ROWS_PER_TASK: usize = 2048;

/// The entries that a corner adds to the row of its vertex, in the columns of
/// the next and of the previous vertex of its face.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Side {
    vertices: [u32; 2],
    values: [f64; 2],
}

/// The diagonal entry of a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Diagonal {
    /// The sum of the other entries: rows of masses.
    Sum,
    /// Minus that sum: rows of Laplacians.
    MinusSum,
}

impl Diagonal {
    fn entry(self, sum: f64) -> f64 {
        match self {
            Self::Sum => sum,
            // Not −0 where there is nothing.
            Self::MinusSum => 0.0 - sum,
        }
    }
}

/// The contributions of the faces to a matrix with an entry for each vertex and
/// a pair of entries for each edge.
///
/// The same code sums a row whether the pattern is found or given.
pub(crate) struct SideSums<'a> {
    mesh: &'a TriMesh,
    diagonal: Diagonal,
    /// In the order of the corners at each vertex.
    sides: Vec<Side>,
}

impl<'a> SideSums<'a> {
    /// `of_face` says, for a face, what the side opposite each corner adds to
    /// its two entries.
    ///
    /// One pass over the faces stores that at their vertices, so that
    /// nothing needs to be searched for there.
    ///
    /// # Errors
    ///
    /// The first of `of_face`; [`OperatorError::TooLarge`] beyond 2³² entries.
    pub(crate) fn new(
        mesh: &'a TriMesh,
        diagonal: Diagonal,
        of_face: impl Fn(usize) -> Result<[f64; 3], OperatorError>,
    ) -> Result<Self, OperatorError> {
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
        Ok(Self { mesh, diagonal, sides })
    }

    /// The matrix, on the pattern of one of the same faces if there is one: the
    /// same bits. Columns ascend, the diagonal is present.
    ///
    /// # Errors
    ///
    /// [`OperatorError::Connectivity`] for the first vertex with an edge that
    /// the pattern does not have.
    pub(crate) fn matrix(
        &self,
        pattern: Option<&SparseMatrix>,
    ) -> Result<SparseMatrix, OperatorError> {
        match pattern {
            None => Ok(self.on_new_pattern()),
            Some(pattern) => self.on_pattern(pattern),
        }
    }

    fn on_new_pattern(&self) -> SparseMatrix {
        let gather =
            |fan: &mut Fan, v: u32| fan.gather(self.at(v as usize).iter().map(|s| s.vertices));
        let fill = |v: u32, fan: &Fan, place: usize, row: &mut [f64]| {
            let after = |rank: u32| rank as usize + usize::from(rank as usize >= place);
            // The fan has every neighbour.
            let _ = self.sum(v as usize, place, row, |side, end| Some(after(fan.ranks[side][end])));
        };
        assemble_rows(self.mesh.vertex_count(), gather, fill)
    }

    fn on_pattern(&self, pattern: &SparseMatrix) -> Result<SparseMatrix, OperatorError> {
        let mut matrix = pattern.map(|_| 0.0);
        let offsets = pattern.indptr();
        let (offsets, columns) = (offsets.raw_storage(), pattern.indices());
        let mut rest = matrix.data_mut();
        let mut blocks = vec![];
        for rows in row_ranges(self.mesh.vertex_count()) {
            let length = offsets[rows.end] - offsets[rows.start];
            let (block, later) = std::mem::take(&mut rest).split_at_mut(length as usize);
            blocks.push((rows, block));
            rest = later;
        }
        let fill = |(rows, values): (Range<usize>, &mut [f64])| -> Result<(), usize> {
            let first = offsets[rows.start] as usize;
            for v in rows {
                let (start, end) = (offsets[v] as usize, offsets[v + 1] as usize);
                let (columns, row) =
                    (&columns[start..end], &mut values[start - first..end - first]);
                let place = |w: u32| {
                    let place = position(columns, w);
                    (columns.get(place) == Some(&w)).then_some(place)
                };
                let at = self.at(v);
                let filled = place(v as u32).and_then(|own| {
                    self.sum(v, own, row, |side, end| place(at[side].vertices[end]))
                });
                filled.ok_or(v)?;
            }
            Ok(())
        };
        let filled = parallel::map_each(blocks, fill);
        let filled: Result<(), usize> = filled.into_iter().collect();
        filled.map_err(|v| OperatorError::Connectivity { vertex: v as u32 })?;
        Ok(matrix)
    }

    /// The contributions of the corners at vertex `v`.
    #[inline]
    fn at(&self, v: usize) -> &[Side] {
        let starts = self.mesh.incidence().offsets();
        &self.sides[starts[v] as usize..starts[v + 1] as usize]
    }

    /// Adds up a row over zeros, whose diagonal is at `own`; `place(i, k)` is
    /// where corner `i` at the vertex adds to the next (0) and to the previous
    /// vertex (1) of its face. `None` if one has no place.
    #[inline]
    fn sum(
        &self,
        v: usize,
        own: usize,
        row: &mut [f64],
        place: impl Fn(usize, usize) -> Option<usize>,
    ) -> Option<()> {
        let mut sum = 0.0;
        for (i, side) in self.at(v).iter().enumerate() {
            for (k, value) in side.values.into_iter().enumerate() {
                row[place(i, k)?] += value;
                sum += value;
            }
        }
        row[own] = self.diagonal.entry(sum);
        Some(())
    }
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
        parallel::map_each(row_ranges(n), |rows| Block::new(rows, &gather, &fill));
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
    fn new<G, F>(rows: Range<usize>, gather: &G, fill: &F) -> Self
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

    fn matrix(mesh: &TriMesh, diagonal: Diagonal, of_face: fn(usize) -> [f64; 3]) -> SparseMatrix {
        let sums = SideSums::new(mesh, diagonal, |f| Ok(of_face(f))).unwrap();
        let matrix = sums.matrix(None).unwrap();
        assert_eq!(sums.matrix(Some(&matrix)), Ok(matrix.clone()));
        matrix
    }

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

    /// Contributions of face 0 to its sides 12, 20, 01, and of face 1 to 21, 13, 32.
    #[test]
    fn sides_go_to_their_two_entries() {
        let mesh = TriMesh::new(vec![[0.0; 3]; 5], vec![[0, 1, 2], [3, 2, 1]]).unwrap();
        let of_face = |f| [[1.0, 2.0, 4.0], [8.0, 16.0, 32.0]][f];
        let m = matrix(&mesh, Diagonal::MinusSum, of_face);
        let expected = [
            [-6.0, 4.0, 2.0, 0.0, 0.0],
            [4.0, -29.0, 9.0, 16.0, 0.0],
            [2.0, 9.0, -43.0, 32.0, 0.0],
            [0.0, 16.0, 32.0, -48.0, 0.0],
            [0.0; 5],
        ];
        assert_eq!(m.to_dense(), ndarray::arr2(&expected));
        let sum = matrix(&mesh, Diagonal::Sum, of_face);
        assert_eq!(sum.get(1, 1), Some(&29.0));
    }

    #[test]
    fn a_hub_has_a_long_row() {
        let n = 400;
        let faces: Vec<[u32; 3]> = (1..n).map(|i| [0, i, i % (n - 1) + 1]).collect();
        let mesh = TriMesh::new(vec![[0.0; 3]; n as usize], faces).unwrap();
        let m = matrix(&mesh, Diagonal::Sum, |_| [1.0, 2.0, 3.0]);
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
        let sum = || matrix(&mesh, Diagonal::Sum, |f| [f as f64, 0.3 * (f % 7) as f64, -0.1]);
        let on = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        assert_eq!(on(1).install(sum), on(3).install(sum));
    }

    #[test]
    fn a_mesh_without_faces_has_a_zero_diagonal() {
        let mesh = TriMesh::new(vec![[0.0; 3]; 3], vec![]).unwrap();
        let m = matrix(&mesh, Diagonal::MinusSum, |_| [1.0; 3]);
        assert_eq!(m.nnz(), 3);
        assert!(m.data().iter().all(|&x| x == 0.0 && x.is_sign_positive()));
    }
}
