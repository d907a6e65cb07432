//! Linear flows: all steps with one operator, by the cheapest method.

use fairing_sparse::GraphLaplacian;

use crate::engine::constraints::Freedom;
use crate::engine::error::{FlowError, FlowFailure};
use crate::engine::implicit_steps::ImplicitSteps;
use crate::engine::outcome::{Approach, Smoothed};
use crate::engine::resolvent::Resolvent;
use crate::engine::response::Response;
use crate::engine::run::{Run, StepNote};
use crate::engine::series::Chain;

/// Multiplies the mode of eigenvalue μ of `L` by `response.at(μ)`; `bound` is the
/// [spectral bound](GraphLaplacian::spectral_bound).
///
/// Unobserved runs with free and pinned vertices only are evaluated as a Chebyshev series if a
/// short one exists. All other steps are taken one after another, implicit steps by conjugate
/// gradients or a factorisation to the relative residual `tolerance`; all other filters are
/// evaluated as a series in the resolvent. The report names the method.
pub(crate) fn advance(
    mut run: Run<'_, '_>,
    laplacian: &GraphLaplacian,
    bound: f64,
    response: Response,
    tolerance: f64,
) -> Result<Smoothed, FlowError> {
    if run.is_linear()
        && let Some(series) = series(bound, response)
    {
        run.report.approach = Approach::Series { degree: series.products() };
        run.report.iterations = response.steps();
        let x = series.apply(laplacian, run.arrangement.mesh().positions());
        return run.finish(x);
    }
    let explicit = |run: Run<'_, '_>, [even, odd]: [f64; 2]| {
        run.iterate(|iteration, mesh, freedom, next| {
            let step = if iteration % 2 == 0 { even } else { odd };
            explicit_step(laplacian, step, mesh.positions(), freedom, next);
            Ok(StepNote { step_size: step, residual: None })
        })
    };
    match response {
        Response::Explicit { step, .. } => explicit(run, [step; 2]),
        Response::Pairs { shrink, grow, .. } => explicit(run, [shrink, grow]),
        Response::Implicit { step, steps } => {
            let mut solver =
                ImplicitSteps::new(laplacian, &run.freedom, step, tolerance, bound, steps);
            let smoothed = run.iterate(|_, mesh, freedom, next| {
                solver.step(laplacian, mesh.positions(), freedom, next)
            });
            smoothed.map(|mut smoothed| {
                smoothed.report.approach = solver.approach();
                smoothed
            })
        }
        Response::Heat { .. } | Response::Butterworth { .. } => filter(run, laplacian, response),
    }
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

/// Applies a filter that is too narrow for a series in `L`, by a series in the resolvent.
fn filter(
    mut run: Run<'_, '_>,
    laplacian: &GraphLaplacian,
    response: Response,
) -> Result<Smoothed, FlowError> {
    let Some(resolvent) = Resolvent::expand(response).filter(|_| run.is_linear()) else {
        let reason = "a low-pass filter supports free and pinned vertices only";
        return Err(run.refuse(FlowFailure::Unsupported { reason }));
    };
    run.report.iterations = 1;
    run.report.approach = Approach::Resolvent { degree: resolvent.degree() };
    let x = run.arrangement.mesh().positions();
    match resolvent.apply(laplacian, &run.freedom, x) {
        Ok((x, residual)) => {
            run.report.worst_residual = Some(residual);
            run.finish(x)
        }
        Err(failure) => Err(run.refuse(failure)),
    }
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
