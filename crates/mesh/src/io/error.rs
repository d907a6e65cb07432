//! Errors of reading and writing.

use crate::build::BuildError;
use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

/// A failure to read: the file, the place in it and the problem.
#[derive(Debug, thiserror::Error)]
#[error("{}: {at}{problem}", file.display())]
#[non_exhaustive]
pub struct ReadError {
    /// The file name as given by the caller.
    pub file: PathBuf,
    /// The position in the file; in the decompressed content if the file is compressed.
    pub at: Place,
    /// The problem.
    pub problem: ReadProblem,
}

impl ReadError {
    /// A problem of the file as a whole.
    pub fn new(file: impl Into<PathBuf>, problem: ReadProblem) -> Self {
        Self { file: file.into(), at: Place::Whole, problem }
    }
}

/// A place in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Place {
    /// The file as a whole.
    Whole,
    /// A line of a text file, from 1.
    Line(u64),
    /// A byte of a binary file, from 0.
    Byte(u64),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Whole => Ok(()),
            Self::Line(line) => write!(f, "line {line}: "),
            Self::Byte(byte) => write!(f, "byte {byte}: "),
        }
    }
}

/// A problem of a file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadProblem {
    /// The operating system cannot read it.
    #[error("cannot be read: {0}")]
    Io(#[from] io::Error),
    /// The file has no content but white space.
    #[error("the file is empty")]
    Empty,
    /// The file has no vertex.
    #[error("the file holds no vertices")]
    NoVertices,
    /// The content contradicts the file extension.
    #[error("the name says {extension}, but the content is {content}")]
    OtherKind {
        /// The kind by file extension.
        extension: String,
        /// The kind by content.
        content: String,
    },
    /// Neither the file extension nor the content is of a known format.
    #[error("expected one of the formats {}, found {found}", known.join(", "))]
    UnknownKind {
        /// The names of the known formats.
        known: Vec<&'static str>,
        /// The kind of the content, or its beginning.
        found: String,
    },
    /// The format requires other content here.
    #[error("expected {expected}, found {found}")]
    Unexpected {
        /// The content that the format requires.
        expected: String,
        /// The content found.
        found: String,
    },
    /// A coordinate is infinite or not a number.
    #[error("vertex {vertex} has the coordinate {value}, which is not finite")]
    NonFinite {
        /// The vertex, from 0.
        vertex: u64,
        /// The coordinate.
        value: f64,
    },
    /// A face names a vertex that does not exist.
    #[error(
        "face {face} names vertex {index} (counted from 0), but there are {vertex_count} vertices"
    )]
    IndexOutOfRange {
        /// The face, from 0.
        face: u64,
        /// The index, counted from 0 in every format.
        index: i64,
        /// The number of vertices.
        vertex_count: u64,
    },
    /// The positions do not make a mesh: their extent is out of range.
    #[error(transparent)]
    Mesh(BuildError),
    /// More vertices or corners than `u32` can number.
    #[error("{count} {what} are more than 32-bit indices can number")]
    TooLarge {
        /// `vertices` or `corners`.
        what: &'static str,
        /// Their number.
        count: u64,
    },
    /// The compressed data are damaged.
    #[error("cannot be decompressed: {0}")]
    Compression(io::Error),
    /// The file or stream exceeds the limit of [`Reader`](super::Reader).
    #[error("there are more than {limit} bytes, the limit")]
    TooLong {
        /// The largest number of bytes read.
        limit: u64,
    },
    /// The decompressed content exceeds the limit of [`Reader`](super::Reader).
    #[error("{compressed} compressed bytes unpack to more than {limit} bytes, the limit")]
    Grows {
        /// The size of the file.
        compressed: u64,
        /// The largest number of bytes that it may unpack to.
        limit: u64,
    },
    /// Content that lenient reading leaves out and reports, and strict reading
    /// refuses.
    #[error("refused by strict reading: {0}")]
    Strict(String),
}

/// A problem and its place, in a file not yet named.
#[derive(Debug)]
pub(crate) struct Fault {
    pub(crate) at: Place,
    pub(crate) problem: ReadProblem,
}

