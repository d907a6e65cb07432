//! XYZ, points in lines of text.
//!
//! A line has a position and perhaps more numbers, in all lines as many. The first line may name
//! them (after `#` or `//`, or if it begins with `x y z`), or count the points. Without names, six
//! numbers are a position and a unit normal or a colour of bytes, and nine are both.

use crate::io::arrays::NamedArray;
use crate::io::column::columns;
use crate::io::error::{Fault, WriteProblem, unexpected};
use crate::io::number;
use crate::io::number::put_triple;
use crate::io::parsed::{Broken, Parsed, check_finite};
use crate::io::ply::columns::{COLORS, vertex_names};
use crate::io::points::of_columns;
use crate::io::row::{Holds, Row};
use crate::io::surface::{Encoded, Surface, lines};
use crate::io::text::{Cursor, normalized};
use crate::io::{FloatWidth, NumberType, WriteOptions};

const NAME: &str = "XYZ";

pub(super) const FORMAT: Row =
    Row { name: NAME, extensions: &["xyz"], looks_like, parse, encode, holds: Holds::POINTS };

/// The most numbers in a line.
const MAX_COLUMNS: usize = 64;

/// The names of columns in a line, without marks of a comment. Programs write `X Y Z R G B Nx Ny
/// Nz`; in small letters names are kept as they are.
fn names(line: &[u8]) -> Option<Vec<String>> {
    let line = std::str::from_utf8(line).ok()?.trim().trim_start_matches(['#', '/']);
    let mut names: Vec<String> =
        line.split_whitespace().take(MAX_COLUMNS + 1).map(str::to_owned).collect();
    if names.first().is_some_and(|name| name == "X") {
        names.iter_mut().take(3).for_each(|name| name.make_ascii_lowercase());
        for name in &mut names {
            if ["Nx", "Ny", "Nz", "R", "G", "B"].contains(&&name[..]) {
                name.make_ascii_lowercase();
            }
        }
    }
    if !names.iter().take(3).eq(["x", "y", "z"]) || names.len() > MAX_COLUMNS {
        return None;
    }
    if let Some(at) = names.windows(3).position(|three| three == ["r", "g", "b"]) {
        for (name, color) in names[at..].iter_mut().zip(COLORS) {
            *name = color.to_owned();
        }
    }
    Some(names)
}

/// Returns true for a first line of three numbers or more, after a count or not. Three counts, as
/// OFF without its first word begins, have to follow names.
fn looks_like(bytes: &[u8]) -> bool {
    let text = normalized(&bytes[..bytes.len().min(1 << 14)]);
    let (mut named, mut counted) = (false, false);
    for line in text.split(|&b| b == b'\n') {
        let line = line.trim_ascii();
        let names = names(line).is_some();
        named |= names;
        if line.is_empty() || names || is_comment(line) {
            continue;
        }
        let words: Vec<&[u8]> =
            line.split(|&b| number::is_delimiter(b)).filter(|word| !word.is_empty()).collect();
        if words.len() == 1 && !counted && words[0].iter().all(u8::is_ascii_digit) {
            counted = true;
            continue;
        }
        let is_number =
            |word: &&[u8]| number::float(word, 0).is_some_and(|(_, end)| end == word.len());
        let are_counts = words.len() == 3 && words.concat().iter().all(u8::is_ascii_digit);
        return (3..=MAX_COLUMNS).contains(&words.len())
            && words.iter().all(is_number)
            && (named || !are_counts);
    }
    false
}

fn is_comment(line: &[u8]) -> bool {
    line.starts_with(b"#") || line.starts_with(b"//")
}

