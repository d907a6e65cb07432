//! STL of stereolithography: triangles without shared vertices.

mod ascii;
mod binary;

use glam::DVec3;

use crate::io::error::{Fault, WriteProblem};
use crate::io::number::put_triple;
use crate::io::parsed::{Broken, Parsed};
use crate::io::row::{Holds, Row};
use crate::io::surface::{Encoded, Surface, lines};
use crate::io::{Encoding, WriteOptions};

pub(super) const FORMAT: Row = Row {
    name: "STL",
    extensions: &["stl"],
    looks_like,
    parse,
    encode,
    holds: Holds { binary: true, ..Holds::NOTHING },
};

/// Returns true for binary STL, known by its size, and for text that begins with
/// `solid` and a facet or the end of the solid.
fn looks_like(bytes: &[u8]) -> bool {
    binary::has_its_size(bytes) || ascii::looks_like(bytes)
}

/// Parses a file. Size and content decide between binary and text, since the header
/// of a binary file may begin with `solid` as well.
fn parse(bytes: &[u8], broken: Broken) -> Result<Parsed, Fault> {
    if !binary::has_its_size(bytes) && ascii::looks_like(bytes) {
        ascii::parse(bytes, broken)
    } else {
        binary::parse(bytes, broken)
    }
}

/// The beginning of a binary file: anything but `solid`.
const HEADER: &[u8] = b"binary STL";

/// Encodes triangles with their unit normals, or zero for a face without area.
fn encode(surface: Surface<'_>, options: &WriteOptions) -> Result<Encoded, WriteProblem> {
    let not_held = |what| WriteProblem::UnsupportedMesh { format: FORMAT.name, what };
    let (encoding, faces) = (options.encoding, surface.faces);
    let notes = losses(surface, encoding);
    let corners = |f: usize| {
        let face = faces.face(f);
        [face[0], face[1], face[2]].map(|v| surface.positions[v as usize])
    };
    let normal = |corners: [[f64; 3]; 3]| {
        let [a, b, c] = corners.map(DVec3::from);
        (b - a).cross(c - a).normalize_or_zero().to_array()
    };
    if encoding == Encoding::Ascii {
        let mut pieces = vec![b"solid\n".to_vec()];
        pieces.extend(lines(faces.len(), 256, |f, text| {
            let corners = corners(f);
            text.extend_from_slice(b"facet normal");
            put_triple(text, normal(corners));
            text.extend_from_slice(b"\nouter loop\n");
            for corner in corners {
                text.extend_from_slice(b"vertex");
                put_triple(text, corner);
                text.push(b'\n');
            }
            text.extend_from_slice(b"endloop\nendfacet\n");
        }));
        pieces.push(b"endsolid\n".to_vec());
        return Ok(Encoded { pieces, notes });
    }
    let large = |p: &[f64; 3]| p.iter().any(|x| (*x as f32).is_infinite());
    if let Some(v) = surface.positions.iter().position(large) {
        let p = surface.positions[v];
        return Err(not_held(format!("vertex {v} at {p:?}, beyond 32 bits")));
    }
    let count =
        u32::try_from(faces.len()).map_err(|_| not_held(format!("{} faces", faces.len())))?;
    let mut header = HEADER.to_vec();
    header.resize(80, b' ');
    header.extend(count.to_le_bytes());
    let mut pieces = vec![header];
    pieces.extend(lines(faces.len(), 50, |f, bytes| {
        let corners = corners(f);
        for vector in [normal(corners), corners[0], corners[1], corners[2]] {
            for x in vector {
                bytes.extend((x as f32).to_le_bytes());
            }
        }
        bytes.extend([0; 2]);
    }));
    Ok(Encoded { pieces, notes })
}

/// The content that is lost on reading the file back.
fn losses(surface: Surface<'_>, encoding: Encoding) -> Vec<String> {
    let Surface { positions, faces, .. } = surface;
    let mut notes = Vec::new();
    let mut used = vec![false; positions.len()];
    let mut next = 0;
    let mut in_order = true;
    for v in (0..faces.len()).flat_map(|f| faces.face(f)).map(|&v| v as usize) {
        if !used[v] {
            used[v] = true;
            in_order &= v == next;
            next += 1;
        }
    }
    let isolated = used.iter().filter(|&&used| !used).count();
    if isolated > 0 {
        notes.push(format!("STL does not hold the {isolated} isolated vertices"));
    }
    if !in_order {
        notes.push("STL numbers vertices by first appearance, not as they were".to_owned());
    }
    let rounded = |x: &f64| f64::from(*x as f32) != *x;
    if encoding == Encoding::Binary && positions.as_flattened().iter().any(rounded) {
        notes.push("binary STL rounds coordinates to 32 bits".to_owned());
    }
    notes
}
