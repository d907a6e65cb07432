//! GLB, the binary form of glTF 2.0, which viewers and browsers show.
//!
//! The form in JSON is read as well, with its buffers in URIs or in files beside it.
//! The meshes of a scene become one mesh, each transformed by its nodes. Vertex attributes of
//! the application (`_NAME`) are fields. Numbers have 32 bits; colours are linear in the file
//! and sRGB in memory. Materials, textures, animations and morph targets are ignored.

mod accessor;
mod assemble;
mod buffers;
mod document;
mod encode;
mod entry;

pub(super) use crate::io::glb::assemble::parse;
pub(super) use crate::io::glb::buffers::Beside;
use crate::io::glb::document::{MAGIC, NAME};
use crate::io::row::{Holds, Row};

pub(super) const FORMAT: Row = Row {
    name: NAME,
    extensions: &["glb"],
    looks_like,
    parse: |bytes, broken| parse(bytes, broken, Beside::default()),
    encode: encode::encode,
    holds: Holds { exact: false, polygons: false, fields: true, ..Holds::TEXT },
};

/// Returns true for the first bytes of GLB, and for JSON with the member `asset`.
fn looks_like(bytes: &[u8]) -> bool {
    let is_json = bytes.trim_ascii_start().starts_with(b"{");
    bytes.starts_with(MAGIC) || is_json && bytes.windows(7).any(|part| part == b"\"asset\"")
}

#[cfg(test)]
mod tests;
