//! Indices by which corners of faces name texture coordinates and normals.

/// The index of a corner that names none.
pub(super) const NONE: u32 = u32::MAX;

/// An index that no value has.
const MISSING: u32 = u32::MAX - 1;

/// The indices that the corners of a piece name.
#[derive(Default)]
pub(super) struct Indices {
    /// One for each corner up to the last that names one.
    pub(super) values: Vec<u32>,
    /// Corners with relative indices, and the index from the first value of the piece.
    relative: Vec<(usize, i64)>,
}

impl Indices {
    /// Sets the index of a corner, from 1 or relative to the end of the values of the piece.
    #[inline]
    pub(super) fn set(&mut self, corner: usize, index: i64, values: usize) {
        self.values.resize(corner, NONE);
        if index < 0 {
            self.relative.push((corner, values as i64 + index));
        }
        let value = u32::try_from(index).ok().and_then(|index| index.checked_sub(1));
        self.values.push(value.filter(|&value| value < MISSING).unwrap_or(MISSING));
    }

    /// Forgets corners from this one on.
    pub(super) fn truncate(&mut self, corner: usize) {
        self.values.truncate(corner);
        while self.relative.pop_if(|&mut (k, _)| k >= corner).is_some() {}
    }

    /// Makes relative indices absolute, given the number of values in the pieces before.
    pub(super) fn resolve_relative(&mut self, before: usize) {
        for &(corner, index) in &self.relative {
            let index = u32::try_from(before as i64 + index).unwrap_or(MISSING);
            self.values[corner] = index.min(MISSING);
        }
    }
}
