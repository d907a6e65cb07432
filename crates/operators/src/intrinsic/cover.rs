//! Glued triangles of a mesh that cover each face twice.

use fairing_mesh::TriMesh;
use glam::DVec3;

use super::delaunay::{BORDER, Triangulation};
use crate::tangent::tangent_frame;

/// The tufted cover: a front and a back of each face, face f and F + f. Around
/// an edge, the side of a face towards the next one is glued to that one's
/// side towards it, so that every edge has two triangles: a border folds back
/// on its own face, and a closed surface becomes two.
///
/// The order around an edge is that of the faces in space, of their numbers
/// where they coincide.
pub(super) fn tufted(mesh: &TriMesh) -> Triangulation {
    let count = mesh.face_count() as u32;
    let mut faces = mesh.faces().to_vec();
    faces.extend(mesh.faces().iter().map(|&[a, b, c]| [a, c, b]));
    let mut glued = sides(mesh, &faces);
    let topology = mesh.topology();
    let mut around: Vec<(f64, u32)> = vec![];
    for (e, &[a, b]) in topology.edges().iter().enumerate() {
        let incident = topology.edge_faces(e as u32);
        around.clear();
        if incident.len() < 3 {
            around.extend(incident.iter().map(|&f| (0.0, f)));
        } else {
            around.extend(incident.iter().map(|&f| (angle_around(mesh, f, [a, b]), f)));
            around.sort_unstable_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
        }
        for (i, &(_, f)) in around.iter().enumerate() {
            let (_, g) = around[(i + 1) % around.len()];
            // A face that runs from a to b shows its front in the direction of
            // growing angles.
            let (_, towards) = fronts(mesh, f, [a, b], count);
            let (backwards, _) = fronts(mesh, g, [a, b], count);
            glued.twin[towards as usize] = backwards;
            glued.twin[backwards as usize] = towards;
        }
    }
    glued
}

/// The sides along the edge `[a, b]` of the two copies of face `f`: the copy
/// facing smaller angles about the edge, then the one facing larger angles. The
/// first side runs from b to a, the second from a to b.
fn fronts(mesh: &TriMesh, f: u32, [a, b]: [u32; 2], count: u32) -> (u32, u32) {
    let front = side_of(mesh, f, [a, b]);
    // The back is (a, c, b): its sides are those of the front backwards,
    // 0 ↔ 2 and 1 ↔ 1.
    let back = 3 * (f + count) + (2 - front % 3);
    let runs_forward = mesh.faces()[f as usize][front as usize % 3] == a;
    if runs_forward { (back, front) } else { (front, back) }
}

/// The side of face `f` along the edge, in whichever direction.
fn side_of(mesh: &TriMesh, f: u32, [a, b]: [u32; 2]) -> u32 {
    let face = mesh.faces()[f as usize];
    // The corner that is on neither end lies opposite; the side follows it.
    let opposite = (0..3).find(|&k| face[k] != a && face[k] != b).unwrap_or(0);
    3 * f + (opposite as u32 + 1) % 3
}

/// The angle of face `f` about the edge from a to b.
fn angle_around(mesh: &TriMesh, f: u32, [a, b]: [u32; 2]) -> f64 {
    let p = mesh.positions();
    let [from, to] = [a, b].map(|v| DVec3::from(p[v as usize]));
    let Some(axis) = (to - from).try_normalize() else { return 0.0 };
    let [x, y] = tangent_frame(axis);
    debug_assert!(x.cross(y).dot(axis) > 0.0);
    let opposite = mesh.faces()[f as usize].into_iter().find(|&v| v != a && v != b);
    let out = DVec3::from(p[opposite.unwrap_or(a) as usize]) - from;
    libm::atan2(out.dot(y), out.dot(x))
}

fn sides(mesh: &TriMesh, faces: &[[u32; 3]]) -> Triangulation {
    let start = faces.as_flattened().to_vec();
    let p = mesh.positions();
    let length = faces
        .iter()
        .flat_map(|f| {
            let [a, b, c] = f.map(|v| DVec3::from(p[v as usize]));
            [a.distance(b), b.distance(c), c.distance(a)]
        })
        .collect();
    Triangulation { twin: vec![BORDER; start.len()], start, length }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(t: &Triangulation) {
        for s in 0..t.start.len() {
            let twin = t.twin[s] as usize;
            assert_eq!(t.twin[twin], s as u32, "glued both ways");
            let end = |s: usize| t.start[super::super::delaunay::after(s as u32) as usize];
            assert_eq!((t.start[s], end(s)), (end(twin), t.start[twin]), "opposite directions");
            assert_eq!(t.length[s], t.length[twin]);
        }
    }

    #[test]
    fn every_side_of_a_cover_is_glued() {
        // A book of four pages, two of them turned, and a page of its own.
        let mut positions = vec![[0.0; 3], [0.0, 0.0, 1.0]];
        for i in 0..4 {
            let a = f64::from(i) * 1.3;
            positions.push([a.cos(), a.sin(), 0.5]);
        }
        positions.extend([[5.0, 0.0, 0.0], [6.0, 0.0, 0.0], [5.0, 1.0, 0.0]]);
        let faces = vec![[0, 1, 2], [1, 0, 3], [0, 1, 4], [1, 0, 5], [6, 7, 8]];
        let mesh = TriMesh::new(positions, faces).unwrap();
        let cover = tufted(&mesh);
        check(&cover);
        // Sides that look at each other are glued: pages 0 and 1, both facing
        // the gap between them with a copy that the other's twin is.
        let s = side_of(&mesh, 0, [0, 1]);
        assert_eq!(cover.twin[s as usize] / 3, 1);
    }

    #[test]
    fn a_closed_surface_becomes_two() {
        let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        let mesh = TriMesh::new(positions, faces).unwrap();
        let cover = tufted(&mesh);
        check(&cover);
        for (s, &t) in cover.twin.iter().enumerate() {
            assert_eq!(s < 12, t < 12, "front is glued to front");
        }
    }
}
