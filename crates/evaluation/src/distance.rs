//! Distances between surfaces.

use crate::correspondence::check_correspondence;
use crate::error::EvaluationError;
use crate::surface_tree::SurfaceTree;
use fairing_mesh::TriMesh;
use glam::DVec3;

/// Distances of the vertices of one mesh from the surface of another.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct VertexDistance {
    /// The mean over the vertices, in mesh units.
    pub mean: f64,
    /// The root mean square, in mesh units.
    pub rms: f64,
    /// The largest distance, in mesh units.
    pub max: f64,
    /// The vertex with the largest distance.
    pub farthest: u32,
}

/// The distances between two surfaces, measured at their vertices in both directions.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct SurfaceDistance {
    /// From the vertices of the mesh to the surface of the reference.
    pub forward: VertexDistance,
    /// From the vertices of the reference to the surface of the mesh.
    pub backward: VertexDistance,
}

impl SurfaceDistance {
    /// The larger of the two largest distances, in mesh units: a lower bound
    /// of the Hausdorff distance, which [`hausdorff`](crate::hausdorff) takes
    /// over whole faces.
    pub fn max(&self) -> f64 {
        self.forward.max.max(self.backward.max)
    }

    /// The Chamfer distance, the sum of the two means, in mesh units.
    pub fn chamfer(&self) -> f64 {
        self.forward.mean + self.backward.mean
    }
}

/// The mesh with each vertex at the closest point of the surface of `reference`: the truth of a
/// mesh whose vertices are not those of its model, as of fused views. (V + F) log F.
///
/// # Errors
///
/// [`EvaluationError::NoFaces`] for a reference without faces, [`EvaluationError::Positions`]
/// if the moved vertices are not a valid mesh.
pub fn at_closest_points(mesh: &TriMesh, reference: &TriMesh) -> Result<TriMesh, EvaluationError> {
    let closest = tree(reference, "reference")?.closest_to_all(mesh.positions());
    let positions = closest.into_iter().map(|closest| closest.point).collect();
    mesh.with_positions(positions).map_err(EvaluationError::Positions)
}

/// The distances of the vertices of `mesh` from the surface of `reference`,
/// exact to rounding. Isolated vertices do not count. (V + F) log F.
///
/// # Errors
///
/// [`EvaluationError::NoFaces`] without a surface to measure from,
/// [`EvaluationError::NoVertices`] with nothing to measure.
pub fn vertex_distance(
    mesh: &TriMesh,
    reference: &TriMesh,
) -> Result<VertexDistance, EvaluationError> {
    summary(mesh, &tree(reference, "reference")?, "mesh")
}

/// The distances of the vertices of either mesh from the surface of the
/// other. The meshes may have different faces.
///
/// # Errors
///
/// As [`vertex_distance`], for either.
pub fn surface_distance(
    mesh: &TriMesh,
    reference: &TriMesh,
) -> Result<SurfaceDistance, EvaluationError> {
    let (own, other) = (tree(mesh, "mesh")?, tree(reference, "reference")?);
    between(mesh, &own, reference, &other)
}

/// [`surface_distance`] with trees that are there already.
pub(crate) fn between(
    mesh: &TriMesh,
    own: &SurfaceTree,
    reference: &TriMesh,
    other: &SurfaceTree,
) -> Result<SurfaceDistance, EvaluationError> {
    Ok(SurfaceDistance {
        forward: summary(mesh, other, "mesh")?,
        backward: summary(reference, own, "reference")?,
    })
}

/// The tree of a mesh, an error naming the mesh by its part in the comparison.
pub(crate) fn tree(mesh: &TriMesh, which: &'static str) -> Result<SurfaceTree, EvaluationError> {
    SurfaceTree::new(mesh).map_err(|error| match error {
        EvaluationError::NoFaces { .. } => EvaluationError::NoFaces { which },
        other => other,
    })
}

fn summary(
    mesh: &TriMesh,
    surface: &SurfaceTree,
    which: &'static str,
) -> Result<VertexDistance, EvaluationError> {
    let distances = surface.distances(mesh.positions());
    let incidence = mesh.incidence();
    let (mut count, mut sum, mut squares) = (0usize, 0.0, 0.0);
    let (mut max, mut farthest) = (-1.0, 0);
    for (v, &d) in distances.iter().enumerate() {
        if incidence.corners(v as u32).is_empty() {
            continue;
        }
        count += 1;
        sum += d;
        squares += d * d;
        if d > max {
            (max, farthest) = (d, v as u32);
        }
    }
    if count == 0 {
        return Err(EvaluationError::NoVertices { which });
    }
    let n = count as f64;
    Ok(VertexDistance { mean: sum / n, rms: (squares / n).sqrt(), max, farthest })
}

/// Distances between vertices of the same number.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct VertexDisplacement {
    /// The root mean square, in mesh units.
    pub rms: f64,
    /// The largest, in mesh units.
    pub max: f64,
}

/// The distances between vertices of the same number, isolated ones included.
///
/// # Errors
///
/// [`EvaluationError::NoCorrespondence`] unless both have the same faces;
/// [`EvaluationError::NoVertices`] without vertices.
pub fn vertex_displacement(
    mesh: &TriMesh,
    reference: &TriMesh,
) -> Result<VertexDisplacement, EvaluationError> {
    check_correspondence(mesh, reference)?;
    if mesh.vertex_count() == 0 {
        return Err(EvaluationError::NoVertices { which: "mesh" });
    }
    let pairs = || mesh.positions().iter().zip(reference.positions());
    let distances = || pairs().map(|(&p, &q)| DVec3::from(p).distance(q.into()));
    let max = distances().fold(0.0, f64::max);
    let squares: f64 = distances().map(|d| d.powi(2)).sum();
    Ok(VertexDisplacement { rms: (squares / mesh.vertex_count() as f64).sqrt(), max })
}
