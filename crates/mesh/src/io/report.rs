//! Reports of reading and writing.

use std::fmt;

use crate::io::Format;

/// A summary of a file and of the content that was split, reduced, welded, left
/// out or ignored.
///
/// `Display` writes a few lines.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct ReadReport {
    /// The format of the content.
    pub format: Format,
    /// True if the file was compressed with gzip.
    pub compressed: bool,
    /// The number of vertices in the mesh.
    pub vertices: usize,
    /// The number of faces in the file, of any size, including faces left out.
    pub file_faces: usize,
    /// The number of faces of more than three corners, which the mesh
    /// [keeps](crate::TriMesh::polygons) beside its triangles.
    pub polygons: usize,
    /// The number of faces that repeat a corner and are reduced to their distinct
    /// corners, in order of first appearance.
    pub reduced: usize,
    /// The first reduced faces, at most [`Self::NAMED`], numbered from 0 as in the
    /// file.
    pub first_reduced: Vec<usize>,
    /// The number of faces left out because they repeat a corner and have fewer
    /// than three distinct ones.
    pub left_out: usize,
    /// The first of these, at most [`Self::NAMED`], numbered from 0 as in the
    /// file.
    pub first_left_out: Vec<usize>,
    /// The number of vertices whose positions are not finite. Such a vertex is at
    /// the position of the first sound vertex and belongs to no face.
    pub broken_vertices: usize,
    /// The first broken vertices, at most [`Self::NAMED`].
    pub first_broken_vertices: Vec<usize>,
    /// The number of faces left out because they have a broken vertex or an index
    /// without a vertex.
    pub broken_faces: usize,
    /// The first broken faces, at most [`Self::NAMED`], numbered from 0 as in the
    /// file.
    pub first_broken_faces: Vec<usize>,
    /// Other content of the file that the mesh does not hold, one sentence each.
    pub notes: Vec<String>,
}

impl ReadReport {
    /// The most faces or vertices of each kind that are listed.
    pub const NAMED: usize = 8;

    /// The number of faces read: all faces of the file except those left out.
    pub fn faces(&self) -> usize {
        self.file_faces - self.left_out - self.broken_faces
    }
}

impl fmt::Display for ReadReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let packed = if self.compressed { ", gzip-compressed" } else { "" };
        let (vertices, faces) = (self.vertices, self.faces());
        let of_vertices = if vertices == 1 { "vertex" } else { "vertices" };
        let of_faces = if faces == 1 { "face" } else { "faces" };
        write!(f, "{}{packed}: {vertices} {of_vertices}, {faces} {of_faces}", self.format)?;
        match self.polygons {
            0 => {}
            1 => write!(f, "\n1 face has more than three corners")?,
            count => write!(f, "\n{count} faces have more than three corners")?,
        }
        // The elements of a kind, with the words for one and for several.
        let mut some = |count: usize, first: &[usize], one: &str, several: &str| {
            if count == 0 {
                return Ok(());
            }
            let named: Vec<String> = first.iter().map(usize::to_string).collect();
            let more = if count > named.len() { ", …" } else { "" };
            let what = if count == 1 { one } else { several };
            write!(f, "\n{count} {what}: {}{more}", named.join(", "))
        };
        some(
            self.reduced,
            &self.first_reduced,
            "face repeats a corner and is reduced to its distinct corners",
            "faces repeat a corner and are reduced to their distinct corners",
        )?;
        some(
            self.left_out,
            &self.first_left_out,
            "face repeats a corner and is left out, with fewer than three distinct ones",
            "faces repeat a corner and are left out, with fewer than three distinct ones",
        )?;
        some(
            self.broken_vertices,
            &self.first_broken_vertices,
            "vertex is not finite: moved to the first sound vertex, in no face",
            "vertices are not finite: moved to the first sound vertex, in no face",
        )?;
        some(
            self.broken_faces,
            &self.first_broken_faces,
            "face is left out because it names a vertex that is missing or not finite",
            "faces are left out because they name a vertex that is missing or not finite",
        )?;
        self.notes.iter().try_for_each(|note| write!(f, "\n{note}"))
    }
}

/// A summary of a file that was written, and of the content that it does not hold.
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct WriteReport {
    /// The format.
    pub format: Format,
    /// The size of the file before compression.
    pub bytes: usize,
    /// The fields left out, which [`UnsupportedFields::Drop`](super::UnsupportedFields) allows.
    pub dropped: Vec<String>,
    /// The number of faces of more than three corners that were written as triangles.
    pub split_polygons: usize,
    /// Other content that the format cannot hold: the order of vertices, isolated
    /// vertices, digits.
    pub notes: Vec<String>,
}
