//! Implicit diffusion, backward Euler, and mean curvature flow.

use std::ops::ControlFlow;

use fairing_mesh::TriMesh;
use fairing_parameters::{Options, Range};

use crate::engine::constraints::Constraints;
use crate::engine::diffusion::Diffusion;
use crate::engine::error::{FlowError, FlowFailure};
use crate::engine::implicit_steps::ImplicitSteps;
use crate::engine::outcome::Smoothed;
use crate::engine::response::Response;
use crate::engine::run::{Observer, Run, RunSettings};
use crate::engine::series::at_once;
use crate::engine::updated::{Update, advance_updated};
use crate::engine::volume::Volume;

fairing_parameters::options! {
    /// Options of [`implicit`].
    #[derive(Debug, Clone, PartialEq)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    #[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
    pub struct Implicit {
        /// The Laplacian and the length of a step.
        pub diffusion: Diffusion = Diffusion::uniform(5.0);
        /// The number of steps.
        pub iterations: usize = 10;
        /// Constraints of the vertices.
        pub constraints: Constraints = Constraints::NONE;
        /// The treatment of the volume of a closed mesh.
        pub volume: Volume = Volume::Drifts;
        /// The part of the operator that follows the moving mesh; cotangents only.
        pub update: Update = Update::Never;
        /// The relative residual of the linear systems.
        pub tolerance: f64 = 1e-8, in Range::above(0.0).below(1.0);
    }
    "implicit": "steps (I − λL)x' = x of any length; always stable, always shrinks", ["desbrun1999"],
        with Self::DEFAULT,
        if |options| options.update != Update::Both;
    "mean-curvature": "implicit steps, the operator reassembled in each: motion by mean curvature",
        ["desbrun1999"],
        without ["weights", "update"],
        with Self::mean_curvature_flow(1.0),
        if |options| options.update == Update::Both;
}

impl Implicit {
    /// Ten steps with the operator of the input, without constraints.
    pub fn new(diffusion: Diffusion) -> Self {
        Self { diffusion, ..Self::DEFAULT }
    }

    /// Mean curvature flow: steps of `lambda` h², each with an updated operator.
    pub fn mean_curvature_flow(lambda: f64) -> Self {
        Self { update: Update::Both, ..Self::new(Diffusion::cotangent(lambda)) }
    }
}

/// Smooths by implicit diffusion steps `(I − λL) x' = x`.
///
/// A mode of eigenvalue μ ≤ 0 of `L` is multiplied by `1/(1 − λμ)`: every λ is stable, and every
/// step shrinks all modes but the constants (λ → ∞ collapses each component to its centroid,
/// weighted by degree or area). Each step solves the symmetric system `(M + λS) x' = M x`:
/// `D − λ(A − D)` for uniform weights, `M + tS` for cotangents, positive definite if all areas are
/// positive.
///
/// Unobserved runs of a constant operator with free and pinned vertices are computed at once by a
/// Chebyshev series; all others step by step, by conjugate gradients or, if the system is
/// ill-conditioned and steps are many, by a Cholesky factorisation. The report names the method.
///
/// Boundaries are natural: a free boundary shrinks. A soft constraint of weight w and target c adds
/// `M w` on the left and `M w c` on the right; sliding vertices move along the tangents of their
/// curves within the system and are then returned to the curve.
///
/// # Errors
///
/// [`FlowError`] with the last good mesh, if an option is out of range, if a face of the input is
/// too thin for cotangents, if a system is not solved to the tolerance, and
/// [`FlowFailure::Collapsed`] if a flow with an updated operator has shrunk the mesh to almost
/// nothing.
///
/// Faces that become degenerate during a flow with an updated operator do not end it: their
/// cotangents and areas are those of a triangle with sides longer by a hundred-thousandth of the
/// longest. The report counts them.
///
/// # Examples
///
/// ```
/// use fairing_shapes as shapes;
/// use fairing_smoothing::{Diffusion, Implicit, implicit};
///
/// let sphere = shapes::icosphere(3);
/// let options = Implicit { iterations: 3, ..Implicit::new(Diffusion::uniform(100.0)) };
/// let smoothed = implicit(&sphere, &options, None)?;
/// assert_eq!(smoothed.report.iterations, 3);
/// # Ok::<(), fairing_smoothing::FlowError>(())
/// ```
///
/// Source: [desbrun1999].
///
/// [desbrun1999]: https://doi.org/10.1145/311535.311576
#[doc(alias("implicit_fairing", "implicit_smoothing"))]
pub fn implicit(
    mesh: &TriMesh,
    options: &Implicit,
    observer: Option<&mut Observer<'_>>,
) -> Result<Smoothed, FlowError> {
    check(options).map_err(|failure| failure.before(mesh))?;
    let (step, tolerance) = (options.diffusion.factor(mesh), options.tolerance);
    let settings = RunSettings {
        volume: options.volume,
        ..RunSettings::new(&options.constraints, options.iterations)
    };
    let mut run = Run::new(mesh, &settings, observer)?;
    if options.update != Update::Never {
        return advance_updated(run, options.diffusion, options.update, step, tolerance);
    }
    let laplacian = run.laplacian(options.diffusion)?;
    let response = Response::Implicit { step, steps: options.iterations };
    let run = match at_once(run, &laplacian, response, Some((step, options.iterations)), || {
        laplacian.spectral_bound()
    }) {
        ControlFlow::Break(smoothed) => return smoothed,
        ControlFlow::Continue(run) => run,
    };
    // (M(1 + w) + λS) x' = M (x + w c)
    let mut steps =
        ImplicitSteps::new(laplacian, &run.freedom, step, tolerance, options.iterations);
    let mut smoothed =
        run.iterate(|_, mesh, freedom, next| steps.step(mesh.positions(), freedom, next))?;
    smoothed.report.approach = steps.approach();
    Ok(smoothed)
}

fn check(options: &Implicit) -> Result<(), FlowFailure> {
    options.check()?;
    let uniform = matches!(options.diffusion, Diffusion::Uniform { .. });
    if uniform && options.update != Update::Never {
        return Err(FlowFailure::Unsupported {
            reason: "uniform weights do not depend on positions, so there is nothing to update",
        });
    }
    Ok(())
}
