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

/// The types of arrays by their names.
pub(super) const TYPES: [(&str, ArrayType); 10] = [
    ("Int8", ArrayType::Number(NumberType::I8)),
    ("UInt8", ArrayType::Number(NumberType::U8)),
    ("Int16", ArrayType::Number(NumberType::I16)),
    ("UInt16", ArrayType::Number(NumberType::U16)),
    ("Int32", ArrayType::Number(NumberType::I32)),
    ("UInt32", ArrayType::Number(NumberType::U32)),
    ("Float32", ArrayType::Number(NumberType::F32)),
    ("Float64", ArrayType::Number(NumberType::F64)),
    ("Int64", ArrayType::I64),
    ("UInt64", ArrayType::U64),
];

impl ArrayType {
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

/// The kinds of cells, elements of a piece, in the order in which a piece numbers them.
pub(super) const CELLS: [&str; 4] = ["Verts", "Lines", "Polys", "Strips"];

/// The element of a piece that holds an array.
fn section_of(name: &str) -> Option<&'static str> {
    ["PointData", "CellData", "Points"].into_iter().chain(CELLS).find(|&section| section == name)
}

/// An element `DataArray`.
#[derive(Debug, Clone)]
pub(super) struct Array {
    /// The name of the element around it.
    pub(super) section: &'static str,
    pub(super) name: String,
    pub(super) kind: ArrayType,
    pub(super) components: usize,
    pub(super) content: Content,
    /// The start of the element in the file.
    pub(super) at: usize,
}

/// An element `Piece`.
#[derive(Debug, Clone, Default)]
pub(super) struct Piece {
    pub(super) points: usize,
    /// The number of cells of each kind of [`CELLS`].
    pub(super) cells: [usize; 4],
    pub(super) arrays: Vec<Array>,
    /// The names of the arrays of normals of points and of cells.
    pub(super) normals: [Option<String>; 2],
    /// The start of the element in the file.
    pub(super) at: usize,
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
    /// The number of bytes of each number of a header.
    pub(super) word_size: usize,
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
    /// The place of the element.
    at: usize,
    section: Option<&'static str>,
    /// True in an array whose text has not come yet.
    waiting: bool,
    arrays: usize,
}

/// Reads the elements up to the appended data.
pub(super) fn read(bytes: &[u8]) -> Result<Document, Fault> {
    let mut reader = Reader::from_reader(bytes);
    let document = Document::default();
    let mut walk = Walk { bytes, document, at: 0, section: None, waiting: false, arrays: 0 };
    let mut root = false;
    loop {
        walk.at = usize::try_from(reader.buffer_position()).unwrap_or(bytes.len());
        let event = reader.read_event().map_err(|error| {
            let at = usize::try_from(reader.error_position()).unwrap_or(walk.at);
            Fault::on_line(bytes, at, unexpected("XML", error.to_string()))
        })?;
        match event {
            Event::Start(tag) | Event::Empty(tag) if !root => {
                walk.root(&tag)?;
                root = true;
            }
            Event::Start(tag) if tag.name().as_ref() == "AppendedData" => {
                walk.document.appended = Some(walk.appended(&tag)?);
                return Ok(walk.document);
            }
            Event::Start(tag) => walk.start(&tag)?,
            Event::Empty(tag) => {
                walk.start(&tag)?;
                walk.end(tag.name().as_ref());
            }
            Event::Text(text) if walk.waiting && !text.trim().is_empty() => {
                place_of(&text, bytes).into_iter().for_each(|place| walk.text(place));
            }
            Event::End(tag) => walk.end(tag.name().as_ref()),
            Event::Eof => break,
            _ => {}
        }
    }
    if !root || !bytes.trim_ascii_end().ends_with(b"</VTKFile>") {
        let problem = unexpected("</VTKFile>", "the end of the file");
        return Err(Fault::on_line(bytes, bytes.len(), problem));
    }
    Ok(walk.document)
}

