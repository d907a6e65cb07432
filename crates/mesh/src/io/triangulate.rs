//! Fields of polygons as those of triangles, and back.

use crate::io::{FaceFields, VertexFields};
use crate::polygon::{PolygonFaces, PolygonMesh};
use crate::trimesh::TriMesh;

/// [`PolygonMesh::triangulate`] with the fields of the mesh: each triangle gets the values of
/// its polygon, and its corners keep their texture coordinates.
/// A note names the first polygon that crosses itself.
pub(crate) fn triangulate(
    mesh: PolygonMesh,
    mut fields: VertexFields,
) -> (TriMesh, VertexFields, Option<String>) {
    let sizes: Vec<usize> = mesh.polygons().map(|face| face.len() - 2).collect();
    let (mesh, corners, crossing) = mesh.split();
    if !fields.faces.is_empty() {
        let of: Vec<usize> =
            sizes.iter().enumerate().flat_map(|(f, &n)| std::iter::repeat_n(f, n)).collect();
        fields.faces = fields.faces.selected(&of, corners.into_iter().flatten());
    }
    let note = crossing.first().map(|face| {
        let count = crossing.len();
        format!("{count} faces cross themselves or have no area, the first is face {face}")
    });
    (mesh, fields, note)
}

/// The fields of the polygons of a mesh, from those of its triangles. `Err` is the first polygon
/// whose triangles differ in one.
pub(crate) fn of_polygons(
    polygons: &PolygonFaces,
    triangles: &[[u32; 3]],
    fields: &FaceFields,
) -> Result<FaceFields, usize> {
    let count = polygons.count();
    let firsts: Vec<usize> = (0..count).map(|f| polygons.triangles_of(f).start).collect();
    if let Some(f) = (0..count).find(|&f| {
        let mut others = polygons.triangles_of(f).skip(1);
        others.any(|triangle| !fields.agree(firsts[f], triangle))
    }) {
        return Err(f);
    }
    let mut corners = Vec::new();
    if let Some(texture) = &fields.texture {
        corners.reserve(polygons.corners().len());
        for f in 0..count {
            let own = polygons.triangles_of(f);
            let places = 3 * own.start..3 * own.end;
            let mut known: Vec<(u32, usize)> =
                triangles[own].as_flattened().iter().copied().zip(places).collect();
            known.sort_unstable();
            if known.windows(2).any(|p| p[0].0 == p[1].0 && texture[p[0].1] != texture[p[1].1]) {
                return Err(f);
            }
            for &v in polygons.face(f) {
                let place = known.partition_point(|&(other, _)| other < v);
                corners.push(known.get(place).ok_or(f)?.1);
            }
        }
    }
    Ok(fields.selected(&firsts, corners))
}
