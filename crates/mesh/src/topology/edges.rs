//! Edges, the faces of edges and the neighbours of vertices.

use fairing_watch::parallel;

use crate::incidence::Incidence;

/// Vertices per task; large enough that joining the pieces costs nothing,
/// small enough to keep every thread busy.
const CHUNK: usize = 4096;

/// Edges in lexicographic order and the tables that go with them.
#[derive(Debug)]
pub(super) struct EdgeTables {
    pub(super) edges: Vec<[u32; 2]>,
    /// The first edge whose lower end is a given vertex.
    lower_offsets: Vec<u32>,
    edge_face_offsets: Vec<u32>,
    edge_faces: Vec<u32>,
    pub(super) face_edges: Vec<[u32; 3]>,
    pub(super) neighbor_offsets: Vec<u32>,
    pub(super) neighbors: Vec<u32>,
}

/// The tables of a run of consecutive vertices; counts in place of offsets.
#[derive(Default)]
struct Piece {
    edges: Vec<[u32; 2]>,
    edge_face_counts: Vec<u32>,
    edge_faces: Vec<u32>,
    lower_counts: Vec<u32>,
    neighbor_counts: Vec<u32>,
    neighbors: Vec<u32>,
}

impl EdgeTables {
    /// Collects and sorts, for each vertex in turn, the other ends of its edges, which
    /// gives the edges in lexicographic order.
    pub(super) fn new(vertex_count: usize, faces: &[[u32; 3]], incidence: &Incidence) -> Self {
        let pieces: Vec<Piece> = parallel::map(vertex_count.div_ceil(CHUNK), 1, |i| {
            let end = ((i + 1) * CHUNK).min(vertex_count);
            Piece::new((i * CHUNK) as u32..end as u32, incidence)
        });
        let mut tables = Self {
            edges: pieces.iter().flat_map(|p| &p.edges).copied().collect(),
            lower_offsets: offsets(pieces.iter().flat_map(|p| &p.lower_counts)),
            edge_face_offsets: offsets(pieces.iter().flat_map(|p| &p.edge_face_counts)),
            edge_faces: pieces.iter().flat_map(|p| &p.edge_faces).copied().collect(),
            face_edges: vec![],
            neighbor_offsets: offsets(pieces.iter().flat_map(|p| &p.neighbor_counts)),
            neighbors: pieces.iter().flat_map(|p| &p.neighbors).copied().collect(),
        };
        tables.face_edges = parallel::map(faces.len(), CHUNK, |i| {
            let [a, b, c] = faces[i];
            [tables.find(b, c), tables.find(c, a), tables.find(a, b)]
        });
        tables
    }

    #[inline]
    pub(super) fn faces_of(&self, e: usize) -> &[u32] {
        &self.edge_faces[self.edge_face_offsets[e] as usize..self.edge_face_offsets[e + 1] as usize]
    }

    #[inline]
    pub(super) fn neighbors_of(&self, v: usize) -> &[u32] {
        &self.neighbors[self.neighbor_offsets[v] as usize..self.neighbor_offsets[v + 1] as usize]
    }

    pub(super) fn edge_between(&self, a: u32, b: u32) -> Option<u32> {
        let [lo, hi] = [a.min(b), a.max(b)];
        let first = self.lower_offsets[lo as usize];
        let range = first as usize..self.lower_offsets[lo as usize + 1] as usize;
        self.edges[range].binary_search_by_key(&hi, |e| e[1]).ok().map(|i| first + i as u32)
    }

    /// The edge between two vertices of one face, which always exists. Bisection ends in a
    /// linear search, since a vertex is usually the lower end of about three edges.
    #[inline]
    fn find(&self, a: u32, b: u32) -> u32 {
        let [lo, hi] = [a.min(b), a.max(b)];
        let mut e = self.lower_offsets[lo as usize];
        let mut end = self.lower_offsets[lo as usize + 1];
        while end - e > 16 {
            let middle = e + (end - e) / 2;
            if self.edges[middle as usize][1] <= hi {
                e = middle;
            } else {
                end = middle;
            }
        }
        while self.edges[e as usize][1] != hi {
            e += 1;
        }
        e
    }
}

impl Piece {
    fn new(vertices: std::ops::Range<u32>, incidence: &Incidence) -> Self {
        let mut piece = Self::default();
        // Other end in the high half, face in the low: sorts by both.
        let mut keys: Vec<u64> = vec![];
        for v in vertices {
            keys.clear();
            for (&c, &side) in incidence.corners(v).iter().zip(incidence.sides(v)) {
                keys.extend(side.map(|other| u64::from(other) << 32 | u64::from(c / 3)));
            }
            keys.sort_unstable();
            let (edges, neighbors) = (piece.edges.len(), piece.neighbors.len());
            let mut last = None;
            for &key in &keys {
                let (other, face) = ((key >> 32) as u32, key as u32);
                if last != Some(other) {
                    last = Some(other);
                    piece.neighbors.push(other);
                    if other > v {
                        piece.edges.push([v, other]);
                        piece.edge_face_counts.push(0);
                    }
                }
                if other > v {
                    piece.edge_faces.push(face);
                    if let Some(count) = piece.edge_face_counts.last_mut() {
                        *count += 1;
                    }
                }
            }
            piece.lower_counts.push((piece.edges.len() - edges) as u32);
            piece.neighbor_counts.push((piece.neighbors.len() - neighbors) as u32);
        }
        piece
    }
}

/// Running sums from 0. Corners fit into `u32`, so the sums do as well.
fn offsets<'a>(counts: impl Iterator<Item = &'a u32>) -> Vec<u32> {
    let mut sum = 0;
    let mut offsets = vec![0];
    offsets.extend(counts.map(|&c| {
        sum += c;
        sum
    }));
    offsets
}
