//! GLB, the binary form of glTF 2.0, which viewers and browsers show.
//!
//! The meshes of a scene become one mesh, each transformed by its nodes. Vertex attributes of
//! the application (`_NAME`) are fields. Numbers have 32 bits; colours are linear in the file
//! and sRGB in memory. Materials, textures, animations and morph targets are ignored.

mod accessor;
mod assemble;
mod color;
mod document;
mod encode;
mod primitive;
mod scene;

use crate::io::row::{Holds, Row};

/// The name of the format.
const NAME: &str = "GLB";

/// The first four bytes of a file.
const MAGIC: &[u8] = b"glTF";

/// The types of chunks.
const JSON: u32 = u32::from_le_bytes(*b"JSON");
const BINARY: u32 = u32::from_le_bytes(*b"BIN\0");

/// The modes of primitives.
const POINTS: usize = 0;
const TRIANGLES: usize = 4;

pub(super) const FORMAT: Row = Row {
    name: NAME,
    extensions: &["glb"],
    looks_like: |bytes| bytes.starts_with(MAGIC),
    parse: assemble::parse,
    encode: encode::encode,
    holds: Holds {
        faces: true,
        exact: false,
        polygons: false,
        colors: true,
        normals: true,
        fields: true,
        face_fields: false,
        texture: false,
        binary: false,
        float_widths: false,
    },
};

#[cfg(test)]
mod tests;
