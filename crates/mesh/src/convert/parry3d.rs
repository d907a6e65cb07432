//! Triangle meshes of Parry in double precision, for queries of distance and collision.

use parry3d_f64::shape;

use crate::build::BuildError;
use crate::trimesh::TriMesh;

/// The same vertices and faces in the same order.
///
/// # Errors
///
/// The error of `parry3d_f64::shape::TriMesh::new` for a mesh without faces.
///
/// # Examples
///
/// ```
/// use fairing_mesh::TriMesh;
/// use parry3d_f64::shape;
///
/// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let mesh = TriMesh::new(corners, vec![[0, 1, 2]])?;
/// let shape = shape::TriMesh::try_from(&mesh)?;
/// assert_eq!(TriMesh::try_from(&shape)?, mesh);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
impl TryFrom<&TriMesh> for shape::TriMesh {
    type Error = shape::TriMeshBuilderError;

    fn try_from(mesh: &TriMesh) -> Result<Self, Self::Error> {
        let positions = mesh.positions().iter().map(|&position| position.into()).collect();
        Self::new(positions, mesh.faces().to_vec())
    }
}

/// The same vertices and faces in the same order.
///
/// # Errors
///
/// As for [`TriMesh::new`].
impl TryFrom<&shape::TriMesh> for TriMesh {
    type Error = BuildError;

    fn try_from(mesh: &shape::TriMesh) -> Result<Self, BuildError> {
        let positions = mesh.vertices().iter().map(|&point| point.into()).collect();
        Self::new(positions, mesh.indices().to_vec())
    }
}
