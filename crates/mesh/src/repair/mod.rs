//! Repair: one call that mends what scanners, modellers and exporters leave in files.
//!
//! A round runs the steps in the order of [`RepairStep::ALL`], all but the filling of holes; rounds
//! follow until one changes nothing. Then holes are filled, and rounds follow again: the result is
//! taken if less boundary is left. So a second call leaves a repaired mesh as it is, if it merges
//! within the same distance.

mod copies;
mod holes;
mod merge;
mod outward;
mod patch;
mod split;
mod thin;

use fairing_parameters::{ParameterError, Range};
use fairing_watch as watch;

use crate::TriMesh;
use crate::build::{BuildError, check_positions};
#[cfg(feature = "io")]
use crate::io::VertexFields;

/// The most rounds; steps that still undo each other after that many end there.
const MAX_ROUNDS: usize = 64;

/// Steps of [`repair`] and their limits.
///
/// The default changes no geometry: the same points are covered by the same triangles.
#[derive(Debug, Clone, PartialEq)]
pub struct RepairOptions {
    /// Merges vertices at one position, and drops faces that lose a corner by it.
    pub merge: bool,
    /// The distance up to which vertices are merged, in mean edge lengths of the input; zero
    /// merges vertices at exactly equal positions. A vertex moves to the first vertex of the file
    /// within the distance that itself stays, so that none moves farther than the distance.
    pub tolerance: f64,
    /// Drops faces with the corners of an earlier face, in any order. Both go if they are a fin of
    /// a closed surface, which one of them would open; both stay if they are a wall between two
    /// closed parts.
    pub duplicates: bool,
    /// Flips faces so that neighbours agree, as [`TriMesh::oriented`] does, and closed components
    /// so that their normals point outwards, or inwards where they are cavities of another one.
    pub orient: bool,
    /// Gives a vertex of its own to each sheet of faces at a non-manifold edge or vertex. Faces
    /// that run the same way along such an edge are different sheets.
    pub split: bool,
    /// Drops components with fewer faces than this; zero keeps all.
    pub smallest_component: usize,
    /// Collapses needles and flips caps: faces whose height is below this fraction of their
    /// longest edge. Zero leaves them.
    pub thin: f64,
    /// Drops vertices that no face uses, unless there are no faces at all.
    pub isolated: bool,
    /// Fills holes of at most this many edges; zero fills none. The largest boundary of a
    /// component that is not closed may be its rim, so choose less than its edges.
    pub holes: usize,
}

impl RepairOptions {
    /// The defaults.
    pub const DEFAULT: Self = Self {
        merge: true,
        tolerance: 0.0,
        duplicates: true,
        orient: true,
        split: true,
        smallest_component: 0,
        thin: 0.0,
        isolated: true,
        holes: 0,
    };

    /// No step at all, to choose steps one by one.
    pub const NONE: Self = Self {
        merge: false,
        duplicates: false,
        orient: false,
        split: false,
        isolated: false,
        ..Self::DEFAULT
    };

    /// The largest number of edges of a hole to fill: its triangulation takes time cubic in it.
    pub const MAX_HOLE: usize = 2000;

    fn check(&self) -> Result<(), ParameterError> {
        Range::FRACTION.check("tolerance", self.tolerance)?;
        Range::from(0.0..=0.1).check("thin", self.thin)?;
        Range::from(0.0..=Self::MAX_HOLE as f64).check("holes", self.holes as f64)
    }
}

impl Default for RepairOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// A reason for which [`repair`] fails.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RepairError {
    /// An option is out of range.
    #[error(transparent)]
    Option(#[from] ParameterError),
    /// The positions that are left do not make a mesh: without the vertices that were dropped or
    /// merged, their extent is out of range.
    #[error("the repaired mesh is not valid: {0}")]
    Positions(#[source] BuildError),
}

/// A step of [`repair`].
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
    /// Holes that were not too large but could not be filled: every triangulation would repeat an
    /// edge of the mesh, or other steps would remove the patch. Each is named by the lowest vertex
    /// of its boundary.
    OpenHoles,
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
);

/// The result of [`repair`].
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
}

