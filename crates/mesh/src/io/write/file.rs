//! Writing files.

use std::io::Write;
use std::path::Path;

use flate2::Compression;
use flate2::write::GzEncoder;

use super::WriteReport;
use super::encode;
use super::surface::{Faces, Surface};
use crate::io::error::{WriteError, WriteProblem};
use crate::io::{Format, NamedFormat, VertexFields, WriteOptions, write_whole};
use crate::{PolygonMesh, TriMesh};

/// Writes a mesh in the format of the file extension: OBJ, PLY (binary), OFF or
/// STL (binary), compressed if `.gz` follows.
///
/// The file appears whole under its name or not at all: it is written under a
/// temporary name in the same folder and renamed. A file of that name is
/// replaced; through a symbolic link, the file that it names is.
///
/// Coordinates are written as the shortest text that reads back as the same
/// `f64`, in PLY as [`FloatWidth::Lossless`](crate::io::FloatWidth::Lossless)
/// says; only STL rounds, to 32 bits, and forgets the numbering of vertices:
/// the report says so.
///
/// # Errors
///
/// [`WriteError`] names the file and what keeps it from being written.
pub fn write(path: impl AsRef<Path>, mesh: &TriMesh) -> Result<WriteReport, WriteError> {
    write_with_fields(path, mesh, &VertexFields::default(), &WriteOptions::default())
}

/// [`write()`] with fields per vertex and options.
///
/// PLY holds all fields. OBJ holds colours (after the coordinates, from 0 to
/// 1), OFF colours and the vector field `normal`, STL nothing; a field that
/// the format cannot hold is an error unless the options say otherwise.
///
/// # Errors
///
/// As for [`write()`]; a field of the wrong length, with a value that is not
/// finite, or whose name would be read back as something else.
pub fn write_with_fields(
    path: impl AsRef<Path>,
    mesh: &TriMesh,
    fields: &VertexFields,
    options: &WriteOptions,
) -> Result<WriteReport, WriteError> {
    let faces = Faces::Triangles(mesh.faces());
    write_surface(path.as_ref(), mesh.positions(), faces, fields, options)
}

/// [`write_with_fields`] for polygons. STL does not hold them.
///
/// # Errors
///
/// As for [`write_with_fields`].
pub fn write_polygons(
    path: impl AsRef<Path>,
    mesh: &PolygonMesh,
    fields: &VertexFields,
    options: &WriteOptions,
) -> Result<WriteReport, WriteError> {
    let faces = Faces::Polygons(mesh);
    write_surface(path.as_ref(), mesh.positions(), faces, fields, options)
}

fn write_surface(
    path: &Path,
    positions: &[[f64; 3]],
    faces: Faces<'_>,
    fields: &VertexFields,
    options: &WriteOptions,
) -> Result<WriteReport, WriteError> {
    let attempt = || {
        let Some(NamedFormat { format, gzip }) = Format::from_path(path) else {
            return Err(WriteProblem::UnknownExtension);
        };
        let surface = Surface { positions, faces, fields };
        let (pieces, report) = encode::encode(format, surface, options)?;
        write_whole(path, |file| {
            if gzip {
                let mut encoder = GzEncoder::new(file, Compression::default());
                pieces.iter().try_for_each(|piece| encoder.write_all(piece))?;
                encoder.finish().map(|_| ())
            } else {
                pieces.iter().try_for_each(|piece| file.write_all(piece))
            }
        })?;
        Ok(report)
    };
    attempt().map_err(|problem| WriteError { file: path.to_owned(), problem })
}
