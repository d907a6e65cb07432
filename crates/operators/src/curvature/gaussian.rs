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
//! each edge with −2π, each vertex, isolated or not, with 2π.
//! Source: \[meyer2003\], \[desbrun2008\].

use std::f64::consts::{PI, TAU};

use fairing_mesh::TriMesh;
use rayon::prelude::*;

use super::boundary::{VertexLinks, vertex_links};
use super::status::{ScalarCurvature, Undefined, VertexStatus};
use crate::corners::{FaceCorners, face_corners};
use crate::error::OperatorError;
use crate::mass::{LumpedArea, lumped_mass};

/// The angle defect of each vertex: its Gaussian curvature, integrated.
///
/// `n` angles in radians, in vertex order; scaling the mesh does not change
/// them. The sum is 2πχ to rounding, with χ = V − E + F and isolated vertices
/// (2π each) counted. Defined on every mesh: where a face without area leaves
/// its angles open, they are taken so that they sum to π.
///
/// Source: \[meyer2003\].
pub fn angle_defect(mesh: &TriMesh) -> Vec<f64> {
    defects(mesh, &vertex_links(mesh))
}

fn defects(mesh: &TriMesh, links: &[VertexLinks]) -> Vec<f64> {
    let corners = face_corners(mesh);
    let incidence = mesh.incidence();
    links
        .par_iter()
        .with_min_len(4096)
        .enumerate()
        .map(|(v, links)| defect(*links, angle_sum(&corners, incidence.corners(v as u32))))
        .collect()
}

/// The angle defect of a vertex from the sum of its angles.
#[inline]
pub(crate) fn defect(links: VertexLinks, angle_sum: f64) -> f64 {
    (2.0 - f64::from(links.edges) + f64::from(links.faces)) * PI - angle_sum
}

/// The sum of the angles at `corners`, in radians.
///
/// The turns are multiplied as complex numbers and full turns counted, so that
/// a vertex costs one arc tangent instead of one per corner.
#[inline]
pub(crate) fn angle_sum(faces: &[FaceCorners], corners: &[u32]) -> f64 {
    let (mut re, mut im) = (1.0f64, 0.0f64);
    let mut full_turns = 0u32;
    for &c in corners {
        let (x, y) = faces[c as usize / 3].turn(c as usize % 3);
        let half_turns = im == 0.0 && re < 0.0 && y == 0.0 && x < 0.0;
        let (old, r) = (im, re);
        re = r * x - old * y;
        // Adding zero turns −0 into 0, whose arc tangent is not −π.
        im = (r * y + old * x) + 0.0;
        // An angle of at most π passes a full turn only out of the lower half
        // plane, unless both are exactly π.
        full_turns += u32::from((old < 0.0 && im >= 0.0) || half_turns);
    }
    let angle = im.atan2(re);
    f64::from(full_turns) * TAU + if angle < 0.0 { angle + TAU } else { angle }
}

/// Pointwise Gaussian curvature: the angle defect over the area of the vertex,
/// in 1 / squared mesh units.
///
/// On the boundary the value is geodesic curvature over area and flagged. A
/// vertex of no positive area is undefined (isolated, only faces without area,
/// negative Voronoi cell). Inside irregular meshes it does not converge
/// pointwise, whatever the area; integrals do.
///
/// # Errors
///
/// As [`lumped_mass`]: never with [`LumpedArea::Barycentric`].
///
/// Source: \[meyer2003\].
pub fn gaussian_curvature(
    mesh: &TriMesh,
    area: LumpedArea,
) -> Result<ScalarCurvature, OperatorError> {
    let mass = lumped_mass(mesh, area)?;
    let links = vertex_links(mesh);
    let mut values = defects(mesh, &links);
    let mut status = Vec::with_capacity(values.len());
    for ((value, mass), links) in values.iter_mut().zip(&mass).zip(&links) {
        let pointwise = *value / mass;
        if *mass > 0.0 && pointwise.is_finite() {
            *value = pointwise;
            status.push(VertexStatus::Defined);
        } else {
            *value = 0.0;
            status.push(VertexStatus::Undefined(undefined(*links)));
        }
    }
    let boundary = links.iter().map(|l| l.boundary).collect();
    Ok(ScalarCurvature { values, status, boundary })
}

/// Why a vertex has no area.
pub(crate) fn undefined(links: VertexLinks) -> Undefined {
    if links.faces == 0 { Undefined::Isolated } else { Undefined::NoArea }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

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
    fn isolated_and_flat_vertices_are_undefined_but_counted() {
        let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 5.0, 0.0]];
        let mesh = TriMesh::new(positions, vec![[0, 1, 2]]).unwrap();
        let total: f64 = angle_defect(&mesh).iter().sum();
        assert!((total - 2.0 * TAU).abs() < 1e-15);
        let k = gaussian_curvature(&mesh, LumpedArea::Barycentric).unwrap();
        assert_eq!(k.status[3], VertexStatus::Undefined(Undefined::Isolated));
        assert_eq!(k.status[0], VertexStatus::Undefined(Undefined::NoArea));
        assert_eq!(k.values, [0.0; 4]);
    }

    /// A saddle of valence 200 turns through many full circles; halves of
    /// turns in a row land exactly on the cut.
    #[test]
    fn many_turns_are_counted() {
        let n = 200u32;
        let mut positions = vec![[0.0; 3]];
        for i in 0..n {
            let a = f64::from(i) / f64::from(n) * TAU;
            positions.push([a.cos(), a.sin(), if i % 2 == 0 { 1.0 } else { -1.0 }]);
        }
        let faces = (0..n).map(|i| [0, i + 1, (i + 1) % n + 1]).collect();
        let mesh = TriMesh::new(positions, faces).unwrap();
        let corners = face_corners(&mesh);
        let direct: f64 = corners.iter().map(|c| c.turn(0)).map(|(x, y)| y.atan2(x)).sum();
        let sum = angle_sum(&corners, mesh.incidence().corners(0));
        assert!(direct > 40.0 && (sum - direct).abs() < 1e-11, "{sum} {direct}");

        let straight = FaceCorners { dots: [-1.0, 1.0, 2.0], twice_area: 0.0 };
        for count in 0..6u32 {
            let at: Vec<u32> = (0..count).map(|f| 3 * f).collect();
            let sum = angle_sum(&vec![straight; count as usize], &at);
            assert!((sum - PI * f64::from(count)).abs() < 1e-15);
        }
    }
}
