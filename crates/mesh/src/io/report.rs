//! What a reader did besides reading.

use std::fmt;

use crate::io::Format;

/// What was read, and what was split, welded, left out or ignored on the way.
/// Its `Display` says it in a few lines.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ReadReport {
    /// The format of the content.
    pub format: Format,
    /// Whether the file was compressed with gzip.
    pub compressed: bool,
    /// Vertices in the mesh.
    pub vertices: usize,
    /// Faces in the file, of any size, those left out included.
    pub file_faces: usize,
    /// Faces of more than three corners; [`read`](super::read) split them into
    /// triangles.
    pub polygons: usize,
    /// How many faces repeat a corner and are left out.
    pub left_out: usize,
    /// The first of them, at most [`Self::NAMED`], numbered from 0 as in the
    /// file.
    pub first_left_out: Vec<usize>,
    /// Anything else: what the file holds and the mesh does not, one sentence
    /// each.
    pub notes: Vec<String>,
}

impl ReadReport {
    /// How many of the faces left out are named.
    pub const NAMED: usize = 8;
}

impl fmt::Display for ReadReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let packed = if self.compressed { ", gzip-compressed" } else { "" };
        write!(
            f,
            "{}{packed}: {} vertices, {} faces",
            self.format, self.vertices, self.file_faces
        )?;
        if self.polygons > 0 {
            write!(f, "\n{} faces have more than three corners", self.polygons)?;
        }
        if self.left_out > 0 {
            let named: Vec<String> = self.first_left_out.iter().map(usize::to_string).collect();
            let more = if self.left_out > named.len() { ", …" } else { "" };
            let named = named.join(", ");
            write!(f, "\n{} faces repeat a corner and are left out: {named}{more}", self.left_out)?;
        }
        self.notes.iter().try_for_each(|note| write!(f, "\n{note}"))
    }
}
