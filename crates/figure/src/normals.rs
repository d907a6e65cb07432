//! Normals for shading.

use fairing_mesh::TriMesh;
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
    /// for objects with sharp edges.
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
            faces
                .par_iter()
                .enumerate()
                .with_min_len(1024)
                .map(|(f, corners)| {
                    corners.map(|v| {
                        incidence
                            .corners(v)
                            .iter()
                            .map(|&c| c as usize / 3)
                            .filter(|&g| g == f || unit[f].dot(unit[g]) >= least)
                            .map(|g| area_vectors[g])
                            .sum::<DVec3>()
                            .normalize_or_zero()
                    })
                })
                .collect()
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
}
