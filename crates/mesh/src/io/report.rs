//! What a reader did besides reading.

use std::fmt;

use crate::io::Format;

/// What was read, and what was split, reduced, welded, left out or ignored on
/// the way.
/// Its `Display` says it in a few lines.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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
    /// How many faces repeat a corner and are kept with their distinct corners,
    /// in the order in which they are first named.
    pub reduced: usize,
    /// The first of them, at most [`Self::NAMED`], numbered from 0 as in the
    /// file.
    pub first_reduced: Vec<usize>,
    /// How many faces repeat a corner, have fewer than three distinct ones and
    /// are left out.
    pub left_out: usize,
    /// The first of them, at most [`Self::NAMED`], numbered from 0 as in the
    /// file.
    pub first_left_out: Vec<usize>,
    /// The number of vertices whose positions are not finite. They are in no
    /// face, at the place of the first sound vertex.
    pub broken_vertices: usize,
    /// The first of them, at most [`Self::NAMED`].
    pub first_broken_vertices: Vec<usize>,
    /// The number of faces that name such a vertex, or one that is not there, and are
    /// left out.
    pub broken_faces: usize,
    /// The first of them, at most [`Self::NAMED`], numbered from 0 as in the
    /// file.
    pub first_broken_faces: Vec<usize>,
    /// Anything else: what the file holds and the mesh does not, one sentence
    /// each.
    pub notes: Vec<String>,
}

impl ReadReport {
    /// The number of faces and vertices of each kind that are named.
    pub const NAMED: usize = 8;

    /// How many faces are read: those of the file but the ones left out.
    pub fn faces(&self) -> usize {
        self.file_faces - self.left_out - self.broken_faces
    }
}

impl fmt::Display for ReadReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let packed = if self.compressed { ", gzip-compressed" } else { "" };
        write!(f, "{}{packed}: {} vertices, {} faces", self.format, self.vertices, self.faces())?;
        if self.polygons > 0 {
            write!(f, "\n{} faces have more than three corners", self.polygons)?;
        }
        let mut some = |count: usize, first: &[usize], what: &str| {
            if count == 0 {
                return Ok(());
            }
            let named: Vec<String> = first.iter().map(usize::to_string).collect();
            let more = if count > named.len() { ", …" } else { "" };
            write!(f, "\n{count} {what}: {}{more}", named.join(", "))
        };
        let reduced = "faces repeat a corner and are reduced to their distinct corners";
        some(self.reduced, &self.first_reduced, reduced)?;
        let left_out = "faces repeat a corner and are left out, having fewer than three";
        some(self.left_out, &self.first_left_out, left_out)?;
        let vertices = "vertices are not finite and stand in no face, where the first sound one is";
        some(self.broken_vertices, &self.first_broken_vertices, vertices)?;
        let faces = "faces are left out, which name such vertices or some that are not there";
        some(self.broken_faces, &self.first_broken_faces, faces)?;
        self.notes.iter().try_for_each(|note| write!(f, "\n{note}"))
    }
}

/// What was written, and what was not.
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct WriteReport {
    /// The format.
    pub format: Format,
    /// The size of the file before compression.
    pub bytes: usize,
    /// The fields that were dropped because the options allow it.
    pub dropped: Vec<String>,
    /// What else the format could not hold: an order of vertices, isolated
    /// ones, digits.
    pub notes: Vec<String>,
}
