//! The Laplacian of a flow as a kernel over positions.
//!
//! Flows need three things of `L = −M⁻¹S`: its value at every vertex for three coordinates at once, fused with
//! whatever the step does with it; the masses `M`; and a bound on its spectrum. Uniform weights need no matrix
//! values at all, which halves the memory traffic of a step.

use std::ops::Range;

use fairing_sparse::SparseMatrix;
use rayon::prelude::*;

/// Rows in one unit of parallel work: large enough to hide scheduling, small enough to balance. Sums are formed
/// within units and then over units in order, so they do not depend on the number of threads.
pub(crate) const ROWS: usize = 4096;

type Point = [f64; 3];

/// `L = −M⁻¹S`, negative semi-definite in the inner product of `M`.
pub(crate) struct Laplacian {
    rows: Rows,
    /// `M`: degrees for uniform weights, areas for cotangents.
    mass: Vec<f64>,
    /// The diagonal of `S`.
    diagonal: Vec<f64>,
}

/// The numbers of a Laplacian on its pattern.
pub(crate) struct Numbers<'a> {
    /// `−Sᵢⱼ/Mᵢ` for each neighbour of each vertex.
    pub(crate) weights: &'a mut [f64],
    /// `M`.
    pub(crate) mass: &'a mut [f64],
    /// The diagonal of `S`.
    pub(crate) diagonal: &'a mut [f64],
}

enum Rows {
    /// The mean of the neighbours minus the vertex. A held or isolated vertex is its own only neighbour.
    Uniform { offsets: Vec<u32>, neighbors: Vec<u32>, inverse_degree: Vec<f64> },
    /// Off-diagonal entries `−Sᵢⱼ/Mᵢ`, so that a row is `Σⱼ wⱼ (xⱼ − xᵢ)`.
    Weighted { offsets: Vec<u32>, columns: Vec<u32>, weights: Vec<f64> },
}

impl Laplacian {
    /// Uniform weights, `(Lx)ᵢ = mean over neighbours xⱼ − xᵢ`: `S = D − A`, `M = D`. Vertices for which `held`
    /// is true, and isolated ones, have zero rows.
    pub(crate) fn uniform(vertex_count: usize, faces: &[[u32; 3]], held: &[bool]) -> Self {
        let (offsets, neighbors) = neighbor_lists(vertex_count, faces, held);
        let degree: Vec<f64> = offsets.windows(2).map(|w| f64::from(w[1] - w[0])).collect();
        let inverse_degree = degree.iter().map(|d| 1.0 / d).collect();
        let diagonal = degree.clone();
        Self { rows: Rows::Uniform { offsets, neighbors, inverse_degree }, mass: degree, diagonal }
    }

    /// From a symmetric stiffness `S` with zero row sums and positive masses. Vertices for which `held` is true
    /// have zero rows.
    pub(crate) fn weighted(stiffness: &SparseMatrix, mass: Vec<f64>, held: &[bool]) -> Self {
        let n = mass.len();
        let mut offsets = Vec::with_capacity(n + 1);
        let mut columns = Vec::with_capacity(stiffness.nnz());
        let mut weights = Vec::with_capacity(stiffness.nnz());
        let mut diagonal = vec![0.0; n];
        offsets.push(0);
        for (i, row) in stiffness.outer_iterator().enumerate() {
            for (j, &s) in row.iter() {
                if i == j {
                    diagonal[i] = s;
                } else if !held[i] {
                    columns.push(j as u32);
                    weights.push(-s / mass[i]);
                }
            }
            offsets.push(columns.len() as u32);
        }
        Self { rows: Rows::Weighted { offsets, columns, weights }, mass, diagonal }
    }

    /// All zero, on a pattern without the diagonal.
    pub(crate) fn empty(offsets: Vec<u32>, columns: Vec<u32>) -> Self {
        let n = offsets.len() - 1;
        let weights = vec![0.0; columns.len()];
        let rows = Rows::Weighted { offsets, columns, weights };
        Self { rows, mass: vec![0.0; n], diagonal: vec![0.0; n] }
    }

