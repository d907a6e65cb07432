//! The Laplacian of a weighted graph, with products fused into the update that uses them.

use std::ops::Range;

use fairing_watch::parallel::{for_chunks, map, map_ranges};

use crate::matrix::SparseMatrix;
use crate::order::larger;
use crate::parallel::{self, CHUNK, Sum};

/// `L = −M⁻¹S` for a symmetric `S` with zero row sums and a positive diagonal `M`: negative
/// semi-definite in the inner product of `M` where `S` is positive semi-definite.
///
/// Rows of `S` act on differences, `−(Sx)ᵢ = Σⱼ wⱼ (xⱼ − xᵢ)`, so that constants vanish exactly.
/// Unit weights are not stored, which halves the memory traffic of a product. Products are fused
/// with the update that uses them, in one pass over the rows; sums are those of
/// [`parallel`](crate::parallel) and do not depend on the number of threads.
///
/// Rows may be zero, for values that do not change: [`is_fixed`](Self::is_fixed).
///
/// # Examples
///
/// ```
/// use fairing_sparse::GraphLaplacian;
/// // A path of three vertices.
/// let path = GraphLaplacian::uniform(vec![0, 1, 3, 4], vec![1, 0, 2, 1]);
/// let mut mean = vec![[0.0]; 3];
/// path.sweep(&[[0.0], [3.0], [4.0]], &mut mean, |_, l, x, _| [x[0] + l[0]]);
/// assert_eq!(mean, [[3.0], [2.0], [3.0]]);
/// ```
#[derive(Debug, Clone)]
pub struct GraphLaplacian {
    offsets: Vec<u32>,
    /// The neighbours. With unit weights, the only neighbour of a zero row is its own vertex.
    columns: Vec<u32>,
    /// `−Sᵢⱼ` for each neighbour; `None` for unit weights.
    weights: Option<Vec<f64>>,
    mass: Vec<f64>,
    /// `M⁻¹`.
    inverse: Vec<f64>,
    /// The diagonal of `S`.
    diagonal: Vec<f64>,
}

/// Mutable values of a [`GraphLaplacian`].
#[derive(Debug)]
#[non_exhaustive]
pub struct GraphNumbers<'a> {
    /// `−Sᵢⱼ`, one for each column.
    pub weights: &'a mut [f64],
    /// The diagonal of `S`, zero rows included.
    pub diagonal: &'a mut [f64],
    /// `M`, positive.
    pub mass: &'a mut [f64],
}

/// A point padded to a SIMD register: a third fewer instructions for a third more memory traffic,
/// which pays in the inner loops of long computations. The fourth number is zero.
pub(crate) type Padded = [f64; 4];

/// Factors of a three-term recurrence.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Factors {
    /// Factor of the given point.
    pub(crate) point: f64,
    /// Factor of the last term.
    pub(crate) own: f64,
    /// Factor of the Laplacian of the last term.
    pub(crate) l: f64,
}

impl GraphLaplacian {
    /// The Laplacian of unit weights over the number of neighbours: `(Lx)ᵢ` is the mean of
    /// `xⱼ − xᵢ` over the neighbours j. The neighbours of `i` are
    /// `columns[offsets[i]..offsets[i + 1]]`; a zero row has its own vertex as its only neighbour.
    ///
    /// # Panics
    ///
    /// Panics if the offsets do not begin with 0 and end with the number of columns.
    pub fn uniform(offsets: Vec<u32>, columns: Vec<u32>) -> Self {
        check(&offsets, &columns);
        let mass: Vec<f64> = offsets.windows(2).map(|w| f64::from(w[1] - w[0])).collect();
        let (inverse, diagonal) = (reciprocals(&mass), mass.clone());
        Self { offsets, columns, weights: None, mass, inverse, diagonal }
    }

