//! Correspondence of meshes by the numbers of their elements.

use std::borrow::Cow;
use std::sync::Arc;

use fairing_mesh::TriMesh;

use crate::error::EvaluationError;

/// Checks that elements of the same number can be compared: the same number of
/// vertices, and faces with the same corners, however they are wound.
///
/// # Errors
///
/// [`EvaluationError::NoCorrespondence`] if they cannot.
pub(crate) fn check_correspondence(
    mesh: &TriMesh,
    reference: &TriMesh,
) -> Result<(), EvaluationError> {
    let shared = Arc::ptr_eq(mesh.connectivity(), reference.connectivity());
    let alike = |(f, g): (&[u32; 3], &[u32; 3])| {
        f == g || {
            let (mut f, mut g) = (*f, *g);
            f.sort_unstable();
            g.sort_unstable();
            f == g
        }
    };
    let counts = |mesh: &TriMesh| (mesh.vertex_count(), mesh.face_count());
    let pairs = || mesh.faces().iter().zip(reference.faces());
    if shared || counts(mesh) == counts(reference) && pairs().all(alike) {
        return Ok(());
    }
    Err(EvaluationError::NoCorrespondence {
        vertices: mesh.vertex_count(),
        reference_vertices: reference.vertex_count(),
        faces: mesh.face_count(),
        reference_faces: reference.face_count(),
    })
}

/// Corresponding meshes, both with the faces of the [oriented](TriMesh::oriented) reference.
pub(crate) fn in_one_winding<'a>(
    mesh: &'a TriMesh,
    reference: &'a TriMesh,
) -> Result<(Cow<'a, TriMesh>, Cow<'a, TriMesh>), EvaluationError> {
    check_correspondence(mesh, reference)?;
    let reference = reference.oriented();
    let same = Arc::ptr_eq(mesh.connectivity(), reference.connectivity())
        || mesh.faces() == reference.faces();
    let mesh = if same {
        Cow::Borrowed(mesh)
    } else {
        let positions = mesh.positions().to_vec();
        Cow::Owned(reference.with_positions(positions).map_err(EvaluationError::Positions)?)
    };
    Ok((mesh, reference))
}

#[cfg(test)]
mod tests {
    use fairing_shapes as shapes;

    use super::*;
    use crate::{ScoreOptions, Scores};

    /// Scores see neither how the mesh is wound nor how the reference is.
    #[test]
    fn turned_faces_do_not_change_scores() {
        let block = shapes::cad_block(0.2);
        let noisy = shapes::jittered(&block, 0.1, 5, |p| p);
        let with_turned = |mesh: &TriMesh, which: usize| {
            let turn = |(f, &[a, b, c]): (usize, &[u32; 3])| {
                if f % 7 < which { [b, a, c] } else { [a, b, c] }
            };
            let faces = mesh.faces().iter().enumerate().map(turn).collect();
            TriMesh::new(mesh.positions().to_vec(), faces).unwrap()
        };
        let numbers = |mesh: &TriMesh, reference: &TriMesh| {
            let scores = Scores::new(mesh, reference, &ScoreOptions::default()).unwrap();
            let normals = scores.normals.unwrap();
            let features = scores.features.unwrap();
            let found = [normals.mean, normals.max, scores.drift.volume.unwrap()];
            let curvature = scores.curvature.unwrap().unwrap();
            (found, features, scores.flipped_faces.unwrap(), curvature)
        };
        let expected = numbers(&noisy, &block);
        for (m, r) in [(2, 0), (0, 2), (3, 2), (2, 2)] {
            let found = numbers(&with_turned(&noisy, m), &with_turned(&block, r));
            for (a, b) in found.0.iter().zip(expected.0) {
                assert!((a - b).abs() < 1e-9 * (1.0 + b.abs()), "{a} and {b}");
            }
            assert_eq!((found.1, found.2), (expected.1, expected.2));
            assert!((found.3 - expected.3).abs() < 1e-9 * expected.3);
        }
    }
}