    /// The numbers on the pattern, to be replaced. Uniform weights have none but mass and diagonal.
    pub(crate) fn numbers_mut(&mut self) -> Numbers<'_> {
        let weights = match &mut self.rows {
            Rows::Uniform { .. } => &mut [][..],
            Rows::Weighted { weights, .. } => weights,
        };
        Numbers { weights, mass: &mut self.mass, diagonal: &mut self.diagonal }
    }

    /// Row `i` of `S` without its diagonal; empty for held and isolated vertices.
    pub(crate) fn stiffness_row(&self, i: usize) -> impl Iterator<Item = (u32, f64)> + '_ {
        let neighbors = if self.is_still(i) { &[] } else { self.neighbors(i) };
        let m = self.mass[i];
        neighbors.iter().enumerate().map(move |(k, &j)| match &self.rows {
            Rows::Uniform { .. } => (j, -1.0),
            Rows::Weighted { offsets, weights, .. } => (j, -m * weights[offsets[i] as usize + k]),
        })
    }

    pub(crate) fn len(&self) -> usize {
        self.mass.len()
    }

    /// Entries of `S`, the diagonal included.
    pub(crate) fn entries(&self) -> usize {
        let (Rows::Uniform { offsets, .. } | Rows::Weighted { offsets, .. }) = &self.rows;
        self.len() + offsets.last().map_or(0, |&end| end as usize)
    }

    /// `M`, one value per vertex.
    pub(crate) fn mass(&self) -> &[f64] {
        &self.mass
    }

    /// The same `S` over another mass; the rows of held vertices stay zero.
    pub(crate) fn replace_mass(&mut self, mass: Vec<f64>) {
        if let Rows::Weighted { offsets, weights, .. } = &mut self.rows {
            for (i, (old, new)) in self.mass.iter().zip(&mass).enumerate() {
                for w in &mut weights[offsets[i] as usize..offsets[i + 1] as usize] {
                    *w *= old / new;
                }
            }
        }
        self.mass = mass;
    }

    /// The diagonal of `S`.
    pub(crate) fn diagonal(&self) -> &[f64] {
        &self.diagonal
    }

    /// An upper bound of the eigenvalues of `−L` by Gershgorin's circles; 2 for uniform weights.
    pub(crate) fn gershgorin(&self) -> f64 {
        match &self.rows {
            Rows::Uniform { .. } => 2.0,
            Rows::Weighted { offsets, weights, .. } => offsets
                .windows(2)
                .map(|w| {
                    let row = &weights[w[0] as usize..w[1] as usize];
                    let (sum, size) = row.iter().fold((0.0, 0.0), |(s, a), w| (s + w, a + w.abs()));
                    sum + size
                })
                .fold(0.0, f64::max),
        }
    }

    /// The neighbours of vertex `i`; itself alone if it is held with uniform weights, or isolated.
    pub(crate) fn neighbors(&self, i: usize) -> &[u32] {
        let (offsets, columns) = match &self.rows {
            Rows::Uniform { offsets, neighbors, .. } => (offsets, neighbors),
            Rows::Weighted { offsets, columns, .. } => (offsets, columns),
        };
        &columns[offsets[i] as usize..offsets[i + 1] as usize]
    }

    /// Whether the row of vertex `i` is zero: it is held or isolated.
    pub(crate) fn is_still(&self, i: usize) -> bool {
        match *self.neighbors(i) {
            [] => true,
            [only] => only as usize == i,
            _ => false,
        }
    }

    /// Calls `f(i, neighbours of i, yᵢ)` for every vertex, in parallel.
    pub(crate) fn visit<F>(&self, y: &mut [Point], f: F)
    where
        F: Fn(usize, &[u32], &mut Point) + Sync,
    {
        y.par_chunks_mut(ROWS).enumerate().for_each(|(chunk, y)| {
            for (k, y) in y.iter_mut().enumerate() {
                let i = chunk * ROWS + k;
                f(i, self.neighbors(i), y);
            }
        });
    }

    /// The largest difference between the numbers of neighbours.
    pub(crate) fn reach(&self) -> usize {
        let (offsets, columns) = match &self.rows {
            Rows::Uniform { offsets, neighbors, .. } => (offsets, neighbors),
            Rows::Weighted { offsets, columns, .. } => (offsets, columns),
        };
        let farthest = |i: usize| {
            let row = &columns[offsets[i] as usize..offsets[i + 1] as usize];
            row.iter().map(|&j| (j as usize).abs_diff(i)).max().unwrap_or(0)
        };
        (0..self.len()).into_par_iter().with_min_len(ROWS).map(farthest).max().unwrap_or(0)
    }

    /// `outᵢ ← point pᵢ + own xᵢ + l (Lx)ᵢ − outᵢ` on some rows; `p` and `out` hold these rows, `x` begins with row
    /// `offset`.
    #[inline(always)]
    pub(crate) fn recur(
        &self,
        rows: Range<usize>,
        offset: usize,
        x: &[Padded],
        points: &[Padded],
        out: &mut [Padded],
        factors: Factors,
    ) {
        let Factors { point, own, l } = factors;
        let here = &x[rows.start - offset..rows.end - offset];
        match &self.rows {
            Rows::Uniform { offsets, neighbors, inverse_degree } => {
                let ends = &offsets[rows.start..=rows.end];
                let degrees = &inverse_degree[rows];
                for (k, out) in out.iter_mut().enumerate() {
                    let mut sum = [0.0; 4];
                    for &j in &neighbors[ends[k] as usize..ends[k + 1] as usize] {
                        let b = &x[j as usize - offset];
                        for d in 0..4 {
                            sum[d] += b[d];
                        }
                    }
                    let (a, p, w) = (&here[k], &points[k], l * degrees[k]);
                    for d in 0..4 {
                        out[d] = point * p[d] + (own - l) * a[d] + w * sum[d] - out[d];
                    }
                }
            }
            Rows::Weighted { offsets, columns, weights } => {
                let ends = &offsets[rows.start..=rows.end];
                for (k, out) in out.iter_mut().enumerate() {
                    let range = ends[k] as usize..ends[k + 1] as usize;
                    let (a, p) = (&here[k], &points[k]);
                    let mut sum = [0.0; 4];
                    for (&j, &w) in columns[range.clone()].iter().zip(&weights[range]) {
                        let b = &x[j as usize - offset];
                        for d in 0..4 {
                            sum[d] += w * (b[d] - a[d]);
                        }
                    }
                    for d in 0..4 {
                        out[d] = point * p[d] + own * a[d] + l * sum[d] - out[d];
                    }
                }
            }
        }
    }

    /// Whether the weights are uniform.
    pub(crate) fn is_uniform(&self) -> bool {
        matches!(self.rows, Rows::Uniform { .. })
    }

    /// `yᵢ ← f(i, (Lx)ᵢ, xᵢ, yᵢ)` for every vertex, in parallel.
    pub(crate) fn sweep<const N: usize, F>(&self, x: &[[f64; N]], y: &mut [[f64; N]], f: F)
    where
        F: Fn(usize, [f64; N], [f64; N], [f64; N]) -> [f64; N] + Sync,
    {
        self.sweep_summing(x, y, |i, l, x, y| (f(i, l, x, y), []));
    }

    /// As [`Self::sweep`], and sums `K` numbers that `f` returns beside the new value.
    pub(crate) fn sweep_summing<const N: usize, const K: usize, F>(
        &self,
        x: &[[f64; N]],
        y: &mut [[f64; N]],
        f: F,
    ) -> [f64; K]
    where
        F: Fn(usize, [f64; N], [f64; N], [f64; N]) -> ([f64; N], [f64; K]) + Sync,
    {
        by_chunk(y, |i, y| {
            let (a, mut l) = (x[i], [0.0; N]);
            match &self.rows {
                Rows::Uniform { offsets, neighbors, inverse_degree } => {
                    for &j in &neighbors[offsets[i] as usize..offsets[i + 1] as usize] {
                        let b = &x[j as usize];
                        for k in 0..N {
                            l[k] += b[k];
                        }
                    }
                    let w = inverse_degree[i];
                    for k in 0..N {
                        l[k] = l[k] * w - a[k];
                    }
                }
                Rows::Weighted { offsets, columns, weights } => {
                    let range = offsets[i] as usize..offsets[i + 1] as usize;
                    for (&j, &w) in columns[range.clone()].iter().zip(&weights[range]) {
                        let b = &x[j as usize];
                        for k in 0..N {
                            l[k] += w * (b[k] - a[k]);
                        }
                    }
                }
            }
            // In one place only, so that it is compiled into the loop.
            f(i, l, a, y)
        })
    }
}

