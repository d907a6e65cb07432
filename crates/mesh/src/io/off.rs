//! OFF, the object file format of Geomview.
//!
//! The keyword `[ST][C][N]OFF`; the counts of vertices, faces and edges; a line per
//! vertex (position, then normal, colour and texture coordinates if the prefixes
//! announce them); and a line per face (count, indices, optional colour). Comments
//! begin with `#` anywhere.

use crate::io::error::{Fault, WriteProblem, unexpected};
use crate::io::number::{put_float, put_integer, put_triple};
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

/// Vertex data announced by the prefixes of the keyword.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
struct Prefixes {
    texture: bool,
    color: bool,
    normal: bool,
}

impl Prefixes {
    /// `None` if the token is not the keyword of a three-dimensional OFF file.
    fn from_keyword(keyword: &[u8]) -> Option<Self> {
        let rest = keyword.strip_suffix(b"OFF")?;
        let (texture, rest) = strip(rest, b"ST");
        let (color, rest) = strip(rest, b"C");
        let (normal, rest) = strip(rest, b"N");
        rest.is_empty().then_some(Self { texture, color, normal })
    }
}

fn strip<'a>(bytes: &'a [u8], prefix: &[u8]) -> (bool, &'a [u8]) {
    bytes.strip_prefix(prefix).map_or((false, bytes), |rest| (true, rest))
}

/// Returns true if the first token ends in `OFF`.
fn looks_like(bytes: &[u8]) -> bool {
    let mut cursor = Cursor::new(bytes, 0, Some(b'#'));
    let token = cursor.token().unwrap_or_default();
    token.len() <= 8 && token.is_ascii() && token.ends_with(b"OFF")
}

/// Parses a file, with or without the keyword.
fn parse(bytes: &[u8], broken: Broken) -> Result<Parsed, Fault> {
    let text = normalized(bytes);
    let mut cursor = Cursor::new(&text, 0, Some(b'#'));
    cursor.more();
    let keyword = cursor.peek();
    let prefixes = if keyword.first().is_some_and(u8::is_ascii_digit) && !keyword.ends_with(b"OFF")
    {
        Prefixes::default()
    } else {
        let Some(prefixes) = Prefixes::from_keyword(keyword) else {
            let expected = "OFF, perhaps with the prefixes ST, C, N";
            return Err(cursor.fault(unexpected(expected, shown(keyword))));
        };
        cursor.token();
        if cursor.more() && cursor.peek() == b"BINARY" {
            return Err(cursor.fault(unexpected("an OFF file in text", "\"BINARY\"")));
        }
        prefixes
    };
    let vertex_count = cursor.count("the number of vertices")?;
    let face_count = cursor.count("the number of faces")?;
    // Some writers omit the number of edges, which is not used. It is on the
    // same line as the faces or on its own.
    let mut ahead = cursor.clone();
    if cursor.more_on_line() || (ahead.token().is_some() && !ahead.more_on_line()) {
        cursor.count("the number of edges")?;
    }

    let mut parsed = Parsed::default();
    parse_vertices(&mut cursor, vertex_count, prefixes, broken, &mut parsed)?;
    parse_faces(&mut cursor, face_count, broken, &mut parsed)?;
    cursor.expect_end(&format!("{vertex_count} vertices and {face_count} faces"))?;
    Ok(parsed)
}

/// The contents of the lines of vertices.
#[derive(Default)]
struct VertexLines {
    broken: Broken,
    positions: Vec<[f64; 3]>,
    normals: Vec<[f64; 3]>,
    colors: Vec<[f64; 3]>,
    largest_alpha: f64,
    /// The number of lines with more numbers than the keyword announces.
    extra: usize,
}

