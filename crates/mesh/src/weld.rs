//! Vertices from corners at equal positions.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use crate::TriMesh;

/// Makes one vertex of all corners at exactly one position, numbered in the
/// order of first appearance. −0 and 0 are one; the first one seen is kept.
#[derive(Default)]
pub(crate) struct Welder {
    positions: Vec<[f64; 3]>,
    vertices: HashMap<[u64; 3], u32>,
}

impl Welder {
    pub(crate) fn with_capacity(vertices: usize) -> Self {
        Self { positions: Vec::with_capacity(vertices), vertices: HashMap::with_capacity(vertices) }
    }

    /// The vertex at a position; `None` if they outnumber `u32`.
    pub(crate) fn vertex(&mut self, position: [f64; 3]) -> Option<u32> {
        // −0 + 0 = 0, and nothing else changes.
        match self.vertices.entry(position.map(|x| (x + 0.0).to_bits())) {
            Entry::Occupied(entry) => Some(*entry.get()),
            Entry::Vacant(entry) => {
                let vertex = u32::try_from(self.positions.len()).ok()?;
                self.positions.push(position);
                Some(*entry.insert(vertex))
            }
        }
    }

    pub(crate) fn into_positions(self) -> Vec<[f64; 3]> {
        self.positions
    }
}

/// A mesh whose vertices at exactly equal positions are one, as [`TriMesh::welded`] makes it.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Welded {
    /// The welded mesh: vertices in the order of their first appearance, faces in their order.
    pub mesh: TriMesh,
    /// The vertex of the welded mesh that each vertex has become.
    pub vertices: Vec<u32>,
    /// The faces with two corners in one place, ascending; the welded mesh does not have them.
    pub left_out: Vec<u32>,
}

impl Welded {
    /// The values of each original vertex, from one for each vertex of the welded mesh.
    ///
    /// # Panics
    ///
    /// If there are fewer values than vertices in the welded mesh.
    pub fn spread<T: Clone>(&self, values: &[T]) -> Vec<T> {
        self.vertices.iter().map(|&v| values[v as usize].clone()).collect()
    }
}

impl TriMesh {
    /// The mesh with all vertices at exactly equal positions (−0 = 0) made one. Nearly linear.
    ///
    /// # Examples
    ///
    /// ```
    /// use fairing_mesh::TriMesh;
    ///
    /// let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
    /// let own = [0, 1, 2, 1, 3, 2].map(|v| corners[v]).to_vec();
    /// let soup = TriMesh::new(own, vec![[0, 1, 2], [3, 4, 5]])?;
    /// assert!(soup.is_unwelded());
    /// let welded = soup.welded();
    /// assert_eq!(welded.mesh.faces(), [[0, 1, 2], [1, 3, 2]]);
    /// assert_eq!(welded.vertices, [0, 1, 2, 1, 3, 2]);
    /// # Ok::<(), fairing_mesh::BuildError>(())
    /// ```
    pub fn welded(&self) -> Welded {
        let mut welder = Welder::with_capacity(self.vertex_count());
        // No more vertices than before, so that none is missing.
        let vertex = |&p: &[f64; 3]| welder.vertex(p).unwrap_or_default();
        let vertices: Vec<u32> = self.positions().iter().map(vertex).collect();
        let mut left_out = vec![];
        let mut faces = Vec::with_capacity(self.face_count());
        for (f, face) in self.faces().iter().enumerate() {
            let [a, b, c] = face.map(|v| vertices[v as usize]);
            if a == b || b == c || c == a {
                left_out.push(f as u32);
            } else {
                faces.push([a, b, c]);
            }
        }
        let mesh = Self::from_checked(welder.into_positions(), faces);
        Welded { mesh, vertices, left_out }
    }

