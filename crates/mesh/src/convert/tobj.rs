//! Meshes of tobj. Its vertices are in the order in which faces first use them.

use crate::build::BuildError;
use crate::polygon::PolygonMesh;
use crate::trimesh::TriMesh;

/// Positions and faces; polygons are split by [`PolygonMesh::triangulate`].
///
/// # Errors
///
/// As for [`TriMesh::from_flat`] and [`PolygonMesh::new`].
///
/// # Examples
///
/// ```
/// use fairing_mesh::TriMesh;
///
/// let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
/// let (models, _) = tobj::load_obj_buf(
///     &mut text.as_bytes(),
///     &tobj::LoadOptions::default(),
///     |_| Err(tobj::LoadError::OpenFileFailed),
/// )?;
/// let mesh = TriMesh::try_from(&models[0].mesh)?;
/// assert_eq!(mesh.face_count(), 2);
/// assert_eq!(tobj::Mesh::from(&mesh).positions.len(), 12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
impl TryFrom<&tobj::Mesh> for TriMesh {
    type Error = BuildError;

    fn try_from(mesh: &tobj::Mesh) -> Result<Self, BuildError> {
        let positions: Vec<f64> = mesh.positions.iter().map(|&x| f64::from(x)).collect();
        if mesh.face_arities.is_empty() {
            return Self::from_flat(&positions, &mesh.indices);
        }
        let (points, []) = positions.as_chunks() else {
            let count = positions.len();
            return Err(BuildError::NotInThrees { what: "coordinates", count });
        };
        let mut rest = &mesh.indices[..];
        let polygons = mesh.face_arities.iter().map(|&arity| {
            let (face, after) = rest.split_at(rest.len().min(arity as usize));
            rest = after;
            face
        });
        Ok(PolygonMesh::new(points.to_vec(), polygons)?.triangulate())
    }
}

/// Positions, which tobj rounds to 32 bits without its feature `use_f64`, and faces.
impl From<&TriMesh> for tobj::Mesh {
    fn from(mesh: &TriMesh) -> Self {
        Self {
            positions: mesh.positions().as_flattened().iter().map(|&x| x as _).collect(),
            indices: mesh.faces().as_flattened().to_vec(),
            ..Self::default()
        }
    }
}
