//! The header of a PCD file.

use crate::io::NumberType;
use crate::io::error::{Fault, unexpected};
use crate::io::text::Cursor;

/// The name of the format.
pub(super) const NAME: &str = "PCD";

/// The name of padding.
pub(super) const PADDING: &str = "_";

/// Returns true for the name of colours in one word.
pub(super) fn is_packed(name: &str) -> bool {
    matches!(name, "rgb" | "rgba")
}

/// The form of the points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Body {
    Ascii,
    Binary,
    Compressed,
}

/// The type of a number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Kind {
    Number(NumberType),
    /// Integers of 64 bits.
    I64,
    U64,
}

impl Kind {
    pub(super) fn size(self) -> usize {
        match self {
            Self::Number(number) => number.size(),
            Self::I64 | Self::U64 => 8,
        }
    }
}

/// Numbers of each point under one name.
#[derive(Debug, PartialEq)]
pub(super) struct Field {
    pub(super) name: String,
    pub(super) kind: Kind,
    pub(super) count: usize,
}

/// The header of a file.
#[derive(Debug)]
pub(super) struct Header {
    pub(super) fields: Vec<Field>,
    pub(super) points: usize,
    pub(super) body: Body,
    /// The place of the points.
    pub(super) start: usize,
    /// The sizes of all fields together, in bytes.
    pub(super) stride: usize,
}

/// The lines of a header as they come.
#[derive(Default)]
struct Lines<'a> {
    names: Vec<&'a [u8]>,
    sizes: Vec<u64>,
    types: Vec<&'a [u8]>,
    counts: Vec<u64>,
    size: [Option<u64>; 2],
    points: Option<u64>,
}

pub(super) fn parse(bytes: &[u8]) -> Result<Header, Fault> {
    let mut cursor = Cursor::new(bytes, 0, Some(b'#'));
    let mut lines = Lines::default();
    let body = loop {
        cursor.more();
        let at = cursor.clone();
        match cursor.token() {
            Some(b"VERSION" | b"VIEWPOINT") => cursor.skip_line(),
            Some(b"FIELDS" | b"COLUMNS") => lines.names = words(&mut cursor),
            Some(b"SIZE") => lines.sizes = counts(&mut cursor, "a size")?,
            Some(b"TYPE") => lines.types = words(&mut cursor),
            Some(b"COUNT") => lines.counts = counts(&mut cursor, "a count")?,
            Some(b"WIDTH") => lines.size[0] = Some(cursor.count("the width")?),
            Some(b"HEIGHT") => lines.size[1] = Some(cursor.count("the height")?),
            Some(b"POINTS") => lines.points = Some(cursor.count("the number of points")?),
            Some(b"DATA") => {
                let at = cursor.clone();
                match words(&mut cursor)[..] {
                    [b"ascii"] => break Body::Ascii,
                    [b"binary"] => break Body::Binary,
                    [b"binary_compressed"] => break Body::Compressed,
                    _ => {
                        let expected = "ascii, binary or binary_compressed";
                        return Err(at.fault(unexpected(expected, at.found())));
                    }
                }
            }
            _ => {
                let expected = "a line of the header of PCD, up to DATA";
                return Err(at.fault(unexpected(expected, at.found())));
            }
        }
    };
    // The points begin after the line of DATA.
    let start = (bytes.len() - cursor.remaining() + 1).min(bytes.len());
    let points = lines.points(&cursor)?;
    let fields = lines.fields(&cursor)?;
    let sizes = fields.iter().map(|field| field.kind.size().checked_mul(field.count));
    let stride = sizes.reduce(|a, b| a?.checked_add(b?)).flatten();
    let Some(stride) = stride else {
        return Err(cursor.fault(unexpected("fields of a point", "none, or too many")));
    };
    Ok(Header { fields, points, body, start, stride })
}

/// The other words of the line.
fn words<'a>(cursor: &mut Cursor<'a>) -> Vec<&'a [u8]> {
    let mut words = Vec::new();
    while cursor.more_on_line() {
        words.extend(cursor.token());
    }
    words
}

fn counts(cursor: &mut Cursor<'_>, what: &str) -> Result<Vec<u64>, Fault> {
    let mut counts = Vec::new();
    while cursor.more_on_line() {
        counts.push(cursor.count(what)?);
    }
    Ok(counts)
}

impl Lines<'_> {
    fn points(&self, cursor: &Cursor<'_>) -> Result<usize, Fault> {
        let product = match self.size {
            [Some(width), Some(height)] => width.checked_mul(height),
            [width, _] => width,
        };
        let points = self.points.or(product);
        if let (Some(points), Some(product)) = (points, product)
            && points != product
        {
            let expected = format!("{points} points, as POINTS says");
            return Err(cursor.fault(unexpected(expected, format!("WIDTH × HEIGHT of {product}"))));
        }
        let points = points.and_then(|points| usize::try_from(points).ok());
        points.ok_or_else(|| cursor.fault(unexpected("POINTS in the header", "none")))
    }

    fn fields(&self, cursor: &Cursor<'_>) -> Result<Vec<Field>, Fault> {
        let fields = self.names.len();
        let ones = vec![1; fields];
        let counts = if self.counts.is_empty() { &ones } else { &self.counts };
        for (line, found) in
            [("SIZE", self.sizes.len()), ("TYPE", self.types.len()), ("COUNT", counts.len())]
        {
            if found != fields {
                let expected = format!("{fields} words of {line}, one for each field");
                return Err(cursor.fault(unexpected(expected, found.to_string())));
            }
        }
        let field = |k: usize| {
            let (kind, size) = (self.types[k], self.sizes[k]);
            let kind = match (kind, size) {
                (b"I", 1) => Kind::Number(NumberType::I8),
                (b"U", 1) => Kind::Number(NumberType::U8),
                (b"I", 2) => Kind::Number(NumberType::I16),
                (b"U", 2) => Kind::Number(NumberType::U16),
                (b"I", 4) => Kind::Number(NumberType::I32),
                (b"U", 4) => Kind::Number(NumberType::U32),
                (b"F", 4) => Kind::Number(NumberType::F32),
                (b"F", 8) => Kind::Number(NumberType::F64),
                (b"I", 8) => Kind::I64,
                (b"U", 8) => Kind::U64,
                _ => {
                    let found = format!("{} of {size}", String::from_utf8_lossy(kind));
                    let expected = "the type I, U or F of 1, 2, 4 or 8 bytes";
                    return Err(cursor.fault(unexpected(expected, found)));
                }
            };
            let count = usize::try_from(counts[k]).unwrap_or(usize::MAX);
            if count == 0 {
                return Err(cursor.fault(unexpected("a COUNT of 1 or more", "0")));
            }
            let name = String::from_utf8_lossy(self.names[k]).into_owned();
            Ok(Field { name, kind, count })
        };
        (0..fields).map(field).collect()
    }
}
