//! The part of a mesh inside a ball.

use fairing_mesh::{Topology, TriMesh};
use glam::DVec3;

use super::neighborhood::Length;
use crate::error::OperatorError;

/// The part of the segment `ab` inside the ball about the origin, as the
/// parameters from 0 at a to 1 at b between which it lies; empty, with equal
/// ends, where the segment stays outside.
#[inline]
fn segment_in_ball(a: DVec3, b: DVec3, square: f64) -> [f64; 2] {
    let d = b - a;
    let (qa, qb, qc) = (d.dot(d), a.dot(d), a.dot(a) - square);
    let discriminant = qb * qb - qa * qc;
    if qa == 0.0 || discriminant <= 0.0 {
        return [0.0; 2];
    }
    let root = discriminant.sqrt();
    let (from, to) = (((-qb - root) / qa).max(0.0), ((root - qb) / qa).min(1.0));
    if from < to { [from, to] } else { [0.0; 2] }
}

/// The parts of the sides opposite each corner that are inside the ball about
/// the origin.
#[inline]
fn sides_in_ball(triangle: &[DVec3; 3], square: f64) -> [[f64; 2]; 3] {
    std::array::from_fn(|k| segment_in_ball(triangle[(k + 1) % 3], triangle[(k + 2) % 3], square))
}

/// The fraction of the area of a triangle inside the ball about the origin, given the parts of its
/// sides: the plane of the triangle cuts the ball in a disc, whose intersection with the triangle
/// is summed side by side. Zero for a triangle without area.
fn fraction_in_ball(triangle: &[DVec3; 3], sides: &[[f64; 2]; 3], square: f64) -> f64 {
    let [a, b, c] = *triangle;
    let normal = (b - a).cross(c - a);
    let twice_area = normal.length();
    if twice_area == 0.0 {
        return 0.0;
    }
    let unit = normal / twice_area;
    let height = a.dot(unit);
    let disc = square - height * height;
    if disc <= 0.0 {
        return 0.0;
    }
    // Coordinates in the plane about the centre of the disc.
    let [x, y] = crate::tangent::tangent_frame(unit);
    let flat = triangle.map(|p| [p.dot(x), p.dot(y)]);
    let twice: f64 =
        (0..3).map(|k| twice_sector(flat[(k + 1) % 3], flat[(k + 2) % 3], sides[k], disc)).sum();
    (twice / twice_area).clamp(0.0, 1.0)
}

/// Twice the signed area of the part of the triangle (0, a, b) inside the disc
/// of the given squared radius about 0, of which the side ab has the part
/// between the parameters inside.
#[inline]
fn twice_sector(a: [f64; 2], b: [f64; 2], [from, to]: [f64; 2], square: f64) -> f64 {
    let wedge = |p: [f64; 2], q: [f64; 2]| p[0] * q[1] - p[1] * q[0];
    let turn = |p: [f64; 2], q: [f64; 2]| libm::atan2(wedge(p, q), p[0] * q[0] + p[1] * q[1]);
    if from >= to {
        return square * turn(a, b);
    }
    let at = |t: f64| [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])];
    let (p, q) = (at(from), at(to));
    let mut twice = wedge(p, q);
    if from > 0.0 {
        twice += square * turn(a, p);
    }
    if to < 1.0 {
        twice += square * turn(q, b);
    }
    twice
}

/// Finds the faces that a ball about a vertex meets, one vertex after another.
#[derive(Debug, Default)]
pub(crate) struct BallExplorer {
    /// The visit at which each face was last reached, counted from one.
    reached_at: Vec<u32>,
    visits: u32,
    stack: Vec<u32>,
}

/// A face that a ball meets, relative to the centre of the ball.
pub(crate) struct FaceInBall {
    pub(crate) face: u32,
    pub(crate) triangle: [DVec3; 3],
    /// The fraction of its area inside the ball.
    pub(crate) fraction: f64,
    /// The fraction of the side opposite each corner inside the ball.
    pub(crate) sides: [f64; 3],
}

impl FaceInBall {
    #[inline]
    fn new(face: u32, triangle: [DVec3; 3], square: f64) -> Self {
        if triangle.iter().all(|&p| p.dot(p) <= square) {
            return Self { face, triangle, fraction: 1.0, sides: [1.0; 3] };
        }
        let sides = sides_in_ball(&triangle, square);
        let fraction = fraction_in_ball(&triangle, &sides, square);
        Self { face, triangle, fraction, sides: sides.map(|[from, to]| to - from) }
    }
}

impl BallExplorer {
    /// The radius of the ball about each vertex.
    ///
    /// # Errors
    ///
    /// As [`Length::at_vertices`] and [`Length::refuse_crowded`].
    pub(crate) fn radii(mesh: &TriMesh, radius: Length) -> Result<Vec<f64>, OperatorError> {
        let radii = radius.at_vertices(mesh)?;
        let mut explorer = Self::default();
        radius.refuse_crowded(mesh, |v| {
            let mut faces = 0;
            explorer.visit(mesh, mesh.topology(), v, radii[v as usize], |_| faces += 1);
            faces
        })?;
        Ok(radii)
    }

