//! Polygons split into triangles.

mod ears;

use glam::DVec3;

use self::ears::{Split, fan, turn};
use crate::polygon::PolygonMesh;
use crate::trimesh::TriMesh;

impl PolygonMesh {
    /// Splits the polygons into triangles: n − 2 for n corners, in the order
    /// of the polygons, without new vertices.
    ///
    /// - A triangle stays as it is.
    /// - A convex polygon becomes the fan around its first corner: `(0, 1, 2)`,
    ///   `(0, 2, 3)`, …
    /// - Any other polygon is cut ear by ear. An ear is a convex corner whose
    ///   triangle contains no other corner; each step cuts the ear of the best
    ///   shape (area over the sum of squared sides), the first of equal ones.
    ///   If no ear is left, as in polygons that cross themselves, the rest
    ///   becomes a fan. n corners take about n log n steps.
    ///
    /// A corner is convex if it turns with the polygon, seen along the area vector
    /// `½ Σ pₖ × pₖ₊₁`, by more than rounding (10⁻¹⁰ of the product of its
    /// sides). Straight corners do not count as convex, since a fan around one
    /// may have triangles without area.
    ///
    /// The result [keeps](TriMesh::polygons) the polygons.
    pub fn triangulate(&self) -> TriMesh {
        self.clone().split().0
    }

    /// [`triangulate`](Self::triangulate) with the place of the corners of each triangle among
    /// those of all polygons in turn, and the polygons that ran out of ears.
    pub(crate) fn split(self) -> (TriMesh, Vec<[usize; 3]>, Vec<usize>) {
        let (corners, crossing) = triangles(&self);
        let vertices = |corners: &[usize; 3]| corners.map(|k| self.faces.corners[k]);
        let faces = corners.iter().map(vertices).collect();
        let polygons = (self.faces.non_triangles() > 0).then_some(self.faces);
        let mesh = TriMesh::from_polygons_checked(self.positions, faces, polygons);
        (mesh, corners, crossing)
    }
}

/// The triangles in the order of the polygons, as places among the corners of all polygons, and the
/// polygons that are not simple.
fn triangles(mesh: &PolygonMesh) -> (Vec<[usize; 3]>, Vec<usize>) {
    let count = mesh.polygons().map(|polygon| polygon.len() - 2).sum();
    let mut triangles = Vec::with_capacity(count);
    let mut crossing = Vec::new();
    let mut start = 0;
    for (number, polygon) in mesh.polygons().enumerate() {
        let corner = |k: usize| start + k;
        if polygon.len() == 3 {
            triangles.push([0, 1, 2].map(corner));
        } else {
            let points: Vec<DVec3> =
                polygon.iter().map(|&v| mesh.positions()[v as usize].into()).collect();
            let split = split(&points);
            triangles.extend(split.triangles.into_iter().map(|triangle| triangle.map(corner)));
            crossing.extend((!split.simple).then_some(number));
        }
        start += polygon.len();
    }
    (triangles, crossing)
}

fn split(points: &[DVec3]) -> Split {
    let points = centered(points);
    let normal = area_vector(&points);
    let n = points.len();
    let turns_left = |k: usize| {
        let [p, q, r] = [(k + n - 1) % n, k, (k + 1) % n].map(|k| points[k]);
        turn(p, q, r, normal) > 0.0
    };
    if (0..n).all(turns_left) {
        let all: Vec<usize> = (0..n).collect();
        return Split { triangles: fan(&all), simple: rounds(&points) == 1 };
    }
    ears::cut(&points, normal)
}

/// The number of times that the sides of a polygon turn around, if all corners turn alike: one if
/// it is convex, more if it crosses itself.
fn rounds(points: &[DVec3]) -> usize {
    let side = |k: usize| points[(k + 1) % points.len()] - points[k % points.len()];
    let is_ahead = |k: usize| side(k).dot(side(0)) >= 0.0;
    (0..points.len()).filter(|&k| !is_ahead(k) && is_ahead(k + 1)).count()
}

/// The polygon moved and scaled into the unit cube, so that products neither
/// overflow nor cancel far from the origin.
fn centered(points: &[DVec3]) -> Vec<DVec3> {
    // Halved first: the difference of two finite numbers may be infinite.
    let halves: Vec<DVec3> = points.iter().map(|&p| 0.5 * p).collect();
    let moved: Vec<DVec3> = halves.iter().map(|&p| p - halves[0]).collect();
    let largest = moved.iter().fold(0.0_f64, |m, p| m.max(p.abs().max_element()));
    if largest == 0.0 {
        return moved;
    }
    moved.into_iter().map(|p| p / largest).collect()
}

/// Twice the area vector, `Σ pₖ × pₖ₊₁`.
fn area_vector(points: &[DVec3]) -> DVec3 {
    let next = points.iter().cycle().skip(1);
    points.iter().zip(next).map(|(&p, &q)| p.cross(q)).sum()
}

#[cfg(test)]
mod tests;
