//! Faces without positions, and what follows from them alone.

use std::sync::{Arc, OnceLock};

use crate::topology::Topology;

/// The faces of a mesh, and all that is derived from them and not from the
/// positions. Meshes that differ in positions only share one.
#[derive(Debug)]
pub struct Connectivity {
    vertex_count: usize,
    faces: Arc<Vec<[u32; 3]>>,
    incidence: OnceLock<Arc<Incidence>>,
    topology: OnceLock<Topology>,
}

impl Connectivity {
    /// The caller has checked indices and repeated corners.
    pub(crate) fn new(vertex_count: usize, faces: Vec<[u32; 3]>) -> Self {
        Self {
            vertex_count,
            faces: Arc::new(faces),
            incidence: OnceLock::new(),
            topology: OnceLock::new(),
        }
    }

    /// The number of vertices, isolated ones included.
    pub fn vertex_count(&self) -> usize {
        self.vertex_count
    }

    /// The faces, counter-clockwise seen from outside.
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.faces
    }

    /// The corners at each vertex; computed at the first call.
    pub fn incidence(&self) -> &Incidence {
        self.shared_incidence()
    }

    /// Edges, neighbours, rings, boundary and the like; computed at the first
    /// call.
    pub fn topology(&self) -> &Topology {
        self.topology.get_or_init(|| {
            Topology::new(
                self.vertex_count,
                Arc::clone(&self.faces),
                Arc::clone(self.shared_incidence()),
            )
        })
    }

    fn shared_incidence(&self) -> &Arc<Incidence> {
        self.incidence.get_or_init(|| Arc::new(Incidence::new(self.vertex_count, &self.faces)))
    }
}

/// The corners at each vertex, in compressed rows.
///
/// Corner `c` is corner `c % 3` of face `c / 3`. Within a vertex corners
/// ascend.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Incidence {
    offsets: Vec<u32>,
    corners: Vec<u32>,
    sides: Vec<[u32; 2]>,
}

impl Incidence {
    /// A counting sort of the corners by vertex: linear in faces.
    fn new(vertex_count: usize, faces: &[[u32; 3]]) -> Self {
        let mut offsets = vec![0u32; vertex_count + 1];
        for &v in faces.as_flattened() {
            offsets[v as usize + 1] += 1;
        }
        for v in 0..vertex_count {
            offsets[v + 1] += offsets[v];
        }
        let mut next = offsets.clone();
        let mut corners = vec![0u32; faces.len() * 3];
        let mut sides = vec![[0u32; 2]; faces.len() * 3];
        for (f, &[a, b, c]) in faces.iter().enumerate() {
            for (k, v, others) in [(0, a, [b, c]), (1, b, [c, a]), (2, c, [a, b])] {
                let slot = &mut next[v as usize];
                corners[*slot as usize] = 3 * f as u32 + k;
                sides[*slot as usize] = others;
                *slot += 1;
            }
        }
        Self { offsets, corners, sides }
    }

    /// The corners at vertex `v`, ascending; empty for an isolated vertex.
    ///
    /// # Panics
    ///
    /// If there is no vertex `v`.
    #[inline]
    pub fn corners(&self, v: u32) -> &[u32] {
        &self.corners[self.range(v)]
    }

    /// The next and the previous vertex in the face of each corner at vertex
    /// `v`, in the order of [`Self::corners`]: what the faces say, without
    /// going to look at them.
    ///
    /// # Panics
    ///
    /// If there is no vertex `v`.
    #[inline]
    pub fn sides(&self, v: u32) -> &[[u32; 2]] {
        &self.sides[self.range(v)]
    }

    #[inline]
    fn range(&self, v: u32) -> std::ops::Range<usize> {
        self.offsets[v as usize] as usize..self.offsets[v as usize + 1] as usize
    }

    /// Where the corners of each vertex begin in [`Self::all_corners`]; one
    /// entry more than there are vertices.
    pub fn offsets(&self) -> &[u32] {
        &self.offsets
    }

    /// The corners of all vertices, one vertex after another.
    pub fn all_corners(&self) -> &[u32] {
        &self.corners
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_and_sides_of_a_strip() {
        let incidence = Incidence::new(5, &[[0, 1, 2], [3, 2, 1]]);
        assert_eq!(incidence.offsets(), [0, 1, 3, 5, 6, 6]);
        assert_eq!(incidence.corners(1), [1, 5]);
        assert_eq!(incidence.sides(1), [[2, 0], [3, 2]]);
        assert_eq!(incidence.sides(2), [[0, 1], [1, 3]]);
        assert!(incidence.corners(4).is_empty() && incidence.sides(4).is_empty());
    }
}
