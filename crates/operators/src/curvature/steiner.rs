//! Curvature from the dihedral angles at a vertex.
//!
//! By Steiner's formula an edge e of length ℓ and dihedral angle θ holds the
//! curvature θ ℓ, bending across itself. A vertex gets half of each edge:
//!
//! ```text
//! II(v) = 1/A Σₑ ½ θ ℓ m ⊗ m,    m = the unit tangent across e,
//! ```
//!
//! with A the barycentric area. H is half the trace. Cheap, signed, defined on
//! every mesh; not convergent pointwise. Edges on the boundary, those with more
//! than two faces, and those whose faces turn against each other do not bend.
//! Source: \[sullivan2008\].

use fairing_mesh::TriMesh;
use fairing_mesh::vec3::{normalize, scale, sub};
use rayon::prelude::*;

use super::bending::{BendSum, edge_bending, normal_sum};
use super::field::{AtVertex, CurvatureField};
use super::status::Undefined;
use crate::symmetric::Symmetric2;
use crate::tangent::tangent_frame;

/// Principal curvatures from dihedral angles.
///
/// Undefined at isolated vertices and where the faces have no area or no
/// normal. Linear cost.
pub fn steiner_curvature(mesh: &TriMesh) -> CurvatureField {
    let topology = mesh.topology();
    let bending = edge_bending(mesh, topology);
    let at_vertex = |v: u32| {
        let corners = mesh.incidence().corners(v);
        if corners.is_empty() {
            return Err(Undefined::Isolated);
        }
        let normal = normalize(normal_sum(mesh, v)).ok_or(Undefined::NoArea)?;
        let mut sum = BendSum::new(tangent_frame(normal));
        let mut area = 0.0;
        for &c in corners {
            let (f, k) = (c as usize / 3, c as usize % 3);
            let (triangle, edges) = (mesh.triangle(f), topology.face_edges()[f]);
            area += mesh.face_area(f) / 3.0;
            // Both sides of the corner; an edge inside comes from two faces.
            for (side, opposite) in [((k + 1) % 3, (k + 2) % 3), ((k + 2) % 3, (k + 1) % 3)] {
                let edge = sub(triangle[side], triangle[k]);
                sum.add(edge, 0.25 * bending[edges[opposite] as usize]);
            }
        }
        if area <= 0.0 {
            return Err(Undefined::NoArea);
        }
        let Symmetric2 { a, b, c } = sum.form;
        let [a, b, c] = scale([a, b, c], 1.0 / area);
        Ok(AtVertex::of_form(Symmetric2 { a, b, c }, sum.frame, normal))
    };
    let found = (0..mesh.vertex_count() as u32)
        .into_par_iter()
        .with_min_len(1024)
        .map(|v| (at_vertex(v), topology.is_boundary_vertex(v)))
        .collect();
    CurvatureField::collect(found, true)
}