fn parse(bytes: &[u8], broken: Broken) -> Result<Parsed, Fault> {
    let text = normalized(bytes);
    let mut cursor = Cursor::new(&text, 0, None);
    let mut named = None;
    let mut claimed = None;
    // One number after the other; `width` of each point.
    let (mut values, mut width) = (Vec::new(), 0);
    while cursor.more() {
        if values.is_empty()
            && let Some(found) = names(cursor.rest_of_line())
        {
            named = Some(found);
            cursor.skip_line();
            continue;
        }
        if is_comment(cursor.peek()) {
            cursor.skip_line();
            continue;
        }
        let (start, first) = (cursor.clone(), values.len());
        numbers_of_line(&mut cursor, &mut values)?;
        let count = values.len() - first;
        if first == 0 && count == 1 && claimed.is_none() {
            claimed = values.pop();
            continue;
        }
        if first == 0 {
            width = count;
        }
        if count != width || count < 3 {
            let expected = if first == 0 {
                "three numbers or more".to_owned()
            } else {
                format!("{width} numbers")
            };
            return Err(start.fault(unexpected(expected, count.to_string())));
        }
        let position = [values[first], values[first + 1], values[first + 2]];
        check_finite(&position, first / width, broken).map_err(|problem| start.fault(problem))?;
    }
    let points = values.len().checked_div(width).unwrap_or(0);
    if let Some(claimed) = claimed
        && claimed != points as f64
    {
        let expected = format!("{claimed} points, as the first line says");
        return Err(Fault::whole(unexpected(expected, points.to_string())));
    }
    if points == 0 {
        return Ok(Parsed::default());
    }
    let mut notes = Vec::new();
    let names = match named.filter(|names| names.len() == width) {
        Some(names) => names,
        None => guessed(&values, width, &mut notes),
    };
    let arrays = names.into_iter().enumerate().map(|(k, name)| {
        let values = values.iter().skip(k).step_by(width).copied().collect();
        NamedArray { name, kind: None, components: 1, values }
    });
    of_columns(arrays.collect(), None, notes).map_err(Fault::whole)
}

/// Appends the numbers of a line up to a comment, and goes to the next.
fn numbers_of_line(cursor: &mut Cursor<'_>, values: &mut Vec<f64>) -> Result<(), Fault> {
    let first = values.len();
    while cursor.more_on_line() && !is_comment(cursor.peek()) {
        if values.len() - first == MAX_COLUMNS {
            let expected = format!("at most {MAX_COLUMNS} numbers in a line");
            return Err(cursor.fault(unexpected(expected, "more")));
        }
        let what = if values.len() - first < 3 { "a coordinate" } else { "a number" };
        values.push(cursor.float(what)?);
    }
    cursor.skip_line();
    Ok(())
}

