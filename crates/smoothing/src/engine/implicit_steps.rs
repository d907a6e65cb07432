//! Consecutive implicit steps `(M(1 + w) + tS) x' = M (x + w c)` with soft constraints of weights w
//! and targets c.

use fairing_sparse::parallel::update;
use fairing_sparse::{GraphLaplacian, GraphSystem};

use crate::engine::constraints::Freedom;
use crate::engine::error::FlowFailure;
use crate::engine::outcome::Approach;
use crate::engine::run::StepNote;

/// A solver for implicit steps of one length; the operator may change from step to step.
pub(crate) struct ImplicitSteps {
    /// t, the factor of `L`.
    step: f64,
    system: GraphSystem,
    /// Iterations of conjugate gradients in all steps.
    iterations: usize,
    factorisations: usize,
}

impl ImplicitSteps {
    /// Prepares steps with the factor `step` of `L`, solved to the relative residual `tolerance`;
    /// each operator serves `solves` steps.
    pub(crate) fn new(
        laplacian: GraphLaplacian,
        freedom: &Freedom,
        step: f64,
        tolerance: f64,
        solves: usize,
    ) -> Self {
        // A vertex without an equation: fixed, or isolated and not drawn anywhere.
        let stays =
            |i: usize| freedom.fixed[i] || laplacian.is_fixed(i) && freedom.pull(i).0 == 0.0;
        let given: Vec<bool> = (0..laplacian.len()).map(stays).collect();
        let diagonal = diagonal(&laplacian, freedom);
        let system =
            GraphSystem::to_tolerance(laplacian, step, diagonal, &given, tolerance, solves);
        Self { step, system, iterations: 0, factorisations: 0 }
    }

    /// Changes the operator.
    pub(crate) fn update<T>(
        &mut self,
        freedom: &Freedom,
        change: impl FnOnce(&mut GraphLaplacian) -> Result<T, FlowFailure>,
    ) -> Result<T, FlowFailure> {
        self.system.update(|laplacian, added| {
            let changed = change(laplacian)?;
            *added = diagonal(laplacian, freedom);
            Ok(changed)
        })
    }

    /// Takes one step from `x`; `next` holds the positions before the previous step and receives
    /// those after this one. The initial guess repeats the displacement of the previous step.
    pub(crate) fn step(
        &mut self,
        x: &[[f64; 3]],
        freedom: &Freedom,
        next: &mut [[f64; 3]],
    ) -> Result<StepNote, FlowFailure> {
        let laplacian = self.system.laplacian();
        update(next, |i, before| {
            if laplacian.is_fixed(i) {
                return (x[i], ());
            }
            let d = freedom.project(i, [0, 1, 2].map(|k| x[i][k] - before[k]));
            ([0, 1, 2].map(|k| x[i][k] + d[k]), ())
        });
        let mass = laplacian.mass();
        let right = |i: usize| {
            let ((w, c), m) = (freedom.pull(i), mass[i]);
            [0, 1, 2].map(|k| m * (x[i][k] + w * c[k]))
        };
        let solved = match &freedom.sliding {
            None => self.system.solve(right, next),
            Some(sliding) => self.system.solve_along(right, next, |i, d| sliding.project(i, d)),
        }?;
        self.iterations += solved.iterations;
        self.factorisations += usize::from(solved.factorised);
        Ok(StepNote { step_size: self.step, residual: Some(solved.residual) })
    }

    /// The method used.
    pub(crate) fn approach(&self) -> Approach {
        if self.iterations > 0 || self.factorisations == 0 {
            Approach::ConjugateGradients { iterations: self.iterations }
        } else {
            Approach::Cholesky { factorisations: self.factorisations }
        }
    }
}

/// `M(1 + w)`.
fn diagonal(laplacian: &GraphLaplacian, freedom: &Freedom) -> Vec<f64> {
    let masses = laplacian.mass().iter().enumerate();
    masses.map(|(i, m)| m * (1.0 + freedom.pull(i).0)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::arrangement::Arrangement;
    use crate::engine::assemble::assemble;
    use crate::engine::constraints::Constraints;
    use crate::engine::diffusion::Diffusion;

    /// Ten steps of a constant operator are factored if they are long and iterated if they are
    /// short.
    #[test]
    fn conditioning_decides() {
        let mesh = fairing_shapes::icosphere(5);
        let freedom = Freedom::new(&Arrangement::as_given(&mesh), &Constraints::NONE).unwrap();
        let h2 = mesh.mean_edge_length().powi(2);
        let diffusion = Diffusion::cotangent(1.0).chosen(&mesh).unwrap().0;
        let is_factored = |lambda: f64, solves| {
            let laplacian = assemble(&mesh, diffusion, &freedom.fixed).unwrap();
            let mut steps = ImplicitSteps::new(laplacian, &freedom, lambda * h2, 1e-8, solves);
            let mut next = mesh.positions().to_vec();
            steps.step(mesh.positions(), &freedom, &mut next).unwrap();
            matches!(steps.approach(), Approach::Cholesky { .. })
        };
        assert!(!is_factored(1.0, 1) && !is_factored(0.1, 10));
        assert!(is_factored(100.0, 10) && is_factored(1e4, 1));
    }
}
