//! Explicit diffusion, forward Euler.

use std::ops::ControlFlow;

use fairing_mesh::TriMesh;
use fairing_parameters::Options;

use crate::engine::constraints::Constraints;
use crate::engine::diffusion::{Diffusion, LAMBDA, TIME, Time};
use crate::engine::error::{FlowError, FlowFailure};
use crate::engine::linear::{at_once, explicit_steps};
use crate::engine::outcome::Smoothed;
use crate::engine::response::Response;
use crate::engine::response::{Stability, measured_limit, uniform_limit};
use crate::engine::run::Observer;
use crate::engine::run::{Run, RunSettings};
use crate::engine::volume::Volume;

fairing_parameters::options! {
    /// Options of [`explicit`].
    #[derive(Debug, Clone, PartialEq)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    #[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
    pub struct Explicit {
        /// The Laplacian and the length of a step.
        pub diffusion: Diffusion = Diffusion::uniform(0.5);
        /// The number of steps.
        pub iterations: usize = 10;
        /// Constraints of the vertices.
        pub constraints: Constraints = Constraints::NONE;
        /// The treatment of the volume of a closed mesh.
        pub volume: Volume = Volume::Drifts;
        /// The treatment of steps beyond the stable limit.
        pub stability: Stability = Stability::Refuse, name "unstable";
    }
    "explicit": "small steps x + λLx, stable up to λ = 4/3 on closed meshes; strong noise on smooth shapes",
        ["taubin1995", "desbrun1999"];
    then |options, values| {
        // The default for uniform weights is beyond the stable limit for cotangents.
        let given = values.number(LAMBDA).or(values.number(TIME)).is_some();
        if let Diffusion::Cotangent { time, .. } = &mut options.diffusion && !given {
            *time = Time::SquaredEdges(0.1);
        }
        Ok(())
    };
}

impl Explicit {
    /// Ten steps without constraints.
    pub fn new(diffusion: Diffusion) -> Self {
        Self { diffusion, ..Self::DEFAULT }
    }
}

/// Smooths by explicit diffusion steps `x ← x + λ L x`, with the operator of the input.
///
/// A mode of eigenvalue μ of `L` is multiplied by `1 + λμ` in each step. With uniform weights the
/// eigenvalues lie in [−3/2, 0] on closed triangle meshes and in [−7/4, 0] on open ones, so λ is
/// stable up to 4/3 and 8/7, respectively; λ = 2 diverges on every mesh. With cotangent weights the
/// limit is 2/ω for the largest eigenvalue ω of `M⁻¹S`, about 0.27 h² on even meshes and much less
/// where triangles are thin; for these prefer [`implicit`](crate::implicit). The limit is checked
/// before the first step.
///
/// With a soft constraint of weight w and target c each step ends at `(x + λLx + wc)/(1 + w)`.
/// Cost: linear in vertices and steps; an unobserved stable run of many steps n takes about 7√n
/// products with L.
///
/// # Errors
///
/// [`FlowError`] with the last good mesh, if an option is out of range, if the step is beyond the
/// stable limit and unstable steps are refused, if a face is too thin for cotangents, or if a
/// position is not finite.
///
/// # Examples
///
/// ```
/// use fairing_shapes as shapes;
/// use fairing_smoothing::{Diffusion, Explicit, explicit};
///
/// let sphere = shapes::icosphere(3);
/// let smoothed = explicit(&sphere, &Explicit::new(Diffusion::uniform(0.5)), None)?;
/// let radius = smoothed.mesh.positions()[0].iter().map(|x| x * x).sum::<f64>().sqrt();
/// assert!(radius < 1.0, "diffusion shrinks");
/// # Ok::<(), fairing_smoothing::FlowError>(())
/// ```
///
/// Source: [taubin1995], [desbrun1999].
///
/// [taubin1995]: https://doi.org/10.1145/218380.218473
/// [desbrun1999]: https://doi.org/10.1145/311535.311576
#[doc(alias("explicit_smoothing", "filter_laplacian", "laplacian_smoothing"))]
pub fn explicit(
    mesh: &TriMesh,
    options: &Explicit,
    observer: Option<&mut Observer<'_>>,
) -> Result<Smoothed, FlowError> {
    let step = options.diffusion.factor(mesh);
    options.check().map_err(|error| FlowFailure::from(error).before(mesh))?;
    let settings = RunSettings {
        volume: options.volume,
        ..RunSettings::new(&options.constraints, options.iterations)
    };
    let mut run = Run::new(mesh, &settings, observer)?;
    let laplacian = run.laplacian(options.diffusion)?;
    let bound = laplacian.spectral_bound();
    // Uniform steps up to 1 are stable on every mesh, so its topology is not needed.
    let limit = match options.diffusion {
        Diffusion::Uniform { lambda } => (lambda > 1.0).then(|| uniform_limit(mesh)),
        Diffusion::Cotangent { .. } => Some(measured_limit(bound)),
    };
    run.report.stable_limit = limit;
    if let Some(limit) = limit.filter(|&limit| step > limit) {
        run.report.unstable = true;
        if options.stability == Stability::Refuse {
            return Err(run.refuse(FlowFailure::Unstable { step, limit }));
        }
    }
    let response = Response::Explicit { step, steps: options.iterations };
    match at_once(run, &laplacian, response, || bound) {
        ControlFlow::Break(smoothed) => smoothed,
        ControlFlow::Continue(run) => explicit_steps(run, &laplacian, &[step]),
    }
}
