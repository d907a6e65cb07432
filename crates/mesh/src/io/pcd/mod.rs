//! PCD, the points of the Point Cloud Library: text, binary, and binary compressed.
//!
//! Fields of one number are grouped by name as the properties of PLY; `normal_x`, `normal_y` and
//! `normal_z` are normals, and `rgb` or `rgba` is a colour packed into one word.

mod body;
mod encode;
mod header;

use crate::io::error::Fault;
use crate::io::parsed::{Broken, Parsed};
use crate::io::pcd::header::NAME;
use crate::io::row::{Holds, Row};
use crate::io::text::Cursor;

pub(super) const FORMAT: Row = Row {
    name: NAME,
    extensions: &["pcd"],
    looks_like,
    parse,
    encode: encode::encode,
    holds: Holds { binary: true, float_widths: true, ..Holds::POINTS },
};

/// Returns true if the first word after comments is that of a header, or the first comment names
/// the format.
fn looks_like(bytes: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(4096)];
    let mut cursor = Cursor::new(head, 0, Some(b'#'));
    let word = cursor.token().unwrap_or_default();
    head.starts_with(b"# .PCD") || [&b"VERSION"[..], b"FIELDS"].contains(&word)
}

fn parse(bytes: &[u8], broken: Broken) -> Result<Parsed, Fault> {
    let header = header::parse(bytes)?;
    body::parse(bytes, &header, broken)
}

#[cfg(test)]
mod tests;
