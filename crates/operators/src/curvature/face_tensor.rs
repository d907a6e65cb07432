//! Curvature tensors of faces, averaged at vertices.
//!
//! In each face the second form II is the least-squares solution of
//!
//! ```text
//! II e = Δn    along the three sides e,
//! ```
//!
//! where Δn is the difference of the vertex normals at its ends, in the plane
//! of the face. The forms are turned into the tangent plane of a vertex along
//! the smallest rotation of the normals, and averaged by the area that each
//! face gives to the vertex (mixed; a third where a face is too thin for it).
//! Source: [rusinkiewicz2004].
//!
//! [rusinkiewicz2004]: https://doi.org/10.1109/TDPVT.2004.1335277

use std::convert::Infallible;

use fairing_mesh::TriMesh;
use fairing_watch::parallel;
use glam::DVec3;

use super::field::{AtVertex, CurvatureField, boundary_flags};
use super::oriented::on_oriented;
use super::status::Undefined;
use crate::corners::FaceCorners;
use crate::kind::LumpedArea;
use crate::normal_equations::NormalEquations;
use crate::normals::{NormalWeight, weighted_vertex_normals};
use crate::tangent::{Symmetric2, tangent_frame, turn_between};

fairing_parameters::options! {
    /// Options of [`face_tensor_curvature`].
    #[derive(Debug, Clone, Copy, PartialEq)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    #[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
    pub struct FaceTensorOptions {
        /// The weights of face normals in the normals of vertices.
        pub normals: NormalWeight = NormalWeight::Sphere;
    }
    "face-tensor": "shading and line drawing; cheap, results close to corrected", ["rusinkiewicz2004"];
}

/// A form in the plane of a face.
#[derive(Clone, Copy)]
struct FaceTensor {
    normal: DVec3,
    frame: [DVec3; 2],
    form: Symmetric2,
    shares: [f64; 3],
}

/// Principal curvatures by averaging the tensors of faces.
///
/// Faces too thin for their cotangents
/// ([`MIN_HEIGHT_RATIO`](crate::MIN_HEIGHT_RATIO)), or with a corner without a
/// normal, are ignored. Undefined at isolated vertices, where all faces are
/// ignored, and where the normals cancel. Linear cost.
#[doc(alias = "rusinkiewicz")]
pub fn face_tensor_curvature(mesh: &TriMesh, options: FaceTensorOptions) -> CurvatureField {
    let Ok(field) = on_oriented(mesh, |mesh| Ok::<_, Infallible>(estimate(mesh, options)));
    field
}

fn estimate(mesh: &TriMesh, options: FaceTensorOptions) -> CurvatureField {
    let normals = weighted_vertex_normals(mesh, options.normals);
    let tensors: Vec<Option<FaceTensor>> =
        parallel::map(mesh.face_count(), 4096, |f| face_tensor(mesh, &normals, f));
    let at_vertex = |v: u32| {
        let corners = mesh.incidence().corners(v);
        if corners.is_empty() {
            return Err(Undefined::Isolated);
        }
        let normal = DVec3::from(normals[v as usize]).try_normalize().ok_or(Undefined::NoArea)?;
        let frame = tangent_frame(normal);
        let (mut sum, mut area) = (Symmetric2::default(), 0.0);
        for &c in corners {
            let Some(face) = &tensors[c as usize / 3] else { continue };
            let weight = face.shares[c as usize % 3];
            // The axes of the vertex in the frame of the face.
            let [[x0, x1], [y0, y1]] = frame.map(|axis| {
                let turned = turn_between(normal, face.normal, axis);
                face.frame.map(|t| t.dot(turned))
            });
            let Symmetric2 { a, b, c } = face.form;
            sum.a += weight * (a * x0 * x0 + 2.0 * b * x0 * x1 + c * x1 * x1);
            sum.b += weight * (a * x0 * y0 + b * (x0 * y1 + x1 * y0) + c * x1 * y1);
            sum.c += weight * (a * y0 * y0 + 2.0 * b * y0 * y1 + c * y1 * y1);
            area += weight;
        }
        if area <= 0.0 {
            return Err(Undefined::NoArea);
        }
        let form = Symmetric2 { a: sum.a / area, b: sum.b / area, c: sum.c / area };
        Ok(AtVertex::from_form(form, frame, normal))
    };
    let boundary = boundary_flags(mesh);
    let found = parallel::map(mesh.vertex_count(), 1024, |v| {
        let v = v as u32;
        (at_vertex(v), boundary[v as usize])
    });
    CurvatureField::collect(found, true)
}

