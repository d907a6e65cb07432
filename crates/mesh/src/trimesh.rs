//! The triangle mesh.

use std::fmt;
use std::sync::Arc;

use glam::DVec3;

use crate::build::{BuildError, check_faces, check_positions};
use crate::connectivity::Connectivity;
use crate::incidence::Incidence;
use crate::polygon::{PolygonFaces, PolygonMesh};
use crate::topology::Topology;

/// A triangle mesh, always valid: indices are in range, coordinates are finite, their extent is
/// zero or within [`EXTENTS`](crate::EXTENTS), and no face repeats a corner. A mesh split from
/// polygons [keeps](Self::polygons) them.
///
/// All else is allowed: isolated vertices, faces of zero area, edges with three faces, inconsistent
/// orientation. Cloning copies positions and shares faces and topology.
#[derive(Clone)]
pub struct TriMesh {
    positions: Vec<[f64; 3]>,
    connectivity: Arc<Connectivity>,
}

impl TriMesh {
    /// Checks and keeps positions (in mesh units) and faces (counter-clockwise
    /// seen from outside).
    ///
    /// # Errors
    ///
    /// [`BuildError`] for the first vertex or face that is not valid.
    pub fn new(positions: Vec<[f64; 3]>, faces: Vec<[u32; 3]>) -> Result<Self, BuildError> {
        let count = positions.len();
        if u32::try_from(count).is_err() {
            return Err(BuildError::TooLarge { what: "vertices", count });
        }
        if u32::try_from(faces.len().saturating_mul(3)).is_err() {
            return Err(BuildError::TooLarge { what: "corners", count: faces.len() * 3 });
        }
        check_positions(&positions)?;
        check_faces(&faces, count)?;
        Ok(Self { positions, connectivity: Arc::new(Connectivity::new(count, faces, None)) })
    }

    /// A mesh from flat lists: three coordinates for each vertex, three indices for each face.
    ///
    /// # Errors
    ///
    /// [`BuildError::NotInThrees`], and those of [`Self::new`].
    ///
    /// # Examples
    ///
    /// ```
    /// use fairing_mesh::TriMesh;
    ///
    /// let positions = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    /// let mesh = TriMesh::from_flat(&positions, &[0, 1, 2])?;
    /// assert_eq!(mesh.positions().as_flattened(), positions);
    /// # Ok::<(), fairing_mesh::BuildError>(())
    /// ```
    pub fn from_flat(positions: &[f64], faces: &[u32]) -> Result<Self, BuildError> {
        let uneven = |what, count| BuildError::NotInThrees { what, count };
        let (points, []) = positions.as_chunks() else {
            return Err(uneven("coordinates", positions.len()));
        };
        let (corners, []) = faces.as_chunks() else {
            return Err(uneven("indices", faces.len()));
        };
        Self::new(points.to_vec(), corners.to_vec())
    }

    /// A mesh from arrays of other number types, such as `f32` and `i64`.
    ///
    /// # Errors
    ///
    /// [`BuildError::NotAnIndex`] for the first face with a corner that does
    /// not fit into `u32`, and those of [`Self::new`].
    ///
    /// # Examples
    ///
    /// ```
    /// use fairing_mesh::{BuildError, TriMesh};
    ///
    /// let positions = [[0.0_f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    /// assert_eq!(TriMesh::from_indexed(&positions, &[[0_i64, 1, 2]])?.face_count(), 1);
    /// let error = TriMesh::from_indexed(&positions, &[[0_i64, 1, -1]]).unwrap_err();
    /// assert_eq!(error, BuildError::NotAnIndex { face: 0 });
    /// # Ok::<(), BuildError>(())
    /// ```
    pub fn from_indexed<P, I>(positions: &[[P; 3]], faces: &[[I; 3]]) -> Result<Self, BuildError>
    where
        P: Into<f64> + Copy,
        I: TryInto<u32> + Copy,
    {
        let index = |(face, corners): (usize, &[I; 3])| {
            let index = |i: I| i.try_into().map_err(|_| BuildError::NotAnIndex { face });
            let &[a, b, c] = corners;
            Ok([index(a)?, index(b)?, index(c)?])
        };
        let faces: Result<Vec<[u32; 3]>, BuildError> =
            faces.iter().enumerate().map(index).collect();
        Self::new(positions.iter().map(|p| p.map(Into::into)).collect(), faces?)
    }