/// The factors of a three-term recurrence.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Factors {
    /// Of a given point.
    pub(crate) point: f64,
    /// Of the last term.
    pub(crate) own: f64,
    /// Of the Laplacian of the last term.
    pub(crate) l: f64,
}

/// A point with a fourth coordinate of zero: whole registers, and two thirds of the instructions. For the inner
/// loops of long computations only; memory traffic grows by a third.
pub(crate) type Padded = [f64; 4];

/// `yᵢ ← f(i, yᵢ)` in units of [`ROWS`], with sums that do not depend on the number of threads.
pub(crate) fn by_chunk<const N: usize, const K: usize, F>(y: &mut [[f64; N]], f: F) -> [f64; K]
where
    F: Fn(usize, [f64; N]) -> ([f64; N], [f64; K]) + Sync,
{
    let partial: Vec<[f64; K]> = y
        .par_chunks_mut(ROWS)
        .enumerate()
        .map(|(chunk, y)| {
            let mut sums = [0.0; K];
            for (k, y) in y.iter_mut().enumerate() {
                let (value, terms) = f(chunk * ROWS + k, *y);
                *y = value;
                for (s, t) in sums.iter_mut().zip(terms) {
                    *s += t;
                }
            }
            sums
        })
        .collect();
    let mut total = [0.0; K];
    for sums in partial {
        for (t, s) in total.iter_mut().zip(sums) {
            *t += s;
        }
    }
    total
}

