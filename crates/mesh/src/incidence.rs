//! The corners at each vertex.

use std::sync::{Arc, OnceLock};

use fairing_watch::parallel;

/// The corners at each vertex, in compressed rows.
///
/// Corner `c` is corner `c % 3` of face `c / 3`. The corners of a vertex
/// ascend.
///
/// Corners and sides are each sorted on first use: scattered writes cost more
/// than the counting, and few callers need both.
#[derive(Debug)]
pub struct Incidence {
    faces: Arc<Vec<[u32; 3]>>,
    offsets: Vec<u32>,
    corners: OnceLock<Vec<u32>>,
    sides: OnceLock<Vec<[u32; 2]>>,
}

impl Incidence {
    /// Counts the corners of each vertex: linear in faces.
    pub(crate) fn new(vertex_count: usize, faces: Arc<Vec<[u32; 3]>>) -> Self {
        let mut offsets = vec![0u32; vertex_count + 1];
        for &v in faces.as_flattened() {
            offsets[v as usize + 1] += 1;
        }
        for v in 0..vertex_count {
            offsets[v + 1] += offsets[v];
        }
        Self { faces, offsets, corners: OnceLock::new(), sides: OnceLock::new() }
    }

    /// Sorts values of corners by vertex; `of_face` gives those of the three corners
    /// of a face. A counting sort, linear in faces.
    fn sorted<T: Copy + Default>(&self, of_face: impl Fn(u32, [u32; 3]) -> [T; 3]) -> Vec<T> {
        let mut next = self.offsets.clone();
        let mut sorted = vec![T::default(); 3 * self.faces.len()];
        for (f, &face) in self.faces.iter().enumerate() {
            for (v, value) in face.into_iter().zip(of_face(f as u32, face)) {
                let slot = &mut next[v as usize];
                sorted[*slot as usize] = value;
                *slot += 1;
            }
        }
        sorted
    }

    /// The corners at vertex `v`, ascending; empty for an isolated vertex.
    ///
    /// # Panics
    ///
    /// If there is no vertex `v`.
    #[inline]
    pub fn corners(&self, v: u32) -> &[u32] {
        &self.all_corners()[self.range(v)]
    }

    /// The next and the previous vertex in the face of each corner at vertex
    /// `v`, in the order of [`Self::corners`], so the face list need not be read.
    ///
    /// # Panics
    ///
    /// If there is no vertex `v`.
    #[inline]
    pub fn sides(&self, v: u32) -> &[[u32; 2]] {
        &self.all_sides()[self.range(v)]
    }

    /// Returns true if no two faces run from a vertex to the same neighbour.
    pub(crate) fn leaves_each_side_once(&self) -> bool {
        let all = self.all_sides();
        let is_clean = |v: usize| {
            let sides = &all[self.range(v as u32)];
            if sides.len() > 16 {
                let mut next: Vec<u32> = sides.iter().map(|side| side[0]).collect();
                next.sort_unstable();
                return next.windows(2).all(|w| w[0] != w[1]);
            }
            (1..sides.len()).all(|i| sides[..i].iter().all(|side| side[0] != sides[i][0]))
        };
        let count = self.offsets.len() - 1;
        parallel::all(count, 4096, is_clean)
    }

    fn all_sides(&self) -> &[[u32; 2]] {
        self.sides.get_or_init(|| self.sorted(|_, [a, b, c]| [[b, c], [c, a], [a, b]]))
    }

    #[inline]
    fn range(&self, v: u32) -> std::ops::Range<usize> {
        self.offsets[v as usize] as usize..self.offsets[v as usize + 1] as usize
    }

    /// The start of each vertex's corners in [`Self::all_corners`]: one entry more
    /// than there are vertices.
    #[inline]
    pub fn offsets(&self) -> &[u32] {
        &self.offsets
    }

    /// The corners of all vertices, one vertex after another.
    #[inline]
    pub fn all_corners(&self) -> &[u32] {
        self.corners.get_or_init(|| self.sorted(|f, _| [3 * f, 3 * f + 1, 3 * f + 2]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_and_sides_of_a_strip() {
        let incidence = Incidence::new(5, Arc::new(vec![[0, 1, 2], [3, 2, 1]]));
        assert_eq!(incidence.offsets(), [0, 1, 3, 5, 6, 6]);
        assert_eq!(incidence.corners(1), [1, 5]);
        assert_eq!(incidence.sides(1), [[2, 0], [3, 2]]);
        assert_eq!(incidence.sides(2), [[0, 1], [1, 3]]);
        assert!(incidence.corners(4).is_empty() && incidence.sides(4).is_empty());
    }
}
