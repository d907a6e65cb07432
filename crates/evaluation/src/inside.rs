//! Inner and outer side of a surface.

use fairing_mesh::TriMesh;
use fairing_operators::{NormalWeight, face_normals, weighted_vertex_normals};
use glam::DVec3;

use crate::surface_tree::Closest;

/// The barycentric coordinate below which a closest point lies on the opposite side of its face.
const ON_SIDE: f64 = 1e-9;

/// True for each point on the inner side of the surface: the side to which normals do not point.
///
/// `closest` are the closest points of the surface, by
/// [`SurfaceTree::closest_to_all`](crate::SurfaceTree::closest_to_all). The side is that of the
/// normal there, at an edge the sum of the normals of its faces, at a vertex the sum weighted by
/// angles: on a closed surface that does not intersect itself this is exact. An open surface
/// divides space only near itself. Faces count as [oriented](TriMesh::oriented). Points on the
/// surface are not inside.
///
/// # Examples
///
/// ```
/// use fairing_evaluation::{SurfaceTree, inside};
/// use fairing_shapes as shapes;
///
/// let sphere = shapes::icosphere(2);
/// let points = [[0.0, 0.2, 0.5], [0.0, 2.0, 0.0]];
/// let closest = SurfaceTree::new(&sphere)?.closest_to_all(&points);
/// assert_eq!(inside(&sphere, &points, &closest), [true, false]);
/// # Ok::<(), fairing_evaluation::EvaluationError>(())
/// ```
///
/// # Panics
///
/// If `closest` are points of a mesh with more faces.
///
/// Source: [baerentzen2005].
///
/// [baerentzen2005]: https://doi.org/10.1109/TVCG.2005.49
#[doc(alias("signed_distance", "contains"))]
pub fn inside(mesh: &TriMesh, points: &[[f64; 3]], closest: &[Closest]) -> Vec<bool> {
    let normals = Normals {
        mesh,
        faces: face_normals(mesh),
        vertices: weighted_vertex_normals(mesh, NormalWeight::Angle),
    };
    let pairs = points.iter().zip(closest);
    pairs
        .map(|(&p, at)| (DVec3::from(p) - DVec3::from(at.point)).dot(normals.at(at)) < 0.0)
        .collect()
}

struct Normals<'a> {
    mesh: &'a TriMesh,
    faces: Vec<[f64; 3]>,
    vertices: Vec<[f64; 3]>,
}

impl Normals<'_> {
    /// The normal at a closest point, not normalised.
    fn at(&self, closest: &Closest) -> DVec3 {
        let face = self.mesh.faces()[closest.face as usize];
        let weights = self.weights(closest);
        let mut corners = (0..3).filter(|&k| weights[k] > ON_SIDE);
        match (corners.next(), corners.next(), corners.next()) {
            (Some(_), Some(_), Some(_)) => self.face(closest.face),
            (Some(j), Some(k), None) => self.edge(face[j], face[k]),
            (Some(k), ..) => self.vertices[face[k] as usize].into(),
            _ => DVec3::ZERO,
        }
    }

    /// Barycentric coordinates; those of the nearest corner in a face without area.
    fn weights(&self, closest: &Closest) -> [f64; 3] {
        let corners = self.mesh.triangle(closest.face as usize).map(DVec3::from);
        let [a, b, c] = corners;
        let point = DVec3::from(closest.point);
        let normal = (b - a).cross(c - a);
        let square = normal.length_squared();
        if square == 0.0 {
            let distances = corners.map(|corner| corner.distance_squared(point));
            let least = distances.iter().copied().fold(f64::INFINITY, f64::min);
            return distances.map(|d| if d == least { 1.0 } else { 0.0 });
        }
        let weight = |u: DVec3, v: DVec3| (u - point).cross(v - point).dot(normal) / square;
        [weight(b, c), weight(c, a), weight(a, b)]
    }

    fn face(&self, f: u32) -> DVec3 {
        self.faces[f as usize].into()
    }

    fn edge(&self, a: u32, b: u32) -> DVec3 {
        let topology = self.mesh.topology();
        let faces = topology.edge_between(a, b).map_or(&[][..], |e| topology.edge_faces(e));
        faces.iter().map(|&f| self.face(f)).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SurfaceTree;

    /// Near an acute edge or corner most points are closest to it, and the normal of one face alone
    /// would be wrong there.
    #[test]
    fn sides_at_sharp_edges_are_those_of_the_solid() {
        // A tetrahedron with a long spike towards +x.
        let corners = vec![[9.0, 0.0, 0.0], [0.0, 1.0, -0.5], [0.0, -1.0, -0.5], [0.0, 0.0, 1.0]];
        let faces = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        let mesh = TriMesh::new(corners.clone(), faces.clone()).unwrap();
        assert!(mesh.signed_volume() > 0.0);
        let mut points = vec![];
        for i in 0..20 {
            for j in 0..15 {
                for k in 0..15 {
                    let [i, j, k] = [i, j, k].map(f64::from);
                    points.push([i * 0.53 - 0.5, j * 0.21 - 1.5, k * 0.19 - 1.2]);
                }
            }
        }
        let closest = SurfaceTree::new(&mesh).unwrap().closest_to_all(&points);
        let found = inside(&mesh, &points, &closest);
        // The solid is the intersection of the half-spaces below its faces.
        let below = |p: &[f64; 3], f: usize| {
            let [a, b, c] = faces[f].map(|v: u32| DVec3::from(corners[v as usize]));
            (b - a).cross(c - a).dot(DVec3::from(*p) - a) < 0.0
        };
        let expected: Vec<bool> = points.iter().map(|p| (0..4).all(|f| below(p, f))).collect();
        assert!(expected.contains(&true) && expected.contains(&false));
        assert_eq!(found, expected);
    }
}
