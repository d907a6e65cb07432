//! Writing: whole or not at all, and nothing lost in silence.

mod encode;
mod fields;
#[cfg(feature = "files")]
mod file;
mod number;
mod obj;
mod off;
mod ply;
mod stl;
mod surface;

use std::io::Write;

use crate::io::error::WriteError;
use crate::io::{Format, VertexFields, WriteOptions};
use crate::{PolygonMesh, TriMesh};
#[cfg(feature = "files")]
pub use file::{write, write_polygons, write_with_fields};
use surface::{Faces, Surface};

/// What was written, and what was not.
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct WriteReport {
    /// The format.
    pub format: Format,
    /// The size of the file before compression.
    pub bytes: usize,
    /// The fields that were dropped because the options allow it.
    pub dropped: Vec<String>,
    /// What else the format could not hold: an order of vertices, isolated
    /// ones, digits.
    pub notes: Vec<String>,
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
    bytes(format, mesh.positions(), Faces::Triangles(mesh.faces()), fields, options)
}

/// [`to_bytes`] for polygons. STL does not hold them.
///
/// # Errors
///
/// As for [`to_bytes`].
pub fn polygons_to_bytes(
    format: Format,
    mesh: &PolygonMesh,
    fields: &VertexFields,
    options: &WriteOptions,
) -> Result<Vec<u8>, WriteError> {
    bytes(format, mesh.positions(), Faces::Polygons(mesh), fields, options)
}

/// Writes the uncompressed bytes of a file to a stream.
///
/// Nothing is written if the format cannot hold the mesh or its fields. What a
/// stream that fails has got by then stays there.
///
/// # Errors
///
/// As for writing a file; the file in the error is empty.
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
    let faces = Faces::Triangles(mesh.faces());
    stream_out(stream, format, Surface { positions: mesh.positions(), faces, fields }, options)
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
    let faces = Faces::Polygons(mesh);
    stream_out(stream, format, Surface { positions: mesh.positions(), faces, fields }, options)
}

fn stream_out(
    mut stream: impl Write,
    format: Format,
    surface: Surface<'_>,
    options: &WriteOptions,
) -> Result<WriteReport, WriteError> {
    let mut attempt = || {
        let (pieces, report) = encode::encode(format, surface, options)?;
        pieces.iter().try_for_each(|piece| stream.write_all(piece))?;
        stream.flush()?;
        Ok(report)
    };
    attempt().map_err(|problem| WriteError { file: Default::default(), problem })
}

fn bytes(
    format: Format,
    positions: &[[f64; 3]],
    faces: Faces<'_>,
    fields: &VertexFields,
    options: &WriteOptions,
) -> Result<Vec<u8>, WriteError> {
    match encode::encode(format, Surface { positions, faces, fields }, options) {
        Ok((pieces, _)) => Ok(pieces.concat()),
        Err(problem) => Err(WriteError { file: Default::default(), problem }),
    }
}
