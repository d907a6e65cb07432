//! The angle between the normals of matching faces, and the error of mean curvature.

use fairing_mesh::TriMesh;
use fairing_operators::curvature::mean_curvature;
use fairing_operators::{LumpedArea, lumped_mass};
use fairing_watch::parallel;
use glam::DVec3;

use crate::correspondence::in_one_winding;
use crate::error::EvaluationError;

/// E_a: angles between the normals of matching faces, in degrees.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct NormalAngles {
    /// The mean over the faces, as in the literature.
    pub mean: f64,
    /// The mean weighted by the area of the reference's faces.
    pub area_weighted: f64,
    /// The largest angle.
    pub max: f64,
    /// The face with the largest angle.
    pub worst: u32,
    /// The number of faces without area in either mesh, which are left out.
    pub undefined: usize,
}

/// The angles between the normals of faces of the same number, from 0 to 180
/// degrees, by `atan2(‖m × n‖, m · n)`, which is exact for small angles too.
///
/// # Errors
///
/// [`EvaluationError::NoCorrespondence`] unless both have the same faces,
/// [`EvaluationError::NoFaces`] if none has a normal in both.
pub fn normal_error(mesh: &TriMesh, reference: &TriMesh) -> Result<NormalAngles, EvaluationError> {
    let (mesh, reference) = in_one_winding(mesh, reference)?;
    let angles: Vec<Option<[f64; 2]>> = parallel::map(mesh.face_count(), 4096, |f| {
        let [own, area] = [&mesh, &reference].map(|mesh| DVec3::from(mesh.area_vector(f)));
        // Unit vectors: products of areas are fourth powers of lengths.
        let (m, n) = (own.try_normalize()?, area.try_normalize()?);
        Some([libm::atan2(m.cross(n).length(), m.dot(n)).to_degrees(), area.length()])
    });
    let (mut sum, mut weighted, mut area, mut count) = (0.0, 0.0, 0.0, 0usize);
    let (mut max, mut worst) = (-1.0, 0);
    for (f, angle) in angles.iter().enumerate() {
        let Some([angle, weight]) = *angle else { continue };
        sum += angle;
        weighted += weight * angle;
        area += weight;
        count += 1;
        if angle > max {
            (max, worst) = (angle, f as u32);
        }
    }
    if count == 0 {
        return Err(EvaluationError::NoFaces { which: "mesh" });
    }
    Ok(NormalAngles {
        mean: sum / count as f64,
        area_weighted: weighted / area,
        max,
        worst,
        undefined: angles.len() - count,
    })
}

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
