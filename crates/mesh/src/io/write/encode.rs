//! From a surface to the bytes of a format.

use rayon::prelude::*;

use crate::PolygonMesh;
use crate::io::error::WriteProblem;
use crate::io::write::number::integer;
use crate::io::write::{WriteReport, fields, obj, off, ply, stl};
use crate::io::{Format, UnheldFields, VertexFields, WriteOptions};

/// A mesh to write, with its fields.
#[derive(Clone, Copy)]
pub(super) struct Surface<'a> {
    pub(super) positions: &'a [[f64; 3]],
    pub(super) faces: Faces<'a>,
    pub(super) fields: &'a VertexFields,
}

/// Triangles or polygons.
#[derive(Clone, Copy)]
pub(super) enum Faces<'a> {
    Triangles(&'a [[u32; 3]]),
    Polygons(&'a PolygonMesh),
}

impl<'a> Faces<'a> {
    pub(super) fn len(self) -> usize {
        match self {
            Self::Triangles(faces) => faces.len(),
            Self::Polygons(mesh) => mesh.polygon_count(),
        }
    }

    #[inline]
    pub(super) fn face(self, face: usize) -> &'a [u32] {
        match self {
            Self::Triangles(faces) => &faces[face],
            Self::Polygons(mesh) => mesh.polygon(face),
        }
    }
}

/// The bytes of a file, in pieces, with the report.
pub(super) fn encode(
    format: Format,
    surface: Surface<'_>,
    options: &WriteOptions,
) -> Result<(Vec<Vec<u8>>, WriteReport), WriteProblem> {
    fields::check(surface.fields, surface.positions.len())?;
    let unheld = fields::unheld(format, surface.fields);
    if !unheld.is_empty() && options.unheld_fields == UnheldFields::Refuse {
        return Err(WriteProblem::FieldsNotHeld { format, fields: unheld });
    }
    let mut notes = Vec::new();
    let pieces = match format {
        Format::Obj => obj::encode(surface),
        Format::Ply => ply::encode(surface, options)?,
        Format::Off => off::encode(surface),
        Format::Stl => stl::encode(surface, options.encoding, &mut notes)?,
    };
    let bytes = pieces.iter().map(Vec::len).sum();
    Ok((pieces, WriteReport { format, bytes, dropped: unheld, notes }))
}

/// A line for each face: the number of its corners and their vertices.
pub(super) fn face_lines(faces: Faces<'_>) -> Vec<Vec<u8>> {
    lines(faces.len(), 26, |f, text| {
        let face = faces.face(f);
        integer(text, face.len() as u64);
        for &v in face {
            text.push(b' ');
            integer(text, u64::from(v));
        }
        text.push(b'\n');
    })
}

/// Text of many lines of about `per_line` bytes each, made in parallel; the
/// result does not depend on the number of threads.
pub(super) fn lines(
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
