//! Curvature from the dihedral angles at a vertex.
//!
//! By Steiner's formula an edge e of length ℓ and dihedral angle θ has the integrated curvature θ
//! ℓ, entirely across the edge. Each end of an edge gets half of it:
//!
//! ```text
//! II(v) = 1/A Σₑ ½ θ ℓ m ⊗ m,    m = the unit tangent across e,
//! ```
//!
//! with A the barycentric area. H is half the trace. The estimator is cheap, signed and defined on
//! every mesh; its pointwise values do not converge. Edges on the boundary, those with more than
//! two faces, and those whose faces turn against each other do not bend. Source: [sullivan2008].
//!
//! [sullivan2008]: https://doi.org/10.1007/978-3-7643-8621-4_9

use std::convert::Infallible;

use fairing_mesh::TriMesh;
use glam::DVec3;

use super::bending::{BendSum, edge_bending, normal_sum};
use super::field::CurvatureField;
use super::oriented::on_oriented;
use super::status::Undefined;

fairing_parameters::options! {
    /// The estimator [`steiner_curvature`] has no options.
    #[derive(Debug, Clone, Copy, PartialEq)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    #[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
    pub struct SteinerOptions {}
    "steiner": "bending at creases, from dihedral angles; works on any mesh", ["sullivan2008"];
}

/// Principal curvatures from dihedral angles.
///
/// Undefined at isolated vertices and where the faces have no area or no
/// normal. Linear cost.
pub fn steiner_curvature(mesh: &TriMesh) -> CurvatureField {
    let Ok(field) = on_oriented(mesh, |mesh| Ok::<_, Infallible>(estimate(mesh)));
    field
}

fn estimate(mesh: &TriMesh) -> CurvatureField {
    let topology = mesh.topology();
    let bending = edge_bending(mesh);
    let at_vertex = |_: &mut (), v: u32| {
        let corners = mesh.incidence().corners(v);
        if corners.is_empty() {
            return Err(Undefined::Isolated);
        }
        let normal = normal_sum(mesh, v).try_normalize().ok_or(Undefined::NoArea)?;
        let mut sum = BendSum::new(normal);
        let mut area = 0.0;
        for &c in corners {
            let (f, k) = (c as usize / 3, c as usize % 3);
            let (triangle, edges) = (mesh.triangle(f).map(DVec3::from), topology.face_edges()[f]);
            area += mesh.face_area(f) / 3.0;
            // Both sides of the corner; an edge inside comes from two faces.
            for (side, opposite) in [((k + 1) % 3, (k + 2) % 3), ((k + 2) % 3, (k + 1) % 3)] {
                let edge = triangle[side] - triangle[k];
                sum.add(edge, 0.25 * bending[edges[opposite] as usize]);
            }
        }
        sum.over(area)
    };
    CurvatureField::at_each_vertex(mesh, at_vertex)
}

#[cfg(test)]
mod tests {
    use super::*;
    use fairing_mesh::TriMesh;
    use std::f64::consts::{FRAC_PI_2, PI};

    /// Three edges of length 1 meet in each corner of a unit cube; half of
    /// each, bent by a right angle, makes a trace of 3π/4, integrated. The
    /// diagonals of the squares do not bend.
    #[test]
    fn each_corner_of_a_cube_holds_half_of_three_edges() {
        let cube = fairing_shapes::cube(1, fairing_shapes::Diagonals::Regular);
        let side = cube.edge_lengths().into_iter().fold(f64::INFINITY, f64::min);
        let field = steiner_curvature(&cube);
        for v in 0..8 {
            let faces = cube.incidence().corners(v).iter();
            let area: f64 = faces.map(|&c| cube.face_area(c as usize / 3) / 3.0).sum();
            let trace = 2.0 * field.mean[v as usize] * area;
            assert!((trace - 0.75 * PI * side).abs() < 1e-14, "{v} {trace}");
        }
    }

    /// Along its ridge a roof bends across it alone.
    #[test]
    fn a_ridge_bends_across_itself() {
        let positions =
            vec![[0.0; 3], [0.0, 2.0, 0.0], [-1.0, 1.0, -1.0], [1.0, 1.0, -1.0], [9.0; 3]];
        let roof = TriMesh::new(positions, vec![[0, 1, 2], [1, 0, 3]]).unwrap();
        let field = steiner_curvature(&roof);
        // The faces have the area √2 each.
        let expected = 0.5 * FRAC_PI_2 * 2.0 / (2.0 * 2f64.sqrt() / 3.0);
        let [first, second] = field.directions.as_ref().unwrap();
        for v in 0..2 {
            assert!((field.kappa1[v] - expected).abs() < 1e-14, "{}", field.kappa1[v]);
            assert!(field.kappa2[v].abs() < 1e-15);
            assert!(first[v][0].abs() > 1.0 - 1e-14);
            assert!(second[v][1].abs() > 1.0 - 1e-14);
        }
        assert_eq!((field.kappa1[2], field.kappa2[2]), (0.0, 0.0));
        assert_eq!(field.status[4], super::super::VertexStatus::Undefined(Undefined::Isolated));
    }
}
