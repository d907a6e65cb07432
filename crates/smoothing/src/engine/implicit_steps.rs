//! Consecutive implicit steps `(M + λS) x' = M x`, by conjugate gradients or a factorisation.

use fairing_sparse::GraphLaplacian;
use fairing_sparse::parallel::update;

use crate::engine::conjugate::{ImplicitSolver, Solved, Workspace};
use crate::engine::constraints::Freedom;
use crate::engine::direct::{self, Direct};
use crate::engine::error::FlowFailure;
use crate::engine::outcome::Approach;
use crate::engine::parts::Parts;
use crate::engine::run::StepNote;

/// CG iterations before a step with sliding vertices, which cannot be factored, fails.
const MAX_ITERATIONS: usize = 20_000;

/// CG iterations before falling back to Cholesky.
const ITERATIONS_BEFORE_FACTORING: usize = 2000;

/// A solver for implicit steps of one length; the operator may change from step to step.
pub(crate) struct ImplicitSteps {
    /// The factor of `L`.
    step: f64,
    /// The relative residual.
    tolerance: f64,
    parts: Parts,
    /// Sliding vertices couple the coordinates, which a factor of the scalar system cannot express.
    may_factor: bool,
    /// True if all systems are factored, because that is faster.
    factors_all: bool,
    direct: Direct,
    /// The displacement of the previous step, the initial guess of conjugate gradients.
    displacement: Vec<[f64; 3]>,
    workspace: Workspace,
    /// CG iterations of all steps.
    iterations: usize,
}

impl ImplicitSteps {
    /// Prepares steps with the factor `step` of `L`, whose spectral bound is `bound`; each operator
    /// serves `solves` steps.
    pub(crate) fn new(
        laplacian: &GraphLaplacian,
        freedom: &Freedom,
        step: f64,
        tolerance: f64,
        bound: f64,
        solves: usize,
    ) -> Self {
        let may_factor = freedom.sliding.is_none();
        Self {
            step,
            tolerance,
            parts: Parts::new(laplacian, freedom),
            may_factor,
            factors_all: may_factor && direct::pays(laplacian, step, bound, tolerance, solves),
            direct: Direct::default(),
            displacement: vec![[0.0; 3]; laplacian.len()],
            workspace: Workspace::default(),
            iterations: 0,
        }
    }

    /// Discards the factor after a change of the operator.
    pub(crate) fn operator_changed(&mut self) {
        self.direct.forget_factor();
    }

    /// Starts the next solve from zero.
    pub(crate) fn forget_displacement(&mut self) {
        self.displacement.fill([0.0; 3]);
    }

    /// Takes one step from `x` to `next`.
    pub(crate) fn step(
        &mut self,
        laplacian: &GraphLaplacian,
        x: &[[f64; 3]],
        freedom: &Freedom,
        next: &mut [[f64; 3]],
    ) -> Result<StepNote, FlowFailure> {
        self.step_on(laplacian, x, freedom, false, next)
    }

    /// Takes one step as [`Self::step`] does; a `hard` system, from thin faces, is factored at
    /// once.
    pub(crate) fn step_on(
        &mut self,
        laplacian: &GraphLaplacian,
        x: &[[f64; 3]],
        freedom: &Freedom,
        hard: bool,
        next: &mut [[f64; 3]],
    ) -> Result<StepNote, FlowFailure> {
        let Solved { iterations, residual } = self.solve(laplacian, x, freedom, hard)?;
        self.iterations += iterations;
        let d = &self.displacement;
        update(next, |i, _| ([x[i][0] + d[i][0], x[i][1] + d[i][1], x[i][2] + d[i][2]], ()));
        Ok(StepNote { step_size: self.step, residual: Some(residual) })
    }

    fn solve(
        &mut self,
        laplacian: &GraphLaplacian,
        x: &[[f64; 3]],
        freedom: &Freedom,
        hard: bool,
    ) -> Result<Solved, FlowFailure> {
        let Self { step, tolerance, .. } = *self;
        let max_iterations =
            if self.may_factor { ITERATIONS_BEFORE_FACTORING } else { MAX_ITERATIONS };
        let solver =
            ImplicitSolver { laplacian, parts: &self.parts, step, tolerance, max_iterations };
        let displacement = &mut self.displacement;
        if !self.may_factor || !(hard || self.factors_all) {
            let solved = solver.solve(x, freedom, displacement, &mut self.workspace);
            if solved.is_ok() || !self.may_factor {
                return solved;
            }
        }
        self.direct.solve(solver, x, freedom, displacement)
    }

    /// The method used.
    pub(crate) fn approach(&self) -> Approach {
        if self.factors_all {
            Approach::Cholesky { factorisations: self.direct.factorisations }
        } else {
            Approach::ConjugateGradients { iterations: self.iterations }
        }
    }
}
