//! A factorised system, solved with iterative refinement.

use fairing_watch::parallel;

use crate::conjugate_gradients::worst_row;
use crate::direct::{Cholesky, Elimination, Ordering, SymbolicCholesky};
use crate::error::SparseError;
use crate::graph_system::equations::{Centred, Equations, RightSide};
use crate::graph_system::gauge::{Columns, Sides, measure};
use crate::order::larger;
use crate::parallel::{CHUNK, update};

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

/// The largest number of solves to a residual. One is the rule, two are rare.
const MAX_TO_RESIDUAL: usize = 6;

/// Rows above which a second order is worth the time to find it: on seven meshes of two to twenty
/// thousand vertices the least fill was at most 2 % below that of minimum degree.
const LARGE: usize = 20_000;

/// The factor of `A' = D + tS + s e eᵀ`, with the diagonal s of tS added at one *grounded* row of
/// each floating part.
///
/// For large t a floating part is nearly singular: a constant has almost no energy, and rounding of
/// tS would determine it. A' is as well conditioned as tS without its constants. The solution of
/// the system is that of A' plus a multiple of the response `v = A'⁻¹ s e`, which makes its
/// weighted mean zero.
#[derive(Debug, Clone)]
pub(super) struct Factored {
    factor: Factor,
    /// Row and value s of each part; the value is 0 where nothing is grounded.
    ground: Vec<(u32, f64)>,
    /// `v` over its mean.
    response: Option<Vec<f64>>,
    /// True if all digits are asked for and rounding of the diagonal costs some.
    refine: bool,
    /// ‖A'⁻¹ diag A'‖ in the largest norm, if refined.
    inverse: f64,
}

#[derive(Debug, Clone)]
enum Factor {
    Stored(Cholesky),
    Graph(Elimination),
    /// All values are given.
    Nothing,
}

/// The accuracy of a solution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Goal {
    /// Nearly all digits.
    Digits,
    /// A residual relative to the right-hand side.
    Residual(f64),
}

impl Factored {
    /// Factorises a system. `like` is an existing analysis, used if it fits the pattern.
    pub(super) fn new(
        equations: &Equations,
        goal: Goal,
        like: Option<&SymbolicCholesky>,
    ) -> Result<Self, SparseError> {
        let free = || (0..equations.len()).filter(|&i| !equations.parts.is_given(i));
        let long = |i: usize| equations.stiffness(i) > LONG * equations.added[i];
        let refine = goal == Goal::Digits && free().any(long);
        let mut new = Self {
            factor: Factor::Nothing,
            ground: ground(equations),
            response: None,
            refine,
            inverse: 1.0,
        };
        if free().next().is_some() {
            new.factorise(equations, like)?;
            new.respond(equations)?;
        }
        Ok(new)
    }

    /// The analysis of the pattern.
    pub(super) fn symbolic(&self) -> Option<SymbolicCholesky> {
        match &self.factor {
            Factor::Stored(factor) => Some(factor.symbolic()),
            _ => None,
        }
    }

    /// The estimated condition of A', scaled to a unit diagonal.
    pub(super) fn condition(&self) -> f64 {
        2.0 * self.inverse
    }

    /// The term s of row `i`.
    #[inline(always)]
    fn grounded(&self, equations: &Equations, i: usize) -> f64 {
        let (row, s) = self.ground[equations.parts.part(i)];
        if row as usize == i { s } else { 0.0 }
    }

    /// Computes the factor and, if solutions get all digits, the estimate of its inverse.
    fn factorise(
        &mut self,
        equations: &Equations,
        like: Option<&SymbolicCholesky>,
    ) -> Result<(), SparseError> {
        let matrix = equations.matrix(|i| self.grounded(equations, i));
        let (symbolic, stored) = match like.map(|like| (like, like.factorize(&matrix))) {
            None | Some((_, Err(SparseError::PatternChanged { .. }))) => {
                let is_large = matrix.rows() > LARGE;
                let order = if is_large { Ordering::LeastFill } else { Ordering::MinimumDegree };
                let symbolic = SymbolicCholesky::new(&matrix, order)?;
                let stored = symbolic.factorize(&matrix);
                (symbolic, stored)
            }
            Some((like, stored)) => (like.clone(), stored),
        };
        let failed = match stored {
            Ok(factor) => {
                self.factor = Factor::Stored(factor);
                match self.refine.then(|| self.probe(equations)) {
                    None | Some(Ok(())) => return Ok(()),
                    Some(Err(failed)) => failed,
                }
            }
            Err(failed) => failed,
        };
        if !self.refine {
            return Err(failed);
        }
        // Weights to given neighbours are part of D.
        let inside = move |i: usize| {
            let row = equations.laplacian.stiffness_row(i);
            let free = move |&(j, _): &(u32, f64)| !equations.parts.is_given(j as usize);
            row.filter(free).map(move |(j, s)| (j, -equations.step * s))
        };
        let held = |i: usize| {
            if equations.parts.is_given(i) {
                return 1.0;
            }
            let row = equations.laplacian.stiffness_row(i);
            let outside = row.filter(|&(j, _)| equations.parts.is_given(j as usize));
            let own = equations.added[i] + self.grounded(equations, i);
            outside.fold(own, |sum, (_, s)| sum - equations.step * s)
        };
        let held = (0..equations.len()).map(held).collect();
        let Ok(graph) = Elimination::new(symbolic.order().to_vec(), inside, held) else {
            return Err(failed);
        };
        self.factor = Factor::Graph(graph);
        self.probe(equations)
    }

