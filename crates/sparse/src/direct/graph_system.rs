//! Systems with the Laplacian of a graph, solved more accurately than a stored diagonal allows.

use crate::direct::cholesky::{Cholesky, SymbolicCholesky};
use crate::direct::elimination::Elimination;
use crate::direct::ordering::Ordering;
use crate::double;
use crate::error::SparseError;
use crate::graph_laplacian::GraphLaplacian;
use crate::matrix::{Rows, SparseMatrix, principal_submatrix};
use crate::order::larger;

/// Systems whose weights are at most this many times D need no correction: rounding of the diagonal
/// is below 10⁻¹³ of D.
const LONG: f64 = 100.0;

/// The size of a correction, relative to the solution, at which the solution counts as converged:
/// the next correction would be smaller by the same factor again.
const CLOSE: f64 = 1e-9;

/// The relative size of the last correction above which half of the digits are lost.
const LOST: f64 = 1e-8;

/// The factor by which corrections must decrease.
const PROGRESS: f64 = 0.1;

/// The largest number of solves of one system: corrections fall from 1 to [`CLOSE`] by factors of
/// [`PROGRESS`].
const MAX_SOLVES: usize = 12;

/// The system `(D + S) x = b` of a diagonal `D ≥ 0` and a graph Laplacian S, with some entries of x
/// given; factorised once.
///
/// S is given by its off-diagonal entries, and its rows act on differences,
/// `(Sx)ᵢ = Σⱼ wᵢⱼ (xᵢ − xⱼ)`. The solution of the stored matrix is refined with residuals in this
/// form, so that it solves the system of the weights, not of a diagonal in which small weights and
/// D are lost to rounding. Where the stored matrix has lost too much for refinement, it is replaced
/// by elimination without subtractions, which is slower by an order of magnitude and, for positive
/// weights, accurate at any condition number.
///
/// A connected part without given values *floats*: it is determined by D alone, or only up to a
/// constant if D is zero there. It is solved about its weighted mean: the sum of b over the part
/// and the mean of x are both subtracted in proportion to the weights.
///
/// # Examples
///
/// ```
/// use fairing_sparse::{GraphSystem, SparseMatrix};
/// // A path of three vertices: 0 at the first, 1 at the last.
/// let values = vec![1.0, -1.0, -1.0, 2.0, -1.0, -1.0, 1.0];
/// let s = SparseMatrix::new((3, 3), vec![0, 2, 5, 7], vec![0, 1, 0, 1, 2, 1, 2], values);
/// let system = GraphSystem::new(&s, vec![0.0; 3], &[1.0; 3], &[true, false, true], None)?;
/// let x = system.solve(&[0.0; 3], &[0.0, 0.0, 1.0])?;
/// assert!((x[1] - 0.5).abs() < 1e-15 && x[2] == 1.0);
/// # Ok::<(), fairing_sparse::SparseError>(())
/// ```
#[derive(Debug, Clone)]
pub struct GraphSystem {
    /// S, zero in the rows of given values.
    laplacian: GraphLaplacian,
    /// D, plus the diagonal s of S at one grounded vertex of each floating part:
    /// `A' = D + S + s e eᵀ` is as well conditioned as S without its constants.
    added: Vec<f64>,
    /// The diagonal of A'.
    diagonal: Vec<f64>,
    /// The vertices whose values are not given, ascending.
    free: Vec<u32>,
    /// `None` if all values are given.
    factor: Option<Factor>,
    /// The part of each vertex.
    part: Vec<u32>,
    /// True for each part that floats.
    floating: Vec<bool>,
    /// The weight of each vertex as a fraction of that of its part.
    fraction: Vec<f64>,
    /// `v = A'⁻¹ s e` over its mean: the solution of the grounded system is off by a multiple of v.
    response: Vec<f64>,
    /// True if solutions are refined.
    refine: bool,
    /// ‖A'⁻¹ diag A'‖ in the largest norm.
    inverse: f64,
}

#[derive(Debug, Clone)]
enum Factor {
    Stored(Cholesky),
    Graph(Elimination),
}

