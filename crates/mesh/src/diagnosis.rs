//! Topology, defects and measures of a mesh, to inspect before a computation.

use fairing_watch::parallel;
use glam::DVec3;
use rayon::prelude::*;

use crate::repair::rounding;
use crate::trimesh::TriMesh;
use crate::weld::places_of;

/// The number of elements of one kind, and the lowest of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Tally {
    /// The number of elements.
    pub count: usize,
    /// The lowest element number, from 0; `None` if there are no elements.
    pub first: Option<u32>,
}

impl Tally {
    fn new(found: impl IntoIterator<Item = u32>) -> Self {
        let mut tally = Self::default();
        for element in found {
            tally.first = Some(tally.first.map_or(element, |f| f.min(element)));
            tally.count += 1;
        }
        tally
    }
}

/// Topology, defects and measures of a mesh.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Diagnosis {
    /// The number of vertices, isolated ones included.
    pub vertices: usize,
    /// The number of faces.
    pub faces: usize,
    /// The number of edges.
    pub edges: usize,
    /// The number of parts connected by shared vertices, isolated vertices not counted.
    pub components: usize,
    /// The number of boundary loops; holes that touch in a vertex are separate loops.
    pub boundary_loops: usize,
    /// The Euler characteristic V − E + F, isolated vertices not counted.
    pub euler_characteristic: i64,
    /// The genus, summed over the components; `None` if the mesh is not manifold,
    /// not orientable, or without faces.
    pub genus: Option<u32>,
    /// True if every edge has at most two faces and every vertex one sheet of faces.
    pub manifold: bool,
    /// True if there are faces and no edge has exactly one.
    pub closed: bool,
    /// True if flipping some faces would orient all of them consistently.
    pub orientable: bool,
    /// Vertices that no face uses.
    pub isolated_vertices: Tally,
    /// Faces without area: twice the area is at most
    /// [`Diagnosis::DEGENERATE`] × (longest edge)².
    pub degenerate_faces: Tally,
    /// Faces that have area but are thin: twice the area is below
    /// [`Diagnosis::SLIVER`] × (longest edge)².
    pub sliver_faces: Tally,
    /// Faces with the corners of an earlier face, in any order.
    pub duplicate_faces: Tally,
    /// Vertices at exactly the position of an earlier vertex.
    pub duplicate_positions: Tally,
    /// Vertices at a boundary that differ from another one by the rounding of single-precision
    /// coordinates ([`Tolerance::Rounding`](crate::Tolerance::Rounding)).
    pub rounded_vertices: Tally,
    /// Edges with more than two faces.
    pub nonmanifold_edges: Tally,
    /// Vertices where sheets of faces touch.
    pub nonmanifold_vertices: Tally,
    /// Edges whose two faces disagree in orientation.
    pub inconsistent_edges: Tally,
    /// Faces to flip so that neighbours agree
    /// ([`TriMesh::turned_faces`]).
    pub turned_faces: Tally,
    /// Vertices of boundary edges that lie exactly on another boundary edge
    /// ([`TriMesh::seam_vertices`]).
    pub seam_vertices: usize,
    /// Lowest and highest corner of the bounding box; `None` without
    /// vertices.
    pub bounding_box: Option<[[f64; 3]; 2]>,
    /// Area, in squared mesh units.
    pub area: f64,
    /// Enclosed volume in cubed mesh units, negative if the surface is
    /// inside out; faces count as [oriented](TriMesh::oriented). `None` unless
    /// closed and orientable.
    pub volume: Option<f64>,
    /// Length of the shortest edge, in mesh units; zero without faces.
    pub shortest_edge: f64,
    /// h, the mean length of the sides of the faces; zero without faces.
    pub mean_edge: f64,
    /// Length of the longest edge; zero without faces.
    pub longest_edge: f64,
}

impl Diagnosis {
    /// The largest ratio of height to longest edge at which a face counts as degenerate.
    /// Rounded coordinates give collinear corners heights of 1e-16 of their distance from
    /// the origin, so this leaves six digits for that distance.
    pub const DEGENERATE: f64 = 1e-10;

