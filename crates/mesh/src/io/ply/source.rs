//! The body of a PLY file as a source of numbers, text or binary.

use fairing_watch::parallel;

use crate::io::NumberType;
use crate::io::error::{Fault, ReadProblem, unexpected};
use crate::io::ply::header::Element;
use crate::io::text::Cursor;

/// A source of the numbers of rows.
pub(super) trait Source {
    /// Takes the next number.
    fn float(&mut self, scalar: NumberType, what: &str) -> Result<f64, Fault>;

    /// Takes the next number, which must be an integer.
    fn integer(&mut self, scalar: NumberType, what: &str) -> Result<i64, Fault>;

    /// Skips `count` numbers.
    fn skip(&mut self, scalar: NumberType, count: u64, what: &str) -> Result<(), Fault>;

    /// Ends a row. Values left on a line of text belong to no property: they are
    /// skipped, and such rows are counted.
    fn end_row(&mut self);

    /// The number of rows that are longer than the header says.
    fn long_rows(&self) -> usize;

    /// The number of bytes left, a bound on the number of values to come.
    fn remaining(&self) -> usize;

    /// A problem at the last or the next number.
    fn fault(&self, problem: ReadProblem) -> Fault;

    /// Takes all rows of an element at once, if they are of one size.
    fn take_rows(&mut self, element: &Element) -> Result<Option<Rows<'_>>, Fault>;

    /// Takes `length` bytes of rows, if the body is binary and has them.
    fn peek_rows(&self, stride: usize, count: usize) -> Option<Rows<'_>>;

    /// Skips bytes seen by [`Self::peek_rows`].
    fn advance(&mut self, bytes: usize);

    /// Fails if a binary body goes on here. Text that does is ignored: returns its number of
    /// lines and the first of them.
    fn finish(&mut self) -> Result<Option<(usize, u64)>, Fault>;
}

/// Rows of one size in a binary body.
pub(super) struct Rows<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) stride: usize,
    pub(super) big_endian: bool,
    /// The start of the first row in the file.
    pub(super) start: usize,
}

impl Rows<'_> {
    /// Decodes all rows in parallel, some thousand rows at a time.
    pub(super) fn map<T: Copy + Default + Send>(
        &self,
        decode: impl Fn(&[u8]) -> T + Sync,
    ) -> Vec<T> {
        const PIECE: usize = 1 << 13;
        let mut values = vec![T::default(); self.bytes.len() / self.stride];
        let pieces = self.bytes.chunks(PIECE * self.stride);
        parallel::for_each(values.chunks_mut(PIECE).zip(pieces), |(values, rows)| {
            let rows = rows.chunks_exact(self.stride);
            values.iter_mut().zip(rows).for_each(|(value, row)| *value = decode(row));
        });
        values
    }
}

/// A text body. A row begins on a line of its own and may span several lines.
pub(super) struct AsciiSource<'a> {
    cursor: Cursor<'a>,
    last: Cursor<'a>,
    lines_before: u64,
    long_rows: usize,
}

impl<'a> AsciiSource<'a> {
    /// A source after a header of that many lines.
    pub(super) fn new(body: &'a [u8], header_lines: u64) -> Self {
        let cursor = Cursor::new(body, 0, None);
        Self { last: cursor.clone(), cursor, lines_before: header_lines, long_rows: 0 }
    }

    fn below_header(&self, fault: Fault) -> Fault {
        fault.below(self.lines_before)
    }
}

