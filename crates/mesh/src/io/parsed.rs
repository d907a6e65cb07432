//! Content of a file as parsers leave it.

use crate::io::VertexFields;
use crate::io::error::{ReadProblem, unexpected};
use crate::polygon::Polygons;

/// The treatment of coordinates that are not finite and of indices without a vertex.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) enum Broken {
    /// An error.
    #[default]
    Refused,
    /// They stay for `Parsed::finish` to leave out, such an index as [`NO_VERTEX`].
    Kept,
}

/// An index that no vertex has.
pub(crate) const NO_VERTEX: u32 = u32::MAX;

/// The content of a file. Parsers have checked that faces have three corners or more
/// and, unless broken faces are [kept](Broken::Kept), that coordinates are finite and
/// indices in range.
#[derive(Default)]
pub(crate) struct Parsed {
    pub(crate) positions: Vec<[f64; 3]>,
    pub(crate) polygons: Polygons,
    pub(crate) fields: VertexFields,
    /// Content that is ignored by design.
    pub(crate) notes: Vec<String>,
    /// Content that is ignored, and refused by strict reading.
    pub(crate) doubts: Vec<String>,
}

/// Checks one index of a face against the number of vertices.
#[inline]
pub(crate) fn vertex_index(
    index: i64,
    face: usize,
    vertex_count: usize,
    broken: Broken,
) -> Result<u32, ReadProblem> {
    match u32::try_from(index) {
        Ok(v) if (v as usize) < vertex_count => Ok(v),
        _ if broken == Broken::Kept => Ok(NO_VERTEX),
        _ => Err(ReadProblem::IndexOutOfRange {
            face: face as u64,
            index,
            vertex_count: vertex_count as u64,
        }),
    }
}

/// A list of faces, built corner by corner.
pub(crate) struct FaceList {
    vertex_count: usize,
    broken: Broken,
    /// The number of faces that have ended.
    ended: usize,
    corners: Vec<u32>,
    pub(crate) polygons: Polygons,
    /// The number of faces with one corner or two, points and segments, which are
    /// left out.
    pub(crate) small: usize,
}

impl FaceList {
    /// An empty list with space for that many faces.
    pub(crate) fn with_capacity(faces: usize, vertex_count: usize, broken: Broken) -> Self {
        let polygons = Polygons::with_capacity(faces);
        Self { vertex_count, broken, ended: 0, corners: Vec::new(), polygons, small: 0 }
    }

    /// Adds the next corner of the face.
    #[inline]
    pub(crate) fn corner(&mut self, index: i64) -> Result<(), ReadProblem> {
        self.corners.push(vertex_index(index, self.ended, self.vertex_count, self.broken)?);
        Ok(())
    }

    /// Ends the face; a face without corners is a problem.
    #[inline]
    pub(crate) fn end(&mut self) -> Result<(), ReadProblem> {
        match self.corners.len() {
            0 => {
                let expected = format!("three corners or more in face {}", self.ended);
                return Err(unexpected(expected, "0"));
            }
            1 | 2 => self.small += 1,
            _ => self.polygons.push(&self.corners),
        }
        self.corners.clear();
        self.ended += 1;
        Ok(())
    }
}

/// The triangles of a strip, turned alike: triangle k has its first two corners swapped if k is
/// odd. Triangles that repeat a corner only join strips and are dropped.
pub(crate) fn strip_triangles<T: Copy + PartialEq>(strip: &[T]) -> impl Iterator<Item = [T; 3]> {
    let triangles = strip.windows(3).enumerate().map(|(k, three)| match three {
        &[a, b, c] if k.is_multiple_of(2) => [a, b, c],
        three => [three[1], three[0], three[2]],
    });
    triangles.filter(|&[a, b, c]| a != b && b != c && c != a)
}

/// Checks that a position is finite.
#[inline]
pub(crate) fn check_finite(
    position: &[f64; 3],
    vertex: usize,
    broken: Broken,
) -> Result<(), ReadProblem> {
    match position.iter().find(|x| !x.is_finite()) {
        None => Ok(()),
        Some(_) if broken == Broken::Kept => Ok(()),
        Some(&value) => Err(ReadProblem::NonFinite { vertex: vertex as u64, value }),
    }
}

/// Colours as bytes. Values count as from 0 to 1 if all are, alpha included,
/// otherwise as from 0 to 255; `None` if one is outside.
///
/// Geomview distinguishes the ranges by spelling (`1` or `1.0`), which writers do
/// not respect, but no file mixes them.
pub(crate) fn bytes_of_colors(colors: &[[f64; 3]], largest_alpha: f64) -> Option<Vec<[u8; 3]>> {
    let values = colors.as_flattened();
    let largest = values.iter().copied().fold(largest_alpha, f64::max);
    if values.iter().any(|c| !(0.0..=255.0).contains(c)) {
        return None;
    }
    let scale = if largest <= 1.0 { 255.0 } else { 1.0 };
    Some(colors.iter().map(|c| c.map(|x| (x * scale).round() as u8)).collect())
}
