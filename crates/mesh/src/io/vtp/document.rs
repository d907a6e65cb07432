//! The structure of a VTP file, without the numbers.

use std::borrow::Cow;
use std::ops::Range;

use quick_xml::events::{BytesStart, Event};
use quick_xml::{Reader, XmlVersion};

use crate::io::NumberType;
use crate::io::error::{Fault, ReadProblem, unexpected};

/// The name of the format.
pub(super) const NAME: &str = "VTP";
/// The name of the array of colours.
pub(super) const COLORS: &str = "RGB";

/// The type of the numbers of an array.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ArrayType {
    Number(NumberType),
    I64,
    U64,
}

impl ArrayType {
    fn from_name(name: &str) -> Option<Self> {
        Some(match name {
            "Int8" => Self::Number(NumberType::I8),
            "UInt8" => Self::Number(NumberType::U8),
            "Int16" => Self::Number(NumberType::I16),
            "UInt16" => Self::Number(NumberType::U16),
            "Int32" => Self::Number(NumberType::I32),
            "UInt32" => Self::Number(NumberType::U32),
            "Float32" => Self::Number(NumberType::F32),
            "Float64" => Self::Number(NumberType::F64),
            "Int64" => Self::I64,
            "UInt64" => Self::U64,
            _ => return None,
        })
    }

    /// The number of bytes.
    pub(super) fn size(self) -> usize {
        match self {
            Self::Number(number) => number.size(),
            Self::I64 | Self::U64 => 8,
        }
    }
}

/// The place of the numbers of an array.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Content {
    /// Text between these bytes of the file.
    Text(Range<usize>),
    /// Base64 between these bytes of the file.
    Base64(Range<usize>),
    /// An offset into the appended data.
    Appended(usize),
}

/// An element `DataArray`.
#[derive(Debug, Clone)]
pub(super) struct Array {
    pub(super) name: String,
    pub(super) kind: ArrayType,
    pub(super) components: usize,
    pub(super) content: Content,
    /// The start of the element in the file.
    pub(super) at: usize,
}

/// The parts of a piece that hold arrays.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Section {
    PointData,
    CellData,
    Points,
    Verts,
    Lines,
    Strips,
    Polys,
}

impl Section {
    fn from_name(name: &str) -> Option<Self> {
        Some(match name {
            "PointData" => Self::PointData,
            "CellData" => Self::CellData,
            "Points" => Self::Points,
            "Verts" => Self::Verts,
            "Lines" => Self::Lines,
            "Strips" => Self::Strips,
            "Polys" => Self::Polys,
            _ => return None,
        })
    }
}

/// An element `Piece`.
#[derive(Debug, Clone, Default)]
pub(super) struct Piece {
    pub(super) points: usize,
    pub(super) verts: usize,
    pub(super) lines: usize,
    pub(super) strips: usize,
    pub(super) polys: usize,
    pub(super) arrays: Vec<(Section, Array)>,
    /// The names of the arrays of normals of points and of cells.
    pub(super) normals: [Option<String>; 2],
    /// The start of the element in the file.
    pub(super) at: usize,
}

impl Piece {
    /// The array of this name in a section.
    pub(super) fn array(&self, section: Section, name: &str) -> Option<&Array> {
        let mut arrays = self.arrays.iter().filter(|(s, _)| *s == section);
        arrays.find(|(_, array)| array.name == name).map(|(_, array)| array)
    }
}

/// The appended data.
#[derive(Debug, Clone)]
pub(super) struct Appended {
    pub(super) base64: bool,
    /// From after the underscore to the end of the element.
    pub(super) bytes: Range<usize>,
}

/// A file without its numbers.
#[derive(Debug, Clone, Default)]
pub(super) struct Document {
    pub(super) big_endian: bool,
    /// True if headers of data are of 64 bits.
    pub(super) long_headers: bool,
    pub(super) compressed: bool,
    pub(super) pieces: Vec<Piece>,
    pub(super) appended: Option<Appended>,
    /// Content that is ignored.
    pub(super) notes: Vec<String>,
}

/// The most arrays and pieces of a file.
const MAX_ARRAYS: usize = 4096;

/// A walk through the elements.
struct Walk<'a> {
    bytes: &'a [u8],
    document: Document,
    section: Option<Section>,
    /// The array whose text comes next.
    waiting: bool,
    arrays: usize,
}

