//! Self-intersections.

use fairing_mesh::TriMesh;
use robust::{Coord3D, orient3d};

use crate::SurfaceTree;

/// The pairs of faces of a mesh that pass through each other.
///
/// A pair counts when a side of one face crosses the plane of the other, with
/// ends strictly on both sides, at a point of that face (its border included),
/// and the side does not share a corner with it. Faces that only touch, or
/// overlap in one plane, do not count; nor do two faces with a common edge,
/// whose planes meet in it. Decided exactly, by Shewchuk's adaptive
/// predicates \[shewchuk1997\]. The number does not change when the mesh is
/// scaled by a power of two, nor when its vertices are renumbered. F log F for
/// F faces and few crossings.
pub fn self_intersections(mesh: &TriMesh) -> usize {
    let (mesh, _) = mesh.at_unit_scale();
    let mesh = &*mesh;
    // Without faces there is no tree, and nothing to cross.
    let Ok(tree) = SurfaceTree::new(mesh) else { return 0 };
    tree.count_overlapping_pairs(|f, g| {
        let (f, g) = (mesh.faces()[f as usize], mesh.faces()[g as usize]);
        crosses(mesh, f, g) || crosses(mesh, g, f)
    })
}

/// Whether a side of `face` without corners of `other` crosses `other`.
fn crosses(mesh: &TriMesh, face: [u32; 3], other: [u32; 3]) -> bool {
    let at = |v: u32| {
        let [x, y, z] = mesh.positions()[v as usize];
        Coord3D { x, y, z }
    };
    let [a, b, c] = other.map(at);
    (0..3).any(|k| {
        let (v, w) = (face[k], face[(k + 1) % 3]);
        if other.contains(&v) || other.contains(&w) {
            return false;
        }
        let (p, q) = (at(v), at(w));
        let (above, below) = (orient3d(a, b, c, p), orient3d(a, b, c, q));
        // Signs, not their product, which may underflow.
        if !(above > 0.0 && below < 0.0 || above < 0.0 && below > 0.0) {
            return false;
        }
        let turns = [orient3d(p, q, a, b), orient3d(p, q, b, c), orient3d(p, q, c, a)];
        turns.iter().all(|&t| t >= 0.0) || turns.iter().all(|&t| t <= 0.0)
    })
}

#[cfg(test)]
mod tests {
    use fairing_shapes as shapes;

    use super::*;

    fn mesh(positions: &[[f64; 3]], faces: &[[u32; 3]]) -> TriMesh {
        TriMesh::new(positions.to_vec(), faces.to_vec()).unwrap()
    }

    #[test]
    fn shapes_do_not_cross_themselves() {
        for shape in [
            shapes::icosphere(4),
            shapes::torus(3.0, 1.0, 24, 12),
            shapes::cad_block(0.15),
            shapes::creature(48),
            shapes::plane(20, 20, shapes::Diagonals::Alternating),
        ] {
            assert_eq!(self_intersections(&shape), 0);
        }
    }

    /// Two spheres of 20 faces through each other, against all pairs tested
    /// one by one with another method: sides cut by planes in coordinates.
    #[test]
    fn two_bodies_through_each_other() {
        let (a, b) = (shapes::icosphere(1), shapes::icosphere(1));
        let n = a.vertex_count() as u32;
        let mut positions = a.positions().to_vec();
        positions.extend(b.positions().iter().map(|p| [p[0] + 0.7, p[1] + 0.11, p[2] + 0.23]));
        let mut faces = a.faces().to_vec();
        faces.extend(b.faces().iter().map(|f| f.map(|v| v + n)));
        let both = mesh(&positions, &faces);
        let meets = |f: usize, g: usize| {
            let cuts = |s: [[f64; 3]; 3], t: [[f64; 3]; 3]| {
                use fairing_mesh::vec3::{add, cross, dot, scale, sub};
                let normal = cross(sub(t[1], t[0]), sub(t[2], t[0]));
                (0..3).any(|k| {
                    let (p, q) = (s[k], s[(k + 1) % 3]);
                    let (x, y) = (dot(sub(p, t[0]), normal), dot(sub(q, t[0]), normal));
                    let at = add(p, scale(sub(q, p), x / (x - y)));
                    let inside = (0..3).all(|i| {
                        let (u, v) = (t[i], t[(i + 1) % 3]);
                        dot(cross(sub(v, u), sub(at, u)), normal) > 0.0
                    });
                    x * y < 0.0 && inside
                })
            };
            cuts(both.triangle(f), both.triangle(g)) || cuts(both.triangle(g), both.triangle(f))
        };
        let half = a.face_count();
        let expected = (0..half)
            .flat_map(|f| (half..2 * half).map(move |g| (f, g)))
            .filter(|&(f, g)| meets(f, g))
            .count();
        assert!(expected > 20);
        assert_eq!(self_intersections(&both), expected);
    }

    #[test]
    fn touching_is_not_crossing() {
        let flat = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
        let with = |more: [[f64; 3]; 3]| {
            let positions: Vec<_> = flat.into_iter().chain(more).collect();
            self_intersections(&mesh(&positions, &[[0, 1, 2], [3, 4, 5]]))
        };
        // A corner on the face, a face in the same plane, a face beside it.
        assert_eq!(with([[1.0, 1.0, 0.0], [1.0, 1.0, 2.0], [2.0, 1.0, 2.0]]), 0);
        assert_eq!(with([[1.0, 1.0, 0.0], [2.0, 1.0, 0.0], [1.0, 2.0, 0.0]]), 0);
        assert_eq!(with([[5.0, 5.0, -1.0], [5.0, 5.0, 1.0], [6.0, 5.0, 1.0]]), 0);
        assert_eq!(with([[1.0, 1.0, -1.0], [1.0, 1.0, 2.0], [2.0, 1.0, 2.0]]), 1);
    }

    /// Two faces with a common corner may still cross.
    #[test]
    fn a_common_corner() {
        let positions = [
            [0.0, 0.0, 0.0],
            [4.0, 0.0, 0.0],
            [0.0, 4.0, 0.0],
            [1.0, 1.0, -1.0],
            [1.0, 1.0, 1.0],
            [-1.0, -1.0, 1.0],
        ];
        assert_eq!(self_intersections(&mesh(&positions, &[[0, 1, 2], [0, 3, 4]])), 1);
        assert_eq!(self_intersections(&mesh(&positions, &[[0, 1, 2], [0, 5, 4]])), 0);
    }
}
