//! The result of a repair.

#[cfg(feature = "io")]
use crate::io::{NumberType, VertexFields};
use crate::trimesh::TriMesh;

/// A step of [`repair`](super::repair).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum RepairStep {
    /// Vertices merged into an earlier one at the same place.
    MergedVertices,
    /// Faces dropped because two of their corners were merged.
    CollapsedFaces,
    /// Faces dropped because another one has the same corners.
    DuplicateFaces,
    /// Faces flipped.
    TurnedFaces,
    /// Vertices of which a sheet of faces got a copy.
    SplitVertices,
    /// Faces dropped with their small component.
    SmallComponents,
    /// Thin faces removed by collapsing an edge, or changed by flipping one.
    ThinFaces,
    /// Vertices dropped because no face uses them.
    IsolatedVertices,
    /// Holes filled, each named by the lowest vertex of its boundary.
    FilledHoles,
    /// Holes left open, each named by the lowest vertex of its boundary; no change of the mesh.
    /// [`Repaired::open_holes`] has the reasons.
    OpenHoles,
    /// Vertices whose position changed: they were merged with vertices at other positions.
    MovedVertices,
    /// Closed parts within others that stay as they are wound, each named by its lowest face,
    /// where [`cavities`](super::RepairOptions::cavities) would turn them; no change of the mesh.
    NestedParts,
    /// Vertices at the position of an earlier vertex that stay, because their faces share no edge
    /// with its faces, or more than two would share one; no change of the mesh.
    TouchingVertices,
}

fairing_parameters::named!(RepairStep, "step of a repair",
    MergedVertices: "merged-vertices",
    CollapsedFaces: "collapsed-faces",
    DuplicateFaces: "duplicate-faces",
    TurnedFaces: "turned-faces",
    SplitVertices: "split-vertices",
    SmallComponents: "small-components",
    ThinFaces: "thin-faces",
    IsolatedVertices: "isolated-vertices",
    FilledHoles: "filled-holes",
    OpenHoles: "open-holes",
    MovedVertices: "moved-vertices",
    NestedParts: "nested-parts",
    TouchingVertices: "touching-vertices",
);

impl RepairStep {
    /// True for elements that are named and not changed.
    pub const fn is_note(self) -> bool {
        matches!(self, Self::OpenHoles | Self::NestedParts | Self::TouchingVertices)
    }
}

/// A hole that [`repair`](super::repair) left open.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct OpenHole {
    /// The lowest vertex of its boundary, a number of the input.
    pub vertex: u32,
    /// The number of its edges.
    pub edges: usize,
    /// The reason why it is open.
    pub reason: OpenReason,
}

/// The reason why [`repair`](super::repair) leaves a hole open.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum OpenReason {
    /// It has more edges than [`RepairOptions::holes`](super::RepairOptions::holes).
    TooLarge,
    /// It is the rim of a single face.
    LoneFace,
    /// Every patch would repeat an edge of the mesh.
    NoPatch,
    /// Other steps would remove the patch.
    PatchRemoved,
}

fairing_parameters::named!(OpenReason, "reason for an open hole",
    TooLarge: "too-large",
    LoneFace: "lone-face",
    NoPatch: "no-patch",
    PatchRemoved: "patch-removed",
);

/// The result of [`repair`](super::repair).
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Repaired {
    /// The repaired mesh. Vertices and faces that were kept have their order; copies of split
    /// vertices follow, then the patches of holes.
    pub mesh: TriMesh,
    /// For each vertex the vertex of the input at its place, from which a split one was copied;
    /// `None` inside the patch of a hole.
    pub vertex_sources: Vec<Option<u32>>,
    /// For each face the face of the input; `None` in the patch of a hole.
    pub face_sources: Vec<Option<u32>>,
    /// For each vertex of the input the vertex that took its place, the first of several; `None`
    /// if it was dropped.
    pub vertices: Vec<Option<u32>>,
    /// The elements that each step changed, with their numbers in the input, ascending; steps that
    /// changed nothing are left out.
    pub changes: Vec<(RepairStep, Vec<u32>)>,
    /// The holes that are left, ascending by vertex; empty if none were to be filled.
    pub open_holes: Vec<OpenHole>,
}