impl Source for AsciiSource<'_> {
    fn float(&mut self, _: NumberType, what: &str) -> Result<f64, Fault> {
        self.cursor.more();
        self.last = self.cursor.clone();
        self.cursor.float(what).map_err(|fault| self.below_header(fault))
    }

    fn integer(&mut self, scalar: NumberType, what: &str) -> Result<i64, Fault> {
        self.cursor.more();
        self.last = self.cursor.clone();
        let value = self.cursor.integer(what).map_err(|fault| self.below_header(fault))?;
        let fits = match scalar {
            NumberType::I8 => i8::try_from(value).is_ok(),
            NumberType::U8 => u8::try_from(value).is_ok(),
            NumberType::I16 => i16::try_from(value).is_ok(),
            NumberType::U16 => u16::try_from(value).is_ok(),
            NumberType::I32 => i32::try_from(value).is_ok(),
            NumberType::U32 => u32::try_from(value).is_ok(),
            NumberType::F32 | NumberType::F64 => true,
        };
        if !fits {
            let expected = format!("{what} of type {scalar:?}");
            return Err(self.fault(unexpected(expected, value.to_string())));
        }
        Ok(value)
    }

    fn skip(&mut self, scalar: NumberType, count: u64, what: &str) -> Result<(), Fault> {
        for _ in 0..count {
            self.float(scalar, what)?;
        }
        Ok(())
    }

    fn end_row(&mut self) {
        if self.cursor.more_on_line() {
            self.long_rows += 1;
            self.cursor.skip_line();
        }
    }

    fn long_rows(&self) -> usize {
        self.long_rows
    }

    fn remaining(&self) -> usize {
        self.cursor.remaining()
    }

    fn fault(&self, problem: ReadProblem) -> Fault {
        self.below_header(self.last.fault(problem))
    }

    fn take_rows(&mut self, _: &Element) -> Result<Option<Rows<'_>>, Fault> {
        Ok(None)
    }

    fn peek_rows(&self, _: usize, _: usize) -> Option<Rows<'_>> {
        None
    }

    fn advance(&mut self, _: usize) {}

    fn finish(&mut self) -> Result<Option<(usize, u64)>, Fault> {
        if !self.cursor.more() {
            return Ok(None);
        }
        let first = self.lines_before + self.cursor.line();
        let lines = self.cursor.rest().split(|&b| b == b'\n');
        Ok(Some((lines.filter(|line| !line.trim_ascii().is_empty()).count(), first)))
    }
}

/// A binary body.
pub(super) struct BinarySource<'a> {
    bytes: &'a [u8],
    at: usize,
    last: usize,
    big_endian: bool,
}

impl<'a> BinarySource<'a> {
    /// A source from byte `at` of the file on.
    pub(super) fn new(bytes: &'a [u8], at: usize, big_endian: bool) -> Self {
        Self { bytes, at, last: at, big_endian }
    }

    fn take(&mut self, scalar: NumberType, what: &str) -> Result<&'a [u8], Fault> {
        self.last = self.at;
        match self.bytes.get(self.at..self.at + scalar.size()) {
            Some(bytes) => {
                self.at += bytes.len();
                Ok(bytes)
            }
            None => Err(self.fault(unexpected(what, "the end of the file"))),
        }
    }
}

impl Source for BinarySource<'_> {
    fn float(&mut self, scalar: NumberType, what: &str) -> Result<f64, Fault> {
        Ok(scalar.decode(self.big_endian, self.take(scalar, what)?))
    }

    fn integer(&mut self, scalar: NumberType, what: &str) -> Result<i64, Fault> {
        Ok(scalar.decode_integer(self.big_endian, self.take(scalar, what)?))
    }

    fn skip(&mut self, scalar: NumberType, count: u64, what: &str) -> Result<(), Fault> {
        self.last = self.at;
        let length = count.saturating_mul(scalar.size() as u64);
        if length > self.remaining() as u64 {
            let found = format!("{} bytes", self.remaining());
            return Err(self.fault(unexpected(format!("{length} bytes of {what}"), found)));
        }
        self.at += length as usize;
        Ok(())
    }

    fn end_row(&mut self) {}

    fn long_rows(&self) -> usize {
        0
    }

    fn remaining(&self) -> usize {
        self.bytes.len() - self.at
    }

    fn fault(&self, problem: ReadProblem) -> Fault {
        Fault::at_byte(self.last, problem)
    }

    fn take_rows(&mut self, element: &Element) -> Result<Option<Rows<'_>>, Fault> {
        let Some(stride) = element.stride() else { return Ok(None) };
        let start = self.at;
        let length = element.count.saturating_mul(stride as u64);
        if length > self.remaining() as u64 {
            self.last = start;
            let expected = format!("{} rows of {stride} bytes ({})", element.count, element.name);
            let found = format!("{} bytes", self.remaining());
            return Err(self.fault(unexpected(expected, found)));
        }
        self.at += length as usize;
        let bytes = &self.bytes[start..self.at];
        Ok(Some(Rows { bytes, stride, big_endian: self.big_endian, start }))
    }

    fn peek_rows(&self, stride: usize, count: usize) -> Option<Rows<'_>> {
        let bytes = self.bytes[self.at..].get(..stride.checked_mul(count)?)?;
        Some(Rows { bytes, stride, big_endian: self.big_endian, start: self.at })
    }

    fn advance(&mut self, bytes: usize) {
        self.at += bytes;
    }

    fn finish(&mut self) -> Result<Option<(usize, u64)>, Fault> {
        // Some writers end a binary file with a line break.
        let rest = &self.bytes[self.at..];
        if rest.iter().all(u8::is_ascii_whitespace) {
            return Ok(None);
        }
        self.last = self.at;
        let found = format!("{} bytes more", rest.len());
        Err(self.fault(unexpected("the end of the file after the last element", found)))
    }
}