impl Repaired {
    /// The elements that a step changed, ascending.
    pub fn changed(&self, step: RepairStep) -> &[u32] {
        self.changes.iter().find(|(s, _)| *s == step).map_or(&[], |(_, elements)| elements)
    }

    /// True if the mesh is the input, vertex by vertex and face by face.
    pub fn is_unchanged(&self) -> bool {
        self.changes.iter().all(|(step, _)| *step == RepairStep::OpenHoles)
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
        fields.selected(&vertices, &faces, corners).with_scalar("source", source)
    }

    /// True if normals of the input no longer fit: vertices were merged, faces flipped or
    /// mended, or holes filled.
    pub fn changes_normals(&self) -> bool {
        use RepairStep::{FilledHoles, MergedVertices, ThinFaces, TurnedFaces};
        let steps = [MergedVertices, TurnedFaces, ThinFaces, FilledHoles];
        steps.iter().any(|&step| !self.changed(step).is_empty())
    }
}

/// Mends a mesh.
///
/// Merges vertices, drops faces and vertices that are of no use, flips faces that disagree,
/// separates sheets that touch, and on request removes small components and thin faces and fills
/// holes. The order of what stays is kept, and nothing is moved, except merged vertices by at most
/// the tolerance and by collapsed needles. The steps:
///
/// - Sheets at an edge with more than two faces are paired so that each pair bounds a wedge of the
///   inside \[gueziec2001\]; a face that is left over, such as a fin on a surface, is cut off.
/// - A component is closed if it has no boundary. Its cavities are the closed components inside
///   it, by winding number.
/// - A needle loses its shortest edge, unless a face would flip or an end lies on another
///   boundary; a cap exchanges its longest edge.
/// - A hole gets the triangulation of least area \[barequet1995\] that repeats no edge of the mesh,
///   refined to the edge lengths around it \[liepa2003\]. Its inner vertices lie on that
///   triangulation, flat over a curved surface: `repair_fair` of the smoothing crate bends them.
///
/// Time is linear in the mesh apart from a sort, cubic in the edges of a hole, and for closed
/// components inside others the product of their number and the faces around them.
///
/// # Errors
///
/// [`RepairError::Option`] if the tolerance is not in `[0, 1]`, `thin` not in `[0, 0.1]`, or
/// `holes` above [`RepairOptions::MAX_HOLE`]; [`RepairError::Positions`] if the vertices that are
/// left span less than a mesh may.
///
/// # Examples
///
/// ```
/// use fairing_mesh::{RepairOptions, RepairStep, TriMesh, repair};
///
/// // Two triangles without shared corners, wound differently, and a vertex without a face.
/// let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
/// let mut own = [0, 1, 2, 1, 2, 3].map(|v| corners[v]).to_vec();
/// own.push([7.0, 7.0, 7.0]);
/// let soup = TriMesh::new(own, vec![[0, 1, 2], [3, 4, 5]])?;
///
/// let repaired = repair(&soup, &RepairOptions::default())?;
/// assert_eq!(repaired.mesh.faces(), [[0, 1, 2], [1, 3, 2]]);
/// assert_eq!(repaired.changed(RepairStep::TurnedFaces), [1]);
/// assert_eq!(repaired.changed(RepairStep::IsolatedVertices), [6]);
/// assert!(repair(&repaired.mesh, &RepairOptions::default())?.is_unchanged());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Sources: \[gueziec2001\], \[barequet1995\], \[liepa2003\].
#[doc(alias("fill_holes", "fix_normals", "remove_degenerate_faces", "remove_unreferenced"))]
pub fn repair(mesh: &TriMesh, options: &RepairOptions) -> Result<Repaired, RepairError> {
    repair_with(mesh, options, |_, _| None)
}

/// Mends a mesh as [`repair`] does, with patches of holes placed by a function.
///
/// `place` takes a mesh and the vertices inside patches, and returns the mesh with these moved, or
/// `None` to leave them. Rounds of the other steps follow, so that a second call within the same
/// distance changes nothing; vertices return to the flat patch if a round would open the hole
/// again.
///
/// `repair_fair` of the smoothing crate calls this with the smoothest patch.
///
/// # Errors
///
/// As [`repair`].
pub fn repair_with(
    mesh: &TriMesh,
    options: &RepairOptions,
    mut place: impl FnMut(&TriMesh, Vec<u32>) -> Option<TriMesh>,
) -> Result<Repaired, RepairError> {
    options.check()?;
    watch::stage("repairing", 0);
    let mut work = Work::new(mesh, options.tolerance * mesh.mean_edge_length());
    work.settle(options);
    while options.holes > 0 && work.fill(options, &mut place) {}
    check_positions(work.mesh.positions()).map_err(RepairError::Positions)?;
    Ok(work.finish(mesh))
}

