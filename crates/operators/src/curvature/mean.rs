//! Mean curvature from a Laplacian of the positions, `Δx = −2 H n`.

use std::convert::Infallible;

use fairing_mesh::TriMesh;
use fairing_watch::parallel;
use glam::DVec3;

use super::cell::{Links, map_cells};
use super::gaussian::undefined;
use super::oriented::{Signed, on_oriented};
use super::status::{ScalarCurvature, VertexStatus};
use crate::corners::check_faces;
use crate::error::OperatorError;
use crate::fan::Fan;
use crate::kind::LumpedArea;

/// The mean curvature at each vertex, with the mean curvature vectors.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct MeanCurvature {
    /// `Δx` at each vertex; zero where undefined.
    pub vectors: Vec<[f64; 3]>,
    /// `H = −½ Δx · n`, with the area-weighted normal n: positive where the
    /// surface bends like a sphere; zero where undefined.
    pub signed: Vec<f64>,
    /// The status of each value: defined, or the reason why it is not.
    pub status: Vec<VertexStatus>,
    /// True for vertices on the boundary, where the Laplacian is one-sided and
    /// points inwards along the surface.
    pub boundary: Vec<bool>,
}

impl MeanCurvature {
    pub(super) fn from_vertices(found: impl ExactSizeIterator<Item = AtVertex>) -> Self {
        let n = found.len();
        let mut all = Self {
            vectors: Vec::with_capacity(n),
            signed: Vec::with_capacity(n),
            status: Vec::with_capacity(n),
            boundary: Vec::with_capacity(n),
        };
        for at in found {
            all.vectors.push(at.vector);
            all.signed.push(at.signed);
            all.status.push(at.status);
            all.boundary.push(at.boundary);
        }
        all
    }

    /// `H = ½ ‖Δx‖`: without a sign, and with the tangential part of Δx.
    pub fn norms(&self) -> Vec<f64> {
        self.vectors.iter().map(|&d| 0.5 * DVec3::from(d).length()).collect()
    }

    /// The signed values with their flags.
    pub fn into_signed(self) -> ScalarCurvature {
        ScalarCurvature { values: self.signed, status: self.status, boundary: self.boundary }
    }
}

/// The mean curvature of the umbrella, `Δx = mean(xⱼ) − xᵢ`.
///
/// A **length**, not a curvature: on a regular mesh it is ¼ ℓ² times the Laplacian for edges of
/// length ℓ. It multiplies by s when the mesh is scaled by s. On irregular meshes the vector also
/// has a tangential part, from the uneven spacing of the neighbours. Source: [taubin1995].
///
/// Undefined at isolated vertices, and where no normal defines the sign. Boundary vertices are
/// computed one-sidedly and flagged.
///
/// [taubin1995]: https://doi.org/10.1145/218380.218473
pub fn umbrella_mean_curvature(mesh: &TriMesh) -> MeanCurvature {
    let Ok(found) =
        on_oriented(mesh, |mesh| Ok::<_, Infallible>(umbrellas(mesh, |count, _| count)));
    found
}

/// The mean curvature of the umbrella times `4 / mean(ℓ²)` over the edges at
/// the vertex, in 1 / mesh units: exact to leading order on regular rings, and
/// comparable with the true value. Source: [desbrun1999].
///
/// Undefined and flagged where [`umbrella_mean_curvature`] is.
///
/// [desbrun1999]: https://doi.org/10.1145/311535.311576
pub fn scaled_umbrella_mean_curvature(mesh: &TriMesh) -> MeanCurvature {
    let Ok(found) =
        on_oriented(mesh, |mesh| Ok::<_, Infallible>(umbrellas(mesh, |_, squares| 0.25 * squares)));
    found
}

/// The pointwise mean curvature of `Δx = −M⁻¹ S x` with cotangent weights and
/// the given area, in 1 / mesh units. Sources: [pinkall1993], [meyer2003].
///
/// No matrix is assembled; [`laplacian_mean_curvature`](super::laplacian_mean_curvature) takes a
/// Laplacian of any kind, such as the robust one.
///
/// Undefined at isolated vertices, where the area is not positive, and where
/// no normal tells the sign. Boundary vertices are computed one-sidedly and
/// flagged.
///
/// # Errors
///
/// [`OperatorError::DegenerateFace`] for the first face too thin for its
/// cotangents.
///
/// [pinkall1993]: https://doi.org/10.1080/10586458.1993.10504266
/// [meyer2003]: https://doi.org/10.1007/978-3-662-05105-4_2
#[doc(alias = "vertexMeanCurvature")]
pub fn mean_curvature(mesh: &TriMesh, area: LumpedArea) -> Result<MeanCurvature, OperatorError> {
    on_oriented(mesh, |mesh| {
        check_faces(mesh)?;
        let found = map_cells(mesh, area, |cell| {
            let vector = (cell.area > 0.0).then(|| cell.laplacian * (1.0 / cell.area));
            AtVertex::new(vector, cell.normal, cell.links)
        });
        Ok(MeanCurvature::from_vertices(found.into_iter()))
    })
}

/// [`mean_curvature`] and [`gaussian_curvature`](super::gaussian_curvature) over the same area, in
/// one pass that takes little longer than either alone.
///
/// # Errors
///
/// [`OperatorError::DegenerateFace`] for the first face too thin for its
/// cotangents.
pub fn mean_and_gaussian_curvature(
    mesh: &TriMesh,
    area: LumpedArea,
) -> Result<(MeanCurvature, ScalarCurvature), OperatorError> {
    on_oriented(mesh, |mesh| both_of_oriented(mesh, area))
}

