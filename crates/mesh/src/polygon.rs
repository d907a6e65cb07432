//! Meshes of polygons.

#[cfg_attr(not(feature = "io"), expect(dead_code, reason = "readers fill the list"))]
mod list;
mod triangulate;

use crate::build::{BuildError, check_positions};

pub(crate) use list::repeats_a_corner;
#[cfg(feature = "io")]
pub(crate) use list::{Distinct, Polygons, first_mentions};

/// A mesh whose faces have three corners or more, always valid: indices are in
/// range, coordinates are finite, and no face repeats a corner.
///
/// Vertices and faces keep the order of their source.
#[derive(Debug, Clone, PartialEq)]
pub struct PolygonMesh {
    positions: Vec<[f64; 3]>,
    faces: PolygonFaces,
}

/// The faces of a [`PolygonMesh`]. A [`TriMesh`](crate::TriMesh) that was split from one
/// [keeps](crate::TriMesh::polygons) them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PolygonFaces {
    /// The start of each face in `corners`, and the end of the last.
    offsets: Vec<u32>,
    corners: Vec<u32>,
}

impl PolygonFaces {
    pub(crate) fn of_triangles(faces: &[[u32; 3]]) -> Self {
        let offsets = (0..=faces.len() as u32).map(|f| 3 * f).collect();
        Self { offsets, corners: faces.as_flattened().to_vec() }
    }

    /// The number of polygons.
    pub fn count(&self) -> usize {
        self.offsets.len() - 1
    }

    /// The corners of polygon `f`, counter-clockwise seen from outside.
    ///
    /// # Panics
    ///
    /// If there is no polygon `f`.
    #[inline]
    pub fn face(&self, f: usize) -> &[u32] {
        &self.corners[self.offsets[f] as usize..self.offsets[f + 1] as usize]
    }

    /// The corners of each polygon in turn.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &[u32]> {
        (0..self.count()).map(|f| self.face(f))
    }

    /// The start of each polygon in [`corners`](Self::corners), and the end of the last.
    pub fn offsets(&self) -> &[u32] {
        &self.offsets
    }

    /// The corners of all polygons, one after another.
    pub fn corners(&self) -> &[u32] {
        &self.corners
    }

    /// The number of polygons of more than three corners.
    pub fn non_triangles(&self) -> usize {
        self.offsets.windows(2).filter(|ends| ends[1] - ends[0] > 3).count()
    }

    /// The triangles that polygon `f` of n corners is split into: n − 2, in the order of the
    /// polygons.
    ///
    /// # Panics
    ///
    /// If there is no polygon `f`.
    pub fn triangles_of(&self, f: usize) -> std::ops::Range<usize> {
        let start = |f: usize| self.offsets[f] as usize - 2 * f;
        start(f)..start(f + 1)
    }
}

impl PolygonMesh {
    /// Checks and keeps positions (in mesh units) and faces (counter-clockwise
    /// seen from outside).
    ///
    /// # Errors
    ///
    /// [`BuildError`] for the first vertex or face that is not valid.
    pub fn new<F: AsRef<[u32]>>(
        positions: Vec<[f64; 3]>,
        faces: impl IntoIterator<Item = F>,
    ) -> Result<Self, BuildError> {
        let vertex_count = positions.len();
        if u32::try_from(vertex_count).is_err() {
            return Err(BuildError::TooLarge { what: "vertices", count: vertex_count });
        }
        check_positions(&positions)?;
        let mut offsets = vec![0];
        let mut corners: Vec<u32> = Vec::new();
        for (number, face) in faces.into_iter().enumerate() {
            let face_corners = face.as_ref();
            if let Some(&index) = face_corners.iter().find(|&&i| i as usize >= vertex_count) {
                return Err(BuildError::IndexOutOfRange { face: number, index, vertex_count });
            }
            if face_corners.len() < 3 {
                let count = face_corners.len();
                return Err(BuildError::TooFewCorners { face: number, count });
            }
            if repeats_a_corner(face_corners) {
                return Err(BuildError::RepeatedPolygonCorner {
                    face: number,
                    count: face_corners.len(),
                });
            }
            corners.extend_from_slice(face_corners);
            let Ok(end) = u32::try_from(corners.len()) else {
                return Err(BuildError::TooLarge { what: "corners", count: corners.len() });
            };
            offsets.push(end);
        }
        Ok(Self { positions, faces: PolygonFaces { offsets, corners } })
    }

    /// A mesh from parts that satisfy the checks of [`Self::new`].
    #[cfg(feature = "io")]
    pub(crate) fn from_checked(positions: Vec<[f64; 3]>, polygons: Polygons) -> Self {
        let (ends, corners): (Vec<u32>, _) = match polygons {
            Polygons::Triangles(faces) => {
                ((1..=faces.len() as u32).map(|f| 3 * f).collect(), faces.into_flattened())
            }
            Polygons::Mixed { ends, corners } => {
                (ends.into_iter().map(|end| end as u32).collect(), corners)
            }
        };
        let offsets = std::iter::once(0).chain(ends).collect();
        Self { positions, faces: PolygonFaces { offsets, corners } }
    }

