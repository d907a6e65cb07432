//! Normals for shading.

use std::collections::BTreeMap;

use fairing_mesh::{Incidence, TriMesh};
use glam::DVec3;
use rayon::prelude::*;

/// Interpolation of normals over a face.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Shading {
    /// Interpolated between vertex normals.
    #[default]
    Smooth,
    /// The normal of each face: shows noise and the mesh itself as they are.
    Flat,
    /// Interpolated, but not across edges that turn by more than `degrees`:
    /// for objects with sharp edges. Around a vertex of more than 256 faces, normals that differ by
    /// a few degrees count as one.
    Creased {
        /// The largest turn between normals that are averaged.
        degrees: f64,
    },
}

/// Twice the area vectors of all faces, in units of `1 / scale²`, so that
/// no mesh is too small or too large for them.
pub(crate) fn area_vectors(mesh: &TriMesh, scale: f64) -> Vec<DVec3> {
    (0..mesh.face_count())
        .into_par_iter()
        .with_min_len(4096)
        .map(|f| {
            let [a, b, c] = mesh.triangle(f).map(DVec3::from_array);
            ((b - a) / scale).cross((c - a) / scale)
        })
        .collect()
}

/// The sum of the area vectors around each vertex, normalised; zero where
/// they cancel or there is none.
pub(crate) fn vertex_normals(mesh: &TriMesh, area_vectors: &[DVec3]) -> Vec<DVec3> {
    let incidence = mesh.incidence();
    (0..mesh.vertex_count() as u32)
        .into_par_iter()
        .with_min_len(4096)
        .map(|v| {
            let corners = incidence.corners(v);
            corners.iter().map(|&c| area_vectors[c as usize / 3]).sum::<DVec3>().normalize_or_zero()
        })
        .collect()
}

/// Faces of a vertex above which their normals are compared in cells: each of n faces would be
/// compared with all the others.
const HUB: usize = 256;

/// Cells of directions to a unit of length: they are some four degrees wide.
const CELLS: f64 = 16.0;

/// The cell of a unit normal.
fn cell(normal: DVec3) -> [i8; 3] {
    (normal * CELLS).round().to_array().map(|x| x as i8)
}

/// The sums of the area vectors around each vertex of more than [`HUB`] faces, by the cells of
/// their directions, of which there are some thousands at most.
fn hubs(
    incidence: &Incidence,
    vertex_count: usize,
    area_vectors: &[DVec3],
    unit: &[DVec3],
) -> BTreeMap<u32, BTreeMap<[i8; 3], DVec3>> {
    let is_hub = |v: &u32| incidence.corners(*v).len() > HUB;
    let cells = |v: u32| {
        let mut cells = BTreeMap::<_, DVec3>::new();
        for f in incidence.corners(v).iter().map(|&c| c as usize / 3) {
            *cells.entry(cell(unit[f])).or_default() += area_vectors[f];
        }
        (v, cells)
    };
    (0..vertex_count as u32).filter(is_hub).map(cells).collect()
}

