//! Changes of volume, area and edge length, and flipped faces.

use std::borrow::Cow;

use fairing_mesh::TriMesh;
use glam::DVec3;
use rayon::prelude::*;

use crate::correspondence::in_one_winding;
use crate::error::EvaluationError;

/// The relative changes of sizes, `x / x_reference − 1`: zero for equal sizes,
/// negative if the mesh shrank, unchanged if both meshes are scaled.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Drift {
    /// The change of the enclosed volume; `None` unless both are closed and
    /// orientable and the reference has a volume above the rounding of its sum
    /// ([`TriMesh::volume_rounding`]).
    pub volume: Option<f64>,
    /// The change of the area; `None` if the reference has none.
    pub area: Option<f64>,
    /// The change of the mean edge length, an edge counted once for each of its faces;
    /// `None` if the reference has none.
    pub edge_length: Option<f64>,
}

/// The relative changes of volume, area and edge length against a reference,
/// which may have different faces.
pub fn drift(mesh: &TriMesh, reference: &TriMesh) -> Drift {
    // Of faces with the same corners the same ones are turned.
    let alike = in_one_winding(mesh, reference);
    let (mesh, reference) = alike.unwrap_or((Cow::Borrowed(mesh), Cow::Borrowed(reference)));
    let (mesh, reference) = (&*mesh, &*reference);
    let change = |new: f64, old: f64| Some(new / old - 1.0).filter(|x| x.is_finite());
    let solid =
        |m: &TriMesh| m.topology().is_closed() && m.topology().orientation().is_orientable();
    let volume = || {
        let old = reference.signed_volume();
        let exists = old.abs() > reference.volume_rounding();
        exists.then(|| change(mesh.signed_volume(), old)).flatten()
    };
    Drift {
        volume: (solid(mesh) && solid(reference)).then(volume).flatten(),
        area: change(mesh.area(), reference.area()),
        edge_length: change(mesh.mean_edge_length(), reference.mean_edge_length()),
    }
}

/// The number of faces whose normal makes more than a right angle with that of
/// the reference's face of the same number. Faces without area are not flipped.
///
/// # Errors
///
/// [`EvaluationError::NoCorrespondence`] unless both have the same faces.
pub fn flipped_faces(mesh: &TriMesh, reference: &TriMesh) -> Result<usize, EvaluationError> {
    let (mesh, reference) = in_one_winding(mesh, reference)?;
    let (mesh, reference) = (&*mesh, &*reference);
    Ok((0..mesh.face_count())
        .into_par_iter()
        .with_min_len(4096)
        .filter(|&f| {
            // Unit vectors, whose product does not underflow.
            let [m, n] =
                [mesh, reference].map(|mesh| DVec3::from(mesh.area_vector(f)).try_normalize());
            m.zip(n).is_some_and(|(m, n)| m.dot(n) < 0.0)
        })
        .count())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_face_without_area_is_not_flipped() {
        let corners = |z| vec![[0.0; 3], [1.0, 0.0, 0.0], z];
        let up = TriMesh::new(corners([0.0, 1.0, 0.0]), vec![[0u32, 1, 2]]).unwrap();
        let down = up.with_positions(corners([0.0, -1.0, 0.0])).unwrap();
        let flat = up.with_positions(corners([2.0, 0.0, 0.0])).unwrap();
        assert_eq!(flipped_faces(&up, &up).unwrap(), 0);
        assert_eq!(flipped_faces(&down, &up).unwrap(), 1);
        assert_eq!(flipped_faces(&flat, &up).unwrap(), 0);
    }
}
