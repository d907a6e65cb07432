//! Cholesky factorisation for the steps of an implicit flow.

use fairing_sparse::{
    Cholesky, CholeskyError, Method, Ordering, SparseMatrix, SymbolicCholesky, Workload,
};

use crate::conjugate::{ImplicitSolver, Solved, not_converged, relative};
use crate::constraints::Freedom;
use crate::error::FlowFailure;
use crate::laplacian::Laplacian;
use crate::spectrum::upper_bound;

type Point = [f64; 3];

/// Solves with refinement: the residual of a solution is solved for again. One is the rule, two are rare. Beyond a
/// condition of one over the tolerance the residual ends at its own rounding, which the report then tells.
const MOST_SOLVES: usize = 4;

/// What a step changes at most, as a share of positions: conjugate gradients begin that close to the solution.
const CHANGE: f64 = 0.01;

/// Whether factorisation is faster than conjugate gradients for a run of implicit steps, by the measured rule of
/// [`fairing_sparse::Method`].
///
/// The condition is `κ = 1 + t ω` for the largest eigenvalue ω of `−L`, about 7.4/h² with cotangents on even meshes. A
/// factor of a frozen operator serves all steps; an operator taken anew needs one for each. So λ decides: short steps
/// are iterated, long ones factored, and those of frozen operators sooner.
pub(crate) fn pays(laplacian: &Laplacian, step: f64, tolerance: f64, solves: usize) -> bool {
    let work = Workload {
        rows: laplacian.len(),
        entries: laplacian.entries(),
        factor_entries: None,
        condition: 1.0 + step * upper_bound(laplacian),
        tolerance: (tolerance / CHANGE).min(1.0),
        solves,
    };
    Method::choose(&work) == Method::Direct
}

/// The systems of a run, factored. Held vertices are taken out; soft constraints are within.
#[derive(Default)]
pub(crate) struct Direct {
    symbolic: Option<SymbolicCholesky>,
    factor: Option<Cholesky>,
    /// Numeric factorisations so far.
    pub(crate) factorisations: usize,
}

impl Direct {
    /// Forgets the factor, because the operator has changed; its pattern is kept.
    pub(crate) fn renew(&mut self) {
        self.factor = None;
    }

    /// The displacement of one step, as [`ImplicitSolver::solve`] defines it. Vertices that slide cannot be had.
    pub(crate) fn solve(
        &mut self,
        solver: ImplicitSolver<'_>,
        x: &[Point],
        freedom: &Freedom,
        displacement: &mut [Point],
    ) -> Result<Solved, FlowFailure> {
        let factor = match self.factor.take() {
            Some(factor) => factor,
            None => self.factorise(&system(solver.laplacian, solver.step, freedom))?,
        };
        let factor = self.factor.insert(factor);
        let scale = solver.right_hand_side_norm(x, freedom);
        displacement.fill([0.0; 3]);
        let mut r = vec![[0.0; 3]; x.len()];
        // A residual is a difference of terms up to t ω times as large as M x: it cannot be smaller than their rounding.
        let rounding = 8.0 * f64::EPSILON * solver.step * solver.laplacian.gershgorin();
        let mut iterations = 0;
        loop {
            let squares = residual(solver, x, freedom, displacement, &mut r);
            let residual = relative(&squares, scale);
            if residual <= solver.tolerance.max(if iterations > 0 { rounding } else { 0.0 }) {
                return Ok(Solved { iterations, residual });
            }
            if iterations == MOST_SOLVES || !residual.is_finite() {
                return Err(not_converged(residual, iterations, &r));
            }
            factor.solve_points_in_place(&mut r);
            for (d, r) in displacement.iter_mut().zip(&r) {
                for k in 0..3 {
                    d[k] += r[k];
                }
            }
            iterations += 1;
        }
    }

    fn factorise(&mut self, matrix: &SparseMatrix) -> Result<Cholesky, FlowFailure> {
        let refuse = |e: CholeskyError| FlowFailure::NotFactored { reason: e.to_string() };
        self.factorisations += 1;
        // The pattern changes where intrinsic edges do.
        if let Some(symbolic) = &self.symbolic {
            match symbolic.factorize(matrix) {
                Err(CholeskyError::PatternChanged { .. }) => {}
                other => return other.map_err(refuse),
            }
        }
        let symbolic = SymbolicCholesky::new(matrix, Ordering::default()).map_err(refuse)?;
        let factor = symbolic.factorize(matrix).map_err(refuse)?;
        self.symbolic = Some(symbolic);
        Ok(factor)
    }
}

/// `M(1 + w) + t S` over the vertices that move, with ones on the diagonal of those that are held.
fn system(laplacian: &Laplacian, step: f64, freedom: &Freedom) -> SparseMatrix {
    let n = laplacian.len();
    let (mut starts, mut columns, mut values) = (vec![0u32], Vec::new(), Vec::new());
    let mut row: Vec<(u32, f64)> = Vec::new();
    for i in 0..n {
        row.clear();
        let own = match freedom.held[i] {
            true => 1.0,
            false => {
                let neighbors = laplacian.stiffness_row(i);
                row.extend(neighbors.filter(|&(j, _)| !freedom.held[j as usize]));
                let s = if laplacian.is_still(i) { 0.0 } else { laplacian.diagonal()[i] };
                laplacian.mass()[i] * (1.0 + freedom.pull(i).0) + step * s
            }
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

/// `r = P M (t L (x + d) + w (c − x − d) − d)` and its squared norm in each coordinate.
fn residual(
    solver: ImplicitSolver<'_>,
    x: &[Point],
    freedom: &Freedom,
    d: &[Point],
    r: &mut [Point],
) -> [f64; 3] {
    let (mass, t) = (solver.laplacian.mass(), solver.step);
    let moved: Vec<Point> =
        x.iter().zip(d).map(|(x, d)| [x[0] + d[0], x[1] + d[1], x[2] + d[2]]).collect();
    solver.laplacian.sweep_summing(&moved, r, |i, l, y, _| {
        let (w, target) = freedom.pull(i);
        let r = [0, 1, 2].map(|k| mass[i] * (t * l[k] + w * (target[k] - y[k]) - d[i][k]));
        let r = freedom.project(i, r);
        (r, r.map(|x| x * x))
    })
}

#[cfg(test)]
mod tests {

    /// Ten steps of a frozen operator are factored where they are long and iterated where they are short.
    #[test]
    fn conditioning_decides() {
        let mesh = fairing_mesh::shapes::icosphere(5);
        let held = vec![false; mesh.vertex_count()];
        let h2 = mesh.mean_edge_length().powi(2);
        let laplacian = crate::assemble::cotangent(&mesh, Default::default(), &held).unwrap();
        let pays = |lambda: f64, solves| super::pays(&laplacian, lambda * h2, 1e-8, solves);
        assert!(!pays(1.0, 1) && !pays(0.1, 10));
        assert!(pays(100.0, 10) && pays(1e4, 1));
    }
}
