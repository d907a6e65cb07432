//! Self-intersections.

use fairing_mesh::TriMesh;
use glam::DVec3;
use robust::{Coord3D, orient3d};

use crate::surface_tree::{Frame, SurfaceTree};

/// The number of faces at a vertex above which their pairs are found by direction.
/// Below, up to half a million pairs are tested one by one, in hundredths of a
/// second.
const HUB: usize = 1000;

/// A triangle whose box has all directions.
const ALL_DIRECTIONS: [DVec3; 3] = [DVec3::NEG_ONE, DVec3::ONE, DVec3::ONE];

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
    let groups = by_hub(mesh);
    let tree = |faces: &Vec<u32>| {
        SurfaceTree::of(faces.clone(), |f| mesh.triangle(f as usize).map(DVec3::from), frame)
    };
    let trees: Vec<SurfaceTree> = groups.iter().map(|(_, faces)| tree(faces)).collect();
    let mut count = 0;
    for (i, (hub, faces)) in groups.iter().enumerate() {
        count += match hub {
            None => trees[i].count_overlapping_pairs(&trees[i], meets),
            Some(hub) => {
                let arcs = SurfaceTree::of(faces.clone(), |f| arc(mesh, *hub, f), Frame::HALF);
                arcs.count_overlapping_pairs(&arcs, meets)
            }
        };
        for other in trees[..i].iter().filter(|other| other.may_meet(&trees[i])) {
            let few_first = trees[i].len() < other.len();
            let (a, b) = if few_first { (&trees[i], other) } else { (other, &trees[i]) };
            count += a.count_overlapping_pairs(b, meets);
        }
    }
    count
}

/// The faces without a hub, a vertex of more than [`HUB`] faces, and those of
/// each hub, of which a face with several has the lowest.
///
/// The boxes of the faces of a hub overlap, as many pairs as there are, near the
/// hub; only the directions in which it sees them are apart.
fn by_hub(mesh: &TriMesh) -> Vec<(Option<u32>, Vec<u32>)> {
    let offsets = mesh.incidence().offsets();
    let is_hub = |v: u32| (offsets[v as usize + 1] - offsets[v as usize]) as usize > HUB;
    let all = 0..mesh.face_count() as u32;
    let mut of_hubs: Vec<(u32, u32)> = vec![];
    let mut others = vec![];
    for f in all {
        match mesh.faces()[f as usize].into_iter().filter(|&v| is_hub(v)).min() {
            Some(hub) => of_hubs.push((hub, f)),
            None => others.push(f),
        }
    }
    of_hubs.sort_unstable();
    let groups = of_hubs.chunk_by(|a, b| a.0 == b.0);
    let groups = groups.map(|group| (Some(group[0].0), group.iter().map(|x| x.1).collect()));
    std::iter::once((None, others)).chain(groups).collect()
}

/// A triangle around the directions in which a corner sees the opposite side:
/// an arc of the unit sphere, between its ends and where its tangents there
/// meet. Two faces that cross, and have only that corner in common, do so in a
/// direction of both.
fn arc(mesh: &TriMesh, corner: u32, face: u32) -> [DVec3; 3] {
    let at = |v: u32| DVec3::from(mesh.positions()[v as usize]);
    let [p, q] = match mesh.faces()[face as usize] {
        [a, b, c] if a == corner => [b, c],
        [a, b, c] if b == corner => [c, a],
        [a, b, _] => [a, b],
    };
    let direction = |v: u32| (at(v) - at(corner)).try_normalize();
    match (direction(p), direction(q)) {
        // Up to a right angle, which leaves the tangents' meeting within √2.
        (Some(u), Some(v)) if u.dot(v) >= 0.0 => [u, v, (u + v) * (1.0 / (1.0 + u.dot(v)))],
        _ => ALL_DIRECTIONS,
    }
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
