//! Implicit steps by Cholesky factorisation.

use fairing_sparse::{
    Cholesky, GraphLaplacian, Ordering, SparseError, SparseMatrix, SymbolicCholesky, Workload,
    larger,
};

use crate::engine::conjugate::{ImplicitSolver, Solved, not_converged};
use crate::engine::constraints::Freedom;
use crate::engine::error::FlowFailure;
use crate::engine::parts::{Gauge, Parts};

type Point = [f64; 3];

/// The largest number of solves with iterative refinement. One is the rule, two are rare.
const MAX_SOLVES: usize = 6;

/// The largest change of a step relative to the positions: the initial error of conjugate
/// gradients.
const CHANGE: f64 = 0.01;

/// The condition beyond which systems are always factored: the smallest eigenvalues, of parts that
/// move nearly as a whole, are then lost to rounding in conjugate gradients.
const ILL_CONDITIONED: f64 = 1e6;

/// Steps longer than this many times the reciprocal of the largest eigenvalue are solved with one
/// vertex of each part grounded.
const LONG: f64 = 100.0;

/// Returns true if a run of implicit steps should be factored: if factorisation is faster than
/// conjugate gradients by the measured rule of [`Workload`], or if the system is too
/// ill-conditioned to iterate.
///
/// The condition is `κ = 1 + t ω` for the largest eigenvalue ω of `−L`, about 7.4/h² with
/// cotangents on even meshes. The factor of a constant operator serves all steps; an updated
/// operator needs one factor for each. Short steps are therefore iterated and long ones factored,
/// sooner for a constant operator.
pub(crate) fn pays(
    laplacian: &GraphLaplacian,
    step: f64,
    bound: f64,
    tolerance: f64,
    solves: usize,
) -> bool {
    let work = Workload {
        rows: laplacian.len(),
        entries: laplacian.entries(),
        condition: 1.0 + step * bound,
        tolerance: (tolerance / CHANGE).min(1.0),
        solves,
    };
    work.condition > ILL_CONDITIONED || work.prefers_factorisation()
}

/// The factored systems of a run, without fixed vertices but with soft constraints.
///
/// For long steps `A = M(1 + w) + tS` is nearly singular: a translation of a part without fixed
/// vertices has almost no energy, and rounding of t S would determine it. But the translation is
/// known, because 1ᵀ A = 1ᵀ M(1 + w) fixes the weighted mean of a part. The system is therefore
/// solved about this mean, with a right-hand side whose sum over each part is zero and with one
/// vertex g of each part *grounded*: `A' = A + s e eᵀ` at g is as well conditioned as t S without
/// its constants. With `u = A'⁻¹ b` and the response `v = A'⁻¹ s e`, the solution of `A x = b` is
/// `u + c v`, where c makes its weighted mean vanish.
#[derive(Default)]
pub(crate) struct Direct {
    symbolic: Option<SymbolicCholesky>,
    factor: Option<Grounded>,
    /// The number of numeric factorisations so far.
    pub(crate) factorisations: usize,
}

/// The factor of a grounded system.
struct Grounded {
    factor: Cholesky,
    /// The response v of all parts; empty if none is grounded.
    response: Vec<f64>,
    /// The sums of `M(1 + w)` and of `M(1 + w) v` over each part.
    weight: Vec<[f64; 2]>,
}

impl Direct {
    /// Discards the factor after a change of the operator; the symbolic factorisation is kept.
    pub(crate) fn forget_factor(&mut self) {
        self.factor = None;
    }