fn face_tensor(mesh: &TriMesh, normals: &[[f64; 3]], f: usize) -> Option<FaceTensor> {
    let triangle = mesh.triangle(f);
    let corners = FaceCorners::new(triangle);
    let triangle = triangle.map(DVec3::from);
    if corners.is_degenerate() {
        return None;
    }
    let normal = DVec3::from(mesh.area_vector(f)).try_normalize()?;
    let at = mesh.faces()[f].map(|v| DVec3::from(normals[v as usize]));
    if at.contains(&DVec3::ZERO) {
        return None;
    }
    // Along the longest side and across it, where the equations of a needle are
    // as well determined as those of any face once each is taken in its own
    // unit, which elimination does. In units of the longest side.
    let sides = corners.squared_sides();
    let longest = (0..3).fold(0, |best, k| if sides[k] > sides[best] { k } else { best });
    let unit = sides[longest].sqrt();
    let along = triangle[(longest + 2) % 3] - triangle[(longest + 1) % 3];
    let across = normal.cross(along).try_normalize()?;
    let frame = [across.cross(normal), across];
    let mut equations = NormalEquations::<3>::default();
    for k in 0..3 {
        let (from, to) = ((k + 1) % 3, (k + 2) % 3);
        let side = triangle[to] - triangle[from];
        let [u, v] = frame.map(|axis| axis.dot(side) / unit);
        let turn = at[to] - at[from];
        equations.add(&[u, v, 0.0], frame[0].dot(turn), 1.0);
        equations.add(&[0.0, u, v], frame[1].dot(turn), 1.0);
    }
    let [a, b, c] = equations.solve()?.map(|x| x / unit);
    let area = 0.5 * corners.twice_area;
    let shares = LumpedArea::Mixed.shares(&corners).unwrap_or([area / 3.0; 3]);
    Some(FaceTensor { normal, frame, form: Symmetric2 { a, b, c }, shares })
}

#[cfg(test)]
mod tests {
    use super::*;
    use fairing_shapes as shapes;

    /// On any triangulation of a sphere the normals are those of the sphere,
    /// and the tensor of each face is the identity over the radius.
    #[test]
    fn exact_on_any_triangulation_of_a_sphere() {
        let unit = shapes::jittered(&shapes::icosphere(1), 0.4, 3, shapes::onto_sphere);
        let positions = unit.positions().iter().map(|p| p.map(|x| 2.5 * x)).collect();
        let sphere = unit.with_positions(positions).unwrap();
        let field = face_tensor_curvature(&sphere, FaceTensorOptions::default());
        for v in 0..field.len() {
            assert!((field.kappa1[v] - 0.4).abs() < 1e-13, "{}", field.kappa1[v]);
            assert!((field.kappa2[v] - 0.4).abs() < 1e-13, "{}", field.kappa2[v]);
        }
        let areas = FaceTensorOptions { normals: NormalWeight::Area };
        let field = face_tensor_curvature(&sphere, areas);
        let largest = field.mean.iter().fold(0.0, |m: f64, h| m.max((h - 0.4).abs()));
        assert!(largest > 1e-3, "area-weighted normals are not exact: {largest}");
    }

    /// The form of a face with one short side at a slant: along that side the
    /// equations would be those of one unknown, to the square of the shape.
    #[test]
    fn needles_of_any_slant_have_their_form() {
        for short in [1e-2, 1e-5, 1e-7] {
            for slant in [0.4, 0.8, 1.3, 1.9, 2.7] {
                let (s, c) = f64::sin_cos(slant);
                let corners = [[0.0; 3], [short * c, short * s, 0.0], [1.0, 0.0, 0.0]];
                for turn in 0..3 {
                    let positions = [0, 1, 2].map(|k| corners[(k + turn) % 3]).to_vec();
                    // II = (2, −0.5; −0.5, 3) in the plane, the normals turned as it says.
                    let mut normals = vec![[0.0, 0.0, 1.0]; 3];
                    for (n, p) in normals.iter_mut().zip(&positions) {
                        n[0] = 2.0 * p[0] - 0.5 * p[1];
                        n[1] = -0.5 * p[0] + 3.0 * p[1];
                    }
                    let mesh = TriMesh::new(positions, vec![[0, 1, 2]]).unwrap();
                    let found = face_tensor(&mesh, &normals, 0).unwrap();
                    // Back to the axes of the plane.
                    let Symmetric2 { a, b, c } = found.form;
                    let entry = |i: usize, j: usize| {
                        let [u, v] = found.frame;
                        a * u[i] * u[j] + b * (u[i] * v[j] + v[i] * u[j]) + c * v[i] * v[j]
                    };
                    let gap = [(0, 0, 2.0), (0, 1, -0.5), (1, 1, 3.0)]
                        .map(|(i, j, expected)| (entry(i, j) - expected).abs());
                    // Rounding of the normals over the length of the short side.
                    let limit = 1e-14 / short;
                    assert!(gap.iter().all(|g| *g < limit), "{short} {slant} {turn}: {gap:?}");
                }
            }
        }
    }

    /// Half for an obtuse corner, a quarter for each of the others.
    #[test]
    fn faces_are_shared_by_mixed_areas() {
        let positions = vec![[0.0; 3], [4.0, 0.0, 0.0], [2.0, 0.5, 0.0]];
        let mesh = TriMesh::new(positions, vec![[0, 1, 2]]).unwrap();
        let found = face_tensor(&mesh, &[[0.0, 0.0, 1.0]; 3], 0).unwrap();
        assert_eq!(found.shares, [0.25, 0.25, 0.5]);
    }

    #[test]
    fn a_plane_is_flat_and_a_collapsed_face_has_no_say() {
        let plane = shapes::jittered_plane(4, 4, 0.2, 1);
        let mut faces = plane.faces().to_vec();
        let mut positions = plane.positions().to_vec();
        positions.push(positions[7]);
        faces.push([7, 8, positions.len() as u32 - 1]);
        let mesh = TriMesh::new(positions, faces).unwrap();
        let field = face_tensor_curvature(&mesh, FaceTensorOptions::default());
        assert!(field.kappa1.iter().chain(&field.kappa2).all(|k| k.abs() < 1e-12));
        assert_eq!(field.status.iter().filter(|s| !s.is_defined()).count(), 1);
    }
}