/// A mesh under repair, with the sources of its elements in the input.
#[derive(Clone)]
struct Work {
    mesh: TriMesh,
    /// The distance up to which vertices are merged.
    distance: f64,
    vertex_sources: Vec<Option<u32>>,
    face_sources: Vec<Option<u32>>,
    /// True for each face that was flipped an odd number of times.
    turned: Vec<bool>,
    /// The vertex of the input that took the place of each merged one.
    merged_into: Vec<(u32, u32)>,
    changes: Vec<(RepairStep, Vec<u32>)>,
}

impl Work {
    fn new(mesh: &TriMesh, distance: f64) -> Self {
        Self {
            mesh: mesh.clone(),
            distance,
            vertex_sources: (0..mesh.vertex_count() as u32).map(Some).collect(),
            face_sources: (0..mesh.face_count() as u32).map(Some).collect(),
            turned: vec![false; mesh.face_count()],
            merged_into: vec![],
            changes: vec![],
        }
    }

    /// Runs rounds until one changes nothing. Returns false if the last one still did.
    fn settle(&mut self, options: &RepairOptions) -> bool {
        (0..MAX_ROUNDS).any(|_| !self.round(options))
    }

    /// Fills holes, places the patches, and settles. Returns false, with the mesh as it was, if
    /// that does not leave less boundary: a patch that makes an edge non-manifold is cut off again.
    fn fill(
        &mut self,
        options: &RepairOptions,
        place: &mut impl FnMut(&TriMesh, Vec<u32>) -> Option<TriMesh>,
    ) -> bool {
        let mut filled = self.clone();
        filled.fill_holes(options.holes, &filled.places(options));
        let notes = filled.changes[self.changes.len()..].to_vec();
        let boundary = |work: &Self| work.mesh.topology().boundary_edges().count();
        let before = boundary(self);
        let any = filled.mesh.face_count() > self.mesh.face_count();
        if any && filled.settle(options) && boundary(&filled) < before {
            *self = filled;
            let patch = patch_vertices(&self.vertex_sources);
            if let Some(mesh) = (!patch.is_empty()).then(|| place(&self.mesh, patch)).flatten() {
                let mut placed = Self { mesh, ..self.clone() };
                if placed.settle(options) && boundary(&placed) < before {
                    *self = placed;
                }
            }
            return true;
        }
        let open = notes.into_iter().map(|(_, holes)| (RepairStep::OpenHoles, holes));
        self.changes.extend(open);
        false
    }

    /// Runs all steps once, except that holes stay. Returns true if the mesh has changed.
    fn round(&mut self, options: &RepairOptions) -> bool {
        let before = self.mesh.clone();
        self.sew(options);
        if options.smallest_component > 1 {
            self.drop_small_components(options.smallest_component);
        }
        if options.thin > 0.0 {
            self.mend_thin_faces(options.thin);
        }
        if options.orient {
            self.turn_outward();
        }
        if options.isolated {
            self.drop_isolated();
        }
        self.mesh != before
    }

    /// Notes the elements that a step changed, given by their sources.
    fn note(&mut self, step: RepairStep, sources: impl IntoIterator<Item = Option<u32>>) {
        self.changes.push((step, sources.into_iter().flatten().collect()));
    }

    /// Drops the faces that are not kept.
    fn keep_faces(&mut self, step: RepairStep, keep: &[bool]) {
        if !keep.contains(&false) {
            return;
        }
        let dropped = self.face_sources.iter().zip(keep).filter(|(_, keep)| !**keep);
        let dropped: Vec<_> = dropped.map(|(&source, _)| source).collect();
        self.note(step, dropped);
        let faces = kept(self.mesh.faces(), keep);
        self.face_sources = kept(&self.face_sources, keep);
        self.turned = kept(&self.turned, keep);
        self.mesh = TriMesh::from_checked(self.mesh.positions().to_vec(), faces);
    }