    /// Visits the faces that the ball meets and that are connected to the
    /// vertex by edges with a part inside it.
    pub(crate) fn visit(
        &mut self,
        mesh: &TriMesh,
        topology: &Topology,
        v: u32,
        radius: f64,
        mut face: impl FnMut(&FaceInBall),
    ) {
        self.reached_at.resize(mesh.face_count(), 0);
        self.visits += 1;
        let (visit, centre) = (self.visits, DVec3::from(mesh.positions()[v as usize]));
        let square = radius * radius;
        self.stack.clear();
        for &c in mesh.incidence().corners(v) {
            self.reached_at[c as usize / 3] = visit;
            self.stack.push(c / 3);
        }
        while let Some(f) = self.stack.pop() {
            let triangle = mesh.triangle(f as usize).map(|p| DVec3::from(p) - centre);
            let part = FaceInBall::new(f, triangle, square);
            face(&part);
            for (&e, &inside) in topology.face_edges()[f as usize].iter().zip(&part.sides) {
                if inside <= 0.0 {
                    continue;
                }
                for &g in topology.edge_faces(e) {
                    if self.reached_at[g as usize] != visit {
                        self.reached_at[g as usize] = visit;
                        self.stack.push(g);
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn segments_are_clipped_at_the_sphere() {
        let part = |a: [f64; 3], b: [f64; 3]| segment_in_ball(a.into(), b.into(), 1.0);
        assert_eq!(part([-2.0, 0.0, 0.0], [2.0, 0.0, 0.0]), [0.25, 0.75]);
        assert_eq!(part([0.0; 3], [4.0, 0.0, 0.0]), [0.0, 0.25]);
        assert_eq!(part([0.0, 0.1, 0.0], [0.0, 0.4, 0.0]), [0.0, 1.0]);
        assert_eq!(part([2.0, 0.0, 0.0], [3.0, 0.0, 0.0]), [0.0, 0.0]);
        assert_eq!(part([2.0, 2.0, 0.0], [-2.0, 2.0, 0.0]), [0.0, 0.0]);
    }

    fn area(triangle: [[f64; 3]; 3], radius: f64) -> f64 {
        let triangle = triangle.map(DVec3::from);
        let [a, b, c] = triangle;
        let whole = 0.5 * (b - a).cross(c - a).length();
        whole * FaceInBall::new(0, triangle, radius * radius).fraction
    }

    #[test]
    fn a_large_triangle_holds_the_disc() {
        for (h, radius) in [(0.0, 1.0), (0.6, 1.0)] {
            let big = [[-9.0, -9.0, h], [9.0, -9.0, h], [0.0, 9.0, h]];
            let expected = PI * (radius * radius - h * h);
            assert!((area(big, radius) - expected).abs() < 1e-14);
        }
        let half = [[-9.0, 0.0, 0.0], [9.0, 0.0, 0.0], [0.0, 9.0, 0.0]];
        assert!((area(half, 1.0) - 0.5 * PI).abs() < 1e-14);
        let outside = [[2.0, 2.0, 0.0], [9.0, 0.0, 0.0], [9.0, 9.0, 0.0]];
        assert!(area(outside, 1.0).abs() < 1e-14);
    }

    /// Against a fine grid of points of the triangle.
    #[test]
    fn a_partial_triangle_by_counting() {
        let t = [[-0.4, -0.2, 0.1], [1.5, 0.1, 0.2], [0.2, 0.7, -0.3]].map(DVec3::from);
        let n = 1000;
        let mut inside = 0u32;
        for i in 0..n {
            for j in 0..n - i {
                let (u, v) =
                    ((f64::from(i) + 0.33) / f64::from(n), (f64::from(j) + 0.33) / f64::from(n));
                let p = (1.0 - u - v) * t[0] + u * t[1] + v * t[2];
                inside += u32::from(p.dot(p) <= 0.64);
            }
        }
        let counted = f64::from(inside) / f64::from(n * (n + 1) / 2);
        let found = FaceInBall::new(0, t, 0.64);
        // The count errs by the border over the spacing, a few in a thousand.
        assert!((found.fraction - counted).abs() < 3e-3, "{} {counted}", found.fraction);
    }

    /// The faces of a plane inside a ball make up its disc.
    #[test]
    fn the_parts_of_a_plane_make_up_the_disc() {
        let plane = fairing_shapes::plane(20, 20, fairing_shapes::Diagonals::Regular);
        let centre = 10 * 21 + 10;
        let mut explorer = BallExplorer::default();
        for radius in [0.02, 0.13, 0.3] {
            let mut sum = 0.0;
            explorer.visit(&plane, plane.topology(), centre, radius, |part| {
                sum += part.fraction * plane.face_area(part.face as usize);
            });
            assert!((sum - PI * radius * radius).abs() < 1e-14, "{radius} {sum}");
        }
    }
}
