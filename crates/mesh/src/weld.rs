//! Welding: one vertex for all corners at one position.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use fairing_watch::parallel;
use rayon::prelude::*;

use crate::trimesh::TriMesh;

/// Joins corners at exactly equal positions to one vertex, numbered in order of
/// first appearance. −0 equals 0; the sign of the first appearance is kept.
#[derive(Default)]
pub(crate) struct Welder {
    positions: Vec<[f64; 3]>,
    vertices: HashMap<[u64; 3], u32>,
}

impl Welder {
    pub(crate) fn with_capacity(vertices: usize) -> Self {
        Self { positions: Vec::with_capacity(vertices), vertices: HashMap::with_capacity(vertices) }
    }

    /// The vertex at a position; `None` if there are more vertices than `u32` can number.
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

/// For each vertex the first one at exactly its position; −0 equals 0.
pub(crate) fn places_of(positions: &[[f64; 3]]) -> Vec<u32> {
    let key = |v: usize| (positions[v].map(|x| (x + 0.0).to_bits()), v as u32);
    let mut keys: Vec<([u64; 3], u32)> = parallel::map(positions.len(), 4096, key);
    keys.par_sort_unstable();
    let mut first = vec![0; positions.len()];
    for group in keys.chunk_by(|x, y| x.0 == y.0) {
        group.iter().for_each(|&(_, v)| first[v as usize] = group[0].1);
    }
    first
}

/// The result of [`TriMesh::welded`]: a mesh without two vertices at one position.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Welded {
    /// The welded mesh: vertices in order of first appearance, faces in the original order.
    pub mesh: TriMesh,
    /// The vertex of the welded mesh for each original vertex.
    pub vertices: Vec<u32>,
    /// The faces with two corners at one position, ascending; the welded mesh omits them.
    pub left_out: Vec<u32>,
}

impl Welded {
    /// Copies values of the welded vertices to the original vertices.
    ///
    /// # Panics
    ///
    /// If there are fewer values than vertices in the welded mesh.
    pub fn spread<T: Clone>(&self, values: &[T]) -> Vec<T> {
        self.vertices.iter().map(|&v| values[v as usize].clone()).collect()
    }
}

impl TriMesh {
    /// Joins all vertices at exactly equal positions (−0 = 0). Nearly linear.
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
    #[doc(alias("merge_vertices", "remove_duplicate_vertices"))]
    pub fn welded(&self) -> Welded {
        let mut welder = Welder::with_capacity(self.vertex_count());
        // There are no more vertices than before, so `u32` can number them.
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

    /// The number of vertices of boundary edges that lie, with exactly equal ends, on one other
    /// boundary edge: seams of texture coordinates or normals, or faces that share no corners at
    /// all. Sheets that only touch in a vertex have no seam there, and neither has an edge at which
    /// more than two faces meet.
    pub fn seam_vertices(&self) -> usize {
        let topology = self.topology();
        let places = places_of(self.positions());
        let mut count = vec![0_u32; places.len()];
        places.iter().for_each(|&place| count[place as usize] += 1);
        let mut edges: Vec<([u32; 2], u32)> = (topology.edges().iter().zip(0..))
            .map(|(ends, e)| (ends.map(|v| places[v as usize]), e))
            .filter(|(ends, _)| ends.iter().all(|&place| count[place as usize] > 1))
            .map(|([a, b], e)| ([a.min(b), a.max(b)], e))
            .collect();
        edges.par_sort_unstable();
        let mut seam = vec![false; places.len()];
        for pair in edges.chunk_by(|x, y| x.0 == y.0) {
            if pair.len() == 2 && pair.iter().all(|&(_, e)| topology.is_boundary_edge(e)) {
                let ends = pair.iter().flat_map(|&(_, e)| topology.edges()[e as usize]);
                ends.for_each(|v| seam[v as usize] = true);
            }
        }
        seam.into_iter().filter(|&seam| seam).count()
    }

    /// Returns true if most vertices of faces are [seams](Self::seam_vertices): faces touch but do
    /// not share vertices, as in files that store three corners for each face. Quantities that
    /// depend on neighbours are meaningless on such a mesh; [`welded`](Self::welded) joins it.
    ///
    /// Constant time for most meshes: the counts of vertices and faces decide.
    pub fn is_unwelded(&self) -> bool {
        // A disc or an annulus of V vertices, b of them on the boundary, has at most 2 V − b faces.
        if self.face_count() < 2 || self.face_count() > self.vertex_count() * 3 / 2 {
            return false;
        }
        let used = self.vertex_count() - self.topology().isolated_vertices().count();
        // Faces whose own corners coincide are degenerate, not unwelded.
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
        // A tube of 8 × 6 squares, open along a seam.
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
