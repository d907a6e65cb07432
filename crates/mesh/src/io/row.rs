//! One row of the table of formats.

use crate::io::WriteOptions;
use crate::io::error::{Fault, WriteProblem};
use crate::io::parsed::{Broken, Parsed};
use crate::io::surface::{Encoded, Surface};

/// A format as its own file describes it.
pub(crate) struct Row {
    /// The name in messages.
    pub(crate) name: &'static str,
    /// The file extensions in lower case, the usual one first.
    pub(crate) extensions: &'static [&'static str],
    /// Tells whether a file begins like one of this format.
    pub(crate) looks_like: fn(&[u8]) -> bool,
    pub(crate) parse: fn(&[u8], Broken) -> Result<Parsed, Fault>,
    /// Encodes a surface of which the format holds the fields.
    pub(crate) encode: fn(Surface<'_>, &WriteOptions) -> Result<Encoded, WriteProblem>,
    pub(crate) holds: Holds,
}

/// The content that a format holds besides the positions and corners of triangles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct Holds {
    /// Numbers of 64 bits, as they are; without them binary files round to 32 bits.
    pub exact: bool,
    /// Faces of more than three corners.
    pub polygons: bool,
    /// Vertex colours.
    pub colors: bool,
    /// The vector field `normal`.
    pub normals: bool,
    /// Scalar and vector fields of vertices, of any name, `normal` included.
    pub fields: bool,
    /// Fields and colours of faces.
    pub face_fields: bool,
    /// Texture coordinates of the corners of faces.
    pub texture: bool,
    /// Objects, groups and materials of faces.
    pub statements: bool,
    /// Both encodings; a format without them is always text.
    pub binary: bool,
    /// Numbers of 32 and of 64 bits, as [`FloatWidth`](crate::io::FloatWidth) says.
    pub float_widths: bool,
}

impl Holds {
    pub(super) const NOTHING: Self = Self {
        exact: false,
        polygons: false,
        colors: false,
        normals: false,
        fields: false,
        face_fields: false,
        texture: false,
        statements: false,
        binary: false,
        float_widths: false,
    };

    /// Text with faces of any number of corners, and colours and normals of vertices.
    pub(super) const TEXT: Self =
        Self { exact: true, polygons: true, colors: true, normals: true, ..Self::NOTHING };
}
