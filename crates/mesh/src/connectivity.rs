//! Faces without positions, and everything derived from them alone.

use std::sync::{Arc, OnceLock};

use crate::incidence::Incidence;
use crate::polygon::PolygonFaces;
use crate::topology::Topology;

/// The faces of a mesh and everything derived from faces alone. Meshes that
/// differ in positions only share one `Connectivity`.
#[derive(Debug)]
pub struct Connectivity {
    vertex_count: usize,
    faces: Arc<Vec<[u32; 3]>>,
    /// The polygons that the faces were split from.
    polygons: Option<PolygonFaces>,
    incidence: OnceLock<Arc<Incidence>>,
    topology: OnceLock<Topology>,
    consistent: OnceLock<bool>,
}

impl Connectivity {
    /// Takes faces whose indices and corners have been checked, and the polygons that they were
    /// split from.
    pub(crate) fn new(
        vertex_count: usize,
        faces: Vec<[u32; 3]>,
        polygons: Option<PolygonFaces>,
    ) -> Self {
        Self {
            vertex_count,
            faces: Arc::new(faces),
            polygons,
            incidence: OnceLock::new(),
            topology: OnceLock::new(),
            consistent: OnceLock::new(),
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

    pub(crate) fn polygons(&self) -> Option<&PolygonFaces> {
        self.polygons.as_ref()
    }

    /// The corners at each vertex, computed on first use.
    pub fn incidence(&self) -> &Incidence {
        self.shared_incidence()
    }

    /// Edges, neighbours, rings and boundary, computed on first use.
    pub fn topology(&self) -> &Topology {
        self.topology.get_or_init(|| {
            Topology::new(
                self.vertex_count,
                Arc::clone(&self.faces),
                Arc::clone(self.shared_incidence()),
            )
        })
    }

    /// Returns true if the two faces of every interior edge run through it in
    /// opposite directions. Computed on first use, and without a topology
    /// if no two faces leave a vertex for the same neighbour.
    pub fn is_consistent(&self) -> bool {
        *self.consistent.get_or_init(|| {
            (self.topology.get().is_none() && self.incidence().leaves_each_side_once())
                || self.topology().orientation().is_consistent()
        })
    }

    fn shared_incidence(&self) -> &Arc<Incidence> {
        self.incidence.get_or_init(|| {
            let faces = Arc::clone(&self.faces);
            Arc::new(Incidence::new(self.vertex_count, faces))
        })
    }
}
