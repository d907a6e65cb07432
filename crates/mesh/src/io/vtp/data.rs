//! The numbers of the arrays of a VTP file.

use std::borrow::Cow;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use crate::io::error::{Fault, ReadProblem, unexpected};
use crate::io::number_type::word;
use crate::io::text::Cursor;
use crate::io::vtp::document::{Array, ArrayType, Content, Document, fault_in_element};
use crate::io::{NumberType, Reader};

/// The decoder of arrays.
pub(super) struct Decoder<'a> {
    bytes: &'a [u8],
    document: &'a Document,
    /// The most bytes of memory that the arrays to come may take. It bounds compressed data and
    /// arrays that share bytes.
    budget: usize,
}

impl<'a> Decoder<'a> {
    pub(super) fn new(bytes: &'a [u8], document: &'a Document) -> Self {
        Self { bytes, document, budget: Reader::unpacked_limit(bytes.len()) }
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
        let mut values = Vec::new();
        if let Content::Text(place) = &array.content {
            let mut cursor = Cursor::new(&self.bytes[..place.end], place.start, None);
            while cursor.more() {
                values.push(parse(&mut cursor)?);
            }
        } else {
            let data = self.data(array)?;
            let size = array.kind.size();
            self.spend(array, 8 * (data.len() / size))?;
            values.extend(data.chunks_exact(size).map(decode));
        }
        match expected {
            Some(expected) if expected != values.len() => {
                let what = format!("{expected} numbers in array {:?}", array.name);
                Err(self.fault(array, unexpected(what, values.len().to_string())))
            }
            _ => Ok(values),
        }
    }

    /// A problem at the element of an array.
    pub(super) fn fault(&self, array: &Array, problem: ReadProblem) -> Fault {
        self.fault_in_element(array.at, problem)
    }

    /// A problem at the element that begins at a byte, perhaps after white space.
    pub(super) fn fault_in_element(&self, at: usize, problem: ReadProblem) -> Fault {
        fault_in_element(self.bytes, at, problem)
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

    /// Refuses more memory than the limit.
    fn spend(&mut self, array: &Array, bytes: usize) -> Result<(), Fault> {
        let left = self.budget.checked_sub(bytes);
        self.budget = left.ok_or_else(|| {
            let length = self.bytes.len();
            let limit = Reader::unpacked_limit(length) as u64;
            self.fault(array, ReadProblem::Grows { compressed: length as u64, limit })
        })?;
        Ok(())
    }

    /// The bytes of the numbers of an array that is no text.
    fn data(&mut self, array: &Array) -> Result<Cow<'a, [u8]>, Fault> {
        let mut stream = self.stream(array)?;
        let bad = |stream: &Stream<'_>, what: &str| {
            let expected = format!("{what} of array {:?}", array.name);
            Fault::at_byte(stream.at, unexpected(expected, "other content"))
        };
        if !self.document.compressed {
            let data = stream.words(1).and_then(|length| stream.take(length[0]));
            return data.ok_or_else(|| bad(&stream, "a header and its number of bytes"));
        }
        // The number of blocks, the size of each and of a short last one, and their packed sizes.
        let header = stream.words(3).and_then(|sizes| Some((stream.words(sizes[0])?, sizes)));
        let Some((packed_sizes, sizes)) = header else {
            return Err(bad(&stream, "the sizes of compressed blocks"));
        };
        let mut unpacked = Vec::new();
        for (block, &size) in packed_sizes.iter().enumerate() {
            let is_short = block + 1 == packed_sizes.len() && sizes[2] > 0;
            let length = if is_short { sizes[2] } else { sizes[1] };
            let packed = stream.take(size);
            let packed = packed.ok_or_else(|| bad(&stream, "the compressed blocks"))?;
            self.spend(array, length)?;
            inflate(&packed, length, &mut unpacked)
                .map_err(|error| self.fault(array, ReadProblem::Compression(error)))?;
        }
        Ok(Cow::Owned(unpacked))
    }

    fn stream(&self, array: &Array) -> Result<Stream<'a>, Fault> {
        let missing = |expected: &str| {
            let expected = format!("{expected} of array {:?}", array.name);
            self.fault(array, unexpected(expected, "none"))
        };
        let (start, end, base64) = match (&array.content, &self.document.appended) {
            (Content::Appended(offset), Some(appended)) => {
                let start = appended.bytes.start.checked_add(*offset);
                let start = start.filter(|&start| start <= appended.bytes.end);
                let start = start.ok_or_else(|| missing("appended data at the offset"))?;
                (start, appended.bytes.end, appended.base64)
            }
            (Content::Base64(place), _) => {
                let text = &self.bytes[place.clone()];
                (place.end - text.trim_ascii_start().len(), place.end, true)
            }
            _ => return Err(missing("the appended data")),
        };
        let (bytes, document) = (&self.bytes[..end], self.document);
        Ok(Stream { bytes, at: start, base64, decoded: vec![], document })
    }
}

/// A position in data of words and bytes, which may be base64.
struct Stream<'a> {
    /// The file up to the end of the data.
    bytes: &'a [u8],
    at: usize,
    base64: bool,
    /// Bytes of the letters before `at` that are not taken yet.
    decoded: Vec<u8>,
    document: &'a Document,
}

impl<'a> Stream<'a> {
    /// The next numbers of a header.
    fn words(&mut self, count: usize) -> Option<Vec<usize>> {
        let Document { word_size, big_endian, .. } = *self.document;
        let bytes = self.take(count.checked_mul(word_size)?)?;
        let words = bytes.chunks_exact(word_size).map(|w| word(w, word_size, big_endian));
        words.map(|word| usize::try_from(word).ok()).collect()
    }

    /// The next `length` bytes. Some writers encode header and data as one unit of base64, others
    /// one after the other, so that padding may occur between bytes.
    fn take(&mut self, length: usize) -> Option<Cow<'a, [u8]>> {
        if !self.base64 {
            let bytes = self.bytes[self.at..].get(..length)?;
            self.at += length;
            return Some(Cow::Borrowed(bytes));
        }
        let mut bytes = std::mem::take(&mut self.decoded);
        while bytes.len() < length {
            let letters = (length - bytes.len()).div_ceil(3).checked_mul(4)?;
            let letters = self.bytes[self.at..].get(..letters)?;
            let padding = letters.iter().position(|&letter| letter == b'=');
            let end = padding.map_or(letters.len(), |at| at / 4 * 4 + 4);
            STANDARD.decode_vec(&letters[..end], &mut bytes).ok()?;
            self.at += end;
        }
        self.decoded = bytes.split_off(length);
        Some(Cow::Owned(bytes))
    }
}

/// Appends a block that zlib has compressed, of a known length.
#[cfg(feature = "gzip")]
fn inflate(packed: &[u8], length: usize, unpacked: &mut Vec<u8>) -> std::io::Result<()> {
    use std::io::Read;

    let before = unpacked.len();
    let limit = u64::try_from(length).unwrap_or(u64::MAX).saturating_add(1);
    flate2::read::ZlibDecoder::new(packed).take(limit).read_to_end(unpacked)?;
    let found = unpacked.len() - before;
    if found == length {
        return Ok(());
    }
    let problem = format!("a block holds {found} bytes and should hold {length}");
    Err(std::io::Error::other(problem))
}

#[cfg(not(feature = "gzip"))]
fn inflate(_: &[u8], _: usize, _: &mut Vec<u8>) -> std::io::Result<()> {
    Err(std::io::Error::other("this program was built without the feature gzip"))
}
