//! Linear flows: all steps of a constant operator at once, or explicit steps one after another.

use std::ops::ControlFlow;

use fairing_sparse::GraphLaplacian;

use crate::engine::constraints::Freedom;
use crate::engine::error::FlowError;
use crate::engine::outcome::{Approach, Smoothed};
use crate::engine::response::Response;
use crate::engine::run::{Run, StepNote};
use crate::engine::series::Chain;

/// Multiplies the mode of eigenvalue μ of `L` by `response.at(μ)` with a Chebyshev series, if the
/// run is unobserved, has free and pinned vertices only, and if a short series exists; otherwise
/// returns the run. `bound` computes the [spectral bound](GraphLaplacian::spectral_bound).
pub(crate) fn at_once<'a, 'o>(
    mut run: Run<'a, 'o>,
    laplacian: &GraphLaplacian,
    response: Response,
    bound: impl FnOnce() -> f64,
) -> ControlFlow<Result<Smoothed, FlowError>, Run<'a, 'o>> {
    if !run.is_linear() {
        return ControlFlow::Continue(run);
    }
    let Some(series) = series(bound(), response) else { return ControlFlow::Continue(run) };
    run.report.approach = Approach::Series { degree: series.products() };
    run.report.iterations = response.steps();
    let x = series.apply(laplacian, run.arrangement.mesh().positions());
    ControlFlow::Break(run.finish(x))
}

/// The series of a run, if it is cheaper than the steps.
fn series(bound: f64, response: Response) -> Option<Chain> {
    // A product of a series costs a third less than a step.
    match response {
        Response::Explicit { steps, .. } if steps > 1 => {
            Chain::expand(bound, response, steps.saturating_add(steps / 2))
        }
        Response::Pairs { pairs, .. } if pairs > 1 => {
            Chain::expand(bound, response, pairs.saturating_mul(3))
        }
        Response::Explicit { .. } | Response::Pairs { .. } => None,
        Response::Implicit { steps: 0, .. } => None,
        other => Chain::one(bound, other),
    }
}

/// Takes explicit steps, of lengths in turn.
pub(crate) fn explicit_steps(
    run: Run<'_, '_>,
    laplacian: &GraphLaplacian,
    lengths: &[f64],
) -> Result<Smoothed, FlowError> {
    run.iterate(|iteration, mesh, freedom, next| {
        let step = lengths[iteration % lengths.len()];
        explicit_step(laplacian, step, mesh.positions(), freedom, next);
        Ok(StepNote { step_size: step, residual: None })
    })
}

/// The explicit step `next ← x + λ P L x`, drawn towards soft targets.
fn explicit_step(
    laplacian: &GraphLaplacian,
    step: f64,
    x: &[[f64; 3]],
    freedom: &Freedom,
    next: &mut [[f64; 3]],
) {
    if freedom.is_linear() {
        laplacian.sweep(x, next, |_, l, x, _| {
            [x[0] + step * l[0], x[1] + step * l[1], x[2] + step * l[2]]
        });
        return;
    }
    laplacian.sweep(x, next, |i, l, x, _| {
        let (w, target) = freedom.pull(i);
        let d = [0, 1, 2].map(|k| (step * l[k] + w * (target[k] - x[k])) / (1.0 + w));
        let d = freedom.project(i, d);
        [x[0] + d[0], x[1] + d[1], x[2] + d[2]]
    });
}