impl GraphSystem {
    /// Factorises D + S. Only the off-diagonal entries of `s` are used; `added` is D, `weights`
    /// define the means of parts, and x is given in the rows for which `given` is true. `like` is
    /// an existing analysis that is reused if it fits the pattern of `s`.
    ///
    /// # Errors
    ///
    /// [`SparseError`]; [`IllConditioned`](SparseError::IllConditioned) if no digits would be
    /// correct.
    ///
    /// # Panics
    ///
    /// Panics if `s` is not square and stored by rows, or a length differs from the number of its
    /// rows.
    pub fn new(
        s: &SparseMatrix,
        added: Vec<f64>,
        weights: &[f64],
        given: &[bool],
        like: Option<&SymbolicCholesky>,
    ) -> Result<Self, SparseError> {
        let n = s.rows();
        assert_eq!((added.len(), weights.len()), (n, n), "sizes of the operands");
        let laplacian = GraphLaplacian::weighted(s, vec![1.0; n], given);
        let (part, floating) = parts(s, given);
        let totals = sums(&part, floating.len(), |v| weights[v]);
        let fraction = weights.iter().zip(&part).map(|(w, &p)| w / totals[p as usize]).collect();
        let free: Vec<u32> = (0..n as u32).filter(|&v| !given[v as usize]).collect();
        let diagonal: Vec<f64> =
            (0..n).map(|v| laplacian.stiffness_row(v).map(|(_, s)| -s).sum()).collect();
        let refine = free.iter().any(|&v| diagonal[v as usize] > LONG * added[v as usize]);
        let mut system = Self {
            laplacian,
            added,
            diagonal,
            free,
            factor: None,
            part,
            floating,
            fraction,
            response: vec![1.0; n],
            refine,
            inverse: 1.0,
        };
        if system.free.is_empty() {
            return Ok(system);
        }
        let ground = system.ground();
        for (added, ground) in system.added.iter_mut().zip(&ground) {
            *added += ground;
        }
        for (diagonal, added) in system.diagonal.iter_mut().zip(&system.added) {
            *diagonal += added;
        }
        system.factorise(s, like)?;
        system.respond(&ground)?;
        Ok(system)
    }

    /// The diagonal of S at one vertex of each floating part in which D is small compared with that
    /// diagonal, on average over the part: a few huge weights do not make a part nearly singular.
    fn ground(&self) -> Vec<f64> {
        let fractions = |v: usize| [self.added[v] / (self.diagonal[v] + self.added[v]), 1.0];
        let [small, count] =
            [0, 1].map(|k| sums(&self.part, self.floating.len(), |v| fractions(v)[k]));
        let mut due: Vec<bool> = self.floating.clone();
        let mut ground = vec![0.0; self.part.len()];
        for (v, ground) in ground.iter_mut().enumerate() {
            let p = self.part[v] as usize;
            if small[p] * LONG < count[p] && std::mem::replace(&mut due[p], false) {
                *ground = self.diagonal[v];
            }
        }
        ground
    }

    /// Computes the factor and the estimate of its inverse.
    fn factorise(
        &mut self,
        s: &SparseMatrix,
        like: Option<&SymbolicCholesky>,
    ) -> Result<(), SparseError> {
        let mut matrix = if self.free.len() == s.rows() {
            s.clone()
        } else {
            principal_submatrix(s, &self.free)
        };
        for (row, mut entries) in matrix.outer_iterator_mut().enumerate() {
            if let Some(own) = entries.get_mut(row) {
                *own = self.diagonal[self.free[row] as usize];
            }
        }
        let stored = match like.map(|like| (like, like.factorize(&matrix))) {
            None | Some((_, Err(SparseError::PatternChanged { .. }))) => {
                let symbolic = SymbolicCholesky::new(&matrix, Ordering::default())?;
                let stored = symbolic.factorize(&matrix);
                (symbolic, stored)
            }
            Some((like, stored)) => (like.clone(), stored),
        };
        let (symbolic, stored) = stored;
        let failed = match stored {
            Ok(factor) => {
                self.factor = Some(Factor::Stored(factor));
                match self.refine.then(|| self.probe()) {
                    None | Some(Ok(())) => return Ok(()),
                    Some(Err(failed)) => failed,
                }
            }
            Err(failed) if self.refine => failed,
            Err(failed) => return Err(failed),
        };
        // The off-diagonal entries are the weights between free vertices; weights to given vertices
        // are part of D.
        let rows = Rows::new(&matrix);
        let weights = |row: usize| {
            let (columns, values) = rows.row(row);
            let entries = columns.iter().zip(values).map(|(&j, &s)| (j, -s));
            entries.filter(move |&(j, _)| j as usize != row)
        };
        let held = self.free.iter().map(|&v| {
            let row = self.laplacian.stiffness_row(v as usize);
            let outside = row.filter(|&(j, _)| self.free.binary_search(&j).is_err());
            outside.fold(self.added[v as usize], |sum, (_, s)| sum - s)
        });
        let held = held.collect();
        let Ok(graph) = Elimination::new(symbolic.order().to_vec(), weights, held) else {
            return Err(failed);
        };
        self.factor = Some(Factor::Graph(graph));
        self.probe()
    }

