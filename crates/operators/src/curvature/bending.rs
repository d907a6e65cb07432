//! The bending of edges: their dihedral angle times their length.

use fairing_mesh::TriMesh;
use glam::DVec3;

use super::field::AtVertex;
use super::status::Undefined;
use crate::angles::dihedral_angles;
use crate::tangent::{Symmetric2, tangent_frame};

/// The dihedral angle of each edge times its length, in edge order: twice the
/// mean curvature of the edge, integrated, in mesh units.
///
/// Positive where convex. Zero where there is [no angle](dihedral_angles).
pub(crate) fn edge_bending(mesh: &TriMesh) -> Vec<f64> {
    let angles = dihedral_angles(mesh).into_iter().zip(mesh.edge_lengths());
    angles.map(|(angle, length)| angle.unwrap_or(0.0) * length).collect()
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
        edge_bending(&mesh)[topology.edge_between(0, 1).unwrap() as usize]
    }

    #[test]
    fn convex_is_positive_whatever_the_order_of_faces() {
        let down = [0.0, 0.0, -1.0];
        for faces in [vec![[0, 1, 2], [1, 0, 3]], vec![[1, 0, 3], [0, 1, 2]]] {
            assert!((roof(faces, down) - 2.0 * FRAC_PI_2).abs() < 1e-15);
        }
        let up = roof(vec![[0, 1, 2], [1, 0, 3]], [0.0, 0.0, 1.0]);
        assert!((up + 2.0 * FRAC_PI_2).abs() < 1e-15);
        // The second face turns against the first, and counts as flipped.
        assert_eq!(roof(vec![[0, 1, 2], [0, 1, 3]], down), roof(vec![[0, 1, 2], [1, 0, 3]], down));
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