    /// A mesh of the polygons of another one, at other positions of its vertices.
    pub(crate) fn of_faces(positions: Vec<[f64; 3]>, faces: PolygonFaces) -> Self {
        Self { positions, faces }
    }

    /// The polygons.
    pub fn faces(&self) -> &PolygonFaces {
        &self.faces
    }

    /// The positions, in mesh units, one per vertex.
    pub fn positions(&self) -> &[[f64; 3]] {
        &self.positions
    }

    /// The number of vertices, isolated ones included.
    pub fn vertex_count(&self) -> usize {
        self.positions.len()
    }

    /// The number of polygons.
    pub fn polygon_count(&self) -> usize {
        self.faces.count()
    }

    /// The corners of polygon `f`, counter-clockwise seen from outside.
    ///
    /// # Panics
    ///
    /// If there is no polygon `f`.
    #[inline]
    pub fn polygon(&self, f: usize) -> &[u32] {
        self.faces.face(f)
    }

    /// The corners of each polygon in turn.
    pub fn polygons(&self) -> impl ExactSizeIterator<Item = &[u32]> {
        self.faces.iter()
    }

    /// The number of edges: pairs of vertices that follow each other in a
    /// polygon, each counted once.
    pub fn edge_count(&self) -> usize {
        let mut edges: Vec<[u32; 2]> = Vec::with_capacity(self.faces.corners.len());
        for polygon in self.polygons() {
            let next = polygon.iter().cycle().skip(1);
            edges.extend(polygon.iter().zip(next).map(|(&a, &b)| [a.min(b), a.max(b)]));
        }
        edges.sort_unstable();
        edges.dedup();
        edges.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_are_those_of_the_polygons() {
        let positions = (0..5).map(|i| [f64::from(i), f64::from(i * i), 0.0]).collect();
        let mesh = PolygonMesh::new(positions, [&[0u32, 1, 2, 3][..], &[3, 2, 4]]).unwrap();
        assert_eq!(mesh.edge_count(), 6);
        assert_eq!(mesh.triangulate().topology().edges().len(), 7);
    }

    #[test]
    fn a_mesh_keeps_the_polygons_of_its_triangles_only() {
        let positions: Vec<_> = (0..5).map(|i| [f64::from(i), f64::from(i * i), 0.0]).collect();
        let polygons = |faces: [&[u32]; 2]| PolygonMesh::new(positions.clone(), faces).unwrap();
        let mesh = polygons([&[0, 1, 2, 3], &[3, 2, 4]]);
        let split = mesh.triangulate();
        assert_eq!(split.polygons(), Some(mesh.faces()));
        assert_eq!(split.to_polygon_mesh(), mesh);
        assert_eq!([0, 1].map(|f| mesh.faces().triangles_of(f)), [0..2, 2..3]);
        let moved = split.with_positions(split.positions().to_vec()).unwrap();
        assert_eq!(moved.polygons(), split.polygons());
        let plain = split.without_polygons();
        assert_eq!((plain.polygons(), plain.to_polygon_mesh().polygon_count()), (None, 3));
        let with = |mesh: &PolygonMesh| plain.clone().with_polygons(mesh.faces().clone());
        assert_eq!(with(&mesh).unwrap().polygons(), Some(mesh.faces()));
        for other in [polygons([&[0, 1, 2, 4], &[3, 2, 4]]), polygons([&[0, 1, 2], &[3, 2, 4]])] {
            assert!(with(&other).is_none());
        }
        // Triangles are their own polygons.
        assert_eq!(polygons([&[0, 1, 2], &[3, 2, 4]]).triangulate().polygons(), None);
    }

    #[test]
    fn invalid_polygons_are_refused_by_name() {
        let square = vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let build = |faces: &[&[u32]]| PolygonMesh::new(square.clone(), faces);
        assert!(build(&[&[0, 1, 2, 3], &[3, 2, 1]]).is_ok());
        let error = |faces: &[&[u32]]| build(faces).unwrap_err();
        assert_eq!(error(&[&[0, 1]]), BuildError::TooFewCorners { face: 0, count: 2 });
        assert_eq!(
            error(&[&[0, 1, 2], &[0, 1, 2, 1]]),
            BuildError::RepeatedPolygonCorner { face: 1, count: 4 }
        );
        assert_eq!(
            error(&[&[0, 1, 2, 4]]),
            BuildError::IndexOutOfRange { face: 0, index: 4, vertex_count: 4 }
        );
        assert!(PolygonMesh::new(vec![[f64::NAN; 3]], [[0u32; 0]; 0]).is_err());
    }
}
