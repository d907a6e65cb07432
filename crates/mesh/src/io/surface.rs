//! Meshes to encode, with the fields of polygons as those of triangles, and the text lines of their
//! elements.

use fairing_watch::parallel;

use crate::io::number::put_integer;
use crate::io::{FaceFields, VertexFields};
use crate::polygon::{PolygonFaces, PolygonMesh};
use crate::trimesh::TriMesh;

/// A mesh to encode, with its fields.
#[derive(Clone, Copy)]
pub(crate) struct Surface<'a> {
    pub(crate) positions: &'a [[f64; 3]],
    pub(crate) faces: Faces<'a>,
    pub(crate) fields: &'a VertexFields,
}

/// Triangles or polygons.
#[derive(Clone, Copy)]
pub(crate) enum Faces<'a> {
    Triangles(&'a [[u32; 3]]),
    Polygons(&'a PolygonFaces),
}

impl<'a> Faces<'a> {
    pub(crate) fn len(self) -> usize {
        match self {
            Self::Triangles(faces) => faces.len(),
            Self::Polygons(faces) => faces.count(),
        }
    }

    #[inline]
    pub(crate) fn face(self, face: usize) -> &'a [u32] {
        match self {
            Self::Triangles(faces) => &faces[face],
            Self::Polygons(faces) => faces.face(face),
        }
    }
}

/// The consecutive pieces of a file, with notes on the content that it does not hold.
pub(crate) struct Encoded {
    pub(crate) pieces: Vec<Vec<u8>>,
    pub(crate) notes: Vec<String>,
}

/// Lines of faces: the number of corners, their vertices, and what `more` appends.
pub(crate) fn face_lines(
    faces: Faces<'_>,
    more: impl Fn(usize, &mut Vec<u8>) + Sync,
) -> Vec<Vec<u8>> {
    lines(faces.len(), 26, |f, text| {
        let face = faces.face(f);
        put_integer(text, face.len() as u64);
        for &v in face {
            text.push(b' ');
            put_integer(text, u64::from(v));
        }
        more(f, text);
        text.push(b'\n');
    })
}

/// Formats many lines of about `per_line` bytes each, in parallel, in pieces that do not depend
/// on the number of threads.
pub(crate) fn lines(
    count: usize,
    per_line: usize,
    line: impl Fn(usize, &mut Vec<u8>) + Sync,
) -> Vec<Vec<u8>> {
    const PIECE: usize = 1 << 13;
    parallel::map(count.div_ceil(PIECE), 1, |piece| {
        let range = piece * PIECE..count.min((piece + 1) * PIECE);
        let mut text = Vec::with_capacity(range.len() * per_line);
        range.for_each(|k| line(k, &mut text));
        text
    })
}

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
