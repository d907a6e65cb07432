//! A format of lines of three coordinates, one for each corner of a triangle.

use crate::io::error::{Fault, WriteProblem};
use crate::io::number::put_triple;
use crate::io::parsed::{Broken, Parsed};
use crate::io::row::{Holds, Row};
use crate::io::surface::{Encoded, Surface, lines};
use crate::io::text::Cursor;
use crate::io::{Format, WriteOptions};

pub(super) const FORMAT: Row = Row {
    name: "DUMMY",
    extensions: &["dummy"],
    looks_like: |bytes| bytes.starts_with(b"dummy"),
    parse,
    encode,
    holds: Holds { exact: true, ..Holds::NOTHING },
};

const _: () = assert!(matches!(Format::ALL, [.., Format::Dummy]));

fn parse(bytes: &[u8], _: Broken) -> Result<Parsed, Fault> {
    let mut cursor = Cursor::new(bytes, 5, None);
    let mut parsed = Parsed::default();
    while cursor.more() {
        let mut position = || cursor.float("a coordinate");
        parsed.positions.push([position()?, position()?, position()?]);
    }
    for corner in (0..parsed.positions.len() as u32).step_by(3) {
        parsed.polygons.push_triangle([corner, corner + 1, corner + 2]);
    }
    Ok(parsed)
}

fn encode(surface: Surface<'_>, _: &WriteOptions) -> Result<Encoded, WriteProblem> {
    let mut pieces = vec![b"dummy\n".to_vec()];
    pieces.extend(lines(surface.faces.len(), 200, |f, text| {
        for &v in surface.faces.face(f) {
            put_triple(text, surface.positions[v as usize]);
            text.push(b'\n');
        }
    }));
    Ok(Encoded { pieces, notes: vec!["DUMMY holds no shared vertices".to_owned()] })
}
