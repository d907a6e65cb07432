//! OFF, the object file format of Geomview.
//!
//! The keyword `[ST][C][N]OFF`; the counts of vertices, faces and edges; a line per
//! vertex (position, then normal, colour and texture coordinates if the prefixes
//! announce them); and a line per face (count, indices, optional colour). Comments
//! begin with `#` anywhere. Line ends may stand between any two numbers. MeshLab
//! writes the prefixes in the order `[N][C][ST]`, and colours before normals.
//! After `OFF BINARY`, numbers are big-endian and of 32 bits.

mod binary;

use crate::io::error::{Fault, WriteProblem, unexpected};
use crate::io::number::{put_float, put_integer, put_triple};
use crate::io::off::binary::{Prefixes, Vertices, finish_faces};
use crate::io::parsed::{Broken, FaceList, Parsed, bytes_of_colors, check_finite};
use crate::io::row::{Holds, Row};
use crate::io::surface::{Encoded, Surface, face_lines, lines};
use crate::io::text::{Cursor, normalized, shown};
use crate::io::{VertexFields, WriteOptions};

pub(super) const FORMAT: Row = Row {
    name: "OFF",
    extensions: &["off", "coff", "noff", "stoff"],
    looks_like,
    parse,
    encode,
    holds: Holds::TEXT,
};

/// The letters before `OFF` in a token that is the keyword. The first count may follow without a
/// blank, as in the files of ModelNet.
fn letters_of(token: &[u8]) -> Option<&[u8]> {
    let end = token.windows(3).position(|three| three == b"OFF")?;
    let (letters, rest) = (&token[..end], &token[end + 3..]);
    let is_keyword = letters.len() <= 6
        && letters.iter().all(|letter| b"STCN4n".contains(letter))
        && rest.iter().all(u8::is_ascii_digit);
    is_keyword.then_some(letters)
}

/// Returns true if the first token is the keyword.
fn looks_like(bytes: &[u8]) -> bool {
    Cursor::new(bytes, 0, Some(b'#')).token().is_some_and(|token| letters_of(token).is_some())
}

/// Places at which lines may end.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Breaks {
    /// After each vertex and face; other numbers in a line are extra.
    BetweenElements,
    /// Between any two numbers of the vertices, and after each face.
    InVertices,
    /// Between any two numbers; faces have no colours.
    Anywhere,
}

/// Parses a file, with or without the keyword.
fn parse(bytes: &[u8], broken: Broken) -> Result<Parsed, Fault> {
    let text = normalized(bytes);
    let mut cursor = Cursor::new(&text, 0, Some(b'#'));
    let prefixes = keyword(&mut cursor)?;
    let mut after = cursor.clone();
    if after.token() == Some(b"BINARY") {
        return binary::parse(bytes, bytes.len() - after.remaining(), prefixes, broken);
    }
    let vertex_count = cursor.count("the number of vertices")?;
    let face_count = cursor.count("the number of faces")?;
    // Some writers omit the number of edges, which is not used. It is on the
    // same line as the faces or on its own.
    let mut ahead = cursor.clone();
    if cursor.more_on_line() || (ahead.token().is_some() && !ahead.more_on_line()) {
        cursor.count("the number of edges")?;
    }
    let counts = [vertex_count, face_count];
    // Lines tell colours and extra numbers from the next element, so they come first.
    let body = |breaks| parse_body(cursor.clone(), counts, prefixes, broken, breaks);
    body(Breaks::BetweenElements).or_else(|fault| {
        body(Breaks::InVertices).or_else(|_| body(Breaks::Anywhere)).map_err(|_| fault)
    })
}

