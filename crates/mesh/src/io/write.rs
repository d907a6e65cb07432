//! Writing files, bytes and streams; nothing is lost in silence.

use std::io::Write;
use std::path::Path;

use crate::io::arrays::as_properties;
use crate::io::error::{WriteError, WriteProblem};
use crate::io::field_check;
use crate::io::surface::{Encoded, Faces, Surface};
use crate::io::{Format, UnsupportedFields, VertexFields, WriteOptions, WriteReport};
use crate::{PolygonMesh, TriMesh};

/// Writes a mesh in the format of the file extension, binary if the format allows
/// it, compressed if `.gz` follows.
///
/// Atomic: the file is written under a temporary name in the same folder and
/// renamed. An existing file is replaced; a symbolic link stays, and its target is
/// replaced.
///
/// Coordinates are lossless: the shortest text that reads back as the same `f64`, or
/// [`FloatWidth::Lossless`](crate::io::FloatWidth::Lossless) in PLY. Only STL and GLB round,
/// to 32 bits, and STL loses the numbering of vertices; the report mentions both. PCD and XYZ hold
/// no faces, which is an error unless the options drop them.
///
/// # Errors
///
/// [`WriteError`] names the file and the problem.
#[cfg(feature = "files")]
pub fn write(path: impl AsRef<Path>, mesh: &TriMesh) -> Result<WriteReport, WriteError> {
    write_with_fields(path, mesh, &VertexFields::default(), &WriteOptions::default())
}

/// [`write()`] with fields and options.
///
/// PLY holds all fields, those of faces and texture coordinates included; VTP all but texture
/// coordinates; GLB, PCD and XYZ those of vertices; OBJ colours (after the coordinates, from 0 to
/// 1), the vector field `normal` and texture coordinates; OFF colours and `normal`; STL none. A
/// field that the format cannot hold is an error unless the options drop it.
///
/// # Errors
///
/// As for [`write()`], and for a field of the wrong length, with a value that is not
/// finite, or with a name that is empty or another field's.
#[cfg(feature = "files")]
pub fn write_with_fields(
    path: impl AsRef<Path>,
    mesh: &TriMesh,
    fields: &VertexFields,
    options: &WriteOptions,
) -> Result<WriteReport, WriteError> {
    write_surface(path.as_ref(), Surface::triangles(mesh, fields), options)
}

/// [`write_with_fields`] for polygons. STL does not hold them.
///
/// # Errors
///
/// As for [`write_with_fields`].
#[cfg(feature = "files")]
pub fn write_polygons(
    path: impl AsRef<Path>,
    mesh: &PolygonMesh,
    fields: &VertexFields,
    options: &WriteOptions,
) -> Result<WriteReport, WriteError> {
    write_surface(path.as_ref(), Surface::polygons(mesh, fields), options)
}

#[cfg(feature = "files")]
fn write_surface(
    path: &Path,
    surface: Surface<'_>,
    options: &WriteOptions,
) -> Result<WriteReport, WriteError> {
    use flate2::{Compression, write::GzEncoder};

    fairing_watch::stage("writing", 0);
    let attempt = || {
        let named = Format::from_path(path).ok_or_else(WriteProblem::unknown_extension)?;
        let (pieces, report) = encode(named.format, surface, options)?;
        crate::io::write_whole(path, |file| {
            if named.gzip {
                let mut encoder = GzEncoder::new(file, Compression::default());
                pieces.iter().try_for_each(|piece| encoder.write_all(piece))?;
                encoder.finish().map(|_| ())
            } else {
                pieces.iter().try_for_each(|piece| file.write_all(piece))
            }
        })?;
        Ok(report)
    };
    attempt().map_err(|problem| WriteError::new(path, problem))
}

/// The bytes of an uncompressed file.
///
/// # Errors
///
/// As for writing a file; the file in the error is empty.
pub fn to_bytes(
    format: Format,
    mesh: &TriMesh,
    fields: &VertexFields,
    options: &WriteOptions,
) -> Result<Vec<u8>, WriteError> {
    let encoded = encode(format, Surface::triangles(mesh, fields), options);
    let (pieces, _) = encoded.map_err(|problem| WriteError::new(Path::new(""), problem))?;
    Ok(pieces.concat())
}

/// Writes the uncompressed bytes of a file to a stream.
///
/// Nothing is written if the format cannot hold the mesh or its fields. If the
/// stream fails, the bytes written before remain in it.
///
/// # Errors
///
/// As for writing a file; the file name in the error is empty.
///
/// # Examples
///
/// ```
/// use fairing_mesh::io::{self, Format};
/// use fairing_mesh::TriMesh;
///
/// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let mesh = TriMesh::new(corners, vec![[0, 1, 2]])?;
/// let mut stream = Vec::new();
/// io::write_to(&mut stream, Format::Off, &mesh, &Default::default(), &Default::default())?;
/// assert!(stream.starts_with(b"OFF\n3 1 0\n"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_to(
    stream: impl Write,
    format: Format,
    mesh: &TriMesh,
    fields: &VertexFields,
    options: &WriteOptions,
) -> Result<WriteReport, WriteError> {
    stream_out(stream, format, Surface::triangles(mesh, fields), options)
}

/// [`write_to`] for polygons. STL does not hold them.
///
/// # Errors
///
/// As for [`write_to`].
pub fn write_polygons_to(
    stream: impl Write,
    format: Format,
    mesh: &PolygonMesh,
    fields: &VertexFields,
    options: &WriteOptions,
) -> Result<WriteReport, WriteError> {
    stream_out(stream, format, Surface::polygons(mesh, fields), options)
}

fn stream_out(
    mut stream: impl Write,
    format: Format,
    surface: Surface<'_>,
    options: &WriteOptions,
) -> Result<WriteReport, WriteError> {
    let mut attempt = || {
        let (pieces, report) = encode(format, surface, options)?;
        pieces.iter().try_for_each(|piece| stream.write_all(piece))?;
        stream.flush()?;
        Ok(report)
    };
    attempt().map_err(|problem| WriteError::new(Path::new(""), problem))
}

/// The bytes of a file, in pieces, with the report.
fn encode(
    format: Format,
    surface: Surface<'_>,
    options: &WriteOptions,
) -> Result<(Vec<Vec<u8>>, WriteReport), WriteProblem> {
    field_check::check(surface.fields, surface.positions.len(), surface.faces)?;
    let unsupported = field_check::not_held(format, surface);
    if !unsupported.is_empty() && options.unsupported_fields == UnsupportedFields::Refuse {
        let (format, fields) = (format.name(), unsupported);
        return Err(WriteProblem::UnsupportedFields { format, fields });
    }
    if let Faces::Polygons(_) = surface.faces
        && format.holds().faces
        && !format.holds().polygons
    {
        let what = "polygons: triangulate the mesh first".to_owned();
        return Err(WriteProblem::UnsupportedMesh { format: format.name(), what });
    }
    let renamed = match format {
        Format::Ply | Format::Pcd | Format::Xyz => as_properties(surface.fields),
        _ => None,
    };
    let fields = renamed.as_ref().map_or(surface.fields, |(fields, _)| fields);
    let encoded = (format.row().encode)(Surface { fields, ..surface }, options)?;
    let Encoded { pieces, mut notes } = encoded;
    notes.extend(renamed.into_iter().flat_map(|(_, notes)| notes));
    let bytes = pieces.iter().map(Vec::len).sum();
    Ok((pieces, WriteReport { format, bytes, dropped: unsupported, notes }))
}