    /// The Laplacian of a symmetric `S` with zero row sums and positive masses. Rows for which
    /// `fixed` is true are zero.
    ///
    /// # Panics
    ///
    /// Panics if `S` is not CSR or a length differs from the number of its rows.
    pub fn weighted(s: &SparseMatrix, mass: Vec<f64>, fixed: &[bool]) -> Self {
        let n = mass.len();
        assert!(s.is_csr(), "the matrix must be stored by rows");
        assert_eq!((s.rows(), s.cols(), fixed.len()), (n, n, n), "sizes of the operands");
        let mut offsets = Vec::with_capacity(n + 1);
        let mut columns = Vec::with_capacity(s.nnz());
        let mut weights = Vec::with_capacity(s.nnz());
        let mut diagonal = vec![0.0; n];
        offsets.push(0);
        for (i, row) in s.outer_iterator().enumerate() {
            for (j, &s) in row.iter() {
                if i == j {
                    diagonal[i] = s;
                } else if !fixed[i] {
                    columns.push(j as u32);
                    weights.push(-s);
                }
            }
            offsets.push(columns.len() as u32);
        }
        let inverse = reciprocals(&mass);
        Self { offsets, columns, weights: Some(weights), mass, inverse, diagonal }
    }

    /// Zeros on the pattern of a graph, to be [filled](Self::fill). The pattern is given as in
    /// [`uniform`](Self::uniform), except that zero rows are empty.
    ///
    /// # Panics
    ///
    /// Panics if the offsets do not begin with 0 and end with the number of columns.
    pub fn on_pattern(offsets: Vec<u32>, columns: Vec<u32>) -> Self {
        check(&offsets, &columns);
        let (n, weights) = (offsets.len() - 1, Some(vec![0.0; columns.len()]));
        let [mass, inverse, diagonal] = [(); 3].map(|()| vec![0.0; n]);
        Self { offsets, columns, weights, mass, inverse, diagonal }
    }

    /// Overwrites all values; unit weights become stored weights.
    ///
    /// # Errors
    ///
    /// The error of `fill`, which leaves the values unspecified.
    pub fn fill<T, E>(
        &mut self,
        fill: impl FnOnce(GraphNumbers<'_>) -> Result<T, E>,
    ) -> Result<T, E> {
        let ones = || vec![1.0; self.columns.len()];
        let weights = self.weights.get_or_insert_with(ones);
        let (diagonal, mass) = (&mut self.diagonal[..], &mut self.mass[..]);
        let filled = fill(GraphNumbers { weights, diagonal, mass })?;
        self.inverse = reciprocals(&self.mass);
        Ok(filled)
    }

    /// Replaces `M`, keeping `S`.
    pub fn replace_mass(&mut self, mass: Vec<f64>) {
        self.inverse = reciprocals(&mass);
        self.mass = mass;
    }

    /// The number of rows.
    #[inline]
    pub fn len(&self) -> usize {
        self.mass.len()
    }

    /// Returns true if there are no rows.
    pub fn is_empty(&self) -> bool {
        self.mass.is_empty()
    }

    /// The number of entries of `S`, diagonal included.
    pub fn entries(&self) -> usize {
        self.len() + self.columns.len()
    }

    /// `M`.
    #[inline]
    pub fn mass(&self) -> &[f64] {
        &self.mass
    }

    /// `M⁻¹`.
    #[inline]
    pub(crate) fn inverse_mass(&self) -> &[f64] {
        &self.inverse
    }

    /// The diagonal of `S`.
    #[inline]
    pub fn diagonal(&self) -> &[f64] {
        &self.diagonal
    }

    /// Returns true if all weights are one.
    #[inline]
    pub(crate) fn is_uniform(&self) -> bool {
        self.weights.is_none()
    }

    /// The range of entries of row `i`.
    #[inline(always)]
    fn row(&self, i: usize) -> Range<usize> {
        self.offsets[i] as usize..self.offsets[i + 1] as usize
    }

    /// The neighbours of row `i`; for a zero row only `i` itself, or none.
    #[inline]
    pub fn neighbors(&self, i: usize) -> &[u32] {
        &self.columns[self.row(i)]
    }

    /// Returns true if row `i` is zero.
    #[inline]
    pub fn is_fixed(&self, i: usize) -> bool {
        match *self.neighbors(i) {
            [] => true,
            [only] => only as usize == i,
            _ => false,
        }
    }

    /// Columns and values of row `i` of `S` off its diagonal; empty for a zero row.
    pub fn stiffness_row(&self, i: usize) -> impl Iterator<Item = (u32, f64)> + '_ {
        let row = if self.is_fixed(i) { 0..0 } else { self.row(i) };
        let weight = |k: usize| self.weights.as_ref().map_or(1.0, |weights| weights[k]);
        row.map(move |k| (self.columns[k], -weight(k)))
    }

