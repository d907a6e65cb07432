//! Repair of the defects that scanners, modellers and exporters leave in files.
//!
//! A round runs the steps in the order of [`RepairStep::ALL`], all but the filling of holes; rounds
//! follow until one changes nothing. Then holes are filled, and rounds follow again: the result is
//! taken if less boundary is left. So a second call that merges within the same distance changes
//! nothing.

mod copies;
mod holes;
mod merge;
mod options;
mod outward;
mod patch;
mod result;
pub(crate) mod rounding;
mod split;
mod thin;

use fairing_watch as watch;

use crate::build::check_positions;
use crate::trimesh::TriMesh;
use crate::weld::places_of;

pub use self::options::{RepairError, RepairOptions, Tolerance};
pub use self::result::{OpenHole, OpenReason, RepairStep, Repaired};

/// The most rounds; steps that still undo each other after that many end there.
const MAX_ROUNDS: usize = 64;

/// Mends a mesh.
///
/// Merges vertices, drops redundant faces and unused vertices, flips faces that disagree, separates
/// sheets that touch, and on request removes small components and thin faces and fills holes. The
/// remaining elements keep their order. Only merged vertices move, by at most the tolerance, and
/// vertices of collapsed needles. The steps:
///
/// - Sheets at an edge with more than two faces are paired so that each pair bounds a wedge of the
///   inside \[gueziec2001\]; a face that is left over, such as a fin on a surface, is cut off.
/// - A component is closed if it has no boundary. It contains the components inside it, by winding
///   number, and is flipped with them if it is inside out and inside no other component.
/// - A needle loses its shortest edge, unless a face would flip or an end lies on another
///   boundary; a cap exchanges its longest edge.
/// - A hole gets the triangulation of least area \[barequet1995\] that repeats no edge of the mesh,
///   refined to the edge lengths around it \[liepa2003\]. A boundary that passes a point more than
///   once is a hole for each time, so that holes that touch are filled one by one. Inner vertices
///   lie on the flat triangulation, also over a curved surface; `repair_fair` of the smoothing
///   crate bends the patch.
///
/// Time is linear in the mesh apart from a sort, cubic in the edges of a hole, and for closed
/// components inside others the product of their number and the faces around them.
///
/// # Errors
///
/// [`RepairError::Option`] if the tolerance is out of its range, `thin` not in `[0, 0.1]`, or
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
    let mut work = Work::new(mesh, options.tolerance.distance(mesh));
    work.settle(options);
    while options.holes > 0 && work.fill(options, &mut place) {}
    check_positions(work.mesh.positions()).map_err(RepairError::Positions)?;
    Ok(work.finish(mesh, options))
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
    /// The lowest faces of the parts within others that cavities would turn.
    nested: Vec<u32>,
    open_holes: Vec<OpenHole>,
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
            nested: vec![],
            open_holes: vec![],
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
        let left = filled.fill_holes(options.holes, &filled.places(options));
        let boundary = |work: &Self| work.mesh.topology().boundary_edges().count();
        let before = boundary(self);
        let any = filled.mesh.face_count() > self.mesh.face_count();
        if any && filled.settle(options) && boundary(&filled) < before {
            *self = filled;
            let patch = result::patch_vertices(&self.vertex_sources);
            if let Some(mesh) = (!patch.is_empty()).then(|| place(&self.mesh, patch)).flatten() {
                let mut placed = Self { mesh, ..self.clone() };
                if placed.settle(options) && boundary(&placed) < before {
                    *self = placed;
                }
            }
            return true;
        }
        self.open_holes = left;
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
            self.turn_outward(options);
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

    fn finish(self, input: &TriMesh, options: &RepairOptions) -> Repaired {
        let touching = if options.merge { self.touching() } else { vec![] };
        let Self { mesh, vertex_sources, face_sources, turned, merged_into, .. } = self;
        let Self { mut changes, nested, mut open_holes, .. } = self;
        open_holes.sort_by_key(|hole| (hole.vertex, hole.edges));
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
        let has_moved = |(v, w): &(usize, &Option<u32>)| {
            w.is_some_and(|w| mesh.positions()[w as usize] != input.positions()[*v])
        };
        let moved = vertices.iter().enumerate().filter(has_moved).map(|(v, _)| v as u32).collect();
        changes.extend([
            (RepairStep::MovedVertices, moved),
            (RepairStep::NestedParts, nested),
            (RepairStep::TouchingVertices, touching),
            (RepairStep::OpenHoles, open_holes.iter().map(|hole| hole.vertex).collect()),
        ]);
        let changes = RepairStep::ALL.into_iter().filter_map(|step| {
            let elements = changes.iter().filter(|(s, _)| *s == step).flat_map(|(_, e)| e);
            let mut elements: Vec<u32> = elements.copied().collect();
            elements.sort_unstable();
            match step {
                // Two holes may have the same lowest vertex.
                RepairStep::FilledHoles | RepairStep::OpenHoles => {}
                _ => elements.dedup(),
            }
            (!elements.is_empty()).then_some((step, elements))
        });
        let changes = changes.collect();
        Repaired { changes, mesh, vertex_sources, face_sources, vertices, open_holes }
    }

    /// The vertices, by their sources, at the position of a vertex with another source.
    fn touching(&self) -> Vec<u32> {
        let first = places_of(self.mesh.positions());
        let sources = &self.vertex_sources;
        let pairs = first.iter().zip(sources).map(|(&first, &v)| (sources[first as usize], v));
        pairs.filter(|(first, v)| first != v).filter_map(|(_, v)| v).collect()
    }
}

/// The items that are kept.
fn kept<T: Copy>(items: &[T], keep: &[bool]) -> Vec<T> {
    items.iter().zip(keep).filter(|(_, keep)| **keep).map(|(&item, _)| item).collect()
}

#[cfg(test)]
mod tests;
