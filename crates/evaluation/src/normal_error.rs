//! The angle between the normals of matching faces.

use fairing_mesh::TriMesh;
use glam::DVec3;
use rayon::prelude::*;

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
    let angles: Vec<Option<[f64; 2]>> = (0..mesh.face_count())
        .into_par_iter()
        .with_min_len(4096)
        .map(|f| {
            let [own, area] = [&mesh, &reference].map(|mesh| DVec3::from(mesh.area_vector(f)));
            // Unit vectors: products of areas are fourth powers of lengths.
            let (m, n) = (own.try_normalize()?, area.try_normalize()?);
            Some([libm::atan2(m.cross(n).length(), m.dot(n)).to_degrees(), area.length()])
        })
        .collect();
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
