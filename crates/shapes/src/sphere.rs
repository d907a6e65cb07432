//! Spheres in latitude and longitude, and a sphere with bumps.

use std::f64::consts::{PI, TAU};

use super::grid::{Diagonals, grid_faces};
use super::icosphere::icosphere;
use super::made::made;
use fairing_mesh::TriMesh;

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
