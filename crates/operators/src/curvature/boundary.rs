//! How many edges meet in a vertex, and whether one of them is on the border.

use fairing_mesh::TriMesh;
use rayon::prelude::*;

use crate::corners::{next, previous};

/// The surroundings of a vertex, counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct VertexLinks {
    /// The faces at the vertex.
    pub faces: u32,
    /// The edges at the vertex, each once.
    pub edges: u32,
    /// Whether an edge at the vertex has one face only.
    pub boundary: bool,
}

/// Counts the faces and edges at each vertex, in vertex order; from the
/// incidence alone, without building edges.
///
/// Orientation does not matter. A vertex inside a manifold has as many edges
/// as faces, one on its boundary has one more.
pub fn vertex_links(mesh: &TriMesh) -> Vec<VertexLinks> {
    let vertices = mesh.faces().as_flattened();
    let incidence = mesh.incidence();
    (0..mesh.vertex_count() as u32)
        .into_par_iter()
        .with_min_len(4096)
        .map_init(Vec::new, |ends, v| links_of(vertices, incidence.corners(v), ends))
        .collect()
}

/// Counts around the vertex at `corners`; `ends` is room to work in.
#[inline]
pub(crate) fn links_of(vertices: &[u32], corners: &[u32], ends: &mut Vec<u32>) -> VertexLinks {
    let faces = corners.len() as u32;
    if is_closed_fan(vertices, corners) {
        return VertexLinks { faces, edges: faces, boundary: false };
    }
    ends.clear();
    for &c in corners {
        ends.push(vertices[next(c) as usize]);
        ends.push(vertices[previous(c) as usize]);
    }
    ends.sort_unstable();
    let (mut edges, mut boundary) = (0, false);
    for same in ends.chunk_by(|a, b| a == b) {
        edges += 1;
        boundary |= same.len() == 1;
    }
    VertexLinks { faces, edges, boundary }
}

/// Whether each neighbour follows the vertex in one face and precedes it in
/// one other: the common case, recognised without sorting.
#[inline]
fn is_closed_fan(vertices: &[u32], corners: &[u32]) -> bool {
    const ROOM: usize = 12;
    if corners.len() > ROOM || corners.len() < 3 {
        return false;
    }
    let (mut after, mut before) = ([u32::MAX; ROOM], [u32::MAX; ROOM]);
    for (i, &c) in corners.iter().enumerate() {
        after[i] = vertices[next(c) as usize];
        before[i] = vertices[previous(c) as usize];
    }
    // If every neighbour follows once and precedes once, the lists agree as
    // sets; counting both in one pass needs no branch.
    (0..corners.len()).all(|i| {
        let w = after[i];
        let follows: u32 = after.iter().map(|&x| u32::from(x == w)).sum();
        let precedes: u32 = before.iter().map(|&x| u32::from(x == w)).sum();
        follows == 1 && precedes == 1
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn links(faces: &[[u32; 3]]) -> Vec<VertexLinks> {
        let n = faces.as_flattened().iter().max().unwrap() + 1;
        vertex_links(&TriMesh::new(vec![[0.0; 3]; n as usize], faces.to_vec()).unwrap())
    }

    #[test]
    fn a_tetrahedron_is_closed_however_it_turns() {
        let closed = VertexLinks { faces: 3, edges: 3, boundary: false };
        assert_eq!(links(&[[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]]), [closed; 4]);
        assert_eq!(links(&[[0, 2, 1], [0, 3, 1], [0, 2, 3], [1, 3, 2]]), [closed; 4]);
    }

    #[test]
    fn a_fan_is_open_until_it_closes() {
        let open = links(&[[0, 1, 2], [0, 2, 3], [0, 3, 4]]);
        assert_eq!(open[0], VertexLinks { faces: 3, edges: 4, boundary: true });
        let closed = links(&[[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1]]);
        assert_eq!(closed[0], VertexLinks { faces: 4, edges: 4, boundary: false });
        assert!(closed[1].boundary);
    }

    #[test]
    fn three_faces_at_an_edge_do_not_hide_the_boundary() {
        let fan = links(&[[0, 1, 2], [1, 0, 3], [0, 1, 4]]);
        assert_eq!(fan[0], VertexLinks { faces: 3, edges: 4, boundary: true });
    }

    #[test]
    fn two_fans_in_a_vertex_add_up() {
        let pinch = links(&[[0, 1, 2], [0, 3, 4]]);
        assert_eq!(pinch[0], VertexLinks { faces: 2, edges: 4, boundary: true });
    }
}