    /// Computes the displacement of one step, defined as in [`ImplicitSolver::solve`]; no vertex
    /// may slide.
    pub(crate) fn solve(
        &mut self,
        solver: ImplicitSolver<'_>,
        x: &[Point],
        freedom: &Freedom,
        displacement: &mut [Point],
    ) -> Result<Solved, FlowFailure> {
        let grounded = match self.factor.take() {
            Some(grounded) => grounded,
            None => self.ground(solver, freedom)?,
        };
        let grounded = &*self.factor.insert(grounded);
        let (laplacian, parts, t) = (solver.laplacian, solver.parts, solver.step);
        let (mass, centres) =
            (laplacian.mass(), solver.parts.centres(laplacian.mass(), x, freedom));
        // The unknown is u = x' − base, with the centre as base for parts that move as a whole, x
        // for all others.
        let base = |i: usize| if parts.is_free(i) { centres[parts.part(i)] } else { x[i] };
        let mut b = vec![[0.0; 3]; x.len()];
        let about = |i: usize, k: usize| x[i][k] - centres[parts.part(i)][k];
        let centred: Vec<Point> = (0..x.len()).map(|i| [0, 1, 2].map(|k| about(i, k))).collect();
        laplacian.sweep_summing(&centred, &mut b, |i, s, _, _| {
            let (w, target) = freedom.pull(i);
            let (base, moves) = (base(i), !freedom.fixed[i]);
            let flow = if parts.is_free(i) { [0.0; 3] } else { s };
            let b = [0, 1, 2].map(|k| {
                let pull = if w > 0.0 { w * (target[k] - base[k]) } else { 0.0 };
                if moves { mass[i] * (x[i][k] - base[k] + pull) + t * flow[k] } else { 0.0 }
            });
            (b, ())
        });
        let mut sides = solver.sides(x, freedom, &centres);
        for (side, own) in sides.iter_mut().zip(parts.sums(|_, i| b[i].map(|b| b * b))) {
            for (side, own) in side.iter_mut().zip(own) {
                *side = larger(*side, own);
            }
        }
        let mut u = vec![[0.0; 3]; x.len()];
        grounded.balance(parts, mass, freedom, &mut b);
        let mut r = b.clone();
        let mut iterations = 0;
        let reported = loop {
            // The terms of a residual, and so their rounding errors, are of the size of u, not of
            // x.
            let reach = parts.largest(|_, i| u[i].map(f64::abs));
            let gauge = Gauge::new(parts, &sides, &reach, solver.tolerance, false);
            let residual = gauge.measured(&r);
            if residual <= solver.tolerance && iterations > 0 {
                break gauge.reported(&r);
            }
            if iterations == MAX_SOLVES || !residual.is_finite() {
                return Err(not_converged(gauge.reported(&r), iterations, &r));
            }
            grounded.correct(parts, mass, freedom, &mut r, &mut u);
            iterations += 1;
            laplacian.sweep_summing(&u, &mut r, |i, s, u, _| {
                let q = mass[i] * (1.0 + freedom.pull(i).0);
                let residual = if freedom.fixed[i] {
                    [0.0; 3]
                } else {
                    [0, 1, 2].map(|k| b[i][k] - (q * u[k] - t * s[k]))
                };
                (residual, ())
            });
            grounded.balance(parts, mass, freedom, &mut r);
        };
        for (i, (d, u)) in displacement.iter_mut().zip(&u).enumerate() {
            let base = base(i);
            *d = [0, 1, 2].map(|k| (base[k] - x[i][k]) + u[k]);
        }
        Ok(Solved { iterations, residual: reported })
    }

    /// Factors the system of a step, grounded if the step is long.
    fn ground(
        &mut self,
        solver: ImplicitSolver<'_>,
        freedom: &Freedom,
    ) -> Result<Grounded, FlowFailure> {
        let (laplacian, parts, t) = (solver.laplacian, solver.parts, solver.step);
        let mut ground = vec![0.0; laplacian.len()];
        if t * laplacian.gershgorin() > LONG {
            for v in parts.representatives().filter(|&v| !laplacian.is_fixed(v)) {
                ground[v] = t * laplacian.diagonal()[v];
            }
        }
        let factor = self.factorise(&system(laplacian, t, freedom, &ground))?;
        let mut response = Vec::new();
        if ground.iter().any(|&s| s > 0.0) {
            response = factor.solve(&ground);
        }
        let weight = parts.sums(|_, i| {
            let q = laplacian.mass()[i] * (1.0 + freedom.pull(i).0);
            [q, q * response.get(i).copied().unwrap_or(0.0)]
        });
        Ok(Grounded { factor, response, weight })
    }

    fn factorise(&mut self, matrix: &SparseMatrix) -> Result<Cholesky, FlowFailure> {
        self.factorisations += 1;
        // The pattern changes if intrinsic edges flip.
        if let Some(symbolic) = &self.symbolic {
            match symbolic.factorize(matrix) {
                Err(SparseError::PatternChanged { .. }) => {}
                other => return other.map_err(FlowFailure::NotFactored),
            }
        }
        let symbolic =
            SymbolicCholesky::new(matrix, Ordering::default()).map_err(FlowFailure::NotFactored)?;
        let factor = symbolic.factorize(matrix).map_err(FlowFailure::NotFactored)?;
        self.symbolic = Some(symbolic);
        Ok(factor)
    }
}

