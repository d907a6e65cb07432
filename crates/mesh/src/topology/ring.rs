//! Ordered one-rings, and the sheets of faces at a vertex.

use fairing_watch::parallel;

use super::Topology;
use super::components::find;

/// Faces around a vertex, each sharing an edge with the next.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct Fan {
    /// The neighbours in order, counter-clockwise seen from outside (as
    /// the fan's lowest face turns, if faces disagree). An open fan has one more
    /// vertex than faces.
    pub vertices: Vec<u32>,
    /// The faces in order: face `i` lies between vertices `i` and `i + 1`.
    pub faces: Vec<u32>,
    /// True if the last face meets the first.
    pub closed: bool,
}

impl Topology {
    /// The one-ring of vertex `v` as fans of faces, in the order of their
    /// lowest faces: one fan at a manifold vertex, closed inside and open on
    /// the boundary; several where sheets touch, none at an isolated vertex.
    /// An edge with more than two faces ends a fan, since no face is next there.
    ///
    /// A closed fan begins with its lowest face, an open one at its end.
    ///
    /// # Panics
    ///
    /// If there is no vertex `v`.
    pub fn ring(&self, v: u32) -> Vec<Fan> {
        let corners = self.incidence.corners(v);
        let mut seen = vec![false; corners.len()];
        let mut fans = vec![];
        for (i, &c) in corners.iter().enumerate() {
            let start = c / 3;
            if seen[i] {
                continue;
            }
            let face = self.faces[start as usize];
            let k = c as usize % 3;
            let [before, after] = [face[(k + 1) % 3], face[(k + 2) % 3]];

            let (mut faces, mut vertices) = (vec![start], vec![before, after]);
            let mut closed = self.walk(v, start, after, &mut faces, &mut vertices);
            if closed {
                vertices.pop();
            } else {
                let (mut back, mut ends) = (vec![start], vec![before]);
                closed = self.walk(v, start, before, &mut back, &mut ends);
                debug_assert!(!closed, "a fan that closes does so either way round");
                faces.splice(0..1, back.into_iter().rev());
                vertices.splice(0..1, ends.into_iter().rev());
            }
            for &f in &faces {
                // Corners are ascending, and a face has one at the vertex.
                seen[corners.partition_point(|&c| c / 3 < f)] = true;
            }
            fans.push(Fan { vertices, faces, closed });
        }
        fans
    }

    /// Continues around `v` from face `f` across the edge to `w`, up to a
    /// boundary, a non-manifold edge or the first face; returns true for the
    /// first face.
    fn walk(
        &self,
        v: u32,
        mut f: u32,
        mut w: u32,
        faces: &mut Vec<u32>,
        vertices: &mut Vec<u32>,
    ) -> bool {
        let start = f;
        loop {
            let ends = self.faces[f as usize];
            let Some(k) = ends.iter().position(|&x| x != v && x != w) else { return false };
            // The edge to `w` lies opposite the third corner.
            let next = match *self.edge_faces(self.face_edges()[f as usize][k]) {
                [a, b] if a == f => b,
                [a, b] if b == f => a,
                _ => return false,
            };
            if next == start {
                return true;
            }
            let Some(&third) = self.faces[next as usize].iter().find(|&&x| x != v && x != w) else {
                return false;
            };
            f = next;
            w = third;
            faces.push(f);
            vertices.push(w);
        }
    }
}

impl Topology {
    /// Labels the neighbours of `v` by sheet: `labels[i]` belongs to
    /// `neighbors(v)[i]`, and two neighbours are in one sheet if faces at `v`
    /// connect them. Returns the number of sheets.
    pub(super) fn label_sheets(&self, v: u32, labels: &mut Vec<u32>) -> u32 {
        let neighbors = self.neighbors(v);
        labels.clear();
        labels.extend(0..neighbors.len() as u32);
        let mut sheets = neighbors.len() as u32;
        for &c in self.incidence.corners(v) {
            let face = self.faces[c as usize / 3];
            let k = c as usize % 3;
            // Both ends are neighbours, since they share the face with `v`.
            let place = |w: u32| neighbors.partition_point(|&x| x < w) as u32;
            let a = find(labels, place(face[(k + 1) % 3]));
            let b = find(labels, place(face[(k + 2) % 3]));
            if a != b {
                sheets -= 1;
                labels[a.max(b) as usize] = a.min(b);
            }
        }
        // Roots are lowest, so that the label of a root is final when reached.
        for i in 0..labels.len() {
            labels[i] = labels[labels[i] as usize];
        }
        sheets
    }

    pub(super) fn find_nonmanifold_vertices(&self) -> Vec<u32> {
        let found = parallel::map_ranges(self.vertex_count, 4096, |vertices| {
            let mut labels = vec![];
            let vertices = vertices.map(|v| v as u32);
            vertices.filter(|&v| self.label_sheets(v, &mut labels) > 1).collect::<Vec<u32>>()
        });
        found.concat()
    }
}