    /// The ratio of height to longest edge below which a face is a sliver, unless it is
    /// degenerate: its largest cotangent exceeds about 250.
    pub const SLIVER: f64 = 2e-3;

    /// Examines a mesh. Linear, apart from two sorts.
    pub fn new(mesh: &TriMesh) -> Self {
        let topology = mesh.topology();
        let thinness: Vec<f64> = parallel::map(mesh.face_count(), 4096, |f| height_ratio(mesh, f));
        let thin = |range: std::ops::Range<f64>| {
            Tally::new(
                (0..mesh.face_count() as u32).filter(|&f| range.contains(&thinness[f as usize])),
            )
        };
        let lengths = mesh.edge_lengths();
        let closed = topology.is_closed();
        let orientation = topology.orientation();
        let just_above = Self::DEGENERATE.next_up();
        Self {
            vertices: mesh.vertex_count(),
            faces: mesh.face_count(),
            edges: topology.edges().len(),
            components: topology.components().count(),
            boundary_loops: topology.boundary_loops().len(),
            euler_characteristic: topology.euler_characteristic(),
            genus: topology.genus(),
            manifold: topology.is_manifold(),
            closed,
            orientable: orientation.is_orientable(),
            isolated_vertices: Tally::new(topology.isolated_vertices()),
            degenerate_faces: thin(f64::NEG_INFINITY..just_above),
            sliver_faces: thin(just_above..Self::SLIVER),
            duplicate_faces: duplicate_faces(mesh),
            duplicate_positions: duplicate_positions(mesh),
            rounded_vertices: Tally::new(rounding::apart(mesh)),
            nonmanifold_edges: Tally::new(topology.nonmanifold_edges()),
            nonmanifold_vertices: Tally::new(topology.nonmanifold_vertices().iter().copied()),
            inconsistent_edges: Tally::new(orientation.inconsistent_edges().iter().copied()),
            turned_faces: Tally::new(mesh.turned_faces()),
            seam_vertices: mesh.seam_vertices(),
            bounding_box: mesh.bounding_box(),
            area: mesh.area(),
            volume: (closed && orientation.is_orientable()).then(|| mesh.signed_volume()),
            shortest_edge: lengths.iter().copied().reduce(f64::min).unwrap_or(0.0),
            mean_edge: mesh.mean_edge_length(),
            longest_edge: lengths.iter().copied().fold(0.0, f64::max),
        }
    }

    /// Returns true if the mesh is manifold and consistently oriented, without degenerate faces or
    /// isolated vertices, so that cotangents and areas exist everywhere.
    pub fn is_clean(&self) -> bool {
        self.manifold
            && self.inconsistent_edges.count == 0
            && self.degenerate_faces.count == 0
            && self.duplicate_faces.count == 0
            && self.isolated_vertices.count == 0
    }

    /// Remarks on normals that point inwards, on seams and on rounding, one sentence each without
    /// full stop.
    pub fn hints(&self) -> Vec<String> {
        let mut hints = vec![];
        if self.volume.is_some_and(|volume| volume < 0.0) {
            hints.push("the volume is negative: normals point inwards".to_owned());
        }
        if self.seam_vertices > 0 {
            let seam = "boundary vertices lie on another boundary: a seam that is not welded";
            hints.push(format!("{} {seam}", self.seam_vertices));
        }
        if self.rounded_vertices.count > 0 {
            let rounded = "boundary vertices differ from another vertex by rounding alone";
            hints.push(format!("{} {rounded}", self.rounded_vertices.count));
        }
        hints
    }
}

/// The ratio of height to longest edge: twice the area over the square of the longest edge. Zero
/// if all corners coincide.
fn height_ratio(mesh: &TriMesh, f: usize) -> f64 {
    let [a, b, c] = mesh.triangle(f).map(DVec3::from);
    let (u, v) = (b - a, c - a);
    // In units of the largest difference, nothing under- or overflows.
    let unit = u.abs().max_element().max(v.abs().max_element());
    if unit == 0.0 {
        return 0.0;
    }
    let (u, v) = (u / unit, v / unit);
    let longest = u.length().max(v.length()).max(u.distance(v));
    u.cross(v).length() / (longest * longest)
}