/// The place of a part of the file.
fn place_of(part: &str, bytes: &[u8]) -> Option<Range<usize>> {
    let start = (part.as_ptr() as usize).checked_sub(bytes.as_ptr() as usize)?;
    Some(start..start + part.len()).filter(|place| place.end <= bytes.len())
}

/// A problem at the element that begins at a byte, perhaps after white space.
pub(super) fn fault_in_element(bytes: &[u8], at: usize, problem: ReadProblem) -> Fault {
    let from = bytes[at..].iter().position(|&b| b == b'<').unwrap_or(0);
    Fault::on_line(bytes, at + from, problem)
}

impl Walk<'_> {
    fn unexpected(&self, expected: impl Into<String>, found: impl Into<String>) -> Fault {
        fault_in_element(self.bytes, self.at, unexpected(expected, found))
    }

    fn attribute(&self, tag: &BytesStart<'_>, name: &str) -> Result<Option<String>, Fault> {
        let bad = |found: String| self.unexpected(format!("the attribute {name}"), found);
        let found = tag.try_get_attribute(name).map_err(|error| bad(error.to_string()))?;
        let value = found.map(|attribute| {
            attribute.normalized_value(XmlVersion::Implicit1_0).map(Cow::into_owned)
        });
        value.transpose().map_err(|error| bad(error.to_string()))
    }

    /// The attribute as a count; 0 if it is missing.
    fn count(&self, tag: &BytesStart<'_>, name: &str) -> Result<usize, Fault> {
        self.attribute(tag, name)?.map_or(Ok(0), |text| {
            let expected = || format!("a count as {name}");
            text.trim().parse().map_err(|_| self.unexpected(expected(), format!("{text:?}")))
        })
    }

    /// The meaning of an attribute by a table of its values; the first if it is missing.
    fn choice<T: Clone>(
        &self,
        tag: &BytesStart<'_>,
        name: &str,
        values: &[(&str, T)],
        expected: &str,
    ) -> Result<T, Fault> {
        let Some(found) = self.attribute(tag, name)? else { return Ok(values[0].1.clone()) };
        match values.iter().find(|(value, _)| *value == found) {
            Some((_, meaning)) => Ok(meaning.clone()),
            None => Err(self.unexpected(expected, format!("{found:?}"))),
        }
    }

    fn root(&mut self, tag: &BytesStart<'_>) -> Result<(), Fault> {
        if tag.name().as_ref() != "VTKFile" {
            return Err(self.unexpected("the element VTKFile", tag.name().as_ref().to_owned()));
        }
        let kind = self.attribute(tag, "type")?.unwrap_or_default();
        if kind != "PolyData" {
            return Err(self.unexpected("the type PolyData", format!("{kind:?}")));
        }
        let orders = [("LittleEndian", false), ("BigEndian", true)];
        let expected = "byte_order LittleEndian or BigEndian";
        self.document.big_endian = self.choice(tag, "byte_order", &orders, expected)?;
        let sizes = [("UInt32", 4), ("UInt64", 8)];
        let expected = "header_type UInt32 or UInt64";
        self.document.word_size = self.choice(tag, "header_type", &sizes, expected)?;
        let compressors = [("", false), ("vtkZLibDataCompressor", true)];
        let expected = "data compressed with vtkZLibDataCompressor";
        self.document.compressed = self.choice(tag, "compressor", &compressors, expected)?;
        Ok(())
    }

    fn start(&mut self, tag: &BytesStart<'_>) -> Result<(), Fault> {
        let name = tag.name();
        match (name.as_ref(), self.section) {
            ("Piece", _) => self.piece(tag)?,
            ("DataArray", Some(section)) => self.array(tag, section)?,
            ("DataArray" | "Array", _) => {
                let name = self.attribute(tag, "Name")?.unwrap_or_default();
                self.document.notes.push(format!("the array {name:?} is ignored"));
            }
            (name, _) => {
                self.section = section_of(name).or(self.section);
                let data = ["PointData", "CellData"].into_iter().position(|data| data == name);
                if let Some(which) = data {
                    let normals = self.attribute(tag, "Normals")?;
                    if let Some(piece) = self.document.pieces.last_mut() {
                        piece.normals[which] = normals;
                    }
                }
            }
        }
        Ok(())
    }

    fn end(&mut self, name: &str) {
        self.waiting &= name != "DataArray";
        self.section = self.section.filter(|_| section_of(name).is_none());
    }

    fn counted(&mut self) -> Result<(), Fault> {
        self.arrays += 1;
        if self.arrays > MAX_ARRAYS {
            return Err(self.unexpected(format!("at most {MAX_ARRAYS} arrays and pieces"), "more"));
        }
        Ok(())
    }

    fn piece(&mut self, tag: &BytesStart<'_>) -> Result<(), Fault> {
        self.counted()?;
        let points = self.count(tag, "NumberOfPoints")?;
        let mut piece = Piece { points, at: self.at, ..Piece::default() };
        for (count, kind) in piece.cells.iter_mut().zip(CELLS) {
            *count = self.count(tag, &format!("NumberOf{kind}"))?;
        }
        self.document.pieces.push(piece);
        Ok(())
    }

    fn array(&mut self, tag: &BytesStart<'_>, section: &'static str) -> Result<(), Fault> {
        self.counted()?;
        let name = self.attribute(tag, "Name")?.unwrap_or_default();
        let kind = self.attribute(tag, "type")?.unwrap_or_default();
        let Some(&(_, kind)) = TYPES.iter().find(|(name, _)| *name == kind) else {
            self.document.notes.push(format!("the array {name:?} of type {kind:?} is ignored"));
            return Ok(());
        };
        let components = self.count(tag, "NumberOfComponents")?.max(1);
        let contents = [
            ("ascii", Content::Text(0..0)),
            ("binary", Content::Base64(0..0)),
            ("appended", Content::Appended(0)),
        ];
        let expected = format!("the format ascii, binary or appended of array {name:?}");
        let mut content = self.choice(tag, "format", &contents, &expected)?;
        if let Content::Appended(offset) = &mut content {
            *offset = self.count(tag, "offset")?;
        }
        self.waiting = !matches!(content, Content::Appended(_));
        let Some(piece) = self.document.pieces.last_mut() else {
            return Err(self.unexpected("the element Piece", "DataArray"));
        };
        piece.arrays.push(Array { section, name, kind, components, content, at: self.at });
        Ok(())
    }

    /// The first text in an array holds its numbers.
    fn text(&mut self, range: Range<usize>) {
        self.waiting = false;
        let array = self.document.pieces.last_mut().and_then(|piece| piece.arrays.last_mut());
        if let Some(Content::Text(place) | Content::Base64(place)) =
            array.map(|array| &mut array.content)
        {
            *place = range;
        }
    }

    fn appended(&self, tag: &BytesStart<'_>) -> Result<Appended, Fault> {
        let encodings = [("base64", true), ("raw", false)];
        let expected = "appended data in raw or base64";
        let base64 = self.choice(tag, "encoding", &encodings, expected)?;
        // The bracket that ends the tag follows.
        let start = place_of(tag, self.bytes).map_or(self.at, |place| place.end + 1);
        let whole = self.bytes.trim_ascii_end().strip_suffix(b"</VTKFile>");
        let whole = whole.and_then(|bytes| bytes.trim_ascii_end().strip_suffix(b"</AppendedData>"));
        let Some(whole) = whole.filter(|whole| whole.len() >= start) else {
            let problem = unexpected("</AppendedData></VTKFile> at the end", "other content");
            return Err(Fault::at_byte(self.bytes.len(), problem));
        };
        let Some(mark) = whole[start..].iter().position(|&b| b == b'_') else {
            return Err(self.unexpected("_ before appended data", "none"));
        };
        Ok(Appended { base64, bytes: start + mark + 1..whole.len() })
    }
}