fn both_of_oriented(
    mesh: &TriMesh,
    area: LumpedArea,
) -> Result<(MeanCurvature, ScalarCurvature), OperatorError> {
    check_faces(mesh)?;
    let found = map_cells(mesh, area, |cell| {
        let inverse = (cell.area > 0.0).then(|| 1.0 / cell.area);
        let vector = inverse.map(|inverse| inverse * cell.laplacian);
        let gaussian = cell.defect() * inverse.unwrap_or(f64::INFINITY);
        (AtVertex::new(vector, cell.normal, cell.links), (gaussian, undefined(cell.links)))
    });
    let gaussian = found.iter().map(|(at, (k, reason))| (*k, *reason, at.boundary)).collect();
    let mean = MeanCurvature::from_vertices(found.into_iter().map(|(at, _)| at));
    Ok((mean, gaussian))
}

pub(super) struct AtVertex {
    vector: [f64; 3],
    signed: f64,
    status: VertexStatus,
    boundary: bool,
}

impl AtVertex {
    /// The mean curvature from Δx, if there is one, and a vector along the normal.
    pub(super) fn new(vector: Option<DVec3>, normal: DVec3, links: Links) -> Self {
        let boundary = links.boundary;
        if let (Some(vector), Some(normal)) = (vector, normal.try_normalize()) {
            let signed = -0.5 * vector.dot(normal);
            if signed.is_finite() {
                let vector = vector.to_array();
                return Self { vector, signed, status: VertexStatus::Defined, boundary };
            }
        }
        let status = VertexStatus::Undefined(undefined(links));
        Self { vector: [0.0; 3], signed: 0.0, status, boundary }
    }
}

/// `Σ (xⱼ − xᵢ)` over the neighbours, each once, divided by a number that follows from their number
/// and from `Σ ℓ²`.
fn umbrellas(mesh: &TriMesh, divisor: fn(f64, f64) -> f64) -> MeanCurvature {
    let (positions, incidence) = (mesh.positions(), mesh.incidence());
    let umbrella = |fan: &mut Fan, v: u32| {
        let at = |w: u32| DVec3::from(positions[w as usize]);
        let (centre, sides) = (at(v), incidence.sides(v));
        fan.gather(sides.iter().copied());
        let (mut sum, mut squares) = (DVec3::ZERO, 0.0);
        for &w in &fan.neighbors {
            let edge = at(w) - centre;
            sum += edge;
            squares += edge.dot(edge);
        }
        let around = fan.ranks.iter().map(|ranks| {
            let [a, b] = ranks.map(|r| at(fan.neighbors[r as usize]) - centre);
            a.cross(b)
        });
        let normal = around.sum();
        let divisor = divisor(fan.neighbors.len() as f64, squares);
        let vector = (divisor > 0.0).then(|| sum * (1.0 / divisor));
        AtVertex::new(vector, normal, Links::new(fan, sides.len()))
    };
    let at = |fan: &mut Fan, v: usize| umbrella(fan, v as u32);
    let found: Vec<AtVertex> = parallel::map_with(mesh.vertex_count(), 2048, Fan::default, at);
    MeanCurvature::from_vertices(found.into_iter())
}

impl Signed for MeanCurvature {
    fn drop_sign(&mut self, v: usize) {
        self.signed[v] = self.signed[v].abs();
    }
}

impl Signed for (MeanCurvature, ScalarCurvature) {
    fn drop_sign(&mut self, v: usize) {
        self.0.drop_sign(v);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curvature::gaussian_curvature;
    use fairing_mesh::TriMesh;
    use fairing_shapes as shapes;

    /// Closed, open, and with a vertex that has no faces.
    #[test]
    fn both_at_once_are_what_each_is_alone() {
        let mut positions = shapes::icosphere(2).into_positions();
        positions.push([3.0; 3]);
        let sphere = TriMesh::new(positions, shapes::icosphere(2).faces().to_vec()).unwrap();
        let tube = shapes::cylinder(1.0, 2.0, 12, 6, shapes::Ends::Open);
        for mesh in [sphere, tube] {
            for area in [LumpedArea::Mixed, LumpedArea::Barycentric] {
                let (mean, gaussian) = mean_and_gaussian_curvature(&mesh, area).unwrap();
                assert_eq!(mean, mean_curvature(&mesh, area).unwrap());
                let alone = gaussian_curvature(&mesh, area).unwrap();
                assert_eq!(gaussian.status, alone.status);
                assert_eq!(gaussian.boundary, alone.boundary);
                for (a, b) in gaussian.values.iter().zip(&alone.values) {
                    // Areas are summed in another order.
                    assert!((a - b).abs() <= 1e-13 * b.abs().max(1.0), "{a} {b}");
                }
            }
        }
    }

    /// Δx = −2Hn: on the unit sphere it points inward and is 2 long.
    #[test]
    fn the_sign_is_that_of_a_sphere() {
        let mesh = shapes::icosphere(3);
        let cotangent = mean_curvature(&mesh, LumpedArea::Mixed).unwrap();
        for mean in [scaled_umbrella_mean_curvature(&mesh), cotangent] {
            for (v, p) in mesh.positions().iter().enumerate() {
                assert!((mean.signed[v] - 1.0).abs() < 0.02, "{}", mean.signed[v]);
                assert!((DVec3::from(mean.vectors[v]).dot(DVec3::from(*p)) + 2.0).abs() < 0.04);
            }
        }
    }
}