/// Takes the keyword, if there is one.
fn keyword(cursor: &mut Cursor<'_>) -> Result<Prefixes, Fault> {
    cursor.more();
    let token = cursor.peek();
    let Some(letters) = letters_of(token) else {
        if token.first().is_some_and(u8::is_ascii_digit) {
            return Ok(Prefixes::default());
        }
        let expected = "OFF, perhaps with the prefixes ST, C, N";
        return Err(cursor.fault(unexpected(expected, shown(token))));
    };
    let Some(prefixes) = Prefixes::from_letters(letters) else {
        let reason = match (letters.contains(&b'4'), letters.contains(&b'n')) {
            (true, false) => "four coordinates of each position",
            (_, true) => "positions of any dimension",
            _ => "prefixes in an unknown order",
        };
        let expected = "OFF with three coordinates of each position, perhaps with ST, C, N";
        return Err(cursor.fault(unexpected(expected, format!("{}, {reason}", shown(token)))));
    };
    cursor.skip(letters.len() + 3);
    Ok(prefixes)
}

fn parse_body(
    mut cursor: Cursor<'_>,
    [vertex_count, face_count]: [u64; 2],
    prefixes: Prefixes,
    broken: Broken,
    breaks: Breaks,
) -> Result<Parsed, Fault> {
    let mut parsed = Parsed::default();
    let one_line = !cursor.rest().trim_ascii().contains(&b'\n');
    parse_vertices(&mut cursor, vertex_count, prefixes, broken, breaks, &mut parsed)?;
    if breaks != Breaks::BetweenElements {
        // A coordinate that is missing would shift the faces.
        if cursor.more_on_line() && !one_line {
            return Err(cursor.fault(unexpected("the end of the line", cursor.found())));
        }
        parsed.notes.push("the numbers of an element are not on a line of their own".to_owned());
    }
    parse_faces(&mut cursor, face_count, broken, breaks, &mut parsed)?;
    cursor.expect_end(&format!("{vertex_count} vertices and {face_count} faces"))?;
    Ok(parsed)
}

impl Vertices {
    fn parse(
        &mut self,
        cursor: &mut Cursor<'_>,
        prefixes: Prefixes,
        breaks: Breaks,
    ) -> Result<(), Fault> {
        let line = cursor.clone();
        let position = triple(cursor, "a coordinate", breaks)?;
        check_finite(&position, self.positions.len(), self.broken)
            .map_err(|problem| line.fault(problem))?;
        self.positions.push(position);
        if prefixes.normal && !prefixes.color_first {
            self.normals.push(triple(cursor, "a component of the normal", breaks)?);
        }
        if prefixes.color {
            self.colors.push(triple(cursor, "a colour", breaks)?);
            // Without lines, and before other numbers, only Geomview's four numbers are clear.
            let before_normal = prefixes.normal && prefixes.color_first;
            if breaks != Breaks::BetweenElements || before_normal || cursor.more_on_line() {
                self.largest_alpha = self.largest_alpha.max(cursor.float("the alpha value")?);
            }
        }
        if prefixes.normal && prefixes.color_first {
            self.normals.push(triple(cursor, "a component of the normal", breaks)?);
        }
        if breaks == Breaks::BetweenElements {
            if cursor.more_on_line() {
                self.extra += usize::from(!prefixes.texture);
                cursor.skip_line();
            }
        } else if prefixes.texture {
            cursor.float("a texture coordinate")?;
            cursor.float("a texture coordinate")?;
        }
        Ok(())
    }

    fn finish(self, prefixes: Prefixes, parsed: &mut Parsed) {
        if self.extra > 0 {
            let extra = self.extra;
            let doubt =
                format!("{extra} vertex lines have more numbers than the keyword announces");
            parsed.doubts.push(doubt);
        }
        if prefixes.texture {
            parsed.notes.push("texture coordinates are ignored".to_owned());
        }
        if prefixes.color {
            match bytes_of_colors(&self.colors, self.largest_alpha) {
                Some(colors) => parsed.fields.colors = Some(colors),
                None => parsed.doubts.push("vertex colours are out of range: left out".to_owned()),
            }
        }
        if prefixes.normal {
            let fields = std::mem::take(&mut parsed.fields);
            parsed.fields = VertexFields::with_vector(fields, "normal", self.normals);
        }
        parsed.positions = self.positions;
    }
}

