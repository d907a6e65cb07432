//! How far the spectrum of a Laplacian reaches.

use fairing_mesh::TriMesh;

use crate::engine::assemble::assemble;
use crate::engine::diffusion::Diffusion;
use crate::engine::error::FlowFailure;

/// Lanczos steps; the eigenvalue is then known to many digits unless crowded by its neighbours.
const STEPS: usize = 200;

/// The largest eigenvalue of `−L = M⁻¹S`, from below: the largest Ritz value of two hundred Lanczos steps from a
/// fixed random vector. Dimensionless for uniform weights, in one over squared mesh units for cotangents; the step of
/// `diffusion` does not matter. Zero without edges.
///
/// A step of the explicit flow multiplies the roughest mode by one minus the step times this.
///
/// # Errors
///
/// [`FlowFailure::Operator`] and [`FlowFailure::NonPositiveMass`] where the cotangent operator does not exist.
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
    Ok(assemble(mesh, diffusion, &vec![false; mesh.vertex_count()])?.largest_eigenvalue(STEPS))
}
