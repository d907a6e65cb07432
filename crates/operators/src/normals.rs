//! Normals of faces and vertices.

use fairing_mesh::TriMesh;
use fairing_watch::parallel;
use glam::DVec3;

use crate::corners::FaceCorners;

/// The weight of each face in the normal of its vertex.
///
/// Written as its name (`Display`), and read from it (`FromStr`).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum NormalWeight {
    /// By its area: robust and cheap; independent of the triangulation of flat regions only on
    /// average.
    Area,
    /// By its angle at the vertex: does not change when a flat region is
    /// triangulated differently. Source: [thurmer1998].
    ///
    /// [thurmer1998]: https://doi.org/10.1080/10867651.1998.10487487
    Angle,
    /// By its area over the squared lengths of the two sides at the vertex:
    /// exact where all vertices lie on a sphere, and of second order on smooth
    /// surfaces. Source: [max1999].
    ///
    /// [max1999]: https://doi.org/10.1080/10867651.1999.10487501
    Sphere,
    /// Equal weights. Source: [gouraud1971].
    ///
    /// [gouraud1971]: https://doi.org/10.1109/T-C.1971.223313
    Uniform,
}

fairing_parameters::choices!(NormalWeight, "weight of normals",
    Area: "area", "By area: robust and cheap";
    Angle: "angle", "By the angle at the vertex: independent of how flat regions are triangulated";
    Sphere: "sphere", "By area over squared sides: exact on spheres";
    Uniform: "uniform", "Equal weights";
);
#[cfg(feature = "serde")]
fairing_parameters::serde_by_name!(NormalWeight);

/// The unit normal of each face of the [oriented](TriMesh::oriented) mesh,
/// outward for counter-clockwise faces; the zero vector for a face without area.
#[doc(alias = "per_face_normals")]
pub fn face_normals(mesh: &TriMesh) -> Vec<[f64; 3]> {
    let mesh = &*mesh.oriented();
    parallel::map(mesh.face_count(), 4096, |f| face_normal(mesh, f).to_array())
}

/// The unit normal of each vertex, weighted by the angles of faces; the zero vector where
/// none is defined (isolated vertices, areas that cancel).
#[doc(alias = "per_vertex_normals")]
pub fn vertex_normals(mesh: &TriMesh) -> Vec<[f64; 3]> {
    weighted_vertex_normals(mesh, NormalWeight::Angle)
}

/// The unit normal of each vertex: the direction of the weighted sum of the
/// normals of its faces, in vertex order. The zero vector where none is
/// defined (isolated vertices, sums that cancel). Faces without area
/// are ignored.
///
/// Faces count as [oriented](TriMesh::oriented). On a
/// [one-sided](TriMesh::one_sided_faces) part, whose normals have no sign, each
/// is one of the two: faces around a vertex count with the side of the first of them.
pub fn weighted_vertex_normals(mesh: &TriMesh, weight: NormalWeight) -> Vec<[f64; 3]> {
    let mesh = &*mesh.oriented();
    let has_two_sides = mesh.one_sided_faces().is_empty();
    let vectors: Vec<DVec3> = parallel::map(mesh.face_count(), 4096, |f| match weight {
        NormalWeight::Area | NormalWeight::Sphere => mesh.area_vector(f).into(),
        NormalWeight::Angle | NormalWeight::Uniform => face_normal(mesh, f),
    });
    let incidence = mesh.incidence();
    let at_vertex = |v: u32| {
        let corners = incidence.corners(v);
        let sum: DVec3 = corners
            .iter()
            .map(|&c| {
                let f = c as usize / 3;
                let first = vectors[corners[0] as usize / 3];
                let is_same_side = has_two_sides || vectors[f].dot(first) >= 0.0;
                let vector = if is_same_side { vectors[f] } else { -vectors[f] };
                match weight {
                    NormalWeight::Area | NormalWeight::Uniform => vector,
                    NormalWeight::Sphere => {
                        let sides = FaceCorners::new(mesh.triangle(f)).squared_sides();
                        let k = c as usize % 3;
                        let squares = sides[(k + 1) % 3] * sides[(k + 2) % 3];
                        if squares > 0.0 { vector * (1.0 / squares) } else { DVec3::ZERO }
                    }
                    NormalWeight::Angle => {
                        let (x, y) = FaceCorners::new(mesh.triangle(f)).turn(c as usize % 3);
                        libm::atan2(y, x) * vector
                    }
                }
            })
            .sum();
        sum.normalize_or_zero().to_array()
    };
    parallel::map(mesh.vertex_count(), 4096, |v| at_vertex(v as u32))
}

