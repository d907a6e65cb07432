//! Topology of the faces: edges, neighbours, rings, boundary, components,
//! genus, orientation.
//!
//! Edges, neighbours and boundary flags are computed together, in parallel and
//! without a global sort, when a topology is made; everything else on first use.

mod boundary;
mod components;
mod edges;
mod orientation;
mod ring;

use std::sync::{Arc, OnceLock};

pub use components::Components;
pub use orientation::Orientation;
pub use ring::Fan;

use crate::incidence::Incidence;
use edges::EdgeTables;

/// Edges, neighbours, boundary, components and orientation of the faces of a mesh,
/// shared between meshes that differ in positions only.
///
/// Any faces are allowed: an edge may have any number of them, and neighbours may
/// disagree in orientation.
#[derive(Debug)]
pub struct Topology {
    vertex_count: usize,
    faces: Arc<Vec<[u32; 3]>>,
    incidence: Arc<Incidence>,
    tables: EdgeTables,
    boundary_vertices: Vec<bool>,
    nonmanifold_vertices: OnceLock<Vec<u32>>,
    boundary_loops: OnceLock<Vec<Vec<u32>>>,
    components: OnceLock<Components>,
    orientation: OnceLock<Orientation>,
}

impl Topology {
    pub(crate) fn new(
        vertex_count: usize,
        faces: Arc<Vec<[u32; 3]>>,
        incidence: Arc<Incidence>,
    ) -> Self {
        let tables = EdgeTables::new(vertex_count, &faces, &incidence);
        let mut boundary_vertices = vec![false; vertex_count];
        for (e, ends) in tables.edges.iter().enumerate() {
            if tables.faces_of(e).len() == 1 {
                boundary_vertices[ends[0] as usize] = true;
                boundary_vertices[ends[1] as usize] = true;
            }
        }
        Self {
            vertex_count,
            faces,
            incidence,
            tables,
            boundary_vertices,
            nonmanifold_vertices: OnceLock::new(),
            boundary_loops: OnceLock::new(),
            components: OnceLock::new(),
            orientation: OnceLock::new(),
        }
    }

    /// The edges as pairs of vertices, the lower first, in lexicographic order.
    pub fn edges(&self) -> &[[u32; 2]] {
        &self.tables.edges
    }

    /// The edges of each face; edge `k` lies opposite corner `k`.
    pub fn face_edges(&self) -> &[[u32; 3]] {
        &self.tables.face_edges
    }

    /// The faces of edge `e`, ascending: one on the boundary, two inside,
    /// more where the edge is not manifold.
    ///
    /// # Panics
    ///
    /// If there is no edge `e`.
    #[inline]
    pub fn edge_faces(&self, e: u32) -> &[u32] {
        self.tables.faces_of(e as usize)
    }

    /// The faces beside each face: entry `k` is the other face at edge `k`, which lies opposite
    /// corner `k`. `None` on the boundary and at edges with more than two faces.
    #[doc(alias("triangle_triangle_adjacency", "face_adjacency"))]
    pub fn face_neighbors(&self) -> Vec<[Option<u32>; 3]> {
        let other = |f: u32, e: u32| match *self.edge_faces(e) {
            [a, b] => Some(if a == f { b } else { a }),
            _ => None,
        };
        let faces = self.face_edges().iter().zip(0..);
        faces.map(|(edges, f)| edges.map(|e| other(f, e))).collect()
    }

    /// The edge between two vertices, in either order; `None` if no face
    /// joins them.
    ///
    /// # Panics
    ///
    /// If there is no such vertex.
    pub fn edge_between(&self, a: u32, b: u32) -> Option<u32> {
        self.tables.edge_between(a, b)
    }

    /// The vertices that share an edge with vertex `v`, ascending.
    ///
    /// # Panics
    ///
    /// If there is no vertex `v`.
    #[doc(alias("adjacency_list", "one_ring"))]
    #[inline]
    pub fn neighbors(&self, v: u32) -> &[u32] {
        self.tables.neighbors_of(v as usize)
    }

    /// Returns true if edge `e` has exactly one face.
    ///
    /// # Panics
    ///
    /// If there is no edge `e`.
    #[inline]
    pub fn is_boundary_edge(&self, e: u32) -> bool {
        self.edge_faces(e).len() == 1
    }

