//! Writing files, bytes and streams; lost content is always reported.

use std::borrow::Cow;
use std::io::Write;
use std::path::Path;

use crate::io::columns::as_properties;
use crate::io::error::{WriteError, WriteProblem};
use crate::io::fields::Attributes;
use crate::io::surface::{Encoded, Faces, Surface, of_polygons};
use crate::io::{FaceFields, Format, UnsupportedFields, VertexFields, WriteOptions, WriteReport};
use crate::trimesh::TriMesh;

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
    check(fields, mesh.vertex_count(), mesh.face_count())?;
    let unsupported = unsupported(format, fields);
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
            split_polygons = polygons.non_triangles();
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

/// The names of what a file of a format cannot hold of a mesh: fields and colours.
pub fn unsupported(format: Format, fields: &VertexFields) -> Vec<String> {
    let holds = format.holds();
    let mut unsupported = Vec::new();
    if !holds.fields {
        let scalars = fields.scalars.iter().map(|(name, _)| name.clone());
        let vectors = fields.vectors.iter().map(|(name, _)| name.clone());
        let vectors = vectors.filter(|name| !holds.normals || name != "normal");
        unsupported.extend(scalars.chain(vectors));
    }
    if !holds.colors && fields.colors.is_some() {
        unsupported.push("colours".to_owned());
    }
    if !holds.face_fields {
        let FaceFields { scalars, vectors, colors, .. } = &fields.faces;
        let names = scalars.iter().map(|(name, _)| name);
        let names = names.chain(vectors.iter().map(|(name, _)| name));
        unsupported.extend(names.map(|name| format!("{name} of faces")));
        unsupported.extend(colors.iter().map(|_| "colours of faces".to_owned()));
    }
    if !holds.texture && fields.faces.texture.is_some() {
        unsupported.push("texture coordinates of corners".to_owned());
    }
    unsupported
}

/// The elements that fields belong to, in the plural and the singular of messages.
type Elements = (&'static str, &'static str);

/// Checks lengths, values and names.
fn check(fields: &VertexFields, vertices: usize, faces: usize) -> Result<(), WriteProblem> {
    check_values(fields.into(), vertices, ("vertices", "vertex"))?;
    check_names(fields.into())?;
    let of_faces = &fields.faces;
    check_values(of_faces.into(), faces, ("faces", "face"))?;
    if let Some(texture) = &of_faces.texture {
        let elements = ("corners", "corner");
        check_length("of texture coordinates", texture.len(), 3 * faces, elements)?;
        check_finite("of texture coordinates", texture.as_flattened(), 2, elements)?;
    }
    if let Some(found) = of_faces.statements.faces() {
        check_length("of statements", found, faces, ("faces", "face"))?;
    }
    check_names(of_faces.into())
}

fn check_values(
    fields: Attributes<'_>,
    count: usize,
    elements: Elements,
) -> Result<(), WriteProblem> {
    for (name, values) in fields.scalars {
        check_length(name, values.len(), count, elements)?;
        check_finite(name, values, 1, elements)?;
    }
    for (name, values) in fields.vectors {
        check_length(name, values.len(), count, elements)?;
        check_finite(name, values.as_flattened(), 3, elements)?;
    }
    match fields.colors {
        Some(colors) => check_length("of colours", colors.len(), count, elements),
        None => Ok(()),
    }
}

fn check_length(
    name: &str,
    found: usize,
    expected: usize,
    (elements, _): Elements,
) -> Result<(), WriteProblem> {
    if found == expected {
        return Ok(());
    }
    Err(WriteProblem::FieldLength { field: name.to_owned(), elements, expected, found })
}

fn check_finite(
    name: &str,
    values: &[f64],
    per_element: usize,
    (_, element): Elements,
) -> Result<(), WriteProblem> {
    match values.iter().position(|x| !x.is_finite()) {
        None => Ok(()),
        Some(at) => Err(WriteProblem::FieldNonFinite {
            field: name.to_owned(),
            element,
            index: at / per_element,
            value: values[at],
        }),
    }
}

/// Checks that names are visible and belong to one scalar and one vector at most.
fn check_names(fields: Attributes<'_>) -> Result<(), WriteProblem> {
    let bad = |name: &str, reason| Err(WriteProblem::FieldName { name: name.to_owned(), reason });
    let scalars: Vec<&str> = fields.scalars.iter().map(|(name, _)| &name[..]).collect();
    let vectors: Vec<&str> = fields.vectors.iter().map(|(name, _)| &name[..]).collect();
    for mut names in [scalars, vectors] {
        let odd = |name: &&&str| name.is_empty() || name.bytes().any(|b| b.is_ascii_control());
        if let Some(name) = names.iter().find(odd) {
            return bad(name, "empty, or with control characters");
        }
        names.sort_unstable();
        if let Some(pair) = names.windows(2).find(|pair| pair[0] == pair[1]) {
            return bad(pair[0], "two fields of this name");
        }
    }
    Ok(())
}