    /// Solves `A' z = diag A'`: the largest entry of z is the norm of `A'⁻¹ diag A'` for positive
    /// weights, an estimate otherwise.
    fn probe(&mut self) -> Result<(), SparseError> {
        self.inverse = f64::INFINITY;
        let n = self.part.len();
        let mut right = vec![0.0; n];
        for &v in &self.free {
            right[v as usize] = self.diagonal[v as usize];
        }
        let lost = |size: f64| SparseError::IllConditioned { condition: 2.0 * size };
        let z = self.refined(&right, vec![[0.0]; n]).map_err(lost)?;
        self.inverse = z.iter().fold(1.0, |m, [z]| larger(m, z.abs()));
        Ok(())
    }

    /// Computes the response to the grounding of the parts.
    fn respond(&mut self, ground: &[f64]) -> Result<(), SparseError> {
        // The response is one where D is zero.
        let added = self.added.iter().zip(ground).any(|(added, ground)| added > ground);
        if !added || ground.iter().all(|&s| s == 0.0) {
            return Ok(());
        }
        let found = self.refined(ground, vec![[0.0]; ground.len()]).map_err(|_| self.lost())?;
        let means = self.means(|v| found[v][0]);
        for (v, [found]) in found.into_iter().enumerate() {
            let p = self.part[v] as usize;
            if self.floating[p] && means[p] > 0.0 {
                self.response[v] = found / means[p];
            }
        }
        Ok(())
    }

    /// The solution x for the right-hand side `right`; in rows with given values x is taken from
    /// `given`.
    ///
    /// # Errors
    ///
    /// [`SparseError::IllConditioned`] if fewer than half of the digits would be correct.
    ///
    /// # Panics
    ///
    /// Panics if a length differs from the number of rows.
    pub fn solve(&self, right: &[f64], given: &[f64]) -> Result<Vec<f64>, SparseError> {
        let n = self.part.len();
        assert_eq!((right.len(), given.len()), (n, n), "sizes of the operands");
        let excess = sums(&self.part, self.floating.len(), |v| right[v]);
        let mut x: Vec<[f64; 1]> = given.iter().map(|&x| [x]).collect();
        let mut right = right.to_vec();
        for &v in &self.free {
            let (v, p) = (v as usize, self.part[v as usize] as usize);
            x[v] = [0.0];
            if self.floating[p] {
                right[v] -= self.fraction[v] * excess[p];
            }
        }
        let x = self.refined(&right, x).map_err(|_| self.lost())?;
        let means = self.means(|v| x[v][0]);
        let shifted = |(v, [x]): (usize, &[f64; 1])| {
            let p = self.part[v] as usize;
            if self.floating[p] { x - self.response[v] * means[p] } else { *x }
        };
        Ok(x.iter().enumerate().map(shifted).collect())
    }

    fn lost(&self) -> SparseError {
        SparseError::IllConditioned { condition: self.condition() }
    }

    /// The refined solution of A' with the given values of `x`.
    ///
    /// # Errors
    ///
    /// The largest entry of a solution that has lost its digits.
    fn refined(&self, right: &[f64], mut x: Vec<[f64; 1]>) -> Result<Vec<[f64; 1]>, f64> {
        let Some(factor) = &self.factor else { return Ok(x) };
        let mut residual = vec![[0.0]; x.len()];
        let mut size = vec![0.0; self.floating.len()];
        let mut last = f64::INFINITY;
        for solved in 0..MAX_SOLVES {
            if solved == 1 && !self.refine {
                break;
            }
            self.laplacian.sweep_summing(&x, &mut residual, |i, s, x, _| {
                ([right[i] + s[0] - self.added[i] * x[0]], ())
            });
            if solved == 1 && self.is_close(&residual, &size) {
                break;
            }
            let mut d: Vec<f64> = self.free.iter().map(|&v| residual[v as usize][0]).collect();
            match factor {
                Factor::Stored(factor) => factor.solve_in_place(&mut d),
                Factor::Graph(factor) => factor.solve_in_place(&mut d),
            }
            let mut change = vec![0.0; size.len()];
            for (&v, d) in self.free.iter().zip(&d) {
                let (v, p) = (v as usize, self.part[v as usize] as usize);
                x[v][0] += d;
                change[p] = larger(change[p], d.abs());
                size[p] = larger(size[p], x[v][0].abs());
            }
            let ratio =
                |(change, size): (&f64, &f64)| if *change == 0.0 { 0.0 } else { change / size };
            let worst = change.iter().zip(&size).map(ratio).fold(0.0, larger);
            if solved > 0 && worst <= CLOSE {
                break;
            }
            let stalled = solved > 0 && worst > PROGRESS * last || solved + 1 == MAX_SOLVES;
            if !worst.is_finite() || stalled && worst > LOST {
                return Err(size.into_iter().fold(0.0, larger));
            }
            if stalled {
                break;
            }
            last = worst;
        }
        Ok(x)
    }

