//! Meshes to encode, and the text lines of their elements.

use rayon::prelude::*;

use crate::io::VertexFields;
use crate::io::number::put_integer;
use crate::polygon::PolygonFaces;

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
    (0..count.div_ceil(PIECE))
        .into_par_iter()
        .map(|piece| {
            let range = piece * PIECE..count.min((piece + 1) * PIECE);
            let mut text = Vec::with_capacity(range.len() * per_line);
            range.for_each(|k| line(k, &mut text));
            text
        })
        .collect()
}
