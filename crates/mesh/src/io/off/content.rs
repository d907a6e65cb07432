//! The content of OFF, whether text or binary.

use crate::io::parsed::{Broken, FaceList, Parsed};

/// Vertex data announced by the prefixes of the keyword.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Prefixes {
    pub(super) texture: bool,
    pub(super) color: bool,
    pub(super) normal: bool,
    /// Colours precede normals.
    pub(super) color_first: bool,
}

impl Prefixes {
    /// `None` if the letters before `OFF` are not those of a three-dimensional file.
    pub(super) fn from_letters(mut letters: &[u8]) -> Option<Self> {
        let mut found = Self::default();
        while !letters.is_empty() {
            letters = if let Some(rest) = letters.strip_prefix(b"ST") {
                found.texture = true;
                rest
            } else if let Some(rest) = letters.strip_prefix(b"C") {
                found.color = true;
                rest
            } else {
                found.normal = true;
                found.color_first = !found.color;
                letters.strip_prefix(b"N")?
            };
        }
        Some(found)
    }
}

/// The contents of the vertices.
#[derive(Default)]
pub(super) struct Vertices {
    pub(super) broken: Broken,
    pub(super) positions: Vec<[f64; 3]>,
    pub(super) normals: Vec<[f64; 3]>,
    pub(super) colors: Vec<[f64; 3]>,
    pub(super) largest_alpha: f64,
    /// The number of lines with more numbers than the keyword announces.
    pub(super) extra: usize,
}

pub(super) fn finish_faces(
    FaceList { polygons, small, .. }: FaceList,
    colored: usize,
    parsed: &mut Parsed,
) {
    if small > 0 {
        parsed.notes.push(format!("{small} points and segments among the faces are ignored"));
    }
    if colored > 0 {
        parsed.notes.push(format!("the colours of {colored} faces are ignored"));
    }
    parsed.polygons = polygons;
}