impl Repaired {
    /// The elements that a step changed, ascending.
    pub fn changed(&self, step: RepairStep) -> &[u32] {
        self.changes.iter().find(|(s, _)| *s == step).map_or(&[], |(_, elements)| elements)
    }

    /// True if the mesh is the input, vertex by vertex and face by face.
    pub fn is_unchanged(&self) -> bool {
        self.changes.iter().all(|(step, _)| step.is_note())
    }

    /// The vertices inside the patches of holes, ascending.
    pub fn patch_vertices(&self) -> Vec<u32> {
        patch_vertices(&self.vertex_sources)
    }

    /// For each vertex its source, or in the patch of a hole that of a vertex nearby, ring by ring:
    /// the vertex whose properties it takes.
    pub fn nearest_sources(&self) -> Vec<u32> {
        let mut sources = self.vertex_sources.clone();
        let mut patch = self.patch_vertices();
        while !patch.is_empty() {
            let known = sources.clone();
            let before = patch.len();
            patch.retain(|&v| {
                let around = self.mesh.topology().neighbors(v).iter();
                sources[v as usize] = around.filter_map(|&w| known[w as usize]).next();
                sources[v as usize].is_none()
            });
            if patch.len() == before {
                break;
            }
        }
        sources.into_iter().map(Option::unwrap_or_default).collect()
    }

    /// For each corner of each face in turn the corner of `input`, the mesh that was repaired,
    /// whose properties it takes: three times its face plus its place in it. The patch of a hole
    /// takes those of a face nearby, a flipped face without the vertex the corner at its place.
    pub fn nearest_corners(&self, input: &TriMesh) -> Vec<usize> {
        let vertices = self.nearest_sources();
        let face_at = |v: u32| input.incidence().corners(v).first().map_or(0, |corner| corner / 3);
        let corners = self.face_sources.iter().zip(self.mesh.faces()).flat_map(|(source, face)| {
            let f = source.unwrap_or_else(|| face_at(vertices[face[0] as usize])) as usize;
            [0, 1, 2].map(|k| {
                let same = |v: &u32| {
                    self.vertices[*v as usize] == Some(face[k])
                        || self.vertex_sources[face[k] as usize] == Some(*v)
                };
                3 * f + input.faces()[f].iter().position(same).unwrap_or(k)
            })
        });
        corners.collect()
    }

    /// The fields of `input`, the mesh that was repaired, at the vertices and faces of the result,
    /// with those nearby in the patches of holes, and without normals that no longer fit. The
    /// field `source` is the vertex of the input, −1 in the patch of a hole.
    ///
    /// # Panics
    ///
    /// If the fields are not those of `input`.
    #[cfg(feature = "io")]
    pub fn carried(&self, input: &TriMesh, fields: VertexFields) -> VertexFields {
        let mut fields = if self.changes_normals() { fields.without_normals() } else { fields };
        fields.scalars.retain(|(name, _)| name != "source");
        let source = self.vertex_sources.iter().map(|v| v.map_or(-1.0, f64::from)).collect();
        let vertices = self.nearest_sources();
        let corners = self.nearest_corners(input);
        let faces: Vec<usize> = corners.iter().step_by(3).map(|corner| corner / 3).collect();
        let mut fields = fields.selected(&vertices, &faces, corners).with_scalar("source", source);
        fields.types.insert("source".to_owned(), NumberType::I32);
        fields
    }

    /// True if normals of the input no longer fit: vertices were merged, faces flipped or
    /// mended, or holes filled.
    pub fn changes_normals(&self) -> bool {
        use RepairStep::{FilledHoles, MergedVertices, ThinFaces, TurnedFaces};
        let steps = [MergedVertices, TurnedFaces, ThinFaces, FilledHoles];
        steps.iter().any(|&step| !self.changed(step).is_empty())
    }
}

/// The vertices without a source.
pub(super) fn patch_vertices(sources: &[Option<u32>]) -> Vec<u32> {
    let new = sources.iter().enumerate().filter(|(_, source)| source.is_none());
    new.map(|(v, _)| v as u32).collect()
}
