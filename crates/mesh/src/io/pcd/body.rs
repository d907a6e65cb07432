//! The points of a PCD file.

use crate::io::NumberType;
use crate::io::ReadOptions;
use crate::io::arrays::{MAX_COMPONENTS, NamedArray};
use crate::io::error::{Fault, ReadProblem, unexpected};
use crate::io::number_type::word;
use crate::io::parsed::{Broken, Parsed, check_finite};
use crate::io::pcd::header::{Body, Header, Kind, PADDING, is_packed};
use crate::io::points::of_columns;
use crate::io::text::{Cursor, normalized};

/// The numbers of one field, read or left out.
struct Column<'a> {
    array: NamedArray,
    kind: Kind,
    kept: bool,
    /// The words of packed colours.
    words: Option<Vec<u32>>,
    of: &'a str,
}

pub(super) fn parse(bytes: &[u8], header: &Header, broken: Broken) -> Result<Parsed, Fault> {
    let mut notes = Vec::new();
    let mut columns: Vec<Column<'_>> = header
        .fields
        .iter()
        .map(|field| {
            let (name, components) = (field.name.clone(), field.count);
            let kind = match field.kind {
                Kind::Number(number) => Some(number),
                Kind::I64 | Kind::U64 => None,
            };
            let padding = field.name == PADDING;
            let kept = !padding && components <= MAX_COMPONENTS;
            if !kept && !padding {
                notes.push(format!("the field {name:?} of {components} numbers is ignored"));
            }
            let packed = is_packed(&name) && components == 1 && field.kind.size() == 4;
            Column {
                array: NamedArray { name, kind, components, values: vec![] },
                kind: field.kind,
                kept,
                words: packed.then(Vec::new),
                of: &field.name,
            }
        })
        .collect();
    match header.body {
        Body::Ascii => ascii(&bytes[header.start..], &bytes[..header.start], header, &mut columns)?,
        Body::Binary => binary(bytes, header, &mut columns, &mut notes)?,
        Body::Compressed => compressed(bytes, header, &mut columns)?,
    }
    let is_packed = |column: &Column<'_>| column.words.is_some();
    let colors = columns.iter().position(is_packed).map(|k| {
        let words = columns.remove(k).words.unwrap_or_default();
        words.iter().map(|word| word.to_be_bytes()).map(|[_, r, g, b]| [r, g, b]).collect()
    });
    // Packed colours after the first are numbers like any other.
    for column in &mut columns {
        if let Some(words) = column.words.take() {
            column.array.kind = Some(NumberType::U32);
            column.array.values = words.into_iter().map(f64::from).collect();
        }
    }
    let mut doubts = Vec::new();
    const EXACT: f64 = 9_007_199_254_740_992.0;
    for column in columns.iter_mut().filter(|column| column.array.kind.is_none()) {
        let array = &mut column.array;
        if array.values.iter().any(|x| x.abs() > EXACT) {
            doubts.push(format!("integers of {:?} are rounded to 53 bits", column.of));
        }
        let types = [NumberType::I32, NumberType::U32];
        array.kind = types.into_iter().find(|t| array.values.iter().all(|&x| t.holds(x)));
    }
    let kept = columns.into_iter().filter(|column| column.kept).map(|column| column.array);
    let mut parsed = of_columns(kept.collect(), colors, notes).map_err(Fault::whole)?;
    parsed.doubts = doubts;
    for (point, position) in parsed.positions.iter().enumerate() {
        check_finite(position, point, broken).map_err(Fault::whole)?;
    }
    Ok(parsed)
}