    /// The number of boundary vertices that lie exactly where another boundary vertex does: the
    /// seams of texture coordinates and normals, or faces that share no corners at all.
    pub fn seam_vertices(&self) -> usize {
        let topology = self.topology();
        let mut at: HashMap<[u64; 3], usize> = HashMap::new();
        let bits = |v: usize| self.positions()[v].map(|x| (x + 0.0).to_bits());
        let boundary = || topology.boundary_vertices().iter().enumerate().filter(|(_, b)| **b);
        for (v, _) in boundary() {
            *at.entry(bits(v)).or_default() += 1;
        }
        at.values().filter(|count| **count > 1).sum()
    }

    /// Whether most vertices of faces are [seams](Self::seam_vertices): the faces meet, but do not
    /// share their corners, as in files whose every face has its own. What needs neighbours means
    /// nothing on such a mesh; [`welded`](Self::welded) joins it.
    ///
    /// A glance at the counts suffices for most meshes.
    pub fn is_unwelded(&self) -> bool {
        // A disc or an annulus of V vertices, b of them on the boundary, has at most 2 V − b faces.
        if self.face_count() < 2 || self.face_count() > self.vertex_count() * 3 / 2 {
            return false;
        }
        let used = self.vertex_count() - self.topology().isolated_vertices().count();
        // Faces with their own corners in one place are no soup, but degenerate.
        2 * self.seam_vertices() > used && 2 * self.welded().left_out.len() < self.face_count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zeros_of_both_signs_are_one_and_neighbours_are_two() {
        let mut welder = Welder::default();
        assert_eq!(welder.vertex([0.0, 1.0, 2.0]), Some(0));
        assert_eq!(welder.vertex([0.0, 1.0_f64.next_up(), 2.0]), Some(1));
        assert_eq!(welder.vertex([-0.0, 1.0, 2.0]), Some(0));
        assert_eq!(welder.into_positions().len(), 2);
    }

    #[test]
    fn a_seam_is_no_soup_and_a_soup_is() {
        // A tube of 8 × 6 squares that is open along a seam.
        let at = |i: u32, j: u32| {
            let t = std::f64::consts::TAU * f64::from(i % 8) / 8.0;
            [t.cos(), t.sin(), f64::from(j)]
        };
        let positions: Vec<[f64; 3]> = (0..7).flat_map(|j| (0..9).map(move |i| at(i, j))).collect();
        let square = |i: u32, j: u32| {
            let v = 9 * j + i;
            [[v, v + 1, v + 9], [v + 1, v + 10, v + 9]]
        };
        let faces: Vec<[u32; 3]> =
            (0..6).flat_map(|j| (0..8).flat_map(move |i| square(i, j))).collect();
        let tube = TriMesh::new(positions, faces).unwrap();
        assert_eq!((tube.seam_vertices(), tube.is_unwelded()), (14, false));
        assert_eq!(tube.welded().mesh.vertex_count(), 56);

        let own: Vec<[f64; 3]> =
            tube.faces().as_flattened().iter().map(|&v| tube.positions()[v as usize]).collect();
        let soup = (0..96).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect();
        let soup = TriMesh::new(own, soup).unwrap();
        assert!(soup.is_unwelded());
        let welded = soup.welded();
        assert_eq!(welded.mesh.vertex_count(), 56);
        assert!(welded.left_out.is_empty());
        assert_eq!(welded.spread(welded.mesh.positions()), soup.positions());
    }

    #[test]
    fn a_face_within_one_place_is_left_out() {
        let corners = vec![[0.0; 3], [1.0, 0.0, 0.0], [-0.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let mesh = TriMesh::new(corners, vec![[0, 1, 2], [0, 1, 3]]).unwrap();
        let welded = mesh.welded();
        assert_eq!(welded.left_out, [0]);
        assert_eq!(welded.mesh.faces(), [[0, 1, 2]]);
        let flat = vec![[1.0; 3], [0.0; 3], [0.0; 3], [1.0; 3]];
        assert!(!TriMesh::new(flat, vec![[0, 1, 2], [3, 2, 1]]).unwrap().is_unwelded());
    }
}
