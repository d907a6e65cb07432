//! The numbers of the arrays of a VTP file.

use std::borrow::Cow;
use std::ops::Range;

use base64::Engine;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};

use crate::io::NumberType;
use crate::io::ReadOptions;
use crate::io::error::{Fault, ReadProblem, unexpected};
use crate::io::number_type::word;
use crate::io::text::Cursor;
use crate::io::vtp::document::{Array, ArrayType, Content, Document};

/// The decoder of arrays.
pub(super) struct Decoder<'a> {
    bytes: &'a [u8],
    document: &'a Document,
    /// The most bytes of memory that the arrays to come may take. It bounds compressed data and
    /// arrays that share bytes.
    budget: usize,
}

/// A position in encoded data.
struct Stream<'a> {
    /// The data and the part not yet read.
    data: &'a [u8],
    base64: bool,
    /// The start of `data` in the file.
    start: usize,
    at: usize,
}

/// Accepts padding or none, since headers and data are encoded one after the other.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &base64::alphabet::STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

impl<'a> Decoder<'a> {
    pub(super) fn new(bytes: &'a [u8], document: &'a Document) -> Self {
        Self { bytes, document, budget: ReadOptions::unpacked_limit(bytes.len()) }
    }

    /// The numbers of an array; `expected` is their number, if it is known.
    pub(super) fn floats(
        &mut self,
        array: &Array,
        expected: Option<usize>,
    ) -> Result<Vec<f64>, Fault> {
        let big_endian = self.document.big_endian;
        let decode = |w: &[u8]| match array.kind {
            ArrayType::Number(number) => number.decode(big_endian, w),
            ArrayType::I64 => word(w, 8, big_endian) as i64 as f64,
            ArrayType::U64 => word(w, 8, big_endian) as f64,
        };
        self.numbers(array, expected, |cursor| cursor.float("a number"), decode)
    }

    /// The numbers of an array as integers; one that is too large becomes −1, which no vertex
    /// has.
    pub(super) fn integers(
        &mut self,
        array: &Array,
        expected: Option<usize>,
    ) -> Result<Vec<i64>, Fault> {
        let of_floats = matches!(array.kind, ArrayType::Number(NumberType::F32 | NumberType::F64));
        if of_floats && !matches!(array.content, Content::Text(_)) {
            let problem = unexpected(format!("integers in array {:?}", array.name), "floats");
            return Err(self.fault(array, problem));
        }
        let big_endian = self.document.big_endian;
        let decode = |w: &[u8]| match array.kind {
            ArrayType::Number(number) => number.decode_integer(big_endian, w),
            ArrayType::I64 => word(w, 8, big_endian) as i64,
            ArrayType::U64 => i64::try_from(word(w, 8, big_endian)).unwrap_or(-1),
        };
        self.numbers(array, expected, |cursor| cursor.integer("an integer"), decode)
    }

