//! Polygons with fields split into triangles.

use crate::io::VertexFields;
use crate::{PolygonMesh, TriMesh};

/// [`PolygonMesh::triangulate`] with the fields of the mesh: each triangle gets the values of
/// its polygon, and its corners keep their texture coordinates.
///
/// # Panics
///
/// If a field of faces has not one value per polygon, or texture coordinates not one per
/// corner.
pub fn triangulate(mesh: &PolygonMesh, mut fields: VertexFields) -> (TriMesh, VertexFields) {
    if fields.faces.is_empty() {
        return (mesh.triangulate(), fields);
    }
    let (triangles, corners) = mesh.triangulate_corners();
    let of: Vec<usize> =
        mesh.polygons().enumerate().flat_map(|(f, face)| vec![f; face.len() - 2]).collect();
    fields.faces = fields.faces.selected(&of, corners.into_iter().flatten());
    (triangles, fields)
}
