//! The header of a PLY file.

use crate::io::NumberType;
use crate::io::error::{Fault, Place, ReadProblem, unexpected};
use crate::io::text::shown;

/// The name of the format.
pub(super) const NAME: &str = "PLY";

/// The encoding of the body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Body {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// The type of this name.
fn type_of(name: &[u8]) -> Option<NumberType> {
    Some(match name {
        b"char" | b"int8" => NumberType::I8,
        b"uchar" | b"uint8" => NumberType::U8,
        b"short" | b"int16" => NumberType::I16,
        b"ushort" | b"uint16" => NumberType::U16,
        b"int" | b"int32" => NumberType::I32,
        b"uint" | b"uint32" => NumberType::U32,
        b"float" | b"float32" => NumberType::F32,
        b"double" | b"float64" => NumberType::F64,
        _ => return None,
    })
}

/// The usual name of a type.
pub(super) fn name_of(number: NumberType) -> &'static str {
    match number {
        NumberType::I8 => "char",
        NumberType::U8 => "uchar",
        NumberType::I16 => "short",
        NumberType::U16 => "ushort",
        NumberType::I32 => "int",
        NumberType::U32 => "uint",
        NumberType::F32 => "float",
        NumberType::F64 => "double",
    }
}

/// The values of a property.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Scalar(NumberType),
    List { count: NumberType, item: NumberType },
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Property {
    pub(super) name: String,
    pub(super) kind: Kind,
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
}

impl Element {
    /// The number of bytes of a row in a binary body, if no property is a list.
    pub(super) fn stride(&self) -> Option<usize> {
        self.properties.iter().try_fold(0, |sum, property| match property.kind {
            Kind::Scalar(scalar) => Some(sum + scalar.size()),
            Kind::List { .. } => None,
        })
    }

    pub(super) fn position_of(&self, names: &[&str]) -> Option<usize> {
        self.properties.iter().position(|property| names.contains(&&property.name[..]))
    }

    /// The count as a bound for loops. A count beyond memory is harmless, since the
    /// bytes of the file end first.
    pub(super) fn rows(&self) -> usize {
        usize::try_from(self.count).unwrap_or(usize::MAX)
    }
}

/// The most elements, or properties of an element. Names are checked pair by pair, so
/// a hostile header with many more would take long.
const MAX_NAMES: usize = 4096;

#[derive(Debug)]
pub(super) struct Header {
    pub(super) body: Body,
    pub(super) elements: Vec<Element>,
    /// The start of the body.
    pub(super) length: usize,
    /// The number of lines of the header.
    pub(super) lines: u64,
}

/// An iterator over the lines of a header. The end of the first line (`\n`, `\r\n` or
/// `\r`) holds for all, because a binary body may begin with either byte.
struct Lines<'a> {
    bytes: &'a [u8],
    at: usize,
    number: u64,
    end: &'static [u8],
}

impl<'a> Lines<'a> {
    fn new(bytes: &'a [u8]) -> Self {
        let first = bytes.iter().position(|&b| b == b'\n' || b == b'\r').unwrap_or(bytes.len());
        let end: &[u8] = match &bytes[first..] {
            [b'\r', b'\n', ..] => b"\r\n",
            [b'\r', ..] => b"\r",
            _ => b"\n",
        };
        Self { bytes, at: 0, number: 0, end }
    }

    fn next(&mut self) -> Option<&'a [u8]> {
        let rest = &self.bytes[self.at..];
        let length = rest.windows(self.end.len()).position(|window| window == self.end)?;
        self.at += length + self.end.len();
        self.number += 1;
        Some(&rest[..length])
    }

    fn fault(&self, problem: ReadProblem) -> Fault {
        Fault { at: Place::Line(self.number), problem }
    }
}