fn parse_vertices(
    cursor: &mut Cursor<'_>,
    count: u64,
    prefixes: Prefixes,
    broken: Broken,
    breaks: Breaks,
    parsed: &mut Parsed,
) -> Result<(), Fault> {
    // A vertex takes six bytes or more, which bounds the memory that a false
    // count reserves.
    let room = (cursor.remaining() / 6).min(usize::try_from(count).unwrap_or(usize::MAX));
    let mut vertices =
        Vertices { positions: Vec::with_capacity(room), broken, ..Default::default() };
    while (vertices.positions.len() as u64) < count {
        if !cursor.more() {
            let found = format!("{} and then the end", vertices.positions.len());
            return Err(cursor.fault(unexpected(format!("{count} vertices"), found)));
        }
        vertices.parse(cursor, prefixes, breaks)?;
    }
    vertices.finish(prefixes, parsed);
    Ok(())
}

/// Parses three numbers, on one line if lines end between elements only.
fn triple(cursor: &mut Cursor<'_>, what: &str, breaks: Breaks) -> Result<[f64; 3], Fault> {
    let mut triple = [0.0; 3];
    for x in &mut triple {
        if breaks == Breaks::BetweenElements && !cursor.more_on_line() {
            return Err(cursor.fault(unexpected(what, cursor.found())));
        }
        *x = cursor.float(what)?;
    }
    Ok(triple)
}

fn parse_faces(
    cursor: &mut Cursor<'_>,
    count: u64,
    broken: Broken,
    breaks: Breaks,
    parsed: &mut Parsed,
) -> Result<(), Fault> {
    let room = (cursor.remaining() / 8).min(usize::try_from(count).unwrap_or(usize::MAX));
    let mut faces = FaceList::with_capacity(room, parsed.positions.len(), broken);
    let mut colored = 0usize;
    for face in 0..usize::try_from(count).unwrap_or(usize::MAX) {
        if !cursor.more() {
            let expected = format!("{count} faces");
            return Err(cursor.fault(unexpected(expected, format!("{face} and then the end"))));
        }
        let line = cursor.clone();
        let size = cursor.count("the number of corners")?;
        for corner in 0..size {
            if breaks != Breaks::Anywhere && !cursor.more_on_line() {
                let expected = format!("{size} corners in face {face}");
                return Err(cursor.fault(unexpected(expected, corner.to_string())));
            }
            let at = cursor.clone();
            let index = cursor.integer("the index of a vertex")?;
            faces.corner(index).map_err(|problem| at.fault(problem))?;
        }
        faces.end().map_err(|problem| line.fault(problem))?;
        if breaks == Breaks::Anywhere {
            // A number that is missing shows in most files as a face that is too small.
            if faces.small > 0 {
                return Err(line.fault(unexpected("three corners or more", size.to_string())));
            }
        } else if cursor.more_on_line() {
            colored += 1;
            cursor.skip_line();
        }
    }
    finish_faces(faces, colored, parsed);
    Ok(())
}

/// Encodes with the prefixes C for colours (red, green, blue and alpha from 0 to
/// 255) and N for normals. The number of edges is written as 0, since readers
/// ignore it.
fn encode(surface: Surface<'_>, _: &WriteOptions) -> Result<Encoded, WriteProblem> {
    let colors = surface.fields.colors.as_deref();
    let normals = surface.fields.vector("normal");
    let color = if colors.is_some() { "C" } else { "" };
    let normal = if normals.is_some() { "N" } else { "" };
    let (vertices, faces) = (surface.positions.len(), surface.faces.len());
    let mut pieces = vec![format!("{color}{normal}OFF\n{vertices} {faces} 0\n").into_bytes()];
    pieces.extend(lines(vertices, 64, |v, text| {
        let [x, y, z] = surface.positions[v];
        put_float(text, x);
        text.push(b' ');
        put_float(text, y);
        text.push(b' ');
        put_float(text, z);
        if let Some(normals) = normals {
            put_triple(text, normals[v]);
        }
        if let Some(colors) = colors {
            for c in colors[v].into_iter().chain([255]) {
                text.push(b' ');
                put_integer(text, u64::from(c));
            }
        }
        text.push(b'\n');
    }));
    pieces.extend(face_lines(surface.faces, |_, _| ()));
    Ok(Encoded { pieces, notes: vec![] })
}

#[cfg(test)]
mod tests;