    /// Returns true if vertex `v` is the end of a boundary edge, which an isolated vertex is not.
    ///
    /// # Panics
    ///
    /// If there is no vertex `v`.
    #[inline]
    pub fn is_boundary_vertex(&self, v: u32) -> bool {
        self.boundary_vertices[v as usize]
    }

    /// [`Self::is_boundary_vertex`] for all vertices.
    pub fn boundary_vertices(&self) -> &[bool] {
        &self.boundary_vertices
    }

    /// The edges with exactly one face, ascending.
    pub fn boundary_edges(&self) -> impl Iterator<Item = u32> {
        (0..self.edges().len() as u32).filter(|&e| self.is_boundary_edge(e))
    }

    /// The edges with more than two faces, ascending.
    pub fn nonmanifold_edges(&self) -> impl Iterator<Item = u32> {
        (0..self.edges().len() as u32).filter(|&e| self.edge_faces(e).len() > 2)
    }

    /// The vertices that no face uses, ascending.
    pub fn isolated_vertices(&self) -> impl Iterator<Item = u32> {
        (0..self.vertex_count as u32).filter(|&v| self.incidence.corners(v).is_empty())
    }

    /// The vertices where two or more sheets of faces touch, ascending. Faces that
    /// share an edge belong to one sheet, however many faces the edge has, so the
    /// ends of a non-manifold edge are not listed for that edge alone.
    pub fn nonmanifold_vertices(&self) -> &[u32] {
        self.nonmanifold_vertices.get_or_init(|| self.find_nonmanifold_vertices())
    }

    /// The boundary as closed walks over vertices, each with the surface on
    /// its left, beginning with its first boundary edge; loops come in the
    /// order of these edges.
    ///
    /// Loops are counted sheet by sheet: two holes that touch in a vertex are
    /// two loops. If other than two boundary edges meet in one sheet, which takes
    /// non-manifold edges, there is no walk; the connected boundary edges then
    /// make one entry, its vertices in the order of a depth-first search.
    #[doc(alias = "boundary_loop")]
    pub fn boundary_loops(&self) -> &[Vec<u32>] {
        self.boundary_loops.get_or_init(|| self.find_boundary_loops())
    }

    /// The parts of the mesh connected by shared vertices.
    #[doc(alias("connected_components", "facet_components"))]
    pub fn components(&self) -> &Components {
        self.components.get_or_init(|| Components::new(self.vertex_count, &self.faces))
    }

    /// The orientation of neighbouring faces.
    pub fn orientation(&self) -> &Orientation {
        self.orientation.get_or_init(|| Orientation::new(&self.faces, &self.tables))
    }

    /// Returns true if every edge has at most two faces and every vertex one sheet.
    #[doc(alias = "is_edge_manifold")]
    pub fn is_manifold(&self) -> bool {
        self.nonmanifold_edges().next().is_none() && self.nonmanifold_vertices().is_empty()
    }

    /// Returns true if there are faces and no edge has exactly one.
    #[doc(alias = "is_watertight")]
    pub fn is_closed(&self) -> bool {
        !self.faces.is_empty() && self.boundary_edges().next().is_none()
    }

    /// The Euler characteristic χ = V − E + F, isolated vertices not counted.
    pub fn euler_characteristic(&self) -> i64 {
        let used = self.vertex_count - self.isolated_vertices().count();
        used as i64 - self.edges().len() as i64 + self.faces.len() as i64
    }

    /// The genus, summed over the components:
    ///
    /// ```text
    /// g = (2 C − χ − b) / 2
    /// ```
    ///
    /// for C components and b boundary loops. `None` without faces, or if the mesh is
    /// not manifold or not orientable.
    pub fn genus(&self) -> Option<u32> {
        if self.faces.is_empty() || !self.is_manifold() || !self.orientation().is_orientable() {
            return None;
        }
        let twice = 2 * self.components().count() as i64
            - self.euler_characteristic()
            - self.boundary_loops().len() as i64;
        u32::try_from(twice / 2).ok()
    }
}

#[cfg(test)]
mod tests;
