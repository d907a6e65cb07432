//! Angles at the corners of faces and across edges.

use std::f64::consts::PI;

use fairing_mesh::TriMesh;
use fairing_parameters::ParameterError;
use fairing_watch::parallel;
use glam::DVec3;

use crate::corners::FaceCorners;
use crate::error::OperatorError;
use crate::normals::face_normals;

/// The angle at each corner of each face: entry `k` of face `f` is at vertex `faces[f][k]`.
///
/// In radians; the three of a face sum to π. Where a face without area does not determine its
/// angles, those of an isosceles or equilateral triangle are used.
#[doc(alias = "internal_angles")]
pub fn corner_angles(mesh: &TriMesh) -> Vec<[f64; 3]> {
    let of_face = |f: usize| {
        let corners = FaceCorners::new(mesh.triangle(f));
        [0, 1, 2].map(|k| corners.turn(k)).map(|(x, y)| libm::atan2(y, x))
    };
    parallel::map(mesh.face_count(), 4096, of_face)
}

/// The dihedral angle of each edge of the topology, between the normals of its two faces.
///
/// In radians, from −π to π: positive where convex, as on a cube (π/2), zero where flat. `None` on
/// the boundary, at edges with more than two faces, next to faces without area, and where two faces
/// of a [one-sided](TriMesh::one_sided_faces) part turn against each other. Other faces count as
/// [oriented](TriMesh::oriented).
pub fn dihedral_angles(mesh: &TriMesh) -> Vec<Option<f64>> {
    let mesh = &*mesh.oriented();
    let normals = face_normals(mesh);
    let (positions, faces, topology) = (mesh.positions(), mesh.faces(), mesh.topology());
    let angle = |e: usize| {
        let &[f, g] = topology.edge_faces(e as u32) else { return None };
        let ends = topology.edges()[e];
        let [f, g] = [f as usize, g as usize];
        let [start, end] = ends.map(|v| DVec3::from(positions[v as usize]));
        let along = end - start;
        let forward = runs(faces[f], ends);
        if forward == runs(faces[g], ends) {
            return None;
        }
        let [n, m] = [f, g].map(|f| DVec3::from(normals[f]));
        let sine = n.cross(m).dot(along) * if forward { 1.0 } else { -1.0 };
        let cosine = n.dot(m) * along.length();
        let defined = sine != 0.0 || cosine != 0.0;
        defined.then(|| libm::atan2(sine, cosine))
    };
    parallel::map(topology.edges().len(), 4096, angle)
}

/// The edges with a [dihedral angle](dihedral_angles) of at least `angle` in absolute value,
/// ascending; convex and concave ones.
///
/// # Errors
///
/// [`OperatorError::Option`] unless 0 ≤ `angle` ≤ π.
///
/// # Examples
///
/// ```
/// use fairing_mesh::TriMesh;
/// use fairing_operators::sharp_edges;
///
/// // Two triangles, folded along their common edge.
/// let corners = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]];
/// let mesh = TriMesh::new(corners, vec![[0, 1, 2], [1, 0, 3]])?;
/// let sharp = sharp_edges(&mesh, 30f64.to_radians())?;
/// assert_eq!(mesh.topology().edges()[sharp[0] as usize], [0, 1]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias("feature_edges", "crease"))]
pub fn sharp_edges(mesh: &TriMesh, angle: f64) -> Result<Vec<u32>, OperatorError> {
    ParameterError::require((0.0..=PI).contains(&angle), "angle", angle, "0 to π")?;
    let is_sharp = |found: Option<f64>| found.is_some_and(|found| found.abs() >= angle);
    let sharp = dihedral_angles(mesh).into_iter().zip(0..).filter(|(found, _)| is_sharp(*found));
    Ok(sharp.map(|(_, e)| e).collect())
}

/// Returns true if the face runs from the first end to the second.
#[inline]
fn runs(face: [u32; 3], [a, b]: [u32; 2]) -> bool {
    (0..3).any(|k| face[k] == a && face[(k + 1) % 3] == b)
}

#[cfg(test)]
mod tests {
    use fairing_shapes as shapes;

    use super::*;

    #[test]
    fn angles_of_a_face_sum_to_pi() {
        let right = [[0.0; 3], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]];
        let mesh = TriMesh::new(right.to_vec(), vec![[2, 0, 1]]).unwrap();
        assert_eq!(corner_angles(&mesh), [[PI / 4.0, PI / 2.0, PI / 4.0]]);
        for angles in corner_angles(&shapes::bumpy_sphere(2, 0.2, 4.0)) {
            assert!((angles.iter().sum::<f64>() - PI).abs() < 1e-14);
        }
    }

    /// A roof and a valley of the same slope, and what has no angle.
    #[test]
    fn convex_edges_are_positive() {
        let folded = |z: f64| {
            let corners = vec![[0.0; 3], [0.0, 1.0, 0.0], [1.0, 0.0, z], [-1.0, 0.0, z]];
            TriMesh::new(corners, vec![[0, 2, 1], [0, 1, 3]]).unwrap()
        };
        for (z, expected) in [(-1.0, PI / 2.0), (1.0, -PI / 2.0), (0.0, 0.0)] {
            let mesh = folded(z);
            let edge = mesh.topology().edge_between(0, 1).unwrap() as usize;
            let angles = dihedral_angles(&mesh);
            assert!((angles[edge].unwrap() - expected).abs() < 1e-15, "{z}");
            assert_eq!(angles.iter().flatten().count(), 1);
            // A flipped face counts as oriented.
            let flipped = vec![[0, 2, 1], [0, 3, 1]];
            let flipped = TriMesh::new(mesh.positions().to_vec(), flipped).unwrap();
            assert!((dihedral_angles(&flipped)[edge].unwrap() - expected).abs() < 1e-15);
        }
        let sharp = sharp_edges(&folded(-1.0), 1.0).unwrap();
        assert_eq!(sharp, [0]);
        assert!(sharp_edges(&folded(-1.0), 1.6).unwrap().is_empty());
        assert!(matches!(sharp_edges(&folded(0.0), -1.0), Err(OperatorError::Option(_))));
    }

    /// Five triangles in a band with half a twist: one of its five inner edges is the cut.
    #[test]
    fn one_sided_bands_have_no_angle_at_the_cut() {
        let corners = (0..5).map(|i: i32| [i * i % 5, i * i * i % 7, i].map(f64::from)).collect();
        let faces = (0..5).map(|i| [i, (i + 1) % 5, (i + 2) % 5]).collect();
        let band = TriMesh::new(corners, faces).unwrap();
        assert_eq!(band.one_sided_faces().len(), 5);
        assert_eq!(dihedral_angles(&band).into_iter().flatten().count(), 4);
    }
}
