//! Subdivided icosahedra.

use super::made;
use crate::TriMesh;
use crate::vec3::{add, norm, scale};

/// The unit sphere as an icosahedron, each face cut into four `level` times,
/// new vertices pushed out to the sphere.
///
/// `10·4^level + 2` vertices: those of the level below, in their order, then
/// one for each of its edges, in the order of
/// [`Topology::edges`](crate::Topology::edges). `20·4^level` faces: the
/// children of a face follow one another, the three corners first.
///
/// # Panics
///
/// Above level 13, which has more corners than `u32` can number.
pub fn icosphere(level: u32) -> TriMesh {
    assert!(level <= 13, "an icosphere of level {level} has more corners than u32 can number");
    let mut mesh = icosahedron();
    for _ in 0..level {
        let mut positions = mesh.positions().to_vec();
        for &[a, b] in mesh.topology().edges() {
            let middle = add(mesh.positions()[a as usize], mesh.positions()[b as usize]);
            positions.push(scale(middle, 1.0 / norm(middle)));
        }
        mesh = made(positions, quartered(&mesh));
    }
    mesh
}

/// The faces of `mesh`, each cut into four; vertex `V + e` is on edge `e`.
fn quartered(mesh: &TriMesh) -> Vec<[u32; 3]> {
    let base = mesh.vertex_count() as u32;
    let mut faces = Vec::with_capacity(4 * mesh.face_count());
    for (&[a, b, c], edges) in mesh.faces().iter().zip(mesh.topology().face_edges()) {
        let [bc, ca, ab] = edges.map(|e| base + e);
        faces.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
    }
    faces
}

/// A vertex at each pole and two rings of five between, the lower one turned
/// by 36°.
fn icosahedron() -> TriMesh {
    let (z, r) = (1.0 / 5f64.sqrt(), 2.0 / 5f64.sqrt());
    let mut positions = vec![[0.0, 0.0, 1.0]];
    for (ring, z) in [(0, z), (1, -z)] {
        for i in 0..5 {
            let angle = std::f64::consts::PI * (2 * i + ring) as f64 / 5.0;
            positions.push([r * angle.cos(), r * angle.sin(), z]);
        }
    }
    positions.push([0.0, 0.0, -1.0]);
    let mut faces = vec![];
    for i in 0..5 {
        let (a, b) = (1 + i, 1 + (i + 1) % 5);
        let (c, d) = (6 + i, 6 + (i + 1) % 5);
        faces.extend([[0, a, b], [a, c, b], [b, c, d], [11, d, c]]);
    }
    made(positions, faces)
}
