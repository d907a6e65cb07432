//! Implicit steps one after another: `(M + λS) x' = M x`, by conjugate gradients or a factorisation.

use fairing_sparse::GraphLaplacian;
use fairing_sparse::parallel::update;

use crate::engine::conjugate::{ImplicitSolver, Solved, Workspace};
use crate::engine::constraints::Freedom;
use crate::engine::direct::{self, Direct};
use crate::engine::error::FlowFailure;
use crate::engine::outcome::Approach;
use crate::engine::parts::Parts;
use crate::engine::run::StepNote;

/// Conjugate gradient iterations after which a step with sliding vertices, which cannot be factored, is given up.
const MAX_ITERATIONS: usize = 20_000;

/// Conjugate gradient iterations before falling back to a factorisation.
const ITERATIONS_BEFORE_FACTORING: usize = 2000;

/// Takes implicit steps of one length; the operator may change from step to step.
pub(crate) struct ImplicitSteps {
    /// The factor of `L`.
    step: f64,
    /// The relative residual.
    tolerance: f64,
    parts: Parts,
    /// Sliding vertices couple the coordinates, which a factor of the scalar system cannot express.
    may_factor: bool,
    /// Whether all systems are factored, because that is faster.
    factors_all: bool,
    direct: Direct,
    /// Displacement of the previous step, the first guess of conjugate gradients.
    displacement: Vec<[f64; 3]>,
    workspace: Workspace,
    /// Conjugate gradient iterations of all steps.
    iterations: usize,
}

impl ImplicitSteps {
    /// Prepares steps with the factor `step` of `L`, whose spectrum reaches to `bound`; the same operator serves
    /// `solves` of them.
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

    /// Forgets the factor, because the operator has changed.
    pub(crate) fn operator_changed(&mut self) {
        self.direct.forget_factor();
    }

    /// Begins the next solve without a first guess.
    pub(crate) fn forget_displacement(&mut self) {
        self.displacement.fill([0.0; 3]);
    }

    /// One step from `x` to `next`.
    pub(crate) fn step(
        &mut self,
        laplacian: &GraphLaplacian,
        x: &[[f64; 3]],
        freedom: &Freedom,
        next: &mut [[f64; 3]],
    ) -> Result<StepNote, FlowFailure> {
        self.step_on(laplacian, x, freedom, false, next)
    }

    /// [`Self::step`]; thin faces make a system `hard`, which is then factored at once.
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
        let max_iterations = match self.may_factor {
            true => ITERATIONS_BEFORE_FACTORING,
            false => MAX_ITERATIONS,
        };
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
        match self.factors_all {
            true => Approach::Cholesky { factorisations: self.direct.factorisations },
            false => Approach::ConjugateGradients { iterations: self.iterations },
        }
    }
}