impl VertexLines {
    fn parse(&mut self, cursor: &mut Cursor<'_>, prefixes: Prefixes) -> Result<(), Fault> {
        let line = cursor.clone();
        let position = triple(cursor, "a coordinate")?;
        check_finite(&position, self.positions.len(), self.broken)
            .map_err(|problem| line.fault(problem))?;
        self.positions.push(position);
        if prefixes.normal {
            self.normals.push(triple(cursor, "a component of the normal")?);
        }
        if prefixes.color {
            // Three or four numbers, then two of texture if announced.
            let (mut values, mut found) = ([0.0; 4], 0);
            while found < 4 && cursor.more_on_line() {
                values[found] = cursor.float("a colour")?;
                found += 1;
            }
            if found < 3 {
                return Err(cursor.fault(unexpected("three or four colours", cursor.found())));
            }
            self.colors.push([values[0], values[1], values[2]]);
            self.largest_alpha = self.largest_alpha.max(values[3]);
        }
        if cursor.more_on_line() {
            self.extra += usize::from(!prefixes.texture);
            cursor.skip_line();
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
    parsed: &mut Parsed,
) -> Result<(), Fault> {
    // A vertex takes six bytes or more, which bounds the memory that a false
    // count reserves.
    let room = (cursor.remaining() / 6).min(usize::try_from(count).unwrap_or(usize::MAX));
    let mut lines =
        VertexLines { positions: Vec::with_capacity(room), broken, ..Default::default() };
    while (lines.positions.len() as u64) < count {
        if !cursor.more() {
            let found = format!("{} and then the end", lines.positions.len());
            return Err(cursor.fault(unexpected(format!("{count} vertices"), found)));
        }
        lines.parse(cursor, prefixes)?;
    }
    lines.finish(prefixes, parsed);
    Ok(())
}

/// Parses three numbers on one line.
fn triple(cursor: &mut Cursor<'_>, what: &str) -> Result<[f64; 3], Fault> {
    let mut triple = [0.0; 3];
    for x in &mut triple {
        if !cursor.more_on_line() {
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
            if !cursor.more_on_line() {
                let expected = format!("{size} corners in face {face}");
                return Err(cursor.fault(unexpected(expected, corner.to_string())));
            }
            let at = cursor.clone();
            let index = cursor.integer("the index of a vertex")?;
            faces.corner(index).map_err(|problem| at.fault(problem))?;
        }
        faces.end().map_err(|problem| line.fault(problem))?;
        if cursor.more_on_line() {
            colored += 1;
            cursor.skip_line();
        }
    }
    let FaceList { polygons, small, .. } = faces;
    if small > 0 {
        parsed.notes.push(format!("{small} points and segments among the faces are ignored"));
    }
    if colored > 0 {
        parsed.notes.push(format!("the colours of {colored} faces are ignored"));
    }
    parsed.polygons = polygons;
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
mod tests {
    use super::*;
    use crate::polygon::Polygons;

    fn parsed(text: &str) -> Parsed {
        parse(text.as_bytes(), Broken::Refused)
            .unwrap_or_else(|fault| panic!("{text:?}: {fault:?}"))
    }

    fn message(text: &str) -> String {
        match parse(text.as_bytes(), Broken::Refused) {
            Ok(_) => panic!("{text:?} was read"),
            Err(fault) => format!("{}{}", fault.at, fault.problem),
        }
    }

    #[test]
    fn counts_and_comments_stand_anywhere() {
        for text in [
            "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
            "OFF 3 1 0\r\n0 0 0\r\n1 0 0\r\n0 1 0\r\n3 0 1 2",
            "# c\n OFF # c\n\n3 1\n# c\n0 0 0 # c\n\n1 0 0\n0 1 0\n3 0 1 2 255 0 0\n# end",
            "3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
            "OFF\n3\n1\n0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
        ] {
            let parsed = parsed(text);
            assert_eq!(parsed.positions, [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], "{text}");
            assert_eq!(parsed.polygons, Polygons::Triangles(vec![[0, 1, 2]]), "{text}");
        }
    }

    #[test]
    fn prefixes_say_what_follows_a_position() {
        let parsed = parsed("STCNOFF 1 0 0\n1 2 3  0 0 1  0.2 0.4 1 0.5  0 1\n");
        assert_eq!(parsed.positions, [[1.0, 2.0, 3.0]]);
        assert_eq!(parsed.fields.vector("normal"), Some(&[[0.0, 0.0, 1.0]][..]));
        assert_eq!(parsed.fields.colors, Some(vec![[51, 102, 255]]));
        assert_eq!(parsed.notes.len(), 1);
        let colors =
            super::parse(b"COFF\n2 0 0\n0 0 0 1 2 255\n0 0 1 0 0 1 255\n", Broken::Refused)
                .unwrap();
        assert_eq!(colors.fields.colors, Some(vec![[1, 2, 255], [0, 0, 1]]));
    }

    #[test]
    fn errors_name_the_line() {
        for (text, expected) in [
            (
                "OFF\n4 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
                "line 7: expected 1 faces, found 0 and then the end",
            ),
            (
                "OFF\n2 1 0\n0 0 0\n1 0 0\n0 1 0\n",
                "line 5: expected three corners or more in face 0, found 0",
            ),
            (
                "OFF\n1 1 0\n0 0 0\n3 0 1 2\n",
                "line 4: face 0 names vertex 1 (counted from 0), but there are 1",
            ),
            ("OFF\n1 1 0\n0 0 0\n3 0 -1 2\n", "line 4: face 0 names vertex -1"),
            ("OFF\n1 0 0\n0 nan 0\n", "line 3: vertex 0 has the coordinate NaN"),
            ("OFF\n1 0 0\n0 1e999 0\n", "line 3: vertex 0 has the coordinate inf"),
            ("OFF\n1 0 0\n0 x 0\n", "line 3: expected a coordinate, found \"x\""),
            ("OFF\n1 0 0\n0 0\n0", "line 3: expected a coordinate, found the end of the line"),
            (
                "OFF\n9999999999 0 0\n0 0 0\n",
                "expected 9999999999 vertices, found 1 and then the end",
            ),
            ("OFF\n1 0 0\n0 0 0\n0 0 0\n", "line 4: expected the end of the file"),
            (
                "OFF\n1 99999999999 0\n0 0 0\n",
                "expected 99999999999 faces, found 0 and then the end",
            ),
            ("OFF\n-1 0 0\n", "line 2: expected the number of vertices, found -1"),
            ("4OFF\n1 0 0\n", "line 1: expected OFF"),
            ("OFF BINARY\n\0\0", "line 1: expected an OFF file in text"),
            ("OFF", "expected the number of vertices, found the end of the file"),
        ] {
            let message = message(text);
            assert!(message.contains(expected), "{text:?}: {message}");
        }
    }
}
