//! The part of a mesh inside a ball.

use fairing_mesh::vec3::{cross, dot, norm, sub};
use fairing_mesh::{Topology, TriMesh};

/// The length of the part of the segment `ab` inside the ball about the
/// origin.
pub(crate) fn segment_in_ball(a: [f64; 3], b: [f64; 3], radius: f64) -> f64 {
    let d = sub(b, a);
    let (qa, qb, qc) = (dot(d, d), dot(a, d), dot(a, a) - radius * radius);
    let discriminant = qb * qb - qa * qc;
    if qa == 0.0 || discriminant <= 0.0 {
        return 0.0;
    }
    let root = discriminant.sqrt();
    let (from, to) = (((-qb - root) / qa).max(0.0), ((root - qb) / qa).min(1.0));
    (to - from).max(0.0) * qa.sqrt()
}

/// The area of the part of a triangle inside the ball about the origin: the
/// plane of the triangle cuts the ball in a disc, whose intersection with the
/// triangle is summed side by side.
pub(crate) fn triangle_in_ball(triangle: [[f64; 3]; 3], radius: f64) -> f64 {
    let [a, b, c] = triangle;
    let normal = cross(sub(b, a), sub(c, a));
    let twice_area = norm(normal);
    if twice_area == 0.0 {
        return 0.0;
    }
    let square = radius * radius;
    if triangle.iter().all(|p| dot(*p, *p) <= square) {
        return 0.5 * twice_area;
    }
    let unit = normal.map(|x| x / twice_area);
    let height = dot(a, unit);
    let disc = square - height * height;
    if disc <= 0.0 {
        return 0.0;
    }
    // Coordinates in the plane about the centre of the disc.
    let [x, y] = crate::tangent::tangent_frame(unit);
    let flat = triangle.map(|p| [dot(p, x), dot(p, y)]);
    let sum: f64 = (0..3).map(|k| sector(flat[k], flat[(k + 1) % 3], disc)).sum();
    sum.clamp(0.0, 0.5 * twice_area)
}

/// The signed area of the part of the triangle (0, a, b) inside the disc of
/// the given squared radius about 0.
fn sector(a: [f64; 2], b: [f64; 2], square: f64) -> f64 {
    let turn =
        |p: [f64; 2], q: [f64; 2]| (p[0] * q[1] - p[1] * q[0]).atan2(p[0] * q[0] + p[1] * q[1]);
    let half = |p: [f64; 2], q: [f64; 2]| 0.5 * (p[0] * q[1] - p[1] * q[0]);
    let d = [b[0] - a[0], b[1] - a[1]];
    let (qa, qb) = (d[0] * d[0] + d[1] * d[1], a[0] * d[0] + a[1] * d[1]);
    let qc = a[0] * a[0] + a[1] * a[1] - square;
    let discriminant = qb * qb - qa * qc;
    if qa == 0.0 {
        return 0.0;
    }
    if discriminant <= 0.0 {
        return 0.5 * square * turn(a, b);
    }
    let root = discriminant.sqrt();
    let (from, to) = ((-qb - root) / qa, (root - qb) / qa);
    if from >= 1.0 || to <= 0.0 {
        return 0.5 * square * turn(a, b);
    }
    let at = |t: f64| [a[0] + t * d[0], a[1] + t * d[1]];
    let (enter, leave) = (from.max(0.0), to.min(1.0));
    let (p, q) = (at(enter), at(leave));
    let mut area = half(p, q);
    if from > 0.0 {
        area += 0.5 * square * turn(a, p);
    }
    if to < 1.0 {
        area += 0.5 * square * turn(q, b);
    }
    area
}

/// Finds the faces that a ball about a vertex meets, one vertex after another.
#[derive(Debug, Default)]
pub(crate) struct BallExplorer {
    /// The vertex for which each face was last reached, plus one.
    reached_for: Vec<u32>,
    stack: Vec<u32>,
}

/// A face that a ball meets, relative to the centre of the ball.
pub(crate) struct FaceInBall {
    pub(crate) face: u32,
    pub(crate) triangle: [[f64; 3]; 3],
    /// The area of the part inside.
    pub(crate) area: f64,
    /// Whether all of it is inside.
    pub(crate) whole: bool,
}