    /// The numbers of an array of text, or those decoded from its words.
    fn numbers<T>(
        &mut self,
        array: &Array,
        expected: Option<usize>,
        parse: impl Fn(&mut Cursor<'_>) -> Result<T, Fault>,
        decode: impl Fn(&[u8]) -> T,
    ) -> Result<Vec<T>, Fault> {
        if let Content::Text(place) = &array.content {
            let values = self.text(place, parse)?;
            return self.counted(array, values, expected);
        }
        let data = self.data(array)?;
        let size = array.kind.size();
        self.take_budget(array, 8 * (data.len() / size))?;
        self.counted(array, data.chunks_exact(size).map(decode).collect(), expected)
    }

    /// A problem at the element of an array.
    pub(super) fn fault(&self, array: &Array, problem: ReadProblem) -> Fault {
        self.fault_in_element(array.at, problem)
    }

    /// A problem at the element that begins at a byte, perhaps after white space.
    pub(super) fn fault_in_element(&self, at: usize, problem: ReadProblem) -> Fault {
        let from = self.bytes[at..].iter().position(|&b| b == b'<').unwrap_or(0);
        Fault::on_line(self.bytes, at + from, problem)
    }

    /// A problem at a number of an array of text, or at the element of another array.
    pub(super) fn fault_at(&self, array: &Array, number: usize, problem: ReadProblem) -> Fault {
        let Content::Text(place) = &array.content else { return self.fault(array, problem) };
        let mut cursor = Cursor::new(&self.bytes[..place.end], place.start, None);
        for _ in 0..number {
            cursor.token();
        }
        cursor.more();
        cursor.fault(problem)
    }

    fn counted<T>(
        &self,
        array: &Array,
        values: Vec<T>,
        expected: Option<usize>,
    ) -> Result<Vec<T>, Fault> {
        match expected {
            Some(expected) if expected != values.len() => {
                let what = format!("{expected} numbers in array {:?}", array.name);
                Err(self.fault(array, unexpected(what, values.len().to_string())))
            }
            _ => Ok(values),
        }
    }

    fn text<T>(
        &self,
        place: &Range<usize>,
        number: impl Fn(&mut Cursor<'_>) -> Result<T, Fault>,
    ) -> Result<Vec<T>, Fault> {
        let mut cursor = Cursor::new(&self.bytes[..place.end], place.start, None);
        let mut values = Vec::new();
        while cursor.more() {
            values.push(number(&mut cursor)?);
        }
        Ok(values)
    }

    fn take_budget(&mut self, array: &Array, bytes: usize) -> Result<(), Fault> {
        match self.budget.checked_sub(bytes) {
            Some(left) => {
                self.budget = left;
                Ok(())
            }
            None => {
                let (compressed, limit) =
                    (self.bytes.len() as u64, Self::new(self.bytes, self.document).budget as u64);
                Err(self.fault(array, ReadProblem::Grows { compressed, limit }))
            }
        }
    }

    /// The bytes of the numbers of an array that is no text.
    fn data(&mut self, array: &Array) -> Result<Cow<'a, [u8]>, Fault> {
        let mut stream = self.stream(array)?;
        let bad = |stream: &Stream<'_>, what: &str| {
            let expected = format!("{what} of array {:?}", array.name);
            Fault::at_byte(stream.start + stream.at, unexpected(expected, "other content"))
        };
        let word_size = if self.document.long_headers { 8 } else { 4 };
        let header = |stream: &mut Stream<'a>, words: usize| -> Option<Vec<usize>> {
            let bytes = stream.take(words.checked_mul(word_size)?)?;
            let words = bytes.chunks_exact(word_size);
            let words = words.map(|w| word(w, word_size, self.document.big_endian));
            words.map(|w| usize::try_from(w).ok()).collect()
        };
        if !self.document.compressed {
            // The header and the data are one stream.
            let expected = "a header and its number of bytes";
            let read = |stream: &mut Stream<'a>| match stream.base64 {
                false => {
                    let length = header(stream, 1)?[0];
                    stream.take(length)
                }
                true => stream.take_with_header(word_size, self.document.big_endian),
            };
            return read(&mut stream).ok_or_else(|| bad(&stream, expected));
        }
        let blocks = header(&mut stream, 1).ok_or_else(|| bad(&stream, "a header"))?[0];
        // The first number was the beginning of a longer header.
        stream.at = 0;
        let sizes = blocks.checked_add(3).and_then(|words| header(&mut stream, words));
        let sizes = sizes.ok_or_else(|| bad(&stream, "the sizes of compressed blocks"))?;
        let whole = sizes[3..].iter().try_fold(0, |sum: usize, &size| sum.checked_add(size));
        let packed = whole.and_then(|whole| stream.take(whole));
        let packed = packed.ok_or_else(|| bad(&stream, "the compressed blocks"))?;
        let mut unpacked = Vec::new();
        let mut start = 0;
        for (block, &size) in sizes[3..].iter().enumerate() {
            let is_short = block + 1 == blocks && sizes[2] > 0;
            let length = if is_short { sizes[2] } else { sizes[1] };
            self.take_budget(array, length)?;
            inflate(&packed[start..start + size], length, &mut unpacked)
                .map_err(|error| self.fault(array, ReadProblem::Compression(error)))?;
            start += size;
        }
        Ok(Cow::Owned(unpacked))
    }

    fn stream(&self, array: &Array) -> Result<Stream<'a>, Fault> {
        let missing = |expected: &str| {
            let expected = format!("{expected} of array {:?}", array.name);
            self.fault(array, unexpected(expected, "none"))
        };
        match (&array.content, &self.document.appended) {
            (Content::Appended(offset), Some(appended)) => {
                let start = appended.bytes.start.checked_add(*offset);
                let start = start.filter(|&start| start <= appended.bytes.end);
                let start = start.ok_or_else(|| missing("appended data at the offset"))?;
                let data = &self.bytes[start..appended.bytes.end];
                Ok(Stream { data, base64: appended.base64, start, at: 0 })
            }
            (Content::Base64(place), _) => {
                let data = &self.bytes[place.clone()];
                let blank = data.iter().take_while(|b| b.is_ascii_whitespace()).count();
                let start = place.start + blank;
                Ok(Stream { data: &data[blank..], base64: true, start, at: 0 })
            }
            _ => Err(missing("the appended data")),
        }
    }
}

