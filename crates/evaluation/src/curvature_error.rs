//! The error of mean curvature.

use fairing_mesh::TriMesh;
use fairing_operators::curvature::mean_curvature;
use fairing_operators::{LumpedArea, lumped_mass};

use crate::correspondence::in_one_winding;
use crate::error::EvaluationError;

/// The relative error of the pointwise mean curvature (cotangents over mixed
/// areas) in the mean square over the surface of the reference,
///
/// ```text
/// √(Σ Mᵢ (Hᵢ − Rᵢ)² / Σ Mᵢ Rᵢ²)
/// ```
///
/// with the curvatures H of the mesh and R of the reference and the mixed
/// areas M of the reference. Vertices on the boundary, where curvature is
/// one-sided, and undefined ones are left out. `None` if the reference is
/// flat. Unchanged when both are scaled.
///
/// # Errors
///
/// [`EvaluationError::NoCorrespondence`] unless both have the same faces,
/// [`EvaluationError::Operator`] for a degenerate face in either.
pub fn curvature_error(
    mesh: &TriMesh,
    reference: &TriMesh,
) -> Result<Option<f64>, EvaluationError> {
    let (mesh, reference) = in_one_winding(mesh, reference)?;
    let (mesh, reference) = (&*mesh, &*reference);
    let operator = LumpedArea::Mixed;
    let (own, other) = (mean_curvature(mesh, operator)?, mean_curvature(reference, operator)?);
    let mass = lumped_mass(reference, LumpedArea::Mixed)?;
    let (mut error, mut size) = (0.0, 0.0);
    for v in 0..mesh.vertex_count() {
        let usable = own.status[v].is_defined() && other.status[v].is_defined();
        if usable && !other.boundary[v] {
            error += mass[v] * (own.signed[v] - other.signed[v]).powi(2);
            size += mass[v] * other.signed[v].powi(2);
        }
    }
    Ok(Some((error / size).sqrt()).filter(|e| e.is_finite()))
}
