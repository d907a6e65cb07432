//! The faces of a file while it is being read.

use rayon::prelude::*;

/// Faces of any size. As long as all are triangles they are stored as such,
/// so that the usual file needs neither offsets nor a conversion.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Polygons {
    Triangles(Vec<[u32; 3]>),
    Mixed {
        /// Where each face ends in `corners`.
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
            Self::Mixed { ends, corners } => {
                let start = if face == 0 { 0 } else { ends[face - 1] };
                &corners[start..ends[face]]
            }
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

    /// Triangles that outgrew that form, such as polygons that were all left
    /// out, become triangles again.
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
            // Usually there is none, and a pass that only asks is the fastest.
            Self::Triangles(faces) => faces
                .par_chunks(1 << 15)
                .enumerate()
                .flat_map_iter(|(chunk, part)| {
                    let bad = |&[a, b, c]: &[u32; 3]| a == b || b == c || c == a;
                    part.iter()
                        .enumerate()
                        .filter(move |(_, face)| bad(face))
                        .map(move |(f, _)| (chunk << 15) + f)
                })
                .collect(),
            Self::Mixed { .. } => {
                (0..self.len()).filter(|&f| repeats_a_corner(self.face(f))).collect()
            }
        }
    }

    /// Takes out the faces that repeat a corner and says which they were.
    pub(crate) fn without_repeating(self) -> (Self, Vec<usize>) {
        let bad = self.repeating();
        if bad.is_empty() {
            return (self, bad);
        }
        let mut next = bad.iter().copied().peekable();
        let mut good = Self::with_capacity(self.len() - bad.len());
        for face in 0..self.len() {
            if next.next_if_eq(&face).is_none() {
                good.push(self.face(face));
            }
        }
        (good.simplified(), bad)
    }
}

/// Whether a polygon names one vertex twice: quadratic for small ones, by
/// sorting for large ones.
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
        let (good, bad) = faces.without_repeating();
        assert_eq!(bad, [1]);
        assert_eq!(good, Polygons::Triangles(vec![[0, 1, 2], [2, 1, 0]]));
    }

    #[test]
    fn repeated_corners_of_large_polygons_are_found() {
        let mut face: Vec<u32> = (0..40).collect();
        assert!(!repeats_a_corner(&face));
        face[39] = 7;
        assert!(repeats_a_corner(&face));
    }
}