impl Fault {
    pub(crate) fn whole(problem: ReadProblem) -> Self {
        Self { at: Place::Whole, problem }
    }

    /// A problem on the line of a text that holds byte `offset`.
    pub(crate) fn on_line(text: &[u8], offset: usize, problem: ReadProblem) -> Self {
        Self { at: Place::Line(line_of(text, offset)), problem }
    }

    pub(crate) fn at_byte(offset: usize, problem: ReadProblem) -> Self {
        Self { at: Place::Byte(offset as u64), problem }
    }

    /// Moves the place down by a number of lines; that of a byte does not change.
    pub(crate) fn below(mut self, lines: u64) -> Self {
        if let Place::Line(line) = &mut self.at {
            *line += lines;
        }
        self
    }

    /// Moves the place on by a number of bytes; a line number does not change.
    pub(crate) fn moved(mut self, bytes: usize) -> Self {
        if let Place::Byte(offset) = &mut self.at {
            *offset += bytes as u64;
        }
        self
    }

    pub(crate) fn in_file(self, file: &Path) -> ReadError {
        ReadError { file: file.to_owned(), at: self.at, problem: self.problem }
    }
}

impl From<io::Error> for Fault {
    fn from(error: io::Error) -> Self {
        Self::whole(ReadProblem::Io(error))
    }
}

/// The number of the line of byte `offset`, from 1.
pub(crate) fn line_of(text: &[u8], offset: usize) -> u64 {
    let before = &text[..offset.min(text.len())];
    before.iter().filter(|&&b| b == b'\n').count() as u64 + 1
}

/// Shorthand for [`ReadProblem::Unexpected`].
pub(crate) fn unexpected(expected: impl Into<String>, found: impl Into<String>) -> ReadProblem {
    ReadProblem::Unexpected { expected: expected.into(), found: found.into() }
}

/// A failure to write: the file and the problem.
#[derive(Debug, thiserror::Error)]
#[error("{}: {problem}", file.display())]
#[non_exhaustive]
pub struct WriteError {
    /// The output file, which is left as it was.
    pub file: PathBuf,
    /// The problem.
    pub problem: WriteProblem,
}

impl WriteError {
    /// A problem of writing this file.
    pub fn new(file: impl Into<PathBuf>, problem: WriteProblem) -> Self {
        Self { file: file.into(), problem }
    }
}

/// A reason why a mesh cannot be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteProblem {
    /// The operating system cannot write it.
    #[error("cannot be written: {0}")]
    Io(#[from] io::Error),
    /// The file extension is not that of a known format.
    #[error("the file extension must be .{}, optionally followed by .gz", known.join(" or ."))]
    UnknownExtension {
        /// The usual file extension of each format.
        known: Vec<&'static str>,
    },
    /// The format cannot hold these fields.
    #[error("{format} cannot hold {}; write PLY, or ask for fields to be dropped", fields.join(", "))]
    UnsupportedFields {
        /// The name of the format.
        format: &'static str,
        /// The names of the fields.
        fields: Vec<String>,
    },
    /// The format cannot hold the mesh itself.
    #[error("{format} cannot hold {what}")]
    UnsupportedMesh {
        /// The name of the format.
        format: &'static str,
        /// The part of the mesh that the format cannot hold.
        what: String,
    },
    /// The number of values of a field is not that of its elements.
    #[error("field {field} has {found} values for {expected} {elements}")]
    FieldLength {
        /// The name of the field.
        field: String,
        /// `vertices`, `faces` or `corners`.
        elements: &'static str,
        /// The number of elements.
        expected: usize,
        /// The number of values.
        found: usize,
    },
    /// A value of a field is infinite or not a number.
    #[error("field {field} is {value} at {element} {index}, which is not finite")]
    FieldNonFinite {
        /// The name of the field.
        field: String,
        /// `vertex`, `face` or `corner`.
        element: &'static str,
        /// The number of the element.
        index: usize,
        /// The value.
        value: f64,
    },
    /// The name of a field is empty, has control characters, or is that of another one.
    #[error("field name {name:?}: {reason}")]
    FieldName {
        /// The name.
        name: String,
        /// The rule that the name breaks.
        reason: &'static str,
    },
}
