//! Stable limits of explicit steps.

use fairing_mesh::TriMesh;

use crate::engine::assemble::assemble;
use crate::engine::diffusion::Diffusion;
use crate::engine::error::FlowFailure;

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
pub(crate) fn measured_limit(bound: f64) -> f64 {
    if bound > 0.0 { 2.0 / bound } else { f64::INFINITY }
}