impl BallExplorer {
    /// Visits the faces with some area inside the ball that are connected to
    /// the vertex by edges inside it.
    pub(crate) fn visit(
        &mut self,
        mesh: &TriMesh,
        topology: &Topology,
        v: u32,
        radius: f64,
        mut face: impl FnMut(&FaceInBall),
    ) {
        self.reached_for.resize(mesh.face_count(), 0);
        let (mark, centre, square) = (v + 1, mesh.positions()[v as usize], radius * radius);
        self.stack.clear();
        for &c in mesh.incidence().corners(v) {
            self.reached_for[c as usize / 3] = mark;
            self.stack.push(c / 3);
        }
        while let Some(f) = self.stack.pop() {
            let triangle = mesh.triangle(f as usize).map(|p| sub(p, centre));
            let inside = triangle.map(|p| dot(p, p) <= square);
            let whole = inside == [true; 3];
            let area = triangle_in_ball(triangle, radius);
            face(&FaceInBall { face: f, triangle, area, whole });
            for k in 0..3 {
                let [p, q] = [(k + 1) % 3, (k + 2) % 3];
                let crosses = inside[p]
                    || inside[q]
                    || segment_in_ball(triangle[p], triangle[q], radius) > 0.0;
                if !crosses {
                    continue;
                }
                for &g in topology.edge_faces(topology.face_edges()[f as usize][k]) {
                    if self.reached_for[g as usize] != mark {
                        self.reached_for[g as usize] = mark;
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
        let length = |a, b| segment_in_ball(a, b, 1.0);
        assert_eq!(length([-3.0, 0.0, 0.0], [3.0, 0.0, 0.0]), 2.0);
        assert_eq!(length([0.0; 3], [3.0, 0.0, 0.0]), 1.0);
        assert_eq!(length([0.0, 0.1, 0.0], [0.0, 0.4, 0.0]), 0.30000000000000004);
        assert_eq!(length([2.0, 0.0, 0.0], [3.0, 0.0, 0.0]), 0.0);
        assert_eq!(length([2.0, 2.0, 0.0], [-2.0, 2.0, 0.0]), 0.0);
    }

    #[test]
    fn a_large_triangle_holds_the_disc() {
        for (h, radius) in [(0.0, 1.0), (0.6, 1.0)] {
            let big = [[-9.0, -9.0, h], [9.0, -9.0, h], [0.0, 9.0, h]];
            let expected = PI * (radius * radius - h * h);
            assert!((triangle_in_ball(big, radius) - expected).abs() < 1e-14);
        }
        let half = [[-9.0, 0.0, 0.0], [9.0, 0.0, 0.0], [0.0, 9.0, 0.0]];
        assert!((triangle_in_ball(half, 1.0) - 0.5 * PI).abs() < 1e-14);
        let outside = [[2.0, 2.0, 0.0], [9.0, 0.0, 0.0], [9.0, 9.0, 0.0]];
        assert!(triangle_in_ball(outside, 1.0).abs() < 1e-14);
    }

    /// Against a fine grid of points of the triangle.
    #[test]
    fn a_partial_triangle_by_counting() {
        let t = [[-0.4, -0.2, 0.1], [1.5, 0.1, 0.2], [0.2, 0.7, -0.3]];
        let n = 1000;
        let mut inside = 0u32;
        for i in 0..n {
            for j in 0..n - i {
                let (u, v) =
                    ((f64::from(i) + 0.33) / f64::from(n), (f64::from(j) + 0.33) / f64::from(n));
                let p: [f64; 3] =
                    std::array::from_fn(|k| t[0][k] * (1.0 - u - v) + t[1][k] * u + t[2][k] * v);
                inside += u32::from(dot(p, p) <= 0.64);
            }
        }
        let [a, b, c] = t;
        let area = 0.5 * norm(cross(sub(b, a), sub(c, a)));
        let counted = area * f64::from(inside) / f64::from(n * (n + 1) / 2);
        // The count errs by the border over the spacing, a few in a thousand.
        assert!((triangle_in_ball(t, 0.8) - counted).abs() < 3e-3 * area);
    }
}