/// Reads the elements up to the appended data.
pub(super) fn read(bytes: &[u8]) -> Result<Document, Fault> {
    let mut reader = Reader::from_reader(bytes);
    let walk =
        Walk { bytes, document: Document::default(), section: None, waiting: false, arrays: 0 };
    let mut walk = walk;
    let mut root = false;
    loop {
        let before = usize::try_from(reader.buffer_position()).unwrap_or(bytes.len());
        let event = reader.read_event().map_err(|error| {
            let at = usize::try_from(reader.error_position()).unwrap_or(before);
            Fault::on_line(bytes, at, unexpected("XML", error.to_string()))
        })?;
        match event {
            Event::Start(tag) | Event::Empty(tag) if !root => {
                walk.root(&tag, before)?;
                root = true;
            }
            Event::Start(tag) if tag.name().as_ref() == "AppendedData" => {
                walk.appended(&tag, before)?;
                return Ok(walk.document);
            }
            Event::Start(tag) => walk.start(&tag, before)?,
            Event::Empty(tag) => {
                walk.start(&tag, before)?;
                walk.waiting = false;
                walk.section = walk.section.filter(|_| tag.name().as_ref() == "DataArray");
            }
            Event::Text(text) if walk.waiting && !text.trim().is_empty() => {
                if let Some(place) = place_of(&text, bytes) {
                    walk.text(place);
                }
            }
            Event::End(tag) => match tag.name().as_ref() {
                "DataArray" => walk.waiting = false,
                name if Section::from_name(name).is_some() => walk.section = None,
                _ => {}
            },
            Event::Eof => break,
            _ => {}
        }
    }
    if !root || !bytes.trim_ascii_end().ends_with(b"</VTKFile>") {
        return Err(Fault::on_line(
            bytes,
            bytes.len(),
            unexpected("</VTKFile>", "the end of the file"),
        ));
    }
    Ok(walk.document)
}

/// The place of a part of the file.
fn place_of(part: &str, bytes: &[u8]) -> Option<Range<usize>> {
    let start = (part.as_ptr() as usize).checked_sub(bytes.as_ptr() as usize)?;
    Some(start..start + part.len()).filter(|place| place.end <= bytes.len())
}