fn duplicate_faces(mesh: &TriMesh) -> Tally {
    let mut keys: Vec<([u32; 3], u32)> = parallel::map(mesh.faces().len(), 64, |f| {
        let face = mesh.faces()[f];
        let mut corners = face;
        corners.sort_unstable();
        (corners, f as u32)
    });
    keys.par_sort_unstable();
    Tally::new(keys.windows(2).filter(|w| w[0].0 == w[1].0).map(|w| w[1].1))
}

fn duplicate_positions(mesh: &TriMesh) -> Tally {
    let places = places_of(mesh.positions());
    Tally::new((0..places.len() as u32).filter(|&v| places[v as usize] != v))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_defect_is_found_with_its_first_element() {
        let positions = vec![
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.5, 0.0, 0.0],  // collinear with 0 and 1
            [0.5, 1e-3, 0.0], // a sliver with 0 and 1
            [-0.0, 1.0, 0.0], // the position of 2
            [9.0, 9.0, 9.0],  // isolated
        ];
        let faces = vec![[0, 1, 2], [0, 1, 3], [0, 4, 1], [2, 0, 1], [5, 1, 2]];
        let d = Diagnosis::new(&TriMesh::new(positions, faces).unwrap());
        let at = |count, first| Tally { count, first: Some(first) };
        assert_eq!(d.isolated_vertices, at(1, 6));
        // The last face has two corners at one position.
        assert_eq!(d.degenerate_faces, at(2, 1));
        assert_eq!(d.sliver_faces, at(1, 2));
        assert_eq!(d.duplicate_faces, at(1, 3));
        assert_eq!(d.duplicate_positions, at(1, 5));
        assert_eq!(d.nonmanifold_edges.count, 2);
        assert!(!d.manifold && !d.closed && d.volume.is_none() && d.genus.is_none());
        assert_eq!((d.longest_edge, d.shortest_edge), (2f64.sqrt(), 0.0));
    }

    #[test]
    fn hints_tell_the_side_and_seams() {
        let corners = [[0.0, 0.0, 0.0], [0.5, 0.0, 0.0], [0.0, 0.2, 0.0], [0.0, 0.0, 0.1]];
        let hints = |faces| Diagnosis::new(&TriMesh::new(corners.to_vec(), faces).unwrap()).hints();
        let outwards = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        let inwards = outwards.iter().map(|&[a, b, c]| [a, c, b]).collect();
        assert_eq!(hints(outwards), [""; 0]);
        assert_eq!(hints(inwards), ["the volume is negative: normals point inwards"]);
        let corners = [[0.0; 3], [50.0, 0.0, 0.0], [0.0, 20.0, 0.0]];
        let twice = [corners, corners].concat();
        let d = Diagnosis::new(&TriMesh::new(twice, vec![[0, 1, 2], [3, 4, 5]]).unwrap());
        let hints = d.hints();
        assert!(hints.len() == 1 && hints[0].starts_with("6 boundary vertices"), "{hints:?}");
    }

    /// The ratios do not depend on the unit of length.
    #[test]
    fn defects_do_not_depend_on_scale() {
        let flat = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 1.9e-3, 0.0], [0.5, -2.1e-3, 0.0]];
        for scale in [1e-29, 1e-9, 1.0, 1e9, 1e29] {
            let positions = flat.iter().map(|p| p.map(|x| x * scale)).collect();
            let mesh = TriMesh::new(positions, vec![[0, 1, 2], [1, 0, 3]]).unwrap();
            let diagnosis = Diagnosis::new(&mesh);
            assert_eq!(diagnosis.sliver_faces, Tally { count: 1, first: Some(0) }, "{scale}");
            assert_eq!(diagnosis.degenerate_faces.count, 0, "{scale}");
        }
    }
}