/// Reads points in lines of text.
fn ascii(
    body: &[u8],
    head: &[u8],
    header: &Header,
    columns: &mut [Column<'_>],
) -> Result<(), Fault> {
    let lines = head.iter().filter(|&&b| b == b'\n').count();
    let on_line = |fault: Fault| fault.below(lines as u64);
    let text = normalized(body);
    let mut cursor = Cursor::new(&text, 0, None);
    for _ in 0..header.points {
        for column in &mut *columns {
            for _ in 0..column.array.components {
                let before = cursor.clone();
                let value = cursor.float("a number").map_err(on_line)?;
                if let Some(words) = &mut column.words {
                    words.push(packed(value, column.kind).ok_or_else(|| {
                        let problem = unexpected("a packed colour", value.to_string());
                        on_line(before.fault(problem))
                    })?);
                } else if column.kept {
                    column.array.values.push(value);
                }
            }
        }
    }
    cursor.expect_end(&format!("{} points", header.points)).map_err(on_line)
}

/// The bits of a packed colour that is written as a number.
fn packed(value: f64, kind: Kind) -> Option<u32> {
    match kind {
        Kind::Number(NumberType::F32) => Some((value as f32).to_bits()),
        Kind::Number(NumberType::I32) if NumberType::I32.holds(value) => Some(value as i32 as u32),
        _ => NumberType::U32.holds(value).then_some(value as u32),
    }
}

/// Reads points in rows of bytes.
fn binary(
    bytes: &[u8],
    header: &Header,
    columns: &mut [Column<'_>],
    notes: &mut Vec<String>,
) -> Result<(), Fault> {
    let body = &bytes[header.start..];
    let length = header.points.checked_mul(header.stride).filter(|&length| length <= body.len());
    let Some(length) = length else { return Err(missing(header, header.start, body.len())) };
    if length < body.len() {
        notes.push(format!("{} bytes after the points are ignored", body.len() - length));
    }
    let mut start = 0;
    for column in columns {
        let end = start + column.array.components * column.kind.size();
        column.take(body[..length].chunks_exact(header.stride).map(|row| &row[start..end]));
        start = end;
    }
    Ok(())
}

/// An error about points that are not there.
fn missing(header: &Header, at: usize, found: usize) -> Fault {
    let expected = format!("{} points of {} bytes", header.points, header.stride);
    Fault::at_byte(at, unexpected(expected, format!("{found} bytes")))
}

/// Reads points in compressed bytes, one field after the other.
fn compressed(bytes: &[u8], header: &Header, columns: &mut [Column<'_>]) -> Result<(), Fault> {
    let body = &bytes[header.start..];
    let Some((sizes, packed)) = body.split_at_checked(8) else {
        return Err(Fault::at_byte(header.start, unexpected("the sizes of the data", "the end")));
    };
    let [length, unpacked] = [0, 4].map(|at| word(&sizes[at..], 4, false) as usize);
    let Some(packed) = packed.get(..length) else {
        let found = format!("{} bytes", packed.len());
        return Err(Fault::at_byte(header.start, unexpected(format!("{length} bytes"), found)));
    };
    if header.points.checked_mul(header.stride) != Some(unpacked) {
        return Err(missing(header, header.start + 4, unpacked));
    }
    let at = header.start + 8;
    let body = decompress(packed, unpacked, ReadOptions::unpacked_limit(bytes.len()))
        .map_err(|problem| Fault::at_byte(at, problem))?;
    let mut rest = &body[..];
    for column in columns {
        let size = column.array.components * column.kind.size();
        let (field, after) = rest.split_at(header.points * size);
        column.take(field.chunks_exact(size));
        rest = after;
    }
    Ok(())
}

/// LZF: runs of bytes as they are, and copies of bytes before.
fn decompress(packed: &[u8], length: usize, limit: usize) -> Result<Vec<u8>, ReadProblem> {
    let damaged = || unexpected(format!("{length} bytes in the compression LZF"), "damaged data");
    if length > limit {
        return Err(unexpected("data that fit into memory", format!("{length} bytes")));
    }
    let mut body = Vec::new();
    let mut bytes = packed.iter().map(|&byte| usize::from(byte));
    while let Some(control) = bytes.next() {
        if control < 32 {
            let run = bytes.by_ref().take(control + 1).map(|byte| byte as u8);
            let before = body.len();
            body.extend(run);
            if body.len() - before <= control {
                return Err(damaged());
            }
        } else {
            let mut more = control >> 5;
            if more == 7 {
                more += bytes.next().ok_or_else(damaged)?;
            }
            let low = bytes.next().ok_or_else(damaged)?;
            let back = ((control & 31) << 8 | low) + 1;
            let start = body.len().checked_sub(back).ok_or_else(damaged)?;
            // A copy may reach into itself.
            for k in start..start + more + 2 {
                let byte = body[k];
                body.push(byte);
            }
        }
        if body.len() > length {
            return Err(damaged());
        }
    }
    if body.len() == length { Ok(body) } else { Err(damaged()) }
}

impl Column<'_> {
    /// Takes the numbers of all points, each point's together.
    fn take<'b>(&mut self, points: impl Iterator<Item = &'b [u8]>) {
        if let Some(words) = &mut self.words {
            words.extend(points.map(|point| word(point, 4, false) as u32));
        } else if self.kept {
            let (kind, size) = (self.kind, self.kind.size());
            let decode = |bytes: &[u8]| match kind {
                Kind::Number(number) => number.decode(false, bytes),
                Kind::I64 => word(bytes, 8, false) as i64 as f64,
                Kind::U64 => word(bytes, 8, false) as f64,
            };
            let numbers = points.flat_map(|point| point.chunks_exact(size));
            self.array.values.extend(numbers.map(decode));
        }
    }
}