    /// The bandwidth: the largest difference |i − j| between neighbours.
    pub(crate) fn bandwidth(&self) -> usize {
        let farthest = |i: usize| {
            self.neighbors(i).iter().map(|&j| (j as usize).abs_diff(i)).max().unwrap_or(0)
        };
        let farthest = map_ranges(self.len(), CHUNK, |rows| rows.map(farthest).max());
        farthest.into_iter().flatten().max().unwrap_or(0)
    }

    /// Gershgorin's upper bound on the eigenvalues of `−L`; 2 for unit weights.
    pub fn gershgorin(&self) -> f64 {
        let Some(weights) = &self.weights else { return 2.0 };
        let circle = |i: usize| {
            let row = &weights[self.row(i)];
            let (sum, size) = row.iter().fold((0.0, 0.0), |(s, a), w| (s + w, a + w.abs()));
            (sum + size) * self.inverse[i]
        };
        (0..self.len()).map(circle).fold(0.0, larger)
    }

    /// Calls `f(i, neighbours of i, yᵢ)` for every row, in parallel.
    pub fn visit<T: Send>(&self, y: &mut [T], f: impl Fn(usize, &[u32], &mut T) + Sync) {
        for_chunks(y, CHUNK, |start, y| {
            for (k, y) in y.iter_mut().enumerate() {
                f(start + k, self.neighbors(start + k), y);
            }
        });
    }

    /// `yᵢ ← f(i, (Lx)ᵢ, xᵢ, yᵢ)` for every row, in parallel.
    ///
    /// # Panics
    ///
    /// Panics unless `x` and `y` have one row for each row of the Laplacian.
    pub fn sweep<const N: usize, F>(&self, x: &[[f64; N]], y: &mut [[f64; N]], f: F)
    where
        F: Fn(usize, [f64; N], [f64; N], [f64; N]) -> [f64; N] + Sync,
    {
        assert_eq!((x.len(), y.len()), (self.len(), self.len()), "sizes of the operands");
        parallel::update(y, |i, y| {
            let (a, w) = (x[i], self.inverse[i]);
            let mut l = self.weighted_sum(i, x);
            for k in 0..N {
                l[k] = if self.is_uniform() { w * l[k] - a[k] } else { w * l[k] };
            }
            (f(i, l, a, y), ())
        })
    }

    /// `yᵢ ← f(i, −(Sx)ᵢ, xᵢ, yᵢ)` for every row, in parallel. Returns the sum of the second values
    /// that `f` returns.
    ///
    /// # Panics
    ///
    /// Panics unless `x` and `y` have one row for each row of the Laplacian.
    pub fn sweep_summing<const N: usize, S: Sum, F>(
        &self,
        x: &[[f64; N]],
        y: &mut [[f64; N]],
        f: F,
    ) -> S
    where
        F: Fn(usize, [f64; N], [f64; N], [f64; N]) -> ([f64; N], S) + Sync,
    {
        assert_eq!((x.len(), y.len()), (self.len(), self.len()), "sizes of the operands");
        parallel::update(y, |i, y| {
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

    /// `Σⱼ wⱼ (xⱼ − xᵢ)`; with unit weights `Σⱼ xⱼ`.
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

    /// `outᵢ ← point pᵢ + own xᵢ + l (Lx)ᵢ − outᵢ` for the given rows; `points` and `out` hold
    /// these rows, `x` begins with row `offset`.
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
}

fn check(offsets: &[u32], columns: &[u32]) {
    let (first, last) = (offsets.first().copied(), offsets.last().copied());
    assert_eq!(
        (first, last),
        (Some(0), Some(columns.len() as u32)),
        "the first and last offset of {} columns",
        columns.len()
    );
}

/// The reciprocal of each number.
fn reciprocals(x: &[f64]) -> Vec<f64> {
    map(x.len(), CHUNK, |i| 1.0 / x[i])
}
