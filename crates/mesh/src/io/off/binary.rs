//! The contents of OFF files, and their binary form, as Geomview describes it.
//!
//! The three counts; for each vertex position, normal, colour with alpha and texture coordinates
//! as announced; for each face the number of corners, their vertices, the number of values of its
//! colour and these. All are big-endian numbers of 32 bits.

use crate::io::error::{Fault, unexpected};
use crate::io::parsed::{Broken, FaceList, Parsed, check_finite};

/// Numbers of four bytes.
struct Words<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Words<'_> {
    /// Fails unless that many elements of some words each are left.
    fn require(&self, count: usize, words: usize, what: &str) -> Result<(), Fault> {
        let left = self.bytes.len() - self.at;
        if count.checked_mul(4 * words).is_none_or(|length| length > left) {
            let problem = unexpected(format!("{count} {what}"), format!("{left} bytes"));
            return Err(Fault::at_byte(self.at, problem));
        }
        Ok(())
    }

    fn word(&mut self, what: &str) -> Result<[u8; 4], Fault> {
        let Some(&word) = self.bytes[self.at..].first_chunk() else {
            return Err(Fault::at_byte(self.at, unexpected(what, "the end of the file")));
        };
        self.at += 4;
        Ok(word)
    }

    fn count(&mut self, what: &str) -> Result<usize, Fault> {
        let value = i32::from_be_bytes(self.word(what)?);
        usize::try_from(value)
            .map_err(|_| Fault::at_byte(self.at - 4, unexpected(what, value.to_string())))
    }

    fn floats<const N: usize>(&mut self, what: &str) -> Result<[f64; N], Fault> {
        let mut floats = [0.0; N];
        for x in &mut floats {
            *x = f64::from(f32::from_be_bytes(self.word(what)?));
        }
        Ok(floats)
    }
}

/// Parses what follows the word `BINARY`, which ends at byte `at`.
pub(super) fn parse(
    bytes: &[u8],
    at: usize,
    prefixes: Prefixes,
    broken: Broken,
) -> Result<Parsed, Fault> {
    let length = match bytes[at..] {
        [b'\r', b'\n', ..] => 2,
        [b'\n', ..] => 1,
        _ => return Err(Fault::at_byte(at, unexpected("a line break after BINARY", "none"))),
    };
    let mut words = Words { bytes, at: at + length };
    let vertex_count = words.count("the number of vertices")?;
    let face_count = words.count("the number of faces")?;
    words.word("the number of edges")?;
    let mut parsed = Parsed::default();
    vertices(&mut words, vertex_count, prefixes, broken, &mut parsed)?;
    faces(&mut words, face_count, broken, &mut parsed)?;
    let rest = &bytes[words.at..];
    if !rest.iter().all(u8::is_ascii_whitespace) {
        let expected = format!("the end after {vertex_count} vertices and {face_count} faces");
        let found = format!("{} bytes more", rest.len());
        return Err(Fault::at_byte(words.at, unexpected(expected, found)));
    }
    Ok(parsed)
}

fn vertices(
    words: &mut Words<'_>,
    count: usize,
    prefixes: Prefixes,
    broken: Broken,
    parsed: &mut Parsed,
) -> Result<(), Fault> {
    let Prefixes { texture, color, normal, .. } = prefixes;
    let size = 3 + 3 * usize::from(normal) + 4 * usize::from(color) + 2 * usize::from(texture);
    words.require(count, size, "vertices")?;
    let mut vertices =
        Vertices { positions: Vec::with_capacity(count), broken, ..Default::default() };
    for vertex in 0..count {
        let start = words.at;
        let position = words.floats("a coordinate")?;
        check_finite(&position, vertex, broken)
            .map_err(|problem| Fault::at_byte(start, problem))?;
        vertices.positions.push(position);
        if normal {
            vertices.normals.push(words.floats("a normal")?);
        }
        if color {
            let [red, green, blue, alpha] = words.floats("a colour")?;
            vertices.colors.push([red, green, blue]);
            vertices.largest_alpha = vertices.largest_alpha.max(alpha);
        }
        if texture {
            words.floats::<2>("texture coordinates")?;
        }
    }
    vertices.finish(prefixes, parsed);
    Ok(())
}

fn faces(
    words: &mut Words<'_>,
    count: usize,
    broken: Broken,
    parsed: &mut Parsed,
) -> Result<(), Fault> {
    // The two counts of a face.
    words.require(count, 2, "faces")?;
    let mut faces = FaceList::with_capacity(count, parsed.positions.len(), broken);
    let mut colored = 0;
    for _ in 0..count {
        let start = words.at;
        let size = words.count("the number of corners")?;
        words.require(size, 1, "corners")?;
        for _ in 0..size {
            let at = words.at;
            let index = i32::from_be_bytes(words.word("the index of a vertex")?);
            faces.corner(i64::from(index)).map_err(|problem| Fault::at_byte(at, problem))?;
        }
        faces.end().map_err(|problem| Fault::at_byte(start, problem))?;
        let values = words.count("the number of values of a colour")?;
        words.require(values, 1, "values of a colour")?;
        words.at += 4 * values;
        colored += usize::from(values > 0);
    }
    finish_faces(faces, colored, parsed);
    Ok(())
}

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
