//! Self-intersections.

use fairing_mesh::TriMesh;
use glam::DVec3;
use robust::{Coord3D, orient3d};

use crate::hub::{by_hub, seen};
use crate::surface_tree::{Frame, SurfaceTree};

/// The number of pairs of faces that pass through each other.
///
/// A pair counts when a side of one face crosses the plane of the other, with
/// ends strictly on both sides, at a point of that face (its border included),
/// and the side does not share a corner with it. Faces that only touch, or
/// overlap in one plane, do not count; nor do two faces with a common edge,
/// whose planes meet in it. Decided exactly, by Shewchuk's adaptive
/// predicates [shewchuk1997]. The number does not change when the mesh is
/// scaled by a power of two, nor when its vertices are renumbered. F log F for
/// F faces and few crossings, whatever the number of faces at a vertex, unless
/// the boxes of faces without a common vertex overlap in many pairs.
///
/// [shewchuk1997]: https://doi.org/10.1007/PL00009321
#[doc(alias = "does_self_intersect")]
pub fn self_intersections(mesh: &TriMesh) -> usize {
    // Without faces there is nothing to cross.
    let Some(frame) = Frame::new(mesh).filter(|_| mesh.face_count() > 0) else { return 0 };
    let meets = |f: u32, g: u32| {
        let (f, g) = (mesh.faces()[f as usize], mesh.faces()[g as usize]);
        crosses(mesh, f, g) || crosses(mesh, g, f)
    };
    let (others, hubs) = by_hub(mesh);
    let tree =
        SurfaceTree::of(others.clone(), |f| mesh.triangle(f as usize).map(DVec3::from), frame);
    let mut count = tree.count_overlapping_pairs(&tree, meets);
    for (i, (hub, faces)) in hubs.iter().enumerate() {
        let as_seen =
            |faces: Vec<u32>| SurfaceTree::of(faces, |f| seen(mesh, *hub, f), Frame::HALF);
        let arcs = as_seen(faces.clone());
        count += arcs.count_overlapping_pairs(&arcs, meets);
        for group in std::iter::once(&others).chain(hubs[..i].iter().map(|(_, faces)| faces)) {
            count += as_seen(near(mesh, group, faces)).count_overlapping_pairs(&arcs, meets);
        }
    }
    count
}

/// The faces whose boxes overlap the one around other faces.
fn near(mesh: &TriMesh, faces: &[u32], others: &[u32]) -> Vec<u32> {
    let bounds = |f: &u32| {
        let [a, b, c] = mesh.triangle(*f as usize).map(DVec3::from);
        [a.min(b).min(c), a.max(b).max(c)]
    };
    let join = |[low, high]: [DVec3; 2], f: &u32| {
        let [l, h] = bounds(f);
        [low.min(l), high.max(h)]
    };
    let [low, high] = others.iter().fold([DVec3::INFINITY, DVec3::NEG_INFINITY], join);
    let overlaps = |f: &&u32| {
        let [l, h] = bounds(f);
        l.cmple(high).all() && h.cmpge(low).all()
    };
    faces.iter().filter(overlaps).copied().collect()
}

/// Returns true if a side of `face` that has no corner in common with `other` crosses `other`.
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
                let (s, t) = (s.map(DVec3::from), t.map(DVec3::from));
                let normal = (t[1] - t[0]).cross(t[2] - t[0]);
                (0..3).any(|k| {
                    let (p, q) = (s[k], s[(k + 1) % 3]);
                    let (x, y) = ((p - t[0]).dot(normal), (q - t[0]).dot(normal));
                    let at = p + (q - p) * (x / (x - y));
                    let inside = (0..3).all(|i| {
                        let (u, v) = (t[i], t[(i + 1) % 3]);
                        (v - u).cross(at - u).dot(normal) > 0.0
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

    /// A star of faces around a vertex in all directions, some of them wide, and a
    /// sphere in it: the same number as by testing all pairs.
    #[test]
    fn faces_of_a_hub() {
        let at = |i: u32| {
            let [x, y, z] = [1u32, 2, 3].map(|k| f64::from(i * (7919 + 104 * k) % 1009) / 504.5);
            [x - 1.0, y - 1.0, z - 1.0]
        };
        let mut positions = vec![[0.01, 0.02, 0.03]];
        positions.extend((1..1500).map(at));
        let mut faces: Vec<[u32; 3]> = (1..1499)
            .map(|i| match i % 3 {
                0 => [0, i, i + 1],
                1 => [i + 1, 0, i],
                _ => [i, i + 1, 0],
            })
            .collect();
        let body = shapes::icosphere(1);
        faces.extend(body.faces().iter().map(|f| f.map(|v| v + 1500)));
        positions.extend(body.positions().iter().map(|p| p.map(|x| 0.5 * x)));
        let star = mesh(&positions, &faces);
        let pairs = (0..faces.len()).flat_map(|f| (0..f).map(move |g| (f, g)));
        let expected = pairs
            .filter(|&(f, g)| {
                crosses(&star, faces[f], faces[g]) || crosses(&star, faces[g], faces[f])
            })
            .count();
        assert!(expected > 1000);
        assert_eq!(self_intersections(&star), expected);
    }

    /// The apex of a closed cone, the centre of its base and a body through both see each other's
    /// faces: the same number as by testing all pairs.
    #[test]
    fn faces_of_two_hubs() {
        let n = 1200u32;
        let mut positions = vec![[0.0, 0.0, 1.0], [0.1, 0.2, 0.0]];
        positions.extend((0..n).map(|i| {
            let angle = std::f64::consts::TAU * f64::from(i) / f64::from(n);
            // Waves of the rim let the faces of the two hubs cross near it.
            [angle.cos(), angle.sin(), if i % 2 == 0 { 0.0 } else { 0.05 }]
        }));
        let next = |i: u32| 2 + (i + 1) % n;
        let mut faces: Vec<[u32; 3]> =
            (0..n).flat_map(|i| [[0, 2 + i, next(i)], [1, next(next(i) - 2), 2 + i]]).collect();
        let body = shapes::icosphere(2);
        faces.extend(body.faces().iter().map(|f| f.map(|v| v + 2 + n)));
        positions.extend(body.positions().iter().map(|p| [0.3 * p[0], 0.3 * p[1], 0.4 * p[2]]));
        let both = mesh(&positions, &faces);
        let pairs = (0..faces.len()).flat_map(|f| (0..f).map(move |g| (f, g)));
        let expected = pairs
            .filter(|&(f, g)| {
                crosses(&both, faces[f], faces[g]) || crosses(&both, faces[g], faces[f])
            })
            .count();
        assert!(expected > 100, "{expected}");
        assert_eq!(self_intersections(&both), expected);
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