impl<'a> Stream<'a> {
    /// The next `length` bytes: as they are, or a unit of base64 by itself.
    fn take(&mut self, length: usize) -> Option<Cow<'a, [u8]>> {
        if !self.base64 {
            let bytes = self.data[self.at..].get(..length)?;
            self.at += length;
            return Some(Cow::Borrowed(bytes));
        }
        let mut bytes = self.decoded(length)?;
        bytes.truncate(length);
        self.at += length.div_ceil(3) * 4;
        Some(Cow::Owned(bytes))
    }

    /// The data that a header counts, where both are one unit of base64.
    fn take_with_header(&mut self, word_size: usize, big_endian: bool) -> Option<Cow<'a, [u8]>> {
        let header = self.decoded(word_size)?;
        let length = usize::try_from(word(&header, word_size, big_endian)).ok()?;
        // Some writers encode the header by itself.
        let alone = word_size.div_ceil(3) * 4;
        if !word_size.is_multiple_of(3) && self.data.get(alone - 1) == Some(&b'=') {
            self.at = alone;
            return self.take(length);
        }
        let mut bytes = self.decoded(word_size.checked_add(length)?)?;
        bytes.truncate(word_size + length);
        Some(Cow::Owned(bytes.split_off(word_size)))
    }

    /// At least `length` bytes from the place on, in whole groups of four letters.
    fn decoded(&self, length: usize) -> Option<Vec<u8>> {
        let letters = self.data[self.at..].get(..length.div_ceil(3).checked_mul(4)?)?;
        BASE64.decode(letters).ok().filter(|bytes| bytes.len() >= length)
    }
}

/// Appends a block that zlib has compressed, of a known length.
#[cfg(feature = "gzip")]
fn inflate(packed: &[u8], length: usize, unpacked: &mut Vec<u8>) -> std::io::Result<()> {
    use std::io::Read;

    let before = unpacked.len();
    let limit = u64::try_from(length).unwrap_or(u64::MAX).saturating_add(1);
    flate2::read::ZlibDecoder::new(packed).take(limit).read_to_end(unpacked)?;
    match unpacked.len() - before == length {
        true => Ok(()),
        false => Err(std::io::Error::other(format!(
            "a block holds {} bytes and should hold {length}",
            unpacked.len() - before
        ))),
    }
}

#[cfg(not(feature = "gzip"))]
fn inflate(_: &[u8], _: usize, _: &mut Vec<u8>) -> std::io::Result<()> {
    Err(std::io::Error::other("this program was built without the feature gzip"))
}
