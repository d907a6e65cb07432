//! Spheres in latitude and longitude or of subdivided icosahedra, octahedra, ellipsoids, and a
//! sphere with bumps.

use std::f64::consts::{PI, TAU};

use fairing_mesh::{TriMesh, subdivide_midpoint};
use glam::DVec3;

use super::grid::{Diagonals, grid_faces, made};

/// The unit sphere in `around` meridians and `across` bands of latitude.
///
/// Vertex 0 is the south pole (0, 0, −1); vertex `1 + (j − 1)·around + i` is
/// at longitude 2π i / around and π j / across from that pole; the last is
/// the north pole. Faces shrink towards the poles.
///
/// # Panics
///
/// If `around` is below 3 or `across` below 2.
pub fn uv_sphere(around: u32, across: u32) -> TriMesh {
    assert!(around >= 3 && across >= 2, "{around} meridians and {across} bands make no sphere");
    let mut positions = vec![[0.0, 0.0, -1.0]];
    for j in 1..across {
        let (r, z) = libm::sincos(PI * f64::from(j) / f64::from(across));
        for i in 0..around {
            let (s, c) = libm::sincos(TAU * f64::from(i) / f64::from(around));
            positions.push([r * c, r * s, -z]);
        }
    }
    positions.push([0.0, 0.0, 1.0]);
    let id = |i: u32, j: u32| 1 + j * around + i % around;
    let mut faces: Vec<[u32; 3]> = (0..around).map(|i| [0, id(i + 1, 0), id(i, 0)]).collect();
    faces.extend(grid_faces(around, across - 2, Diagonals::Regular, id));
    let (last, north) = (across - 2, positions.len() as u32 - 1);
    faces.extend((0..around).map(|i| [id(i, last), id(i + 1, last), north]));
    made(positions, faces)
}

/// A sphere with smooth bumps: the icosphere of the level, scaled along its
/// radius by
///
/// ```text
/// r = 1 + a (sin fx sin fy + sin fy sin fz + sin fz sin fx)
/// ```
///
/// with `amplitude` a and `frequency` f, at the point (x, y, z) of the unit
/// sphere.
///
/// # Panics
///
/// If |a| is not below ⅓, where the radius could vanish; if the frequency is
/// not finite; above level 13.
pub fn bumpy_sphere(level: u32, amplitude: f64, frequency: f64) -> TriMesh {
    assert!(amplitude.abs() < 1.0 / 3.0, "amplitude {amplitude} is not below 1/3");
    assert!(frequency.is_finite(), "frequency {frequency}");
    let sphere = icosphere(level);
    let positions = sphere
        .positions()
        .iter()
        .map(|&p| {
            let [x, y, z] = p.map(|t| libm::sin(frequency * t));
            let height = 1.0 + amplitude * (x * y + y * z + z * x);
            p.map(|t| height * t)
        })
        .collect();
    made(positions, sphere.faces().to_vec())
}

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

/// The regular octahedron with vertices at distance 1 along the axes: +x, −x, +y, −y, +z, −z, in
/// this order.
///
/// Four faces around the upper vertex, then four around the lower one. Its uniform Laplacian has
/// the eigenvalues 0, −1 (three times) and −3/2 (twice), the least that a closed triangle mesh can
/// have.
pub fn octahedron() -> TriMesh {
    let axis = |v: usize| {
        let mut p = [0.0; 3];
        p[v / 2] = if v.is_multiple_of(2) { 1.0 } else { -1.0 };
        p
    };
    let upper = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4]];
    let lower = [[2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    made((0..6).map(axis).collect(), [upper, lower].concat())
}

/// The ellipsoid x²/a² + y²/b² + z²/c² = 1 for `axes` (a, b, c): the icosphere
/// of the level, stretched; same vertices and faces. Volume 4π/3 abc.
///
/// # Panics
///
/// Unless the half-axes are positive and finite; for an extent outside of
/// [`EXTENTS`](fairing_mesh::EXTENTS); above level 13.
pub fn ellipsoid(axes: [f64; 3], level: u32) -> TriMesh {
    assert!(axes.iter().all(|&a| a > 0.0 && a.is_finite()), "half-axes {axes:?}");
    let sphere = icosphere(level);
    let positions = sphere.positions().iter().map(|p| [0, 1, 2].map(|k| axes[k] * p[k])).collect();
    made(positions, sphere.faces().to_vec())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_closed_and_turned_outward() {
        let mesh = octahedron();
        assert!(mesh.topology().is_closed());
        assert!((mesh.signed_volume() - 4.0 / 3.0).abs() < 1e-15);
    }
}