    /// Solves `A' z = diag A'`: the largest entry of z is the norm of `A'⁻¹ diag A'` for positive
    /// weights, an estimate otherwise.
    fn probe(&mut self, equations: &Equations) -> Result<(), SparseError> {
        self.inverse = f64::INFINITY;
        let right = |i: usize| [self.diagonal(equations, i)];
        let z = self.refined(equations, &right)?;
        self.inverse = z.iter().fold(1.0, |m, [z]| larger(m, z.abs()));
        Ok(())
    }

    /// The diagonal of A'; 0 in rows of given values.
    fn diagonal(&self, equations: &Equations, i: usize) -> f64 {
        if equations.parts.is_given(i) {
            return 0.0;
        }
        equations.added[i] + equations.stiffness(i) + self.grounded(equations, i)
    }

    /// Computes the response to the grounded rows.
    fn respond(&mut self, equations: &Equations) -> Result<(), SparseError> {
        // The response is one where D is zero.
        let is_one = equations.added.iter().all(|&d| d == 0.0);
        if is_one || self.ground.iter().all(|&(_, s)| s == 0.0) {
            return Ok(());
        }
        let right = |i: usize| [self.grounded(equations, i)];
        let mut found = self.refined(equations, &right)?;
        let means = equations.means(|i| found[i]);
        for (i, [found]) in found.iter_mut().enumerate() {
            let [mean] = means[equations.parts.part(i)];
            *found = if mean > 0.0 { *found / mean } else { 1.0 };
        }
        self.response = Some(found.into_iter().map(|[v]| v).collect());
        Ok(())
    }

    /// The solution y about the origins of the parts, zero in the rows of given values, and its
    /// residual; 0 if all digits are asked for.
    pub(super) fn solve<const N: usize>(
        &self,
        centred: &Centred<'_, N>,
        goal: Goal,
    ) -> Result<(Vec<[f64; N]>, f64), SparseError> {
        match goal {
            Goal::Digits => {
                let mut y = self.refined(centred.equations, &|i| centred.right(i))?;
                self.centre(centred.equations, &mut y);
                Ok((y, 0.0))
            }
            Goal::Residual(tolerance) => self.solve_to(centred, tolerance),
        }
    }

    /// The solution of a residual within the tolerance.
    fn solve_to<const N: usize>(
        &self,
        centred: &Centred<'_, N>,
        tolerance: f64,
    ) -> Result<(Vec<[f64; N]>, f64), SparseError> {
        let (equations, right) = (centred.equations, |i: usize| centred.right(i));
        let parts = &equations.parts;
        let sides = Sides::new(centred);
        let mut r = parallel::map(equations.len(), CHUNK, right);
        let mut y = vec![[0.0; N]; r.len()];
        let mut solved = 0;
        loop {
            self.apply_inverse(&mut r);
            update(&mut y, |i, y| (std::array::from_fn(|k| y[k] + r[i][k]), ()));
            self.centre(equations, &mut y);
            residual(equations, &right, &|_| 0.0, &y, &mut r);
            solved += 1;
            // The terms of a residual, and so their rounding errors, are of the size of y.
            let reach = parts.largest(|_, i| y[i].map(f64::abs));
            let scales = sides.scales(&reach, tolerance, Columns::Independent);
            let residual = measure(parts, &scales, &r);
            if residual <= tolerance {
                return Ok((y, residual));
            }
            if solved == MAX_TO_RESIDUAL || !residual.is_finite() {
                let row = worst_row(&r);
                return Err(SparseError::NotConverged { residual, iterations: solved, row });
            }
        }
    }