/// Names of columns by their numbers.
fn guessed(values: &[f64], width: usize, notes: &mut Vec<String>) -> Vec<String> {
    let mut names = ["x", "y", "z"].map(str::to_owned).to_vec();
    let triples =
        |at: usize| values.chunks_exact(width).map(move |row| [row[at], row[at + 1], row[at + 2]]);
    let are_units = |at| {
        // Text of three digits is as far from unit length.
        triples(at).all(|v| (v.iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 0.01)
    };
    let are_bytes = |at| triples(at).all(|v| v.iter().all(|&x| NumberType::U8.holds(x)));
    let mut guess = |at: usize| {
        let triple = if are_units(at) {
            ["nx", "ny", "nz"]
        } else if are_bytes(at) {
            ["red", "green", "blue"]
        } else {
            return false;
        };
        let unknown = !names.iter().any(|name| name == triple[0]);
        if unknown {
            names.extend(triple.map(str::to_owned));
        }
        unknown
    };
    let known = match width {
        6 => guess(3),
        9 => guess(3) && guess(6),
        _ => width == 3,
    };
    if !known {
        let first = names.len();
        names.extend((first..width).map(|k| format!("column_{}", k + 1)));
        notes.push(format!("columns {} to {width} have no names", first + 1));
    }
    names
}

/// Lines of `x y z`, or of all fields below a line of their names. Without names, a first line
/// that could be the three counts of OFF gets a decimal point.
fn encode(surface: Surface<'_>, _: &WriteOptions) -> Result<Encoded, WriteProblem> {
    let Surface { positions, fields, .. } = surface;
    let columns = columns(NAME, fields.into(), FloatWidth::Double)?;
    let mut pieces = vec![];
    if !columns.is_empty() {
        pieces.push(format!("# {}\n", vertex_names(fields).join(" ")).into_bytes());
    }
    pieces.extend(lines(positions.len(), 64, |v, text| {
        let start = text.len();
        put_triple(text, positions[v]);
        text.remove(start);
        let is_count = |b: &u8| b.is_ascii_digit() || *b == b' ';
        if v == 0 && columns.is_empty() && text[start..].iter().all(is_count) {
            text.extend_from_slice(b".0");
        }
        columns.iter().for_each(|column| column.write(v, text));
        text.push(b'\n');
    }));
    Ok(Encoded { pieces, notes: vec![] })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::TriMesh;
    use crate::io::tests::read;
    use crate::io::{Format, ReadOptions, VertexFields, read_bytes, to_bytes};

    fn message(text: &str) -> String {
        match parse(text.as_bytes(), Broken::Refused) {
            Ok(_) => panic!("{text:?} was read"),
            Err(fault) => format!("{}{}", fault.at, fault.problem),
        }
    }

    /// The first point of a file without names is told from counts; the others stay as they are.
    #[test]
    fn points_of_counts_are_known_by_content() {
        let points = TriMesh::new(vec![[8.0, 6.0, 12.0], [1.0, 2.0, 3.0]], vec![]).unwrap();
        let options = WriteOptions::default();
        let bytes = to_bytes(Format::Xyz, &points, &VertexFields::default(), &options).unwrap();
        assert_eq!(String::from_utf8_lossy(&bytes), "8 6 12.0\n1 2 3\n");
        let file = read_bytes("", &bytes, &ReadOptions::strict()).unwrap();
        assert_eq!(file.mesh.positions(), points.positions());
    }

    #[test]
    fn columns_are_known_by_names_or_numbers() {
        for (text, scalars, vectors, colors) in [
            ("0 0 .5\n1\t2 3\r\n", &[][..], &[][..], false),
            ("2\n0 0 .5\n1 2 3\n", &[], &[], false),
            ("// a comment\n\n0 0 0.5 0 0.6 0.8\n1 2 3 1 0 0 # last\n", &[], &["normal"], false),
            ("0 0 0.5 0 6 8\n1 2 3 255 0 0\n", &[], &[], true),
            ("0 0 0.5 0 6 8 0 0 1\n1 2 3 255 0 0 0 1 0\n", &[], &["normal"], true),
            ("0 0 0.5 7\n1 2 3 -1\n", &["column_4"], &[], false),
            ("0 0 0.5 7 .5 0\n1 2 3 0 0 0\n", &["column_4", "column_5", "column_6"], &[], false),
            ("X Y Z q R G B\n0 0 0.5 9 1 2 3\n1 2 3 9 0 0 0\n", &["q"], &[], true),
            ("#x y z d_x d_y d_z\n0 0 0.5 9 1 2\n1 2 3 0 0 0\n", &[], &["d"], false),
        ] {
            let file = read("", text.as_bytes());
            assert_eq!(file.mesh.positions(), [[0.0, 0.0, 0.5], [1.0, 2.0, 3.0]], "{text}");
            let fields = &file.fields;
            assert!(fields.scalars.iter().map(|(name, _)| name).eq(scalars), "{text}");
            assert!(fields.vectors.iter().map(|(name, _)| name).eq(vectors), "{text}");
            assert_eq!(fields.colors.is_some(), colors, "{text}");
            let unnamed =
                usize::from(scalars.first().is_some_and(|name| name.starts_with("column")));
            assert_eq!(file.report.notes.len(), unnamed, "{text}");
        }
    }

    #[test]
    fn errors_name_the_line() {
        for (text, expected) in [
            ("0 0 0.5\n0 0\n", "line 2: expected 3 numbers, found 2"),
            ("0 0.5\n", "line 1: expected three numbers or more, found 2"),
            ("0 0 x\n", "line 1: expected a coordinate, found \"x\""),
            ("3\n\nC 0 0 0\n", "line 3: expected a coordinate, found \"C\""),
            ("0 0 0.5 1\n\n0 0 1 y\n", "line 3: expected a number, found \"y\""),
            ("0 0 0.5\n0 nan 0\n", "line 2: vertex 1 has the coordinate NaN"),
            ("3\n0 0 0.5\n", "expected 3 points, as the first line says, found 1"),
        ] {
            let message = message(text);
            assert!(message.contains(expected), "{text:?}: {message}");
        }
    }

    /// OFF without its first word, which the name tells.
    #[test]
    fn counts_are_no_point() {
        assert!(!looks_like(b"3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"));
        assert_eq!(read("a.off", b"3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n").mesh.face_count(), 1);
        assert_eq!(read("a.xyz", b"3 1 0\n0 0 0\n1 0 0\n").mesh.vertex_count(), 3);
    }
}
