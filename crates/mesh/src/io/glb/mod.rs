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
mod scene;

use crate::io::glb::document::{MAGIC, NAME};
use crate::io::row::{Holds, Row};

pub(super) const FORMAT: Row = Row {
    name: NAME,
    extensions: &["glb"],
    looks_like: |bytes| bytes.starts_with(MAGIC),
    parse: assemble::parse,
    encode: encode::encode,
    holds: Holds { exact: false, polygons: false, fields: true, ..Holds::TEXT },
};

#[cfg(test)]
mod tests;