    /// `r` ← A'⁻¹ r.
    fn apply_inverse<const N: usize>(&self, r: &mut [[f64; N]]) {
        match &self.factor {
            Factor::Stored(factor) => factor.solve_columns(r),
            Factor::Graph(factor) => factor.solve_in_place(r),
            Factor::Nothing => {}
        }
    }

    /// Adds the multiple of the response that makes the mean of each floating part zero.
    fn centre<const N: usize>(&self, equations: &Equations, y: &mut [[f64; N]]) {
        let means = equations.means(|i| y[i]);
        update(y, |i, mut y| {
            let part = equations.parts.part(i);
            if equations.parts.floats(part) {
                let v = self.response.as_ref().map_or(1.0, |response| response[i]);
                for k in 0..N {
                    y[k] -= v * means[part][k];
                }
            }
            (y, ())
        });
    }

    /// The solution of A', refined to all digits.
    fn refined<const N: usize>(
        &self,
        equations: &Equations,
        right: RightSide<'_, N>,
    ) -> Result<Vec<[f64; N]>, SparseError> {
        let (n, count) = (equations.len(), equations.parts.count());
        let mut r: Vec<[f64; N]> = (0..n).map(right).collect();
        let mut x = vec![[0.0; N]; n];
        let mut size = vec![[0.0; N]; count];
        let mut last = f64::INFINITY;
        for solved in 0..MAX_SOLVES {
            if solved == 1 && !self.refine {
                break;
            }
            if solved > 0 {
                residual(equations, right, &|i| self.grounded(equations, i), &x, &mut r);
            }
            if solved == 1 && self.is_close(equations, &r, &size) {
                break;
            }
            self.apply_inverse(&mut r);
            let mut change = vec![[0.0; N]; count];
            for (i, (x, d)) in x.iter_mut().zip(&r).enumerate() {
                let part = equations.parts.part(i);
                for k in 0..N {
                    x[k] += d[k];
                    change[part][k] = larger(change[part][k], d[k].abs());
                    size[part][k] = larger(size[part][k], x[k].abs());
                }
            }
            let ratio =
                |(change, size): (&f64, &f64)| if *change == 0.0 { 0.0 } else { change / size };
            let sizes = size.as_flattened();
            let worst = change.as_flattened().iter().zip(sizes).map(ratio).fold(0.0, larger);
            if solved > 0 && worst <= CLOSE {
                break;
            }
            let stalled = solved > 0 && worst > PROGRESS * last || solved + 1 == MAX_SOLVES;
            if !worst.is_finite() || stalled && worst > LOST {
                let largest = sizes.iter().copied().fold(0.0, larger);
                let inverse = if self.inverse.is_finite() { self.inverse } else { largest };
                return Err(SparseError::IllConditioned { condition: 2.0 * inverse });
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
    fn is_close<const N: usize>(
        &self,
        equations: &Equations,
        r: &[[f64; N]],
        size: &[[f64; N]],
    ) -> bool {
        r.iter().enumerate().all(|(i, r)| {
            let most = CLOSE * self.diagonal(equations, i);
            let size = &size[equations.parts.part(i)];
            (0..N).all(|k| r[k].abs() * self.inverse <= most * size[k])
        })
    }
}

/// The diagonal of tS at one row of each floating part in which D is small compared with that
/// diagonal, on average over the part: a few huge weights do not make a part nearly singular.
fn ground(equations: &Equations) -> Vec<(u32, f64)> {
    let parts = &equations.parts;
    let sums = parts.sums(|_, i| {
        let d = equations.added[i];
        [d / (equations.stiffness(i) + d), 1.0]
    });
    let mut ground = vec![(u32::MAX, 0.0); parts.count()];
    for i in 0..equations.len() {
        let part = parts.part(i);
        let [small, count] = sums[part];
        if parts.floats(part) && small * LONG < count && ground[part].0 == u32::MAX {
            ground[part] = (i as u32, equations.stiffness(i));
        }
    }
    ground
}

/// `b − (D + ground + tS) x`, zero in the rows of given values.
fn residual<const N: usize>(
    equations: &Equations,
    right: RightSide<'_, N>,
    ground: &(dyn Fn(usize) -> f64 + Sync),
    x: &[[f64; N]],
    r: &mut [[f64; N]],
) {
    equations.laplacian.sweep_summing(x, r, |i, s, x, _| {
        let (mut r, d) = (right(i), equations.added[i] + ground(i));
        for k in 0..N {
            r[k] -= d * x[k] - equations.step * s[k];
        }
        (r, ())
    });
}
