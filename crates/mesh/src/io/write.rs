//! Writing files, bytes and streams; nothing is lost in silence.

use std::borrow::Cow;
use std::io::Write;
use std::path::Path;

use crate::TriMesh;
use crate::io::arrays::as_properties;
use crate::io::error::{WriteError, WriteProblem};
use crate::io::field_check;
use crate::io::surface::{Encoded, Faces, Surface};
use crate::io::triangulate::of_polygons;
use crate::io::{Format, UnsupportedFields, VertexFields, WriteOptions, WriteReport};

/// Writes a mesh in the format of the file extension, binary if the format allows
/// it, compressed if `.gz` follows.
///
/// Atomic: the file is written under a temporary name in the same folder and
/// renamed. An existing file is replaced; a symbolic link stays, and its target is
/// replaced.
///
/// A mesh that keeps [polygons](TriMesh::polygons) is written with them if the format holds any;
/// STL and GLB get the triangles, and the report says so.
///
/// Coordinates are lossless: the shortest text that reads back as the same `f64`, or
/// [`FloatWidth::Lossless`](crate::io::FloatWidth::Lossless) in PLY. Only STL and GLB round,
/// to 32 bits, and STL loses the numbering of vertices; the report mentions both.
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
/// coordinates; GLB those of vertices; OBJ colours (after the coordinates, from 0 to
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
    use flate2::{Compression, write::GzEncoder};

    fairing_watch::stage("writing", 0);
    let path = path.as_ref();
    let attempt = || {
        let named = Format::from_path(path).ok_or_else(WriteProblem::unknown_extension)?;
        let (pieces, mut report) = encode(named.format, mesh, fields, options)?;
        if named.format.holds().statements {
            report.notes.extend(missing_libraries(path, &fields.faces.statements.libraries));
        }
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

/// A note for each file of materials that is not where a reader of the file at `path` looks.
#[cfg(feature = "files")]
fn missing_libraries(path: &Path, libraries: &[Vec<u8>]) -> Vec<String> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let names = libraries.iter().map(|name| String::from_utf8_lossy(name));
    // A line names one file, with spaces perhaps, or several.
    let is_found = |line: &str| {
        let exists = |name: &str| folder.join(name).exists();
        exists(line) || line.split_ascii_whitespace().all(exists)
    };
    let missing = names.filter(|line| !is_found(line));
    missing
        .map(|line| format!("its materials are looked for in {line}, which is not there"))
        .collect()
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
    let encoded = encode(format, mesh, fields, options);
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
    mut stream: impl Write,
    format: Format,
    mesh: &TriMesh,
    fields: &VertexFields,
    options: &WriteOptions,
) -> Result<WriteReport, WriteError> {
    let mut attempt = || {
        let (pieces, report) = encode(format, mesh, fields, options)?;
        pieces.iter().try_for_each(|piece| stream.write_all(piece))?;
        stream.flush()?;
        Ok(report)
    };
    attempt().map_err(|problem| WriteError::new(Path::new(""), problem))
}

/// The bytes of a file, in pieces, with the report.
fn encode(
    format: Format,
    mesh: &TriMesh,
    fields: &VertexFields,
    options: &WriteOptions,
) -> Result<(Vec<Vec<u8>>, WriteReport), WriteProblem> {
    field_check::check(fields, mesh.vertex_count(), mesh.face_count())?;
    let unsupported = field_check::unsupported(format, fields);
    if !unsupported.is_empty() && options.unsupported_fields == UnsupportedFields::Refuse {
        let (format, fields) = (format.name(), unsupported);
        return Err(WriteProblem::UnsupportedFields { format, fields });
    }
    let holds = format.holds();
    let (mut faces, mut of_faces) = (Faces::Triangles(mesh.faces()), Cow::Borrowed(fields));
    let (mut split_polygons, mut split) = (0, vec![]);
    if let Some(polygons) = mesh.polygons() {
        let why = match of_polygons(polygons, mesh.faces(), &fields.faces) {
            _ if !holds.polygons => Some(format!("{} holds triangles only", format.name())),
            Err(f) => Some(format!("the triangles of polygon {f} have different values")),
            Ok(own) => {
                faces = Faces::Polygons(polygons);
                if !own.is_empty() {
                    of_faces.to_mut().faces = own;
                }
                None
            }
        };
        if let Some(why) = why {
            split_polygons = polygons.larger();
            split.push(format!("{split_polygons} polygons are split into triangles: {why}"));
        }
    }
    let renamed = (format == Format::Ply).then(|| as_properties(&of_faces)).flatten();
    let fields_written = renamed.as_ref().map_or(&*of_faces, |(fields, _)| fields);
    let surface = Surface { positions: mesh.positions(), faces, fields: fields_written };
    let Encoded { pieces, mut notes } = (format.row().encode)(surface, options)?;
    notes.extend(renamed.into_iter().flat_map(|(_, notes)| notes));
    notes.append(&mut split);
    if let Some(lost) = fields.faces.statements.lost().filter(|_| !holds.statements) {
        notes.push(format!("{} holds no {lost}: left out", format.name()));
    }
    let bytes = pieces.iter().map(Vec::len).sum();
    Ok((pieces, WriteReport { format, bytes, dropped: unsupported, split_polygons, notes }))
}