impl Grounded {
    /// Subtracts the sum of a residual over each part that moves as a whole. The sum is due to
    /// rounding, of the centre and of the terms of t S.
    fn balance(&self, parts: &Parts, mass: &[f64], freedom: &Freedom, r: &mut [Point]) {
        let sums = parts.sums(|_, i| r[i]);
        for (i, r) in r.iter_mut().enumerate().filter(|(i, _)| parts.is_free(*i)) {
            let part = parts.part(i);
            let fraction = mass[i] * (1.0 + freedom.pull(i).0) / self.weight[part][0];
            *r = [0, 1, 2].map(|k| r[k] - fraction * sums[part][k]);
        }
    }

    /// `u ← u + A⁻¹ r` for a balanced residual; overwrites `r`.
    fn correct(
        &self,
        parts: &Parts,
        mass: &[f64],
        freedom: &Freedom,
        r: &mut [Point],
        u: &mut [Point],
    ) {
        let weigh = |i: usize| mass[i] * (1.0 + freedom.pull(i).0);
        self.factor.solve_points_in_place(r);
        let means = parts.sums(|_, i| [0, 1, 2].map(|k| weigh(i) * (u[i][k] + r[i][k])));
        for (i, (u, r)) in u.iter_mut().zip(r).enumerate() {
            let (part, mut shift) = (parts.part(i), [0.0; 3]);
            if parts.is_free(i) {
                // Parts that are not grounded are translated.
                let (v, weight) = match self.weight[part] {
                    [_, weight] if weight > 0.0 => (self.response[i], weight),
                    [weight, _] => (1.0, weight),
                };
                shift = means[part].map(|m| v * (m / weight));
            }
            *u = [0, 1, 2].map(|k| u[k] + (r[k] - shift[k]));
        }
    }
}

/// The matrix `M(1 + w) + t S` plus the diagonal `ground`, restricted to the vertices that move,
/// with ones on the diagonal for fixed vertices.
fn system(
    laplacian: &GraphLaplacian,
    step: f64,
    freedom: &Freedom,
    ground: &[f64],
) -> SparseMatrix {
    let n = laplacian.len();
    let (mut starts, mut columns, mut values) = (vec![0u32], Vec::new(), Vec::new());
    let mut row: Vec<(u32, f64)> = Vec::new();
    for i in 0..n {
        row.clear();
        let own = if freedom.fixed[i] {
            1.0
        } else {
            let neighbors = laplacian.stiffness_row(i);
            row.extend(neighbors.filter(|&(j, _)| !freedom.fixed[j as usize]));
            let s = if laplacian.is_fixed(i) { 0.0 } else { laplacian.diagonal()[i] };
            laplacian.mass()[i] * (1.0 + freedom.pull(i).0) + step * s + ground[i]
        };
        for (_, s) in &mut row {
            *s *= step;
        }
        row.push((i as u32, own));
        row.sort_unstable_by_key(|&(j, _)| j);
        columns.extend(row.iter().map(|e| e.0));
        values.extend(row.iter().map(|e| e.1));
        starts.push(columns.len() as u32);
    }
    SparseMatrix::new((n, n), starts, columns, values)
}

#[cfg(test)]
mod tests {

    /// Ten steps of a constant operator are factored if they are long and iterated if they are
    /// short.
    #[test]
    fn conditioning_decides() {
        let mesh = fairing_shapes::icosphere(5);
        let fixed = vec![false; mesh.vertex_count()];
        let h2 = mesh.mean_edge_length().powi(2);
        let diffusion = crate::Diffusion::cotangent(1.0).chosen(&mesh).unwrap().0;
        let laplacian = crate::engine::assemble::assemble(&mesh, diffusion, &fixed).unwrap();
        let bound = laplacian.spectral_bound();
        let pays = |lambda: f64, n| super::pays(&laplacian, lambda * h2, bound, 1e-8, n);
        assert!(!pays(1.0, 1) && !pays(0.1, 10));
        assert!(pays(100.0, 10) && pays(1e4, 1));
    }
}