/// Normals for the corners of each face, of any length above zero.
pub(crate) fn corner_normals(
    mesh: &TriMesh,
    area_vectors: &[DVec3],
    shading: Shading,
) -> Vec<[DVec3; 3]> {
    let faces = mesh.faces();
    match shading {
        Shading::Flat => area_vectors.iter().map(|&n| [n; 3]).collect(),
        Shading::Smooth => {
            let normals = vertex_normals(mesh, area_vectors);
            faces
                .iter()
                .enumerate()
                .map(|(f, corners)| {
                    corners.map(|v| match normals[v as usize] {
                        DVec3::ZERO => area_vectors[f],
                        n => n,
                    })
                })
                .collect()
        }
        Shading::Creased { degrees } => {
            let least = libm::cos(degrees.to_radians());
            let unit: Vec<DVec3> = area_vectors.iter().map(|n| n.normalize_or_zero()).collect();
            let incidence = mesh.incidence();
            let hubs = hubs(incidence, mesh.vertex_count(), area_vectors, &unit);
            let around = |f: usize, v: u32| -> DVec3 {
                let corners = incidence.corners(v).iter().map(|&c| c as usize / 3);
                let alike = corners.filter(|&g| g == f || unit[f].dot(unit[g]) >= least);
                alike.map(|g| area_vectors[g]).sum()
            };
            let around_hub = |f: usize, cells: &BTreeMap<[i8; 3], DVec3>| -> DVec3 {
                let own = cell(unit[f]);
                let is_alike = |(key, sum): &(&[i8; 3], &DVec3)| {
                    **key == own || unit[f].dot(sum.normalize_or_zero()) >= least
                };
                cells.iter().filter(is_alike).map(|(_, sum)| *sum).sum()
            };
            let normal = |f: usize, v: u32| match hubs.get(&v) {
                Some(cells) => around_hub(f, cells).normalize_or_zero(),
                None => around(f, v).normalize_or_zero(),
            };
            let of_face = |(f, corners): (usize, &[u32; 3])| corners.map(|v| normal(f, v));
            faces.par_iter().enumerate().with_min_len(1024).map(of_face).collect()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two squares that meet at a right angle.
    fn step() -> TriMesh {
        TriMesh::new(
            vec![
                [0.0, 0.0, 0.0],
                [0.0, 1.0, 0.0],
                [1.0, 0.0, 0.0],
                [1.0, 1.0, 0.0],
                [1.0, 0.0, -1.0],
                [1.0, 1.0, -1.0],
            ],
            vec![[0, 2, 1], [1, 2, 3], [2, 4, 3], [3, 4, 5]],
        )
        .unwrap()
    }

    #[test]
    fn a_crease_keeps_its_two_normals() {
        let mesh = step();
        let areas = area_vectors(&mesh, 1.0);
        let creased = corner_normals(&mesh, &areas, Shading::Creased { degrees: 40.0 });
        for (f, corners) in creased.iter().enumerate() {
            let expected = if f < 2 { DVec3::Z } else { DVec3::X };
            for n in corners {
                assert!(n.distance(expected) < 1e-15, "{f}: {n}");
            }
        }
        let smooth = corner_normals(&mesh, &areas, Shading::Smooth);
        // Vertex 2 has one face on one side and two of the same size on the
        // other.
        assert!(smooth[0][1].distance(DVec3::new(1.0, 0.0, 2.0).normalize()) < 1e-15);
    }

    /// A roof of two planes around a vertex of many faces keeps its crease; the cells of a hub do
    /// not become more with its faces, even where these look everywhere.
    #[test]
    fn hubs_have_a_bounded_number_of_cells() {
        let n = 4 * HUB as u32;
        let rim = (0..n).map(|i| {
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(i) / f64::from(n));
            [cos, sin, -cos.abs()]
        });
        let positions = std::iter::once([0.0; 3]).chain(rim).collect();
        let faces = (0..n).map(|i| [0, i + 1, (i + 1) % n + 1]).collect();
        let roof = TriMesh::new(positions, faces).unwrap();
        let areas = area_vectors(&roof, 1.0);
        let creased = corner_normals(&roof, &areas, Shading::Creased { degrees: 40.0 });
        for (area, [hub, ..]) in areas.iter().zip(creased) {
            assert!(hub.distance(area.normalize()) < 1e-9, "{hub} {area}");
        }
        let cells = |n: usize| {
            let spiral = |i: usize| {
                let z = 1.0 - (2 * i + 1) as f64 / n as f64;
                let (sin, cos) = libm::sincos(2.4 * i as f64);
                DVec3::new((1.0 - z * z).sqrt() * cos, (1.0 - z * z).sqrt() * sin, z)
            };
            let faces = (0..n as u32).map(|i| [0, i + 1, i + 2]).collect();
            let fan = TriMesh::new(vec![[0.0; 3]; n + 2], faces).unwrap();
            let unit: Vec<DVec3> = (0..n).map(spiral).collect();
            hubs(fan.incidence(), n + 2, &unit, &unit)[&0].len()
        };
        assert!(cells(200_000) < 6000 && cells(400_000) < 6000, "{}", cells(400_000));
    }
}
