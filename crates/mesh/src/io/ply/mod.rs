//! PLY, the Stanford polygon format: text, and binary of either byte order.
//!
//! Elements and properties may have any order and any type. Scalar properties of
//! vertices and faces become fields, which keep their types; faces are the lists `vertex_indices`
//! (or `vertex_index`) of the element `face`, or the strips of `tristrips`.

mod encode;
mod faces;
mod header;
mod scalars;
mod source;
mod vertices;

use crate::io::error::{Fault, unexpected};
use crate::io::parsed::{Broken, Parsed};
use crate::io::row::{Holds, Row};
use crate::io::text::normalized;
use faces::Limits;
use header::{Body, Element, Header, Kind};
use source::{AsciiSource, BinarySource, Source};

pub(super) const FORMAT: Row = Row {
    name: header::NAME,
    extensions: &["ply"],
    looks_like,
    parse,
    encode: encode::encode,
    holds: Holds {
        fields: true,
        face_fields: true,
        texture: true,
        binary: true,
        float_widths: true,
        ..Holds::TEXT
    },
};

/// Returns true if the first word is `ply`.
fn looks_like(bytes: &[u8]) -> bool {
    bytes.starts_with(b"ply") && bytes.get(3).is_some_and(u8::is_ascii_whitespace)
}

fn parse(bytes: &[u8], broken: Broken) -> Result<Parsed, Fault> {
    let header = header::parse(bytes)?;
    match header.body {
        Body::Ascii => {
            let body = normalized(&bytes[header.length..]);
            read_body(AsciiSource::new(&body, header.lines), &header, broken)
        }
        Body::LittleEndian => {
            read_body(BinarySource::new(bytes, header.length, false), &header, broken)
        }
        Body::BigEndian => {
            read_body(BinarySource::new(bytes, header.length, true), &header, broken)
        }
    }
}

fn read_body(mut source: impl Source, header: &Header, broken: Broken) -> Result<Parsed, Fault> {
    let elements = &header.elements;
    let Some(vertices) = elements.iter().find(|element| element.name == "vertex") else {
        let found = elements.iter().map(|element| &element.name[..]).collect::<Vec<_>>();
        let found = format!("elements {found:?}");
        return Err(source.fault(unexpected("an element vertex", found)));
    };
    // Faces may precede vertices, so the header gives the range of indices;
    // reading the vertices confirms it.
    let vertex_count = vertices.rows();
    let mut parsed = Parsed::default();
    let limits = Limits { vertex_count, broken };
    for element in elements {
        match &element.name[..] {
            "vertex" => vertices::read(&mut source, element, broken, &mut parsed)?,
            "face" if element.count > 0 => {
                let list = faces::index_list(element, &source)?;
                faces::read(&mut source, element, list, limits, &mut parsed)?;
            }
            "tristrips" if element.count > 0 => {
                let list = faces::index_list(element, &source)?;
                faces::read_strips(&mut source, element, list, limits, &mut parsed)?;
            }
            "face" | "tristrips" => {}
            _ => skip(&mut source, element, &mut parsed)?,
        }
    }
    if let Some((count, first)) = source.finish()? {
        let doubt =
            format!("{count} lines after the last element, from line {first} on, are ignored");
        parsed.doubts.push(doubt);
    }
    if source.long_rows() > 0 {
        let doubt = format!("{} lines have more values than properties", source.long_rows());
        parsed.doubts.push(doubt);
    }
    Ok(parsed)
}

/// Skips an element that a mesh cannot hold.
fn skip(source: &mut impl Source, element: &Element, parsed: &mut Parsed) -> Result<(), Fault> {
    if element.count > 0 {
        parsed.notes.push(format!("element {} is ignored", element.name));
    }
    if element.properties.is_empty() || source.take_rows(element)?.is_some() {
        return Ok(());
    }
    for _ in 0..element.rows() {
        for property in &element.properties {
            match property.kind {
                Kind::Scalar(scalar) => source.skip(scalar, 1, &property.name)?,
                Kind::List { count, item } => {
                    let length = vertices::list_length(source, count, &property.name)?;
                    source.skip(item, length, &property.name)?;
                }
            }
        }
        source.end_row();
    }
    Ok(())
}

#[cfg(test)]
mod tests;
