//! VTP, the XML format of polygonal data of VTK and ParaView.
//!
//! Points, polygons and arrays of numbers per point (`PointData`) and per cell
//! (`CellData`), in text, in base64 or as bytes after the XML, plain or compressed
//! with zlib. Cells come in the order vertices, lines, polygons, strips: the first two are
//! ignored, and strips become triangles. Pieces are joined.

mod assemble;
mod data;
mod document;
mod encode;

use crate::io::row::{Holds, Row};

pub(super) const FORMAT: Row = Row {
    name: document::NAME,
    extensions: &["vtp"],
    looks_like,
    parse: assemble::parse,
    encode: encode::encode,
    holds: Holds {
        fields: true,
        face_fields: true,
        binary: true,
        float_widths: true,
        ..Holds::TEXT
    },
};

/// Returns true for XML whose first element is a `VTKFile` of `PolyData`.
fn looks_like(bytes: &[u8]) -> bool {
    let beginning = String::from_utf8_lossy(&bytes[..bytes.len().min(2048)]);
    let text = beginning.trim_start();
    let Some(start) = text.find("<VTKFile").filter(|_| text.starts_with('<')) else {
        return false;
    };
    let tag = text[start..].split('>').next().unwrap_or_default();
    tag.contains("\"PolyData\"") || tag.contains("'PolyData'")
}

#[cfg(test)]
mod tests;
