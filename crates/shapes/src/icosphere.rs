//! Subdivided icosahedra.

use super::made::made;
use fairing_mesh::TriMesh;
use fairing_mesh::subdivide_midpoint;
use glam::DVec3;

/// The unit sphere as an icosahedron, each face cut into four `level` times,
/// new vertices pushed out to the sphere.
///
/// `10·4^level + 2` vertices: those of the level below, in their order, then
/// one for each of its edges, in the order of
/// [`Topology::edges`](fairing_mesh::Topology::edges). `20·4^level` faces: the
/// children of a face follow one another, the three corners first.
///
/// # Panics
///
/// Above level 13, which has more corners than `u32` can number.
pub fn icosphere(level: u32) -> TriMesh {
    assert!(level <= 13, "an icosphere of level {level} has more corners than u32 can number");
    let mut mesh = icosahedron();
    for _ in 0..level {
        mesh = match subdivide_midpoint(&mesh) {
            Ok(fine) => fine,
            Err(error) => unreachable!("the level was checked: {error}"),
        };
        let unit = mesh.positions().iter().map(|&p| {
            let p = DVec3::from(p);
            (p * (1.0 / p.length())).to_array()
        });
        mesh = made(unit.collect(), mesh.faces().to_vec());
    }
    mesh
}

/// A vertex at each pole and two rings of five between, the lower one turned
/// by 36°.
fn icosahedron() -> TriMesh {
    let (z, r) = (1.0 / 5f64.sqrt(), 2.0 / 5f64.sqrt());
    let mut positions = vec![[0.0, 0.0, 1.0]];
    for (ring, z) in [(0, z), (1, -z)] {
        for i in 0..5 {
            let angle = std::f64::consts::PI * (2 * i + ring) as f64 / 5.0;
            positions.push([r * libm::cos(angle), r * libm::sin(angle), z]);
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
