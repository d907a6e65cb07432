//! The surface in the middle of the noise.

use fairing_mesh::TriMesh;
use fairing_mesh::vec3::{add, distance, dot, norm, scale, sub};
use fairing_operators::NormalEquations;
use rayon::prelude::*;

use crate::DenoiseError;
use crate::rebuild::rebuild;

/// A displacement of this many standard deviations counts a quarter.
const RANGE: f64 = 2.0;

/// What pulls a corner towards its mean normal, as a share of what its faces ask for: where
/// they are nearly parallel it must not slide along them.
const STIFFNESS: f64 = 0.01;

/// Rounds; the first leaves what is curved, and weights that change.
const ROUNDS: usize = 2;

/// Offsets each connected part of a result by the mean displacement of its noisy vertices along the normals,
/// so that the noise lies evenly on both sides of the surface, as that of a scanner does. A closed part
/// thus keeps its volume.
///
/// All faces of a part move by the same distance along their `normals`, planes in parallel, as far
/// as three or more faces at a corner allow. Vertices that are far away count less. No vertex goes further than `limit`
/// from where it was in the noisy mesh.
///
/// # Errors
///
/// [`DenoiseError::NonFinite`] if coordinates overflow.
pub(super) fn in_the_middle(
    noisy: &TriMesh,
    mut mesh: TriMesh,
    normals: &[[f64; 3]],
    sigma: f64,
    limit: f64,
) -> Result<TriMesh, DenoiseError> {
    let components = noisy.topology().components();
    let directions = directions(&mesh, normals);
    for _ in 0..ROUNDS {
        // What lies outside of the surface, and the area, both weighted.
        let mut sums = vec![[0.0; 2]; components.count()];
        let areas = vertex_areas(&mesh, normals);
        for (v, (&x, &p)) in mesh.positions().iter().zip(noisy.positions()).enumerate() {
            let Some(part) = components.of_vertex(v as u32) else { continue };
            let away = sub(p, x);
            let far = norm(away) / (RANGE * sigma);
            let weight = (1.0 / (1.0 + far * far)).powi(2);
            let sum = &mut sums[part as usize];
            sum[0] += weight * dot(areas[v], away);
            sum[1] += weight * dot(areas[v], directions[v]);
        }
        let offsets: Vec<f64> =
            sums.iter().map(|[out, area]| if *area > 0.0 { out / area } else { 0.0 }).collect();
        let positions = (mesh.positions().iter().enumerate())
            .map(|(v, &x)| {
                let part = components.of_vertex(v as u32);
                let offset = part.map_or(0.0, |part| offsets[part as usize]);
                let moved = add(x, scale(directions[v], offset));
                if distance(moved, noisy.positions()[v]) > limit { x } else { moved }
            })
            .collect();
        mesh = rebuild(&mesh, positions)?;
    }
    Ok(mesh)
}

/// A third of the area vectors of the faces around each vertex.
fn vertex_areas(mesh: &TriMesh, normals: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let mut areas = vec![[0.0; 3]; mesh.vertex_count()];
    for (f, face) in mesh.faces().iter().enumerate() {
        let share = scale(normals[f], norm(mesh.area_vector(f)) / 3.0);
        for &v in face {
            areas[v as usize] = add(areas[v as usize], share);
        }
    }
    areas
}

/// How each vertex moves when all faces move by one along their normals: in the least squares, weighted by area.
fn directions(mesh: &TriMesh, normals: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let incidence = mesh.incidence();
    (0..mesh.vertex_count() as u32)
        .into_par_iter()
        .map(|v| {
            let mut equations = NormalEquations::<3>::default();
            let (mut sum, mut total) = ([0.0; 3], 0.0);
            for &c in incidence.corners(v) {
                let f = c as usize / 3;
                let area = norm(mesh.area_vector(f));
                if normals[f] != [0.0; 3] && area > 0.0 {
                    equations.add(&normals[f], 1.0, area);
                    sum = add(sum, scale(normals[f], area));
                    total += area;
                }
            }
            let length = norm(sum);
            if length <= 0.0 {
                return [0.0; 3];
            }
            let mean = scale(sum, 1.0 / length);
            for axis in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] {
                equations.add(&axis, dot(axis, mean), STIFFNESS * total);
            }
            equations.factor().map_or(mean, |factor| factor.solve(equations.rhs()))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use fairing_shapes::{Diagonals, cube, icosphere};

    use super::*;
    use crate::faces::FaceShapes;

    fn scaled(mesh: &TriMesh, factor: f64) -> TriMesh {
        let positions = mesh.positions().iter().map(|&p| scale(p, factor)).collect();
        mesh.with_positions(positions).unwrap()
    }

    fn middle(noisy: &TriMesh, moved: TriMesh, limit: f64) -> TriMesh {
        let normals = FaceShapes::new(&moved).normals;
        in_the_middle(noisy, moved, &normals, 0.05, limit).unwrap()
    }

    /// What has shrunk comes back: a sphere up to the curvature of its faces, and
    /// a cube with its corners, since all of its faces are planes.
    #[test]
    fn lost_volume_returns() {
        let sphere = icosphere(3);
        let found = middle(&sphere, scaled(&sphere, 0.97), 1.0).signed_volume();
        let volume = sphere.signed_volume();
        assert!((found / volume - 1.0).abs() < 1e-3, "{found}, {volume}");
        let cube = cube(6, Diagonals::Alternating);
        let found = middle(&cube, scaled(&cube, 0.97), 1.0);
        for (p, q) in found.positions().iter().zip(cube.positions()) {
            // The pull towards mean normals keeps a part of the offset along edges and at corners.
            assert!(distance(*p, *q) < 1e-3, "{p:?}, {q:?}");
        }
    }

    /// A few vertices far away count little, and no vertex passes the limit.
    #[test]
    fn impulses_do_not_move_the_surface() {
        let sphere = icosphere(3);
        let mut positions = sphere.positions().to_vec();
        for p in positions.iter_mut().step_by(7) {
            *p = scale(*p, 1.5);
        }
        let noisy = sphere.with_positions(positions).unwrap();
        let found = middle(&noisy, sphere.clone(), 1.0);
        let moved = distance(found.positions()[1], sphere.positions()[1]);
        assert!(moved < 2e-3, "{moved}");
        let far = middle(&scaled(&sphere, 1.04), sphere.clone(), 0.03);
        assert_eq!(far.positions(), sphere.positions());
    }
}
