//! Lists of faces under construction.

use fairing_watch::parallel;

/// Faces of any size. A list of triangles only is stored without offsets, so the
/// usual file needs no conversion.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Polygons {
    Triangles(Vec<[u32; 3]>),
    Mixed {
        /// The end of each face in `corners`.
        ends: Vec<usize>,
        corners: Vec<u32>,
    },
}

impl Default for Polygons {
    fn default() -> Self {
        Self::Triangles(Vec::new())
    }
}

impl Polygons {
    pub(crate) fn with_capacity(faces: usize) -> Self {
        Self::Triangles(Vec::with_capacity(faces))
    }

    pub(crate) fn len(&self) -> usize {
        match self {
            Self::Triangles(faces) => faces.len(),
            Self::Mixed { ends, .. } => ends.len(),
        }
    }

    pub(crate) fn corner_count(&self) -> usize {
        match self {
            Self::Triangles(faces) => 3 * faces.len(),
            Self::Mixed { corners, .. } => corners.len(),
        }
    }

    pub(crate) fn face(&self, face: usize) -> &[u32] {
        match self {
            Self::Triangles(faces) => &faces[face],
            Self::Mixed { corners, .. } => &corners[self.corners_of(face)],
        }
    }

    /// The places of the corners of a face among those of all faces in turn.
    pub(crate) fn corners_of(&self, face: usize) -> std::ops::Range<usize> {
        match self {
            Self::Triangles(_) => 3 * face..3 * face + 3,
            Self::Mixed { ends, .. } => (if face == 0 { 0 } else { ends[face - 1] })..ends[face],
        }
    }

    pub(crate) fn corners_mut(&mut self) -> &mut [u32] {
        match self {
            Self::Triangles(faces) => faces.as_flattened_mut(),
            Self::Mixed { corners, .. } => corners,
        }
    }

    #[inline]
    pub(crate) fn push_triangle(&mut self, triangle: [u32; 3]) {
        match self {
            Self::Triangles(faces) => faces.push(triangle),
            Self::Mixed { ends, corners } => {
                corners.extend_from_slice(&triangle);
                ends.push(corners.len());
            }
        }
    }

    #[inline]
    pub(crate) fn push(&mut self, face: &[u32]) {
        if let &[a, b, c] = face {
            return self.push_triangle([a, b, c]);
        }
        let (ends, corners) = self.mixed();
        corners.extend_from_slice(face);
        ends.push(corners.len());
    }

    /// Appends all faces of another list.
    pub(crate) fn append(&mut self, other: &Self) {
        match (&mut *self, other) {
            (Self::Triangles(faces), Self::Triangles(more)) => faces.extend_from_slice(more),
            _ => {
                for face in 0..other.len() {
                    self.push(other.face(face));
                }
            }
        }
    }

    fn mixed(&mut self) -> (&mut Vec<usize>, &mut Vec<u32>) {
        if let Self::Triangles(faces) = self {
            let ends = (1..=faces.len()).map(|f| 3 * f).collect();
            let corners = std::mem::take(faces).into_flattened();
            *self = Self::Mixed { ends, corners };
        }
        match self {
            Self::Mixed { ends, corners } => (ends, corners),
            Self::Triangles(_) => unreachable!("converted above"),
        }
    }

    /// Returns to the form of triangles if no larger polygon is left.
    fn simplified(self) -> Self {
        match self {
            Self::Mixed { ends, corners }
                if ends.iter().enumerate().all(|(f, &end)| end == 3 * (f + 1)) =>
            {
                Self::Triangles(corners.as_chunks().0.to_vec())
            }
            other => other,
        }
    }

    /// The faces that repeat a corner, ascending.
    fn repeating(&self) -> Vec<usize> {
        match self {
            // Usually there is none, and a pass that only tests is the fastest.
            Self::Triangles(faces) => {
                let bad = |&[a, b, c]: &[u32; 3]| a == b || b == c || c == a;
                let found = parallel::map_ranges(faces.len(), 1 << 15, |range| {
                    range.filter(|&f| bad(&faces[f])).collect::<Vec<usize>>()
                });
                found.concat()
            }
            Self::Mixed { .. } => {
                (0..self.len()).filter(|&f| repeats_a_corner(self.face(f))).collect()
            }
        }
    }

