//! Gaussian curvature from the angle defect.
//!
//! ```text
//! ∫ K = (2 − e + f) π − Σ θ
//! ```
//!
//! over the angles θ at a vertex with f faces and e edges: `2π − Σθ` inside,
//! `π − Σθ` on the boundary, where it measures the turning of the border
//! (geodesic curvature). Written with e and f it sums to `2πχ` on every
//! complex of triangles, manifold or not: each face takes part with 3π − π,
//! each edge with −2π, each vertex with 2π. An isolated vertex has none.
//! Source: [meyer2003], [desbrun2008].
//!
//! [meyer2003]: https://doi.org/10.1007/978-3-662-05105-4_2
//! [desbrun2008]: https://doi.org/10.1007/978-3-7643-8621-4_16

use fairing_mesh::TriMesh;
use fairing_watch::parallel;
use glam::DVec3;

use super::cell::{Links, Turns};
use super::status::{ScalarCurvature, Undefined};
use crate::corners::FaceCorners;
use crate::error::OperatorError;
use crate::fan::Fan;
use crate::kind::LumpedArea;
use crate::mass::lumped_mass;

/// The angle defect of each vertex: its integrated Gaussian curvature.
///
/// `n` angles in radians, in vertex order; scaling the mesh does not change them. The sum is 2πχ up
/// to rounding, with χ = V − E + F over the vertices that have faces; isolated vertices have defect
/// zero. Defined on every mesh: where a face without area does not determine its angles, they are
/// chosen to sum to π.
///
/// Source: [meyer2003].
///
/// [meyer2003]: https://doi.org/10.1007/978-3-662-05105-4_2
#[doc(alias("gaussian_curvature", "vertex_defects"))]
pub fn angle_defect(mesh: &TriMesh) -> Vec<f64> {
    defects(mesh).into_iter().map(|(defect, _)| defect).collect()
}

/// The angle defect and the surroundings of each vertex, on any mesh.
pub(crate) fn defects(mesh: &TriMesh) -> Vec<(f64, Links)> {
    let (positions, incidence) = (mesh.positions(), mesh.incidence());
    let defect = |fan: &mut Fan, v: u32| {
        let at = |w: u32| DVec3::from(positions[w as usize]);
        let (sides, centre) = (incidence.sides(v), at(v));
        fan.gather(sides.iter().copied());
        let mut turns = Turns::default();
        for side in sides {
            let [to_next, to_previous] = side.map(|w| at(w) - centre);
            turns.add(FaceCorners::from_sides(to_next, to_previous).0.turn(0));
        }
        let links = Links::new(fan, sides.len());
        (links.defect(turns.sum()), links)
    };
    parallel::map_with(mesh.vertex_count(), 2048, Fan::default, |fan, v| defect(fan, v as u32))
}

/// Pointwise Gaussian curvature: the angle defect over the area of the vertex,
/// in 1 / squared mesh units.
///
/// On the boundary the value is geodesic curvature over area and flagged. A vertex of no positive
/// area is undefined (isolated, only faces without area, negative Voronoi cell). On irregular
/// meshes pointwise values do not converge, whatever the area; integrals do.
///
/// # Errors
///
/// As [`lumped_mass`]: never with [`LumpedArea::Barycentric`].
///
/// Source: [meyer2003].
///
/// [meyer2003]: https://doi.org/10.1007/978-3-662-05105-4_2
#[doc(alias = "vertexGaussianCurvature")]
pub fn gaussian_curvature(
    mesh: &TriMesh,
    area: LumpedArea,
) -> Result<ScalarCurvature, OperatorError> {
    let mass = lumped_mass(mesh, area)?;
    Ok(defects(mesh)
        .into_iter()
        .zip(mass)
        .map(|((defect, links), mass)| {
            let pointwise = if mass > 0.0 { defect / mass } else { f64::INFINITY };
            (pointwise, undefined(links), links.boundary)
        })
        .collect())
}

/// The reason why a vertex has no area.
pub(crate) fn undefined(links: Links) -> Undefined {
    if links.faces == 0 { Undefined::Isolated } else { Undefined::NoArea }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curvature::VertexStatus;
    use std::f64::consts::{FRAC_PI_2, TAU};

    fn cube() -> TriMesh {
        let positions = (0..8).map(|i| [i & 1, i >> 1 & 1, i >> 2].map(f64::from)).collect();
        let quads =
            [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let faces = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        TriMesh::new(positions, faces).unwrap()
    }

    #[test]
    fn each_corner_of_a_cube_holds_a_quarter_turn() {
        for defect in angle_defect(&cube()) {
            assert!((defect - FRAC_PI_2).abs() < 1e-15, "{defect}");
        }
        let k = gaussian_curvature(&cube(), LumpedArea::Mixed).unwrap();
        for v in 0..8 {
            assert!((k.get(v).unwrap() - FRAC_PI_2 / 0.75).abs() < 1e-14);
        }
    }

    #[test]
    fn isolated_and_flat_vertices_are_undefined() {
        let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 5.0, 0.0]];
        let mesh = TriMesh::new(positions, vec![[0, 1, 2]]).unwrap();
        let total: f64 = angle_defect(&mesh).iter().sum();
        assert!((total - TAU).abs() < 1e-15);
        let k = gaussian_curvature(&mesh, LumpedArea::Barycentric).unwrap();
        assert_eq!(k.status[3], VertexStatus::Undefined(Undefined::Isolated));
        assert_eq!(k.status[0], VertexStatus::Undefined(Undefined::NoArea));
        assert_eq!(k.values, [0.0; 4]);
    }
}
