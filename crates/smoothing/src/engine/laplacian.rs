//! The Laplacian of a flow as a kernel over positions.
//!
//! Flows need three things of `L = −M⁻¹S`: its value at every vertex for three coordinates at once, fused with
//! whatever the step does with it; the masses `M`; and a bound on its spectrum. Uniform weights need no matrix
//! values at all, which halves the memory traffic of a step.

use std::ops::Range;

use fairing_mesh::TriMesh;
use fairing_operators::{CotangentNumbers, CotangentPattern, OperatorError, ThinFaces};
use fairing_sparse::SparseMatrix;
use rayon::prelude::*;

/// Rows in one unit of parallel work: large enough to hide scheduling, small enough to balance. Sums are formed
/// within units and then over units in order, so they do not depend on the number of threads.
pub(crate) const ROWS: usize = 4096;

type Point = [f64; 3];

/// `L = −M⁻¹S`, negative semi-definite in the inner product of `M`, for a symmetric `S` with zero row sums.
pub(crate) struct Laplacian {
    offsets: Vec<u32>,
    /// The neighbours. With uniform weights a held or isolated vertex is its own only one.
    columns: Vec<u32>,
    /// `−Sᵢⱼ` for each neighbour, so that a row of `−S x` is `Σⱼ wⱼ (xⱼ − xᵢ)`; `None` for ones.
    weights: Option<Vec<f64>>,
    /// `M`: degrees for uniform weights, areas for cotangents.
    mass: Vec<f64>,
    /// `M⁻¹`.
    inverse: Vec<f64>,
    /// The diagonal of `S`.
    diagonal: Vec<f64>,
}

