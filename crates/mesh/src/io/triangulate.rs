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
pub fn triangulate(mesh: &PolygonMesh, fields: VertexFields) -> (TriMesh, VertexFields) {
    let (triangles, fields, _) = split(mesh, fields);
    (triangles, fields)
}

/// [`triangulate`] with a note if polygons cross themselves.
pub(crate) fn split(
    mesh: &PolygonMesh,
    mut fields: VertexFields,
) -> (TriMesh, VertexFields, Option<String>) {
    let (triangles, corners, crossing) = mesh.triangulate_corners();
    if !fields.faces.is_empty() {
        let of: Vec<usize> =
            mesh.polygons().enumerate().flat_map(|(f, face)| vec![f; face.len() - 2]).collect();
        fields.faces = fields.faces.selected(&of, corners.into_iter().flatten());
    }
    let note = crossing.first().map(|face| {
        let count = crossing.len();
        format!("{count} faces cross themselves or have no area, the first is face {face}")
    });
    (triangles, fields, note)
}