    /// Reduces faces that repeat a corner to their distinct corners, in order of
    /// first appearance, and drops faces with fewer than three.
    pub(crate) fn without_repeating(self) -> Distinct {
        let repeating = self.repeating();
        let mut distinct = Distinct { reduced: vec![], left_out: vec![], polygons: self };
        if repeating.is_empty() {
            return distinct;
        }
        let mut next = repeating.iter().copied().peekable();
        let mut kept = Self::with_capacity(distinct.polygons.len());
        let mut corners = Vec::new();
        for face in 0..distinct.polygons.len() {
            let named = distinct.polygons.face(face);
            if next.next_if_eq(&face).is_none() {
                kept.push(named);
                continue;
            }
            corners.clear();
            corners.extend(first_mentions(named).map(|k| named[k]));
            if corners.len() < 3 {
                distinct.left_out.push(face);
            } else {
                distinct.reduced.push(face);
                kept.push(&corners);
            }
        }
        distinct.polygons = kept.simplified();
        distinct
    }
}

/// Faces without repeated corners, and the changed faces, ascending and with
/// their original numbers.
#[derive(Debug)]
pub(crate) struct Distinct {
    pub(crate) polygons: Polygons,
    /// Faces that repeated a corner and have three or more distinct ones.
    pub(crate) reduced: Vec<usize>,
    /// Faces with fewer than three distinct corners.
    pub(crate) left_out: Vec<usize>,
}

/// The places of the distinct corners of a face in order of first appearance, in
/// O(n log n).
pub(crate) fn first_mentions(face: &[u32]) -> impl Iterator<Item = usize> + use<> {
    let mut order: Vec<usize> = (0..face.len()).collect();
    order.sort_unstable_by_key(|&k| (face[k], k));
    order.dedup_by_key(|k| face[*k]);
    order.sort_unstable();
    order.into_iter()
}

/// Returns true if a polygon names one vertex twice. Compares all pairs of a small
/// polygon and sorts a large one.
pub(crate) fn repeats_a_corner(face: &[u32]) -> bool {
    if face.len() <= 16 {
        return face.iter().enumerate().any(|(k, v)| face[..k].contains(v));
    }
    let mut sorted = face.to_vec();
    sorted.sort_unstable();
    sorted.windows(2).any(|pair| pair[0] == pair[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_stay_triangles_until_another_polygon_comes() {
        let mut faces = Polygons::default();
        faces.push(&[0, 1, 2]);
        assert!(matches!(faces, Polygons::Triangles(_)));
        faces.push(&[0, 1, 2, 2]);
        faces.push(&[2, 1, 0]);
        assert_eq!(faces.len(), 3);
        assert_eq!(faces.face(0), [0, 1, 2]);
        assert_eq!(faces.face(1), [0, 1, 2, 2]);
        assert_eq!(faces.face(2), [2, 1, 0]);
        faces.push(&[3, 3, 1, 1]);
        let distinct = faces.without_repeating();
        assert_eq!((distinct.reduced, distinct.left_out), (vec![1], vec![3]));
        let expected = Polygons::Triangles(vec![[0, 1, 2], [0, 1, 2], [2, 1, 0]]);
        assert_eq!(distinct.polygons, expected);
    }

    #[test]
    fn distinct_corners_keep_the_order_of_the_face() {
        for (face, expected) in [
            (&[5u32, 5, 2, 9, 7][..], &[5u32, 2, 9, 7][..]),
            (&[5, 2, 2, 9, 7], &[5, 2, 9, 7]),
            (&[5, 2, 9, 7, 5], &[5, 2, 9, 7]),
            (&[8, 1, 8, 1, 0, 1], &[8, 1, 0]),
            (&[4, 4, 4], &[4]),
        ] {
            let corners: Vec<u32> = first_mentions(face).map(|k| face[k]).collect();
            assert_eq!(corners, expected);
        }
    }

    #[test]
    fn repeated_corners_of_large_polygons_are_found() {
        let mut face: Vec<u32> = (0..40).collect();
        assert!(!repeats_a_corner(&face));
        face[39] = 7;
        assert!(repeats_a_corner(&face));
    }
}
