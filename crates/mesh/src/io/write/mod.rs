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

use crate::io::error::WriteError;
use crate::io::{Format, VertexFields, WriteOptions};
use crate::{PolygonMesh, TriMesh};
use encode::{Faces, Surface};
#[cfg(feature = "files")]
pub use file::{write, write_polygons, write_with_fields};

/// What was written, and what was not.
#[derive(Debug, Clone, PartialEq, Eq)]
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