    /// Returns true if the correction for a residual is negligible:
    /// `|A'⁻¹ r| ≤ max |rᵢ/aᵢᵢ| ‖A'⁻¹ diag A'‖`.
    fn is_close(&self, residual: &[[f64; 1]], size: &[f64]) -> bool {
        self.free.iter().all(|&v| {
            let v = v as usize;
            let [r] = residual[v];
            r.abs() * self.inverse <= CLOSE * size[self.part[v] as usize] * self.diagonal[v]
        })
    }

    /// The weighted mean over each part, formed about one of its values, so that means of constants
    /// are exact.
    fn means(&self, value: impl Fn(usize) -> f64) -> Vec<f64> {
        let mut origin = vec![f64::NAN; self.floating.len()];
        for (v, &p) in self.part.iter().enumerate().rev() {
            origin[p as usize] = value(v);
        }
        let about = |v: usize| self.fraction[v] * (value(v) - origin[self.part[v] as usize]);
        let means = sums(&self.part, origin.len(), about);
        means.iter().zip(&origin).map(|(mean, origin)| origin + mean).collect()
    }

    /// The weighted mean over each floating part, and 0 for all other parts.
    ///
    /// # Panics
    ///
    /// Panics if there are fewer values than rows.
    pub fn floating_means(&self, values: &[f64]) -> Vec<f64> {
        let mut means = self.means(|v| values[v]);
        for (mean, floating) in means.iter_mut().zip(&self.floating) {
            *mean = if *floating { *mean } else { 0.0 };
        }
        means
    }

    /// S, zero in the rows of given values.
    pub fn laplacian(&self) -> &GraphLaplacian {
        &self.laplacian
    }

    /// The connected part of the pattern of S that each row belongs to.
    pub fn parts(&self) -> &[u32] {
        &self.part
    }

    /// An estimate of the condition of the matrix scaled to a unit diagonal, in the maximum norm,
    /// with one vertex of each floating part grounded: twice the norm of `A⁻¹ diag A`.
    ///
    /// It bounds the effect of perturbing the entries. Solutions are more accurate, because they
    /// are refined with residuals of the weights.
    pub fn condition(&self) -> f64 {
        2.0 * self.inverse
    }
}

/// The part of each row, and for each part true if it has no given value.
fn parts(s: &SparseMatrix, given: &[bool]) -> (Vec<u32>, Vec<bool>) {
    const NONE: u32 = u32::MAX;
    let (mut part, mut floating) = (vec![NONE; s.rows()], Vec::new());
    let mut open = vec![];
    for first in 0..s.rows() {
        if part[first] != NONE {
            continue;
        }
        let own = floating.len() as u32;
        floating.push(true);
        part[first] = own;
        open.push(first);
        while let Some(row) = open.pop() {
            floating[own as usize] &= !given[row];
            for &column in s.outer_view(row).iter().flat_map(|row| row.indices()) {
                let slot = &mut part[column as usize];
                if *slot == NONE {
                    *slot = own;
                    open.push(column as usize);
                }
            }
        }
    }
    (part, floating)
}