/// Vertices with more faces sort their neighbours to find repetitions: searching is quadratic.
const MANY_FACES: usize = 64;

/// The neighbours of every vertex along edges of faces, each once, in compressed rows; `[v]` for an isolated or
/// held vertex `v`.
fn neighbor_lists(n: usize, faces: &[[u32; 3]], held: &[bool]) -> (Vec<u32>, Vec<u32>) {
    let mut start = vec![0u32; n + 1];
    for &v in faces.as_flattened() {
        start[v as usize + 1] += 1;
    }
    for v in 0..n {
        start[v + 1] += start[v];
    }
    let mut next = start.clone();
    let mut around = vec![0u32; faces.len() * 3];
    for (f, face) in faces.iter().enumerate() {
        for &v in face {
            let slot = &mut next[v as usize];
            around[*slot as usize] = f as u32;
            *slot += 1;
        }
    }
    let pieces: Vec<(Vec<u32>, Vec<u32>)> = (0..n.div_ceil(ROWS))
        .into_par_iter()
        .map(|chunk| {
            let vertices = chunk * ROWS..n.min((chunk + 1) * ROWS);
            let mut lists = Vec::with_capacity(ROWS * 7);
            let mut lengths = Vec::with_capacity(ROWS);
            for v in vertices {
                let begin = lists.len();
                let around = &around[start[v] as usize..start[v + 1] as usize];
                if held[v] || around.is_empty() {
                    lists.push(v as u32);
                } else if around.len() > MANY_FACES {
                    let corners = around.iter().flat_map(|&f| faces[f as usize]);
                    let mut all: Vec<u32> = corners.filter(|&j| j as usize != v).collect();
                    all.sort_unstable();
                    all.dedup();
                    lists.extend(all);
                } else {
                    for &f in around {
                        for j in faces[f as usize] {
                            if j as usize != v && !lists[begin..].contains(&j) {
                                lists.push(j);
                            }
                        }
                    }
                }
                lengths.push((lists.len() - begin) as u32);
            }
            (lists, lengths)
        })
        .collect();
    let mut offsets = Vec::with_capacity(n + 1);
    let mut neighbors = Vec::with_capacity(pieces.iter().map(|(lists, _)| lists.len()).sum());
    let mut end = 0;
    offsets.push(0);
    for (lists, lengths) in pieces {
        neighbors.extend_from_slice(&lists);
        for length in lengths {
            end += length;
            offsets.push(end);
        }
    }
    (offsets, neighbors)
}