    /// Splits the mesh into positions and faces.
    pub fn into_parts(self) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
        let faces = self.faces().to_vec();
        (self.positions, faces)
    }

    /// A mesh from parts that satisfy the checks of [`Self::new`].
    pub(crate) fn from_checked(positions: Vec<[f64; 3]>, faces: Vec<[u32; 3]>) -> Self {
        Self::from_polygons_checked(positions, faces, None)
    }

    /// [`from_checked`](Self::from_checked) with the polygons that the faces were split from.
    pub(crate) fn from_polygons_checked(
        positions: Vec<[f64; 3]>,
        faces: Vec<[u32; 3]>,
        polygons: Option<PolygonFaces>,
    ) -> Self {
        let connectivity = Arc::new(Connectivity::new(positions.len(), faces, polygons));
        Self { positions, connectivity }
    }

    /// The polygons that the faces were split from, `None` if all are triangles. Meshes that
    /// differ in positions only share them; files are written with them. A mesh of other faces
    /// has none.
    pub fn polygons(&self) -> Option<&PolygonFaces> {
        self.connectivity.polygons()
    }

    /// The mesh with the [polygons](Self::polygons) that its faces were split from, or with its
    /// faces if it has no larger polygons.
    pub fn to_polygon_mesh(&self) -> PolygonMesh {
        let triangles = || PolygonFaces::of_triangles(self.faces());
        let faces = self.polygons().cloned().unwrap_or_else(triangles);
        PolygonMesh::of_faces(self.positions.clone(), faces)
    }

    /// The same triangles as parts of polygons; `None` if they are not what these are
    /// [split into](PolygonFaces::triangles_of).
    pub fn with_polygons(self, polygons: PolygonFaces) -> Option<Self> {
        let count = polygons.corners().len() - 2 * polygons.count();
        let parts = |f: usize| {
            let corners = self.faces()[polygons.triangles_of(f)].as_flattened();
            let [mut found, mut own] = [corners, polygons.face(f)].map(<[u32]>::to_vec);
            [&mut found, &mut own].into_iter().for_each(|corners| corners.sort_unstable());
            found.dedup();
            found == own
        };
        let fits = count == self.face_count() && (0..polygons.count()).all(parts);
        let faces = fits.then(|| self.faces().to_vec())?;
        let polygons = (polygons.non_triangles() > 0).then_some(polygons);
        Some(Self::from_polygons_checked(self.positions, faces, polygons))
    }

    /// The same triangles without the [polygons](Self::polygons) that they were split from.
    #[must_use]
    pub fn without_polygons(self) -> Self {
        match self.polygons() {
            None => self,
            Some(_) => {
                let faces = self.faces().to_vec();
                Self::from_checked(self.positions, faces)
            }
        }
    }

    /// The same faces with other positions; topology is shared, not recomputed.
    ///
    /// # Errors
    ///
    /// [`BuildError`] if there are too few or too many positions, one is
    /// not finite, or their extent is out of range.
    pub fn with_positions(&self, positions: Vec<[f64; 3]>) -> Result<Self, BuildError> {
        if positions.len() != self.vertex_count() {
            return Err(BuildError::PositionCount {
                expected: self.vertex_count(),
                found: positions.len(),
            });
        }
        check_positions(&positions)?;
        Ok(Self { positions, connectivity: Arc::clone(&self.connectivity) })
    }

    /// The positions, in mesh units, one per vertex.
    pub fn positions(&self) -> &[[f64; 3]] {
        &self.positions
    }

    /// The positions as an `n × 3` view, without a copy.
    #[cfg(feature = "ndarray")]
    pub fn positions_view(&self) -> ndarray::ArrayView2<'_, f64> {
        ndarray::ArrayView2::from(self.positions())
    }

    /// The faces as an `m × 3` view, without a copy.
    #[cfg(feature = "ndarray")]
    pub fn faces_view(&self) -> ndarray::ArrayView2<'_, u32> {
        ndarray::ArrayView2::from(self.faces())
    }

    /// Takes the positions out of the mesh.
    pub fn into_positions(self) -> Vec<[f64; 3]> {
        self.positions
    }

    /// The faces, counter-clockwise seen from outside.
    pub fn faces(&self) -> &[[u32; 3]] {
        self.connectivity.faces()
    }

    /// The number of vertices, isolated ones included.
    pub fn vertex_count(&self) -> usize {
        self.positions.len()
    }

    /// The number of faces.
    pub fn face_count(&self) -> usize {
        self.faces().len()
    }

    /// The faces and everything derived from them, shared between meshes that differ in positions
    /// only.
    pub fn connectivity(&self) -> &Arc<Connectivity> {
        &self.connectivity
    }

    /// The corners at each vertex.
    pub fn incidence(&self) -> &Incidence {
        self.connectivity.incidence()
    }

    /// Edges, neighbours, rings and boundary.
    pub fn topology(&self) -> &Topology {
        self.connectivity.topology()
    }

    /// The corner positions of face `f`.
    ///
    /// # Panics
    ///
    /// If there is no face `f`.
    #[inline]
    pub fn triangle(&self, f: usize) -> [[f64; 3]; 3] {
        self.faces()[f].map(|v| self.positions[v as usize])
    }

    /// The area vector of face `f`, `½ (b − a) × (c − a)`: along the outward normal, with the area
    /// as its length (squared mesh units).
    ///
    /// # Panics
    ///
    /// If there is no face `f`.
    #[inline]
    pub fn area_vector(&self, f: usize) -> [f64; 3] {
        let [a, b, c] = self.triangle(f).map(DVec3::from);
        (0.5 * (b - a).cross(c - a)).to_array()
    }

    /// The area of face `f`, in squared mesh units.
    ///
    /// # Panics
    ///
    /// If there is no face `f`.
    #[doc(alias = "doublearea")]
    #[inline]
    pub fn face_area(&self, f: usize) -> f64 {
        DVec3::from(self.area_vector(f)).length()
    }

    /// The mean length of the sides of the faces, in mesh units: an edge counts once for each of
    /// its faces. Zero without faces.
    #[doc(alias = "avg_edge_length")]
    pub fn mean_edge_length(&self) -> f64 {
        if self.face_count() == 0 {
            return 0.0;
        }
        let sum: f64 = (0..self.face_count())
            .map(|f| {
                let [a, b, c] = self.triangle(f).map(DVec3::from);
                a.distance(b) + b.distance(c) + c.distance(a)
            })
            .sum();
        sum / (3 * self.face_count()) as f64
    }

    /// The smallest axis-aligned box around the vertices, as its lowest and
    /// highest corner; `None` without vertices.
    #[doc(alias("aabb", "bounds"))]
    pub fn bounding_box(&self) -> Option<[[f64; 3]; 2]> {
        let first = *self.positions.first()?;
        Some(self.positions.iter().fold([first, first], |[lo, hi], p| {
            let pick =
                |f: fn(f64, f64) -> f64, q: [f64; 3]| [f(q[0], p[0]), f(q[1], p[1]), f(q[2], p[2])];
            [pick(f64::min, lo), pick(f64::max, hi)]
        }))
    }

    /// The length of the diagonal of the bounding box; zero without vertices.
    pub fn diagonal(&self) -> f64 {
        self.bounding_box().map_or(0.0, |[lo, hi]| DVec3::from(lo).distance(hi.into()))
    }
}

/// Counts only, since an error message cannot show millions of coordinates.
impl fmt::Debug for TriMesh {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("TriMesh")
            .field("vertices", &self.vertex_count())
            .field("faces", &self.face_count())
            .finish_non_exhaustive()
    }
}

/// Meshes are equal if positions and triangles are.
impl PartialEq for TriMesh {
    fn eq(&self, other: &Self) -> bool {
        self.positions == other.positions && self.faces() == other.faces()
    }
}