impl Walk<'_> {
    fn fault(&self, at: usize, problem: ReadProblem) -> Fault {
        // The text between two elements comes before the second.
        let from = self.bytes[at..].iter().position(|&b| b == b'<').unwrap_or(0);
        Fault::on_line(self.bytes, at + from, problem)
    }

    fn attribute(
        &self,
        tag: &BytesStart<'_>,
        name: &str,
        at: usize,
    ) -> Result<Option<String>, Fault> {
        let bad =
            |found: String| self.fault(at, unexpected(format!("the attribute {name}"), found));
        let found = tag.try_get_attribute(name).map_err(|error| bad(error.to_string()))?;
        let value = found.map(|attribute| {
            attribute.normalized_value(XmlVersion::Implicit1_0).map(Cow::into_owned)
        });
        value.transpose().map_err(|error| bad(error.to_string()))
    }

    /// The attribute as a count; 0 if it is missing.
    fn count(&self, tag: &BytesStart<'_>, name: &str, at: usize) -> Result<usize, Fault> {
        match self.attribute(tag, name, at)? {
            None => Ok(0),
            Some(text) => text.trim().parse().map_err(|_| {
                self.fault(at, unexpected(format!("a count as {name}"), format!("{text:?}")))
            }),
        }
    }

    fn root(&mut self, tag: &BytesStart<'_>, at: usize) -> Result<(), Fault> {
        let expect =
            |expected: &str, found: String| Err(self.fault(at, unexpected(expected, found)));
        if tag.name().as_ref() != "VTKFile" {
            return expect("the element VTKFile", tag.name().as_ref().to_owned());
        }
        let of = |name| self.attribute(tag, name, at);
        match of("type")?.as_deref() {
            Some("PolyData") => {}
            other => return expect("the type PolyData", format!("{:?}", other.unwrap_or(""))),
        }
        let big_endian = match of("byte_order")?.as_deref() {
            None | Some("LittleEndian") => false,
            Some("BigEndian") => true,
            Some(other) => {
                return expect("byte_order LittleEndian or BigEndian", format!("{other:?}"));
            }
        };
        let long_headers = match of("header_type")?.as_deref() {
            None | Some("UInt32") => false,
            Some("UInt64") => true,
            Some(other) => return expect("header_type UInt32 or UInt64", format!("{other:?}")),
        };
        let compressed = match of("compressor")?.as_deref() {
            None | Some("") => false,
            Some("vtkZLibDataCompressor") => true,
            Some(other) => {
                return expect("data compressed with vtkZLibDataCompressor", format!("{other:?}"));
            }
        };
        self.document = Document { big_endian, long_headers, compressed, ..Document::default() };
        Ok(())
    }

    fn start(&mut self, tag: &BytesStart<'_>, at: usize) -> Result<(), Fault> {
        let name = tag.name();
        let name = name.as_ref();
        if name == "Piece" {
            return self.piece(tag, at);
        }
        if let Some(section) = Section::from_name(name) {
            self.section = Some(section);
            let which = match section {
                Section::PointData => 0,
                Section::CellData => 1,
                _ => return Ok(()),
            };
            let normals = self.attribute(tag, "Normals", at)?;
            if let Some(piece) = self.document.pieces.last_mut() {
                piece.normals[which] = normals;
            }
            return Ok(());
        }
        match (name, self.section) {
            ("DataArray", Some(section)) => self.array(tag, section, at),
            ("DataArray" | "Array", _) => {
                let name = self.attribute(tag, "Name", at)?.unwrap_or_default();
                self.document.notes.push(format!("the array {name:?} is ignored"));
                Ok(())
            }
            _ => Ok(()),
        }
    }

    fn counted(&mut self, at: usize) -> Result<(), Fault> {
        self.arrays += 1;
        if self.arrays > MAX_ARRAYS {
            let expected = format!("at most {MAX_ARRAYS} arrays and pieces");
            return Err(self.fault(at, unexpected(expected, "more")));
        }
        Ok(())
    }

    fn piece(&mut self, tag: &BytesStart<'_>, at: usize) -> Result<(), Fault> {
        self.counted(at)?;
        let piece = Piece {
            points: self.count(tag, "NumberOfPoints", at)?,
            verts: self.count(tag, "NumberOfVerts", at)?,
            lines: self.count(tag, "NumberOfLines", at)?,
            strips: self.count(tag, "NumberOfStrips", at)?,
            polys: self.count(tag, "NumberOfPolys", at)?,
            at,
            ..Piece::default()
        };
        self.document.pieces.push(piece);
        Ok(())
    }

    fn array(&mut self, tag: &BytesStart<'_>, section: Section, at: usize) -> Result<(), Fault> {
        self.counted(at)?;
        let name = self.attribute(tag, "Name", at)?.unwrap_or_default();
        let kind = self.attribute(tag, "type", at)?.unwrap_or_default();
        let Some(kind) = ArrayType::from_name(&kind) else {
            self.document.notes.push(format!("the array {name:?} of type {kind:?} is ignored"));
            return Ok(());
        };
        let components = self.count(tag, "NumberOfComponents", at)?.max(1);
        let content = match self.attribute(tag, "format", at)?.as_deref() {
            None | Some("ascii") => Content::Text(0..0),
            Some("binary") => Content::Base64(0..0),
            Some("appended") => Content::Appended(self.count(tag, "offset", at)?),
            Some(other) => {
                let expected = format!("the format ascii, binary or appended of array {name:?}");
                return Err(self.fault(at, unexpected(expected, format!("{other:?}"))));
            }
        };
        self.waiting = !matches!(content, Content::Appended(_));
        let Some(piece) = self.document.pieces.last_mut() else {
            return Err(self.fault(at, unexpected("the element Piece", "DataArray")));
        };
        piece.arrays.push((section, Array { name, kind, components, content, at }));
        Ok(())
    }

    /// The first text in an array holds its numbers.
    fn text(&mut self, range: Range<usize>) {
        self.waiting = false;
        let arrays = self.document.pieces.last_mut().map(|piece| &mut piece.arrays);
        if let Some((_, array)) = arrays.and_then(|arrays| arrays.last_mut()) {
            match &mut array.content {
                Content::Text(place) | Content::Base64(place) => *place = range,
                Content::Appended(_) => {}
            }
        }
    }

    fn appended(&mut self, tag: &BytesStart<'_>, at: usize) -> Result<(), Fault> {
        let base64 = match self.attribute(tag, "encoding", at)?.as_deref() {
            Some("raw") => false,
            None | Some("base64") => true,
            Some(other) => {
                let problem = unexpected("appended data in raw or base64", format!("{other:?}"));
                return Err(self.fault(at, problem));
            }
        };
        // The bracket that ends the tag follows.
        let start = place_of(tag, self.bytes).map_or(at, |place| place.end + 1);
        let whole = self.bytes.trim_ascii_end().strip_suffix(b"</VTKFile>");
        let whole = whole.and_then(|bytes| bytes.trim_ascii_end().strip_suffix(b"</AppendedData>"));
        let Some(whole) = whole.filter(|whole| whole.len() >= start) else {
            let problem = unexpected("</AppendedData></VTKFile> at the end", "other content");
            return Err(Fault::at_byte(self.bytes.len(), problem));
        };
        let Some(mark) = whole[start..].iter().position(|&b| b == b'_') else {
            return Err(self.fault(at, unexpected("_ before appended data", "none")));
        };
        self.document.appended = Some(Appended { base64, bytes: start + mark + 1..whole.len() });
        Ok(())
    }
}
