//! Explicit diffusion, forward Euler, and its stability.

use std::ops::ControlFlow;

use fairing_mesh::TriMesh;
use fairing_parameters::Options;

use crate::engine::assemble::assemble;
use crate::engine::constraints::Constraints;
use crate::engine::diffusion::{Diffusion, LAMBDA, TIME, Time};
use crate::engine::error::{FlowError, FlowFailure};
use crate::engine::outcome::Smoothed;
use crate::engine::response::Response;
use crate::engine::run::{Observer, Run, RunSettings};
use crate::engine::series::{at_once, explicit_steps};
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
    match at_once(run, &laplacian, response, None, || bound) {
        ControlFlow::Break(smoothed) => smoothed,
        ControlFlow::Continue(run) => explicit_steps(run, &laplacian, &[step]),
    }
}

/// Treatment of an explicit step beyond its stable limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Stability {
    /// Returns an error.
    #[default]
    Refuse,
    /// Takes the step; the report says so, and programs warn.
    Warn,
    /// Takes the step; the report says so, but programs do not warn.
    Allow,
}

fairing_parameters::choices!(Stability, "treatment of unstable steps",
    Refuse: "refuse", "An error";
    Warn: "warn", "Taken, with a warning";
    Allow: "allow", "Taken without a warning";
);
#[cfg(feature = "serde")]
fairing_parameters::serde_by_name!(Stability);

/// The largest step for which no mode grows under `x ← x + λLx`, in the unit of the factor of `L`:
/// dimensionless for uniform weights, squared mesh units for cotangents; infinite without edges.
///
/// - Uniform weights, closed mesh (every edge has two faces): 4/3. The sum of
///   `(xₐ + x_b + x_c)² ≥ 0` over all triangles contains every edge twice and every vertex as often
///   as its valence, which gives μ ≥ −3/2. The octahedron attains the bound.
/// - Uniform weights, open mesh: 8/7. The same sum, with boundary edges once, gives
///   `μ ≥ −(1 + ½(1 + 1/d))` for the smallest valence d ≥ 2.
/// - Uniform weights, some edge with three or more faces: 1, since the spectrum of every random
///   walk lies in [−2, 0].
/// - Cotangent weights: 2/ω for an upper bound ω of the spectrum, estimated by twenty Lanczos steps
///   to a few percent.
///
/// Fixed vertices can only narrow the spectrum: the remaining rows form a principal submatrix.
///
/// # Errors
///
/// [`FlowFailure::Operator`] and [`FlowFailure::NonPositiveMass`] where the cotangent operator does
/// not exist.
pub fn stable_limit(mesh: &TriMesh, diffusion: Diffusion) -> Result<f64, FlowFailure> {
    match diffusion {
        Diffusion::Uniform { .. } => Ok(uniform_limit(mesh)),
        Diffusion::Cotangent { .. } => {
            let fixed = vec![false; mesh.vertex_count()];
            let laplacian = assemble(mesh, diffusion.chosen(mesh)?.0, &fixed)?;
            Ok(measured_limit(laplacian.spectral_bound()))
        }
    }
}

/// Lanczos steps; they give many digits of the eigenvalue unless its neighbours crowd it.
const LANCZOS_STEPS: usize = 200;

/// The largest eigenvalue ω of `−L = M⁻¹S`, estimated from below by the largest Ritz value of two
/// hundred Lanczos steps from a fixed random vector. Dimensionless for uniform weights, in one over
/// squared mesh units for cotangents; independent of the step of `diffusion`. Zero without edges.
///
/// An explicit step λ multiplies the roughest mode by 1 − λω.
///
/// # Errors
///
/// [`FlowFailure::Operator`] and [`FlowFailure::NonPositiveMass`] where the cotangent operator does
/// not exist.
///
/// # Examples
///
/// ```
/// use fairing_shapes as shapes;
/// use fairing_smoothing::{Diffusion, largest_eigenvalue};
///
/// // At most 3/2 on every closed triangle mesh.
/// let reach = largest_eigenvalue(&shapes::icosphere(3), Diffusion::uniform(1.0))?;
/// assert!(reach > 1.0 && reach <= 1.5 + 1e-12);
/// # Ok::<(), fairing_smoothing::FlowFailure>(())
/// ```
pub fn largest_eigenvalue(mesh: &TriMesh, diffusion: Diffusion) -> Result<f64, FlowFailure> {
    let diffusion = diffusion.chosen(mesh)?.0;
    Ok(assemble(mesh, diffusion, &vec![false; mesh.vertex_count()])?
        .largest_eigenvalue(LANCZOS_STEPS))
}

/// The limit for uniform weights, from the topology alone.
pub(crate) fn uniform_limit(mesh: &TriMesh) -> f64 {
    let topology = mesh.topology();
    if topology.nonmanifold_edges().next().is_some() {
        1.0
    } else if topology.boundary_edges().next().is_some() {
        8.0 / 7.0
    } else {
        4.0 / 3.0
    }
}

/// The limit for a spectrum of `−L` up to `bound`.
fn measured_limit(bound: f64) -> f64 {
    if bound > 0.0 { 2.0 / bound } else { f64::INFINITY }
}
