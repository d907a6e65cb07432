//! The bending of edges: their dihedral angle times their length.

use fairing_mesh::{Topology, TriMesh};
use glam::DVec3;
use rayon::prelude::*;

use super::field::AtVertex;
use super::status::Undefined;
use crate::normals::face_normals;
use crate::tangent::{Symmetric2, tangent_frame};

/// The dihedral angle of each edge times its length, in edge order: twice the
/// mean curvature of the edge, integrated, in mesh units.
///
/// Positive where convex. Zero on the boundary, on edges with more than two
/// faces, next to faces without area, and where two faces turn against each
/// other, so that no side is the outer one.
pub(crate) fn edge_bending(mesh: &TriMesh, topology: &Topology) -> Vec<f64> {
    let normals = face_normals(mesh);
    let (positions, faces) = (mesh.positions(), mesh.faces());
    let bend = |e: usize| {
        let &[f, g] = topology.edge_faces(e as u32) else { return 0.0 };
        let ends = topology.edges()[e];
        let [f, g] = [f as usize, g as usize];
        let [start, end] = ends.map(|v| DVec3::from(positions[v as usize]));
        let along = end - start;
        let length = along.length();
        let forward = runs(faces[f], ends);
        if forward == runs(faces[g], ends) {
            return 0.0;
        }
        let [n, m] = [f, g].map(|f| DVec3::from(normals[f]));
        let sine = n.cross(m).dot(along) * if forward { 1.0 } else { -1.0 };
        let cosine = n.dot(m) * length;
        if sine == 0.0 && cosine == 0.0 { 0.0 } else { libm::atan2(sine, cosine) * length }
    };
    (0..topology.edges().len()).into_par_iter().with_min_len(4096).map(bend).collect()
}

/// Returns true if the face runs from the first end to the second.
#[inline]
fn runs(face: [u32; 3], [a, b]: [u32; 2]) -> bool {
    (0..3).any(|k| face[k] == a && face[(k + 1) % 3] == b)
}

/// The sum of `w m ⊗ m` over bends w across directions m, in a tangent frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BendSum {
    normal: DVec3,
    frame: [DVec3; 2],
    form: Symmetric2,
}

impl BendSum {
    /// None yet, in the plane across the unit normal.
    pub(crate) fn new(normal: DVec3) -> Self {
        Self { normal, frame: tangent_frame(normal), form: Symmetric2::default() }
    }

    /// The curvature of which the sum is the integral over an area.
    pub(crate) fn over(self, area: f64) -> Result<AtVertex, Undefined> {
        if area <= 0.0 {
            return Err(Undefined::NoArea);
        }
        let Symmetric2 { a, b, c } = self.form;
        let form = Symmetric2 { a: a / area, b: b / area, c: c / area };
        Ok(AtVertex::from_form(form, self.frame, self.normal))
    }

    /// Adds a bend across an edge: in the tangent plane, along the quarter turn
    /// of the edge. An edge along the normal adds to neither direction.
    #[inline]
    pub(crate) fn add(&mut self, edge: DVec3, weight: f64) {
        let (x, y) = (edge.dot(self.frame[0]), edge.dot(self.frame[1]));
        let square = x * x + y * y;
        if square > 1e-24 * edge.dot(edge) && weight != 0.0 {
            let w = weight / square;
            self.form.a += w * y * y;
            self.form.b -= w * x * y;
            self.form.c += w * x * x;
        }
    }
}

/// The sum of the area vectors of the faces at a vertex.
#[inline]
pub(crate) fn normal_sum(mesh: &TriMesh, v: u32) -> DVec3 {
    let corners = mesh.incidence().corners(v).iter();
    corners.map(|&c| DVec3::from(mesh.area_vector(c as usize / 3))).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    fn roof(faces: Vec<[u32; 3]>, tip: [f64; 3]) -> f64 {
        let positions = vec![[0.0, 0.0, 0.0], [0.0, 2.0, 0.0], [-1.0, 0.0, 0.0], tip];
        let mesh = TriMesh::new(positions, faces).unwrap();
        let topology = mesh.topology();
        edge_bending(&mesh, topology)[topology.edge_between(0, 1).unwrap() as usize]
    }

    #[test]
    fn convex_is_positive_whatever_the_order_of_faces() {
        let down = [0.0, 0.0, -1.0];
        for faces in [vec![[0, 1, 2], [1, 0, 3]], vec![[1, 0, 3], [0, 1, 2]]] {
            assert!((roof(faces, down) - 2.0 * FRAC_PI_2).abs() < 1e-15);
        }
        let up = roof(vec![[0, 1, 2], [1, 0, 3]], [0.0, 0.0, 1.0]);
        assert!((up + 2.0 * FRAC_PI_2).abs() < 1e-15);
        // The second face turns against the first.
        assert_eq!(roof(vec![[0, 1, 2], [0, 1, 3]], down), 0.0);
    }

    /// The form of an edge is that of its part in the tangent plane, however
    /// steep the edge is: bending across it, none along it.
    #[test]
    fn steep_edges_count_by_their_direction() {
        let [e1, e2] = tangent_frame(DVec3::Z);
        for steep in [0.0, 1.0, 30.0, 1e4] {
            for scale in [1.0, 1e-3] {
                let (x, y) = (0.6 * scale, 0.8 * scale);
                let edge = x * e1 + y * e2 + steep * scale * DVec3::Z;
                let mut sum = BendSum::new(DVec3::Z);
                sum.add(edge, 2.0);
                let Symmetric2 { a, b, c } = sum.form;
                for (found, expected) in [(a, 1.28), (b, -0.96), (c, 0.72)] {
                    assert!((found - expected).abs() < 1e-10, "{steep} {found} {expected}");
                }
            }
        }
    }
}
