//! STL of stereolithography: triangles without shared vertices.

mod ascii;
mod binary;

use crate::io::error::Fault;
use crate::io::parsed::{Broken, Parsed};

/// Whether the bytes are STL: binary by their size, or text that begins with
/// `solid` and goes on with a facet or the end of the solid.
pub(crate) fn looks_like(bytes: &[u8]) -> bool {
    binary::has_its_size(bytes) || ascii::looks_like(bytes)
}

/// Whether the file is as long as a binary one with its count of triangles.
pub(crate) fn is_binary(bytes: &[u8]) -> bool {
    binary::has_its_size(bytes)
}

/// Parses a file. A binary one may begin with `solid` too, so that size and
/// content decide.
pub(crate) fn parse(bytes: &[u8], broken: Broken) -> Result<Parsed, Fault> {
    if !binary::has_its_size(bytes) && ascii::looks_like(bytes) {
        ascii::parse(bytes, broken)
    } else {
        binary::parse(bytes, broken)
    }
}