    /// Drops the vertices that are not kept; no face uses them.
    fn keep_vertices(&mut self, keep: &[bool]) {
        let mut numbers = vec![0; keep.len()];
        let mut next = 0;
        for (number, &keep) in numbers.iter_mut().zip(keep) {
            *number = next;
            next += u32::from(keep);
        }
        let faces = self.mesh.faces().iter().map(|face| face.map(|v| numbers[v as usize]));
        let faces = faces.collect();
        self.vertex_sources = kept(&self.vertex_sources, keep);
        self.mesh = TriMesh::from_checked(kept(self.mesh.positions(), keep), faces);
    }

    /// Drops components, connected by shared vertices, with fewer faces than `smallest`, and
    /// their vertices.
    fn drop_small_components(&mut self, smallest: usize) {
        let components = self.mesh.topology().components();
        let label = |face: &[u32; 3]| components.label(face[0]).unwrap_or_default() as usize;
        let mut sizes = vec![0; components.count()];
        self.mesh.faces().iter().for_each(|face| sizes[label(face)] += 1);
        let keep: Vec<bool> =
            self.mesh.faces().iter().map(|face| sizes[label(face)] >= smallest).collect();
        let vertices = 0..self.mesh.vertex_count() as u32;
        let keep_vertices: Vec<bool> = vertices
            .map(|v| components.label(v).is_none_or(|label| sizes[label as usize] >= smallest))
            .collect();
        if keep.contains(&false) {
            self.keep_faces(RepairStep::SmallComponents, &keep);
            self.keep_vertices(&keep_vertices);
        }
    }

    /// Drops vertices without a face, unless there are no faces: then they are a point cloud.
    fn drop_isolated(&mut self) {
        if self.mesh.face_count() == 0 {
            return;
        }
        let mut keep = vec![false; self.mesh.vertex_count()];
        self.mesh.faces().iter().flatten().for_each(|&v| keep[v as usize] = true);
        if keep.contains(&false) {
            let dropped = self.vertex_sources.iter().zip(&keep).filter(|(_, keep)| !**keep);
            let dropped: Vec<_> = dropped.map(|(&source, _)| source).collect();
            self.note(RepairStep::IsolatedVertices, dropped);
            self.keep_vertices(&keep);
        }
    }

    fn finish(self, input: &TriMesh) -> Repaired {
        let Self { mesh, vertex_sources, face_sources, turned, merged_into, mut changes, .. } =
            self;
        let of_turned = face_sources.iter().zip(&turned).filter(|(_, turned)| **turned);
        changes.push((RepairStep::TurnedFaces, of_turned.filter_map(|(&f, _)| f).collect()));
        let mut vertices = vec![None; input.vertex_count()];
        for (v, source) in vertex_sources.iter().enumerate().rev() {
            if let Some(source) = source {
                vertices[*source as usize] = Some(v as u32);
            }
        }
        // A vertex may have been merged into one that was merged in a later round.
        for &(vertex, into) in merged_into.iter().rev() {
            vertices[vertex as usize] = vertices[vertex as usize].or(vertices[into as usize]);
        }
        let changes = RepairStep::ALL.into_iter().filter_map(|step| {
            let elements = changes.iter().filter(|(s, _)| *s == step).flat_map(|(_, e)| e);
            let mut elements: Vec<u32> = elements.copied().collect();
            elements.sort_unstable();
            elements.dedup();
            (!elements.is_empty()).then_some((step, elements))
        });
        Repaired { changes: changes.collect(), mesh, vertex_sources, face_sources, vertices }
    }
}

/// The vertices without a source.
fn patch_vertices(sources: &[Option<u32>]) -> Vec<u32> {
    let new = sources.iter().enumerate().filter(|(_, source)| source.is_none());
    new.map(|(v, _)| v as u32).collect()
}

/// The items that are kept.
fn kept<T: Copy>(items: &[T], keep: &[bool]) -> Vec<T> {
    items.iter().zip(keep).filter(|(_, keep)| **keep).map(|(&item, _)| item).collect()
}

#[cfg(test)]
mod tests;
