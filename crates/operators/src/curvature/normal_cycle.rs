//! Curvature from the normal cycle over a ball.
//!
//! ```text
//! II(B) = 1/A(B) Σₑ θₑ ℓ(e ∩ B) m ⊗ m
//! ```
//!
//! over the edges inside the ball B about the vertex, with the dihedral angle
//! θ, the length ℓ of the part inside, the unit tangent m across the edge, and
//! A the area of the mesh inside the ball, both clipped exactly. Only the part
//! connected to the vertex counts. Edges on the boundary, those with more than
//! two faces, and those whose faces turn against each other do not bend.
//! Source: [cohensteiner2003].
//!
//! [cohensteiner2003]: https://doi.org/10.1145/777792.777839

use fairing_mesh::TriMesh;
use fairing_parameters::{Options, Range};
use fairing_watch::parallel;

use super::ball::BallExplorer;
use super::bending::{BendSum, edge_bending, normal_sum};
use super::field::CurvatureField;
use super::neighborhood::Length;
use super::oriented::on_oriented;
use super::status::Undefined;
use crate::error::OperatorError;

fairing_parameters::options! {
    /// Options of [`normal_cycle_curvature`].
    #[derive(Debug, Clone, Copy, PartialEq)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    #[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
    pub struct NormalCycleOptions {
        /// The radius of the ball about each vertex.
        pub radius: Length = Length::MeanEdges(2.0), in Range::POSITIVE, unit "mean edge lengths";
    }
    "normal-cycle": "averages over a ball of a chosen radius; for noisy shapes",
        ["cohensteiner2003"];
}

/// Principal curvatures from the normal cycle over a ball about each vertex.
///
/// Larger balls average out both noise and features.
///
/// Undefined at isolated vertices and where the ball contains no area or
/// there is no normal. Cost: linear in the faces in a ball, per vertex.
///
/// # Errors
///
/// [`OperatorError::Option`] for a radius that is not positive.
#[doc(alias("curvature_tria", "curvature_tensor"))]
pub fn normal_cycle_curvature(
    mesh: &TriMesh,
    options: NormalCycleOptions,
) -> Result<CurvatureField, OperatorError> {
    options.check()?;
    on_oriented(mesh, |mesh| estimate(mesh, options))
}

fn estimate(mesh: &TriMesh, options: NormalCycleOptions) -> Result<CurvatureField, OperatorError> {
    let radii = BallExplorer::radii(mesh, options.radius)?;
    let topology = mesh.topology();
    let bending = edge_bending(mesh);
    let areas: Vec<f64> = parallel::map(mesh.face_count(), 4096, |f| mesh.face_area(f));
    let at_vertex = |explorer: &mut BallExplorer, v: u32| {
        if mesh.incidence().corners(v).is_empty() {
            return Err(Undefined::Isolated);
        }
        let normal = normal_sum(mesh, v).try_normalize().ok_or(Undefined::NoArea)?;
        let mut sum = BendSum::new(normal);
        let mut area = 0.0;
        explorer.visit(mesh, topology, v, radii[v as usize], |part| {
            let f = part.face as usize;
            area += part.fraction * areas[f];
            for (k, &e) in topology.face_edges()[f].iter().enumerate() {
                let edge = part.triangle[(k + 2) % 3] - part.triangle[(k + 1) % 3];
                // An edge inside comes from both of its faces.
                sum.add(edge, 0.5 * part.sides[k] * bending[e as usize]);
            }
        });
        sum.over(area)
    };
    Ok(CurvatureField::at_each_vertex(mesh, at_vertex))
}