pub(super) fn parse(bytes: &[u8]) -> Result<Header, Fault> {
    let mut lines = Lines::new(bytes);
    let mut body = None;
    let mut elements: Vec<Element> = Vec::new();
    if lines.next().map(<[u8]>::trim_ascii) != Some(b"ply") {
        lines.number = 1;
        return Err(lines.fault(unexpected("\"ply\"", shown(&bytes[..bytes.len().min(8)]))));
    }
    loop {
        let Some(line) = lines.next() else {
            let problem = unexpected("end_header", "the end of the file");
            lines.number += 1;
            return Err(lines.fault(problem));
        };
        let mut words = line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
        let keyword = words.next().unwrap_or(b"");
        let words: Vec<&[u8]> = words.collect();
        let found = || shown(line.trim_ascii());
        let statement = match (keyword, &words[..]) {
            (b"comment" | b"obj_info" | b"", _) => Ok(()),
            (b"format", [name, version]) => format(name, version).map(|found| body = Some(found)),
            (b"element", [name, count]) => add_element(&mut elements, name, count),
            (b"property", words) => add_property(&mut elements, words, found),
            (b"end_header", []) => break,
            _ => Err(unexpected("a statement of a PLY header", found())),
        };
        statement.map_err(|problem| lines.fault(problem))?;
    }
    match body {
        Some(body) => Ok(Header { body, elements, length: lines.at, lines: lines.number }),
        None => Err(lines.fault(unexpected("a format before end_header", "none"))),
    }
}

fn format(name: &[u8], version: &[u8]) -> Result<Body, ReadProblem> {
    let body = match name {
        b"ascii" => Body::Ascii,
        b"binary_little_endian" => Body::LittleEndian,
        b"binary_big_endian" => Body::BigEndian,
        _ => {
            let expected = "ascii, binary_little_endian or binary_big_endian";
            return Err(unexpected(expected, shown(name)));
        }
    };
    match version {
        b"1.0" => Ok(body),
        _ => Err(unexpected("version 1.0", shown(version))),
    }
}

fn add_element(elements: &mut Vec<Element>, name: &[u8], count: &[u8]) -> Result<(), ReadProblem> {
    let name = String::from_utf8_lossy(name).into_owned();
    let parsed = std::str::from_utf8(count).ok().and_then(|c| c.parse().ok());
    let Some(count) = parsed else {
        let expected = format!("the number of {name} elements");
        return Err(unexpected(expected, shown(count)));
    };
    if elements.iter().any(|element| element.name == name) {
        return Err(unexpected("elements of different names", format!("a second {name}")));
    }
    if elements.len() >= MAX_NAMES {
        return Err(unexpected(format!("at most {MAX_NAMES} elements"), "more"));
    }
    elements.push(Element { name, count, properties: Vec::new() });
    Ok(())
}

/// Adds a property to the last element; `found` gives the line for messages.
fn add_property(
    elements: &mut [Element],
    words: &[&[u8]],
    found: impl Fn() -> String,
) -> Result<(), ReadProblem> {
    let property = property(words)
        .ok_or_else(|| unexpected("property TYPE NAME or property list TYPE TYPE NAME", found()))?;
    let Some(element) = elements.last_mut() else {
        return Err(unexpected("an element before a property", found()));
    };
    if element.position_of(&[&property.name]).is_some() {
        let found = format!("a second {}", property.name);
        return Err(unexpected("properties of different names", found));
    }
    if element.properties.len() >= MAX_NAMES {
        return Err(unexpected(format!("at most {MAX_NAMES} properties"), "more"));
    }
    element.properties.push(property);
    Ok(())
}

fn property(words: &[&[u8]]) -> Option<Property> {
    let (kind, name) = match words {
        [b"list", count, item, name] => {
            let count = type_of(count).filter(|count| count.is_integer())?;
            (Kind::List { count, item: type_of(item)? }, name)
        }
        [scalar, name] => (Kind::Scalar(type_of(scalar)?), name),
        _ => return None,
    };
    Some(Property { name: String::from_utf8_lossy(name).into_owned(), kind })
}
