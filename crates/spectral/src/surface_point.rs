//! Points on a surface.

use std::cmp::Ordering;

use fairing_mesh::TriMesh;
use fairing_parameters::Range;
use glam::DVec3;

use crate::error::SpectralError;

/// A vertex, or a point on a face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfacePoint {
    vertices: [u32; 3],
    /// Barycentric coordinates: not negative, with the sum 1.
    weights: [f64; 3],
    /// Straight distances to the vertices, in mesh units.
    distances: [f64; 3],
}

impl SurfacePoint {
    /// A vertex.
    pub fn vertex(v: u32) -> Self {
        Self { vertices: [v; 3], weights: [1.0, 0.0, 0.0], distances: [0.0; 3] }
    }

    /// The point on face `f` with these barycentric coordinates, which are scaled to the sum 1.
    ///
    /// # Errors
    ///
    /// [`SpectralError::NoSuchFace`]; [`SpectralError::Option`] for a coordinate that is negative
    /// or not finite, or if all are zero.
    pub fn on_face(mesh: &TriMesh, f: u32, weights: [f64; 3]) -> Result<Self, SpectralError> {
        let Some(&vertices) = mesh.faces().get(f as usize) else {
            return Err(SpectralError::NoSuchFace { face: f, faces: mesh.face_count() });
        };
        for weight in weights {
            Range::NOT_NEGATIVE.check("barycentric coordinate", weight)?;
        }
        let sum: f64 = weights.iter().sum();
        Range::POSITIVE.check("sum of barycentric coordinates", sum)?;
        let weights = weights.map(|weight| weight / sum);
        if let Some(k) = weights.iter().position(|weight| *weight == 1.0) {
            return Ok(Self::vertex(vertices[k]));
        }
        let corners = vertices.map(|v| DVec3::from(mesh.positions()[v as usize]));
        let point = blend(corners, weights);
        let distances = corners.map(|corner| corner.distance(point));
        Ok(Self { vertices, weights, distances })
    }

    /// The point on face `f` that a point in space is projected to along the normal; beyond the
    /// face's sides, a point on them.
    ///
    /// # Errors
    ///
    /// [`SpectralError::NoSuchFace`].
    pub fn projected(mesh: &TriMesh, f: u32, point: [f64; 3]) -> Result<Self, SpectralError> {
        if f as usize >= mesh.face_count() {
            return Err(SpectralError::NoSuchFace { face: f, faces: mesh.face_count() });
        }
        let corners = mesh.triangle(f as usize).map(DVec3::from);
        Self::on_face(mesh, f, barycentric(corners, point.into()))
    }

    /// The position, in mesh units.
    ///
    /// # Panics
    ///
    /// If the point is on another mesh with more vertices.
    pub fn position(&self, mesh: &TriMesh) -> [f64; 3] {
        let corners = self.vertices.map(|v| DVec3::from(mesh.positions()[v as usize]));
        blend(corners, self.weights).to_array()
    }

    /// The vertices around the point, with the barycentric coordinates.
    pub(crate) fn corners(&self) -> impl Iterator<Item = (u32, f64)> + use<> {
        let corners = self.vertices.into_iter().zip(self.weights);
        corners.filter(|(_, weight)| *weight > 0.0)
    }

    /// The corners of the face of the point, with their straight distances from it.
    pub(crate) fn corner_distances(&self) -> impl Iterator<Item = (u32, f64)> + use<> {
        self.vertices.into_iter().zip(self.distances)
    }

    pub(crate) fn order(&self, other: &Self) -> Ordering {
        let weights = self.weights.iter().zip(&other.weights);
        let weights = weights.map(|(a, b)| a.total_cmp(b));
        self.vertices
            .cmp(&other.vertices)
            .then_with(|| weights.fold(Ordering::Equal, Ordering::then))
    }
}

fn blend(corners: [DVec3; 3], weights: [f64; 3]) -> DVec3 {
    corners[0] * weights[0] + corners[1] * weights[1] + corners[2] * weights[2]
}

/// Barycentric coordinates of the projection of `p`, those below zero raised to it.
fn barycentric([a, b, c]: [DVec3; 3], p: DVec3) -> [f64; 3] {
    let normal = (b - a).cross(c - a);
    let area = normal.length_squared();
    if area == 0.0 {
        // The nearest corner of a face without area.
        let distances = [a, b, c].map(|corner| corner.distance_squared(p));
        let least = distances.iter().copied().fold(f64::INFINITY, f64::min);
        return distances.map(|d| if d == least { 1.0 } else { 0.0 });
    }
    let weight = |u: DVec3, v: DVec3| ((u - p).cross(v - p).dot(normal) / area).max(0.0);
    [weight(b, c), weight(c, a), weight(a, b)]
}