impl Laplacian {
    /// Uniform weights, `(Lx)ᵢ = mean over neighbours xⱼ − xᵢ`: `S = D − A`, `M = D`. Vertices for which `held`
    /// is true, and isolated ones, have zero rows.
    pub(crate) fn uniform(vertex_count: usize, faces: &[[u32; 3]], held: &[bool]) -> Self {
        let (offsets, columns) = neighbor_lists(vertex_count, faces, held);
        let mass: Vec<f64> = offsets.windows(2).map(|w| f64::from(w[1] - w[0])).collect();
        let (inverse, diagonal) = (reciprocals(&mass), mass.clone());
        Self { offsets, columns, weights: None, mass, inverse, diagonal }
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
                    weights.push(-s);
                }
            }
            offsets.push(columns.len() as u32);
        }
        let inverse = reciprocals(&mass);
        Self { offsets, columns, weights: Some(weights), mass, inverse, diagonal }
    }

    /// All zero, on the pattern of cotangents.
    pub(crate) fn on(pattern: &CotangentPattern) -> Self {
        let (offsets, columns) = (pattern.offsets().to_vec(), pattern.columns().to_vec());
        let (n, weights) = (offsets.len() - 1, Some(vec![0.0; columns.len()]));
        let [mass, inverse, diagonal] = [(); 3].map(|()| vec![0.0; n]);
        Self { offsets, columns, weights, mass, inverse, diagonal }
    }

    /// Replaces the numbers by those of cotangents at the positions of `mesh`. Returns the faces that were widened.
    pub(crate) fn refill(
        &mut self,
        pattern: &mut CotangentPattern,
        mesh: &TriMesh,
        thin: ThinFaces,
    ) -> Result<Vec<u32>, OperatorError> {
        let weights = self.weights.get_or_insert_default();
        let (diagonal, mass) = (&mut self.diagonal[..], &mut self.mass[..]);
        let widened = pattern.fill(mesh, thin, CotangentNumbers { weights, diagonal, mass })?;
        self.inverse = reciprocals(&self.mass);
        Ok(widened)
    }

    /// Row `i` of `S` without its diagonal; empty for held and isolated vertices.
    pub(crate) fn stiffness_row(&self, i: usize) -> impl Iterator<Item = (u32, f64)> + '_ {
        let row = if self.is_still(i) { 0..0 } else { self.row(i) };
        let weight = |k: usize| self.weights.as_ref().map_or(1.0, |weights| weights[k]);
        row.map(move |k| (self.columns[k], -weight(k)))
    }

    /// The entries of row `i`.
    #[inline(always)]
    fn row(&self, i: usize) -> Range<usize> {
        self.offsets[i] as usize..self.offsets[i + 1] as usize
    }

    pub(crate) fn len(&self) -> usize {
        self.mass.len()
    }

    /// Entries of `S`, the diagonal included.
    pub(crate) fn entries(&self) -> usize {
        self.len() + self.columns.len()
    }

    /// `M`, one value per vertex.
    pub(crate) fn mass(&self) -> &[f64] {
        &self.mass
    }

    /// `M⁻¹`, one value per vertex.
    pub(crate) fn inverse_mass(&self) -> &[f64] {
        &self.inverse
    }

    /// The same `S` over another mass.
    pub(crate) fn replace_mass(&mut self, mass: Vec<f64>) {
        self.inverse = reciprocals(&mass);
        self.mass = mass;
    }

    /// The diagonal of `S`.
    pub(crate) fn diagonal(&self) -> &[f64] {
        &self.diagonal
    }

    /// An upper bound of the eigenvalues of `−L` by Gershgorin's circles; 2 for uniform weights.
    pub(crate) fn gershgorin(&self) -> f64 {
        let Some(weights) = &self.weights else { return 2.0 };
        let circle = |i: usize| {
            let row = &weights[self.row(i)];
            let (sum, size) = row.iter().fold((0.0, 0.0), |(s, a), w| (s + w, a + w.abs()));
            (sum + size) * self.inverse[i]
        };
        (0..self.len()).map(circle).fold(0.0, f64::max)
    }

    /// The neighbours of vertex `i`; itself alone if it is held with uniform weights, or isolated.
    pub(crate) fn neighbors(&self, i: usize) -> &[u32] {
        &self.columns[self.row(i)]
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
        let farthest = |i: usize| {
            self.neighbors(i).iter().map(|&j| (j as usize).abs_diff(i)).max().unwrap_or(0)
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
        let (ends, inverse) = (&self.offsets[rows.start..=rows.end], &self.inverse[rows]);
        match &self.weights {
            None => {
                for (k, out) in out.iter_mut().enumerate() {
                    let mut sum = [0.0; 4];
                    for &j in &self.columns[ends[k] as usize..ends[k + 1] as usize] {
                        let b = &x[j as usize - offset];
                        for d in 0..4 {
                            sum[d] += b[d];
                        }
                    }
                    let (a, p, w) = (&here[k], &points[k], l * inverse[k]);
                    for d in 0..4 {
                        out[d] = point * p[d] + (own - l) * a[d] + w * sum[d] - out[d];
                    }
                }
            }
            Some(weights) => {
                for (k, out) in out.iter_mut().enumerate() {
                    let range = ends[k] as usize..ends[k + 1] as usize;
                    let (a, p, l) = (&here[k], &points[k], l * inverse[k]);
                    let mut sum = [0.0; 4];
                    for (&j, &w) in self.columns[range.clone()].iter().zip(&weights[range]) {
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
        self.weights.is_none()
    }

    /// `yᵢ ← f(i, (Lx)ᵢ, xᵢ, yᵢ)` for every vertex, in parallel.
    pub(crate) fn sweep<const N: usize, F>(&self, x: &[[f64; N]], y: &mut [[f64; N]], f: F)
    where
        F: Fn(usize, [f64; N], [f64; N], [f64; N]) -> [f64; N] + Sync,
    {
        by_chunk(y, |i, y| {
            let (a, w) = (x[i], self.inverse[i]);
            let mut l = self.weighted_sum(i, x);
            for k in 0..N {
                l[k] = if self.is_uniform() { w * l[k] - a[k] } else { w * l[k] };
            }
            (f(i, l, a, y), [])
        });
    }

    /// `yᵢ ← f(i, −(Sx)ᵢ, xᵢ, yᵢ)` for every vertex, in parallel, and the sums of `K` numbers that `f` returns beside
    /// the new value.
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
            let a = x[i];
            let mut s = self.weighted_sum(i, x);
            if self.is_uniform() {
                for k in 0..N {
                    s[k] -= self.mass[i] * a[k];
                }
            }
            f(i, s, a, y)
        })
    }

    /// `Σⱼ wⱼ (xⱼ − xᵢ)`; with uniform weights `Σⱼ xⱼ`.
    #[inline(always)]
    fn weighted_sum<const N: usize>(&self, i: usize, x: &[[f64; N]]) -> [f64; N] {
        let (row, mut sum) = (self.row(i), [0.0; N]);
        match &self.weights {
            None => {
                for &j in &self.columns[row] {
                    let b = &x[j as usize];
                    for k in 0..N {
                        sum[k] += b[k];
                    }
                }
            }
            Some(weights) => {
                let a = x[i];
                for (&j, &w) in self.columns[row.clone()].iter().zip(&weights[row]) {
                    let b = &x[j as usize];
                    for k in 0..N {
                        sum[k] += w * (b[k] - a[k]);
                    }
                }
            }
        }
        sum
    }
}

/// `1/x` of each.
fn reciprocals(x: &[f64]) -> Vec<f64> {
    x.par_iter().with_min_len(ROWS).map(|x| 1.0 / x).collect()
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