/// The sum over each part in double-double arithmetic, so that conserved sums do not drift over
/// many steps.
fn sums(part: &[u32], parts: usize, value: impl Fn(usize) -> f64) -> Vec<f64> {
    let mut sums = vec![(0.0, 0.0); parts];
    for (v, &p) in part.iter().enumerate() {
        let slot = &mut sums[p as usize];
        *slot = double::sum(*slot, (value(v), 0.0));
    }
    sums.iter().map(|(high, low)| high + low).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::matrix::from_triplets;

    /// The stiffness of weighted edges.
    fn laplacian(n: usize, edges: &[(usize, usize, f64)]) -> SparseMatrix {
        let entries = |&(i, j, w): &(usize, usize, f64)| {
            let (i, j) = (i as u32, j as u32);
            [(i, i, w), (j, j, w), (i, j, -w), (j, i, -w)]
        };
        let entries: Vec<(u32, u32, f64)> = edges.iter().flat_map(entries).collect();
        from_triplets((n, n), &entries).unwrap()
    }

    /// A ladder of stiff rungs and weak rails with 0 at its foot and 1 at its head has a linear
    /// solution, whatever the ratio of stiffnesses.
    #[test]
    fn ratios_cost_no_digits() {
        for rail in [1.0, 1e-6, 1e-10, 1e-14, 1e-20, 1e-100] {
            let n = 500;
            let mut edges: Vec<_> = (0..n).map(|i| (2 * i, 2 * i + 1, 1.0)).collect();
            edges.extend((0..2 * n - 2).map(|v| (v, v + 2, rail)));
            let mut given = vec![false; 2 * n];
            given[0] = true;
            given[2 * n - 1] = true;
            let s = laplacian(2 * n, &edges);
            let system = GraphSystem::new(&s, vec![0.0; 2 * n], &vec![1.0; 2 * n], &given, None);
            let mut x = vec![0.0; 2 * n];
            x[2 * n - 1] = 1.0;
            let x = system.unwrap().solve(&vec![0.0; 2 * n], &x).unwrap();
            for (v, x) in x.iter().enumerate().filter(|_| rail < 1e-5) {
                // The rungs at the ends carry the current of one rail.
                let exact = (v / 2) as f64 / (n - 1) as f64;
                assert!((x - exact).abs() < 1e-5, "{rail:e} {v}: {x} {exact}");
            }
            // Symmetry of the ladder.
            for v in 0..2 * n {
                assert!((x[v] + x[2 * n - 1 - v] - 1.0).abs() < 1e-9, "{rail:e} {v}");
            }
        }
    }

    /// The negative weight of an edge cancels the conductance of a detour of two edges up to
    /// rounding.
    #[test]
    fn lost_digits_are_an_error() {
        let edges = [(0, 1, 0.3), (1, 2, 0.7), (0, 2, -0.21 * (1.0 - 4e-16)), (2, 3, 1.0)];
        let s = laplacian(4, &edges);
        let given = [true, false, false, false];
        let system = GraphSystem::new(&s, vec![0.0; 4], &[1.0; 4], &given, None);
        let found = system.and_then(|system| system.solve(&[0.0, 0.0, 0.0, 1.0], &[0.0; 4]));
        assert!(found.is_err(), "{found:?}");
    }

    /// Of two triangles, one has no given value: its mean is zero, and the sum of b is subtracted
    /// in proportion to the weights.
    #[test]
    fn parts_float_about_their_means() {
        let triangle = |v: usize| [(v, v + 1, 1.0), (v + 1, v + 2, 2.0), (v, v + 2, 3.0)];
        let s = laplacian(6, &[triangle(0), triangle(3)].concat());
        let given = [true, false, false, false, false, false];
        let weights = [1.0, 1.0, 1.0, 1.0, 2.0, 1.0];
        for added in [0.0, 1e-3, 10.0] {
            let added = [0.0, 0.0, 0.0, added, 2.0 * added, added];
            let system = GraphSystem::new(&s, added.to_vec(), &weights, &given, None).unwrap();
            assert_eq!(system.parts(), [0, 0, 0, 1, 1, 1]);
            assert_eq!(system.floating_means(&[9.0, 9.0, 9.0, 1.0, 2.0, 3.0]), [0.0, 2.0]);
            let b = [0.0, 1.0, 2.0, 4.0, 0.0, 0.0];
            let x = system.solve(&b, &[5.0, 0.0, 0.0, 0.0, 0.0, 0.0]).unwrap();
            assert_eq!(x[0], 5.0);
            assert!((x[3] + 2.0 * x[4] + x[5]).abs() < 1e-15);
            let image = crate::multiply(&s, &x);
            for v in [1, 2, 3, 4, 5] {
                let balance = if v < 3 { 0.0 } else { weights[v] };
                let found = image[v] + added[v] * x[v];
                // A few roundings of numbers below ten.
                assert!((found - (b[v] - balance)).abs() < 1e-13, "{v}: {found}");
            }
        }
    }
}
