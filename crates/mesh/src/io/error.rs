//! Why a file cannot be read or written.

use crate::build::BuildError;
use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

/// Why a file cannot be read: which file, where in it, and what is wrong.
#[derive(Debug, thiserror::Error)]
#[error("{}: {at}{problem}", file.display())]
#[non_exhaustive]
pub struct ReadError {
    /// The file, as it was named by the caller.
    pub file: PathBuf,
    /// Where in the file; in the decompressed bytes if the file is compressed.
    pub at: Place,
    /// What is wrong.
    pub problem: ReadProblem,
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

/// What is wrong with a file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadProblem {
    /// The operating system cannot read it.
    #[error("cannot be read: {0}")]
    Io(#[from] io::Error),
    /// The file has no content, or nothing but white space and comments.
    #[error("the file is empty")]
    Empty,
    /// A sound file without a single vertex.
    #[error("the file holds no vertices")]
    NoVertices,
    /// The content is of another kind than the file extension says.
    #[error("the name says {extension}, but the content is {content}")]
    OtherKind {
        /// What the file extension says.
        extension: String,
        /// What the content is.
        content: String,
    },
    /// Neither the file extension nor the content is of a known format.
    #[error("expected one of the formats {}, found {found}", known.join(", "))]
    UnknownKind {
        /// The names of the known formats.
        known: Vec<&'static str>,
        /// How the content begins.
        found: String,
    },
    /// The format requires something else here.
    #[error("expected {expected}, found {found}")]
    Unexpected {
        /// What the format requires.
        expected: String,
        /// What is there.
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
        /// The index it names, from 0 whatever the format counts from.
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
        /// How many there are.
        count: u64,
    },
    /// The compressed data are damaged.
    #[error("cannot be decompressed: {0}")]
    Compression(io::Error),
    /// Decompression yields more than [`ReadOptions`](super::ReadOptions) allows.
    #[error("{compressed} compressed bytes unpack to more than {limit} bytes, the limit")]
    Grows {
        /// The size of the file.
        compressed: u64,
        /// The most bytes it may unpack to.
        limit: u64,
    },
    /// Something a lenient reader leaves out and reports, and a strict one
    /// refuses.
    #[error("refused by strict reading: {0}")]
    Strict(String),
}

/// A problem and its place, before the file's name is known.
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
        let before = &text[..offset.min(text.len())];
        let line = before.iter().filter(|&&b| b == b'\n').count() as u64 + 1;
        Self { at: Place::Line(line), problem }
    }

    pub(crate) fn at_byte(offset: usize, problem: ReadProblem) -> Self {
        Self { at: Place::Byte(offset as u64), problem }
    }

    /// The same problem, that many bytes further on; lines do not change.
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

/// Shorthand for the commonest problem.
pub(crate) fn unexpected(expected: impl Into<String>, found: impl Into<String>) -> ReadProblem {
    ReadProblem::Unexpected { expected: expected.into(), found: found.into() }
}

/// Why a mesh cannot be written.
#[derive(Debug, thiserror::Error)]
#[error("{}: {problem}", file.display())]
#[non_exhaustive]
pub struct WriteError {
    /// The file that was to be written; it is left as it was.
    pub file: PathBuf,
    /// What is wrong.
    pub problem: WriteProblem,
}

/// What keeps a mesh from being written.
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
    /// The format has no place for these fields.
    #[error("{format} cannot hold {}; write PLY, or ask for fields to be dropped", fields.join(", "))]
    UnsupportedFields {
        /// The name of the format.
        format: &'static str,
        /// The fields it has no place for.
        fields: Vec<String>,
    },
    /// The format cannot hold the mesh itself.
    #[error("{format} cannot hold {what}")]
    UnsupportedMesh {
        /// The name of the format.
        format: &'static str,
        /// What it has no place for.
        what: String,
    },
    /// A field has more or fewer values than there are vertices.
    #[error("field {field} has {found} values for {expected} vertices")]
    FieldLength {
        /// The name of the field.
        field: String,
        /// The number of vertices.
        expected: usize,
        /// The number of values.
        found: usize,
    },
    /// A field holds an infinite value or one that is not a number.
    #[error("field {field} is {value} at vertex {vertex}, which is not finite")]
    FieldNonFinite {
        /// The name of the field.
        field: String,
        /// The vertex.
        vertex: usize,
        /// The value.
        value: f64,
    },
    /// The name of a field is empty, contains white space, or would be read back as
    /// something else.
    #[error("field name {name:?}: {reason}")]
    FieldName {
        /// The name.
        name: String,
        /// Why it will not do.
        reason: &'static str,
    },
}
