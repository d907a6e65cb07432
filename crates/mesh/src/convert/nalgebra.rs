//! Points and matrices of nalgebra.

use nalgebra::{Matrix3xX, Point3};

use crate::build::BuildError;
use crate::trimesh::TriMesh;

/// The positions.
///
/// # Examples
///
/// ```
/// use fairing_mesh::TriMesh;
/// use nalgebra::Point3;
///
/// let corners = [Point3::origin(), Point3::new(1.0, 0.0, 0.0), Point3::new(0.0, 1.0, 0.0)];
/// let mesh = TriMesh::from_points(&corners, vec![[0, 1, 2]])?;
/// assert_eq!(Vec::<Point3<f64>>::from(&mesh), corners);
/// # Ok::<(), fairing_mesh::BuildError>(())
/// ```
impl From<&TriMesh> for Vec<Point3<f64>> {
    fn from(mesh: &TriMesh) -> Self {
        mesh.positions().iter().map(|&position| position.into()).collect()
    }
}

/// The positions, one in each column.
impl From<&TriMesh> for Matrix3xX<f64> {
    fn from(mesh: &TriMesh) -> Self {
        Self::from_column_slice(mesh.positions().as_flattened())
    }
}

impl TriMesh {
    /// A mesh from points of nalgebra and faces.
    ///
    /// # Errors
    ///
    /// As for [`Self::new`].
    pub fn from_points(points: &[Point3<f64>], faces: Vec<[u32; 3]>) -> Result<Self, BuildError> {
        Self::new(points.iter().map(|&point| point.into()).collect(), faces)
    }
}