fn face_normal(mesh: &TriMesh, f: usize) -> DVec3 {
    DVec3::from(mesh.area_vector(f)).normalize_or_zero()
}

/// Rounds of averaging over the neighbours that make a normal one of the surface without its
/// noise: the measure of how far a neighbourhood turns.
const NORMAL_ROUNDS: usize = 2;

/// Unit normals averaged twice over each vertex and its neighbours; zero where `normals` are.
pub(crate) fn smoothed_normals(mesh: &TriMesh, normals: &[[f64; 3]]) -> Vec<DVec3> {
    let topology = mesh.topology();
    let mut smooth: Vec<DVec3> = normals.iter().map(|&n| n.into()).collect();
    for _ in 0..NORMAL_ROUNDS {
        let mean = |v: usize| {
            let neighbors = topology.neighbors(v as u32);
            let sum: DVec3 = neighbors.iter().map(|&w| smooth[w as usize]).sum();
            if normals[v] == [0.0; 3] {
                DVec3::ZERO
            } else {
                (smooth[v] + sum).try_normalize().unwrap_or(smooth[v])
            }
        };
        smooth = parallel::map(smooth.len(), 1024, mean);
    }
    smooth
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A corner of a cube, one of its squares cut through the corner: areas
    /// and counts favour that square, angles do not.
    #[test]
    fn angles_do_not_see_the_triangulation() {
        let positions = vec![
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
            [1.0, 1.0, 0.0],
            [7.0, 7.0, 7.0],
        ];
        let faces = vec![[0, 2, 4], [0, 4, 1], [0, 3, 2], [0, 1, 3]];
        let mesh = TriMesh::new(positions, faces).unwrap();
        let angle = weighted_vertex_normals(&mesh, NormalWeight::Angle);
        let d = -(1.0f64 / 3.0).sqrt();
        assert!(angle[0].iter().all(|x| (x - d).abs() < 1e-15));
        assert_eq!(angle, vertex_normals(&mesh));
        let area = weighted_vertex_normals(&mesh, NormalWeight::Area);
        assert!((area[0][2] + (2.0f64 / 3.0).sqrt()).abs() < 1e-15);
        assert_eq!(area, weighted_vertex_normals(&mesh, NormalWeight::Uniform));
        assert_eq!(area[5], [0.0; 3]);
    }

    /// An uneven ring on the unit sphere about its pole.
    #[test]
    fn sphere_weights_are_exact_on_a_sphere() {
        let mut positions = vec![[0.0, 0.0, 1.0]];
        for (theta, phi) in [(0.3f64, 0.0f64), (0.5, 1.1), (0.2, 2.0), (0.6, 3.5), (0.4, 5.0)] {
            positions.push([theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()]);
        }
        let faces = (0..5).map(|i| [0, i + 1, (i + 1) % 5 + 1]).collect();
        let mesh = TriMesh::new(positions, faces).unwrap();
        let [x, y, z] = weighted_vertex_normals(&mesh, NormalWeight::Sphere)[0];
        assert!(x.abs() < 1e-15 && y.abs() < 1e-15 && (z - 1.0).abs() < 1e-15);
        assert!(vertex_normals(&mesh)[0][2] < 1.0 - 1e-4);
    }

    /// A one-sided soup, with edges of more than two faces.
    #[test]
    fn one_sided_soups_have_normals() {
        #[rustfmt::skip]
        let positions: [[i32; 3]; 10] = [
            [1, 3, 0], [-2, -3, 2], [-1, -2, -3], [-2, 3, 3], [4, 3, -3],
            [0, -3, -2], [0, -3, 0], [2, 1, 3], [-2, 1, -2], [-3, -1, -2],
        ];
        #[rustfmt::skip]
        let faces = vec![
            [0, 2, 1], [2, 7, 9], [6, 2, 9], [8, 0, 5], [2, 3, 6], [0, 5, 6], [0, 2, 8],
            [0, 3, 1], [8, 2, 3], [1, 3, 7], [4, 0, 2], [0, 3, 6], [9, 1, 2],
        ];
        let positions = positions.iter().map(|p| p.map(f64::from)).collect();
        let soup = TriMesh::new(positions, faces).unwrap();
        assert!(!soup.one_sided_faces().is_empty());
        let lengths = vertex_normals(&soup).into_iter().map(|n| DVec3::from(n).length());
        assert!(lengths.into_iter().all(|length| (length - 1.0).abs() < 1e-12));
    }
}
