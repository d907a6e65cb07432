//! Polygons split into triangles.

use glam::DVec3;

use crate::polygon::PolygonMesh;
use crate::trimesh::TriMesh;

/// The largest polygon that is cut ear by ear.
const MAX_CORNERS: usize = 1024;

/// The sine of a turn that rounding may produce in a straight line.
const STRAIGHT: f64 = 1e-10;

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
    ///   becomes a fan. So does a non-convex polygon of more than 1024 corners,
    ///   because cutting takes quadratic time.
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
    /// those of all polygons in turn.
    pub(crate) fn split(self) -> (TriMesh, Vec<[usize; 3]>) {
        let corners = triangles(&self);
        let vertices = |corners: &[usize; 3]| corners.map(|k| self.faces.corners[k]);
        let faces = corners.iter().map(vertices).collect();
        let polygons = (self.faces.larger() > 0).then_some(self.faces);
        (TriMesh::from_polygons_checked(self.positions, faces, polygons), corners)
    }
}

/// The triangles in the order of the polygons, as places among the corners of all polygons.
fn triangles(mesh: &PolygonMesh) -> Vec<[usize; 3]> {
    let count = mesh.polygons().map(|polygon| polygon.len() - 2).sum();
    let mut triangles = Vec::with_capacity(count);
    let mut start = 0;
    for polygon in mesh.polygons() {
        let corner = |k: usize| start + k;
        if polygon.len() == 3 {
            triangles.push([0, 1, 2].map(corner));
        } else {
            let points: Vec<DVec3> =
                polygon.iter().map(|&v| mesh.positions()[v as usize].into()).collect();
            triangles.extend(split(&points).into_iter().map(|triangle| triangle.map(corner)));
        }
        start += polygon.len();
    }
    triangles
}

/// The triangles of one polygon, by the numbers of its corners.
fn split(points: &[DVec3]) -> Vec<[usize; 3]> {
    let all: Vec<usize> = (0..points.len()).collect();
    let points = centered(points);
    let normal = area_vector(&points);
    let turns_left = |k: usize| {
        let n = points.len();
        let [p, q, r] = [(k + n - 1) % n, k, (k + 1) % n].map(|k| points[k]);
        turn(p, q, r, normal) > 0.0
    };
    if points.len() > MAX_CORNERS || all.iter().all(|&k| turns_left(k)) {
        return fan(&all);
    }
    cut_ears(&points, normal)
}

fn fan(corners: &[usize]) -> Vec<[usize; 3]> {
    corners[1..].windows(2).map(|pair| [corners[0], pair[0], pair[1]]).collect()
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

/// The turn of the path p, q, r at q: twice the signed area seen along the normal,
/// or 0 if it is no more than rounding.
fn turn(p: DVec3, q: DVec3, r: DVec3, normal: DVec3) -> f64 {
    let (a, b) = (q - p, r - q);
    let turn = a.cross(b).dot(normal);
    if turn.abs() > STRAIGHT * a.length() * b.length() * normal.length() { turn } else { 0.0 }
}

/// Cuts ears until three corners are left.
fn cut_ears(points: &[DVec3], normal: DVec3) -> Vec<[usize; 3]> {
    let mut rest: Vec<usize> = (0..points.len()).collect();
    let mut triangles = Vec::with_capacity(points.len() - 2);
    let mut quality: Vec<f64> = (0..rest.len()).map(|k| ear(points, &rest, k, normal)).collect();
    while rest.len() > 3 {
        let best = (0..rest.len()).fold(0, |b, k| if quality[k] > quality[b] { k } else { b });
        if quality[best] <= 0.0 {
            triangles.extend(fan(&rest));
            return triangles;
        }
        let n = rest.len();
        triangles.push([rest[(best + n - 1) % n], rest[best], rest[(best + 1) % n]]);
        rest.remove(best);
        quality.remove(best);
        // Only the neighbours' triangles have changed, but the corner that is gone may have
        // been inside another candidate.
        for k in 0..rest.len() {
            let neighbour = k == best % rest.len() || k == (best + rest.len() - 1) % rest.len();
            if neighbour || quality[k] <= 0.0 {
                quality[k] = ear(points, &rest, k, normal);
            }
        }
    }
    triangles.push([rest[0], rest[1], rest[2]]);
    triangles
}

/// The shape of the ear at a corner: area over the sum of squared sides, or 0
/// if the corner is no ear.
fn ear(points: &[DVec3], rest: &[usize], k: usize, normal: DVec3) -> f64 {
    let n = rest.len();
    let corners = [(k + n - 1) % n, k, (k + 1) % n];
    let [p, q, r] = corners.map(|k| points[rest[k]]);
    let area = turn(p, q, r, normal);
    if area <= 0.0 {
        return 0.0;
    }
    let side = |a: DVec3, b: DVec3, x: DVec3| (b - a).cross(x - a).dot(normal);
    let inside = |x: DVec3| {
        x != p
            && x != q
            && x != r
            && side(p, q, x) >= 0.0
            && side(q, r, x) >= 0.0
            && side(r, p, x) >= 0.0
    };
    if (0..n).any(|j| !corners.contains(&j) && inside(points[rest[j]])) {
        return 0.0;
    }
    let squared = |a: DVec3, b: DVec3| (b - a).dot(b - a);
    area / (squared(p, q) + squared(q, r) + squared(r, p))
}

#[cfg(test)]
mod tests;
