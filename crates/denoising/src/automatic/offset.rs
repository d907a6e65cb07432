//! The surface in the middle of the noise.

use fairing_mesh::TriMesh;
use fairing_operators::NormalEquations;
use fairing_watch::parallel;
use glam::DVec3;

use crate::error::DenoiseError;
use crate::masked::Masked;

/// The weight of the mean normal of a vertex in the fit to its faces: without it a vertex whose
/// faces are nearly parallel would slide along them.
const STIFFNESS: f64 = 0.01;

/// Rounds of Newton's method: what is curved leaves some to the second and the third.
const ROUNDS: usize = 3;

/// Offsets each connected part of a result so that the noise lies evenly on both sides of the
/// surface, as that of a scanner does: a closed part gets the volume that it had with the noise,
/// another one the mean displacement of its noisy vertices along the normals. The volume of a
/// closed mesh is linear in each of its vertices, so noise that is independent from vertex to
/// vertex does not bias it.
///
/// All faces of a part move by the same distance along their `normals`, planes in parallel, as far
/// as three or more faces at a corner allow. No vertex goes further than `limit`
/// from where it was in the noisy mesh, and a fixed one stays there.
pub(super) fn in_the_middle(
    input: Masked<'_>,
    mut mesh: TriMesh,
    normals: &[DVec3],
    limit: f64,
) -> Result<TriMesh, DenoiseError> {
    let noisy = input.mesh();
    let components = noisy.topology().components();
    let directions = directions(&mesh, normals);
    let closed = closed_parts(noisy);
    let wanted = part_volumes(noisy, noisy);
    for _ in 0..ROUNDS {
        // The volume that lies outside of the surface, and the area.
        let mut sums = vec![[0.0; 2]; components.count()];
        let areas = vertex_areas(&mesh, normals);
        for (v, (&x, &p)) in mesh.positions().iter().zip(noisy.positions()).enumerate() {
            let Some(part) = components.label(v as u32) else { continue };
            let sum = &mut sums[part as usize];
            sum[0] += areas[v].dot(DVec3::from(p) - DVec3::from(x));
            if !input.is_fixed(v) {
                sum[1] += areas[v].dot(directions[v]);
            }
        }
        let volumes = part_volumes(&mesh, noisy);
        for (part, sum) in sums.iter_mut().enumerate().filter(|(part, _)| closed[*part]) {
            sum[0] = wanted[part] - volumes[part];
        }
        let offsets: Vec<f64> =
            sums.iter().map(|[out, area]| if *area > 0.0 { out / area } else { 0.0 }).collect();
        let positions = (mesh.positions().iter().enumerate())
            .map(|(v, &x)| {
                let part = components.label(v as u32);
                let offset = part.map_or(0.0, |part| offsets[part as usize]);
                let moved = DVec3::from(x) + offset * directions[v];
                let far = moved.distance(noisy.positions()[v].into()) > limit;
                if far || input.is_fixed(v) { x } else { moved.to_array() }
            })
            .collect();
        mesh = mesh.with_positions(positions)?;
    }
    Ok(mesh)
}

/// Returns `true` for each connected part that is closed and oriented.
fn closed_parts(mesh: &TriMesh) -> Vec<bool> {
    let topology = mesh.topology();
    let components = topology.components();
    let mut closed = vec![true; components.count()];
    let mut open = |e: u32| {
        if let Some(part) = components.label(topology.edges()[e as usize][0]) {
            closed[part as usize] = false;
        }
    };
    topology.boundary_edges().for_each(&mut open);
    topology.nonmanifold_edges().for_each(&mut open);
    topology.orientation().inconsistent_edges().iter().copied().for_each(open);
    closed
}

/// The signed volume of each connected part seen from one of its vertices in the noisy mesh.
fn part_volumes(mesh: &TriMesh, noisy: &TriMesh) -> Vec<f64> {
    let components = noisy.topology().components();
    let mut parts = vec![(None, 0.0); components.count()];
    for (f, face) in mesh.faces().iter().enumerate() {
        let Some(part) = components.label(face[0]) else { continue };
        let (origin, volume) = &mut parts[part as usize];
        let o = *origin.get_or_insert(DVec3::from(noisy.positions()[face[0] as usize]));
        let [a, b, c] = mesh.triangle(f).map(DVec3::from);
        *volume += (a - o).dot((b - a).cross(c - a)) / 6.0;
    }
    parts.into_iter().map(|(_, volume)| volume).collect()
}

/// A third of the area vectors of the faces around each vertex.
fn vertex_areas(mesh: &TriMesh, normals: &[DVec3]) -> Vec<DVec3> {
    let mut areas = vec![DVec3::ZERO; mesh.vertex_count()];
    for (f, face) in mesh.faces().iter().enumerate() {
        let third = normals[f] * (DVec3::from(mesh.area_vector(f)).length() / 3.0);
        for &v in face {
            areas[v as usize] += third;
        }
    }
    areas
}

/// The motion of each vertex when all faces move by one along their normals, in least squares
/// weighted by area.
fn directions(mesh: &TriMesh, normals: &[DVec3]) -> Vec<DVec3> {
    let incidence = mesh.incidence();
    parallel::map(mesh.vertex_count(), 64, |v| {
        let v = v as u32;
        let mut equations = NormalEquations::<3>::default();
        let (mut sum, mut total) = (DVec3::ZERO, 0.0);
        for &c in incidence.corners(v) {
            let f = c as usize / 3;
            let area = DVec3::from(mesh.area_vector(f)).length();
            if normals[f] != DVec3::ZERO && area > 0.0 {
                equations.add(&normals[f].to_array(), 1.0, area);
                sum += area * normals[f];
                total += area;
            }
        }
        let length = sum.length();
        if length <= 0.0 {
            return DVec3::ZERO;
        }
        let mean = sum * (1.0 / length);
        for axis in DVec3::AXES {
            equations.add(&axis.to_array(), axis.dot(mean), STIFFNESS * total);
        }
        equations.factor().map_or(mean, |factor| factor.solve(equations.rhs()).into())
    })
}

#[cfg(test)]
mod tests {
    use fairing_shapes::{Diagonals, cube, icosphere, plane};

    use super::*;
    use crate::faces::FaceShapes;

    fn scaled(mesh: &TriMesh, factor: f64) -> TriMesh {
        let positions = mesh.positions().iter().map(|p| p.map(|x| factor * x)).collect();
        mesh.with_positions(positions).unwrap()
    }

    fn apart(a: &TriMesh, b: &TriMesh, v: usize) -> f64 {
        DVec3::from(a.positions()[v]).distance(b.positions()[v].into())
    }

    fn middle(noisy: &TriMesh, moved: TriMesh, limit: f64) -> TriMesh {
        let normals = FaceShapes::new(&moved).normals;
        in_the_middle(noisy.into(), moved, &normals, limit).unwrap()
    }

    /// A shrunken sphere gets its volume back, and a cube its corners, since all of its faces are
    /// planes.
    #[test]
    fn lost_volume_returns() {
        let sphere = icosphere(3);
        let found = middle(&sphere, scaled(&sphere, 0.97), 1.0).signed_volume();
        let volume = sphere.signed_volume();
        assert!((found / volume - 1.0).abs() < 1e-6, "{found}, {volume}");
        let cube = cube(6, Diagonals::Alternating);
        let found = middle(&cube, scaled(&cube, 0.97), 1.0);
        for (p, q) in found.positions().iter().zip(cube.positions()) {
            for (x, y) in p.iter().zip(q) {
                // The pull towards mean normals keeps a part of the offset along edges and at
                // corners.
                assert!(y.abs() < 0.5 || (x - y).abs() < 1e-3, "{p:?}, {q:?}");
            }
        }
    }

    /// Of two parts the closed one gets its volume back and the open one its mean height.
    #[test]
    fn parts_are_offset_apart() {
        let sphere = icosphere(2);
        let plane = plane(6, 6, Diagonals::Alternating);
        let lifted = |height: f64, size: f64| {
            let above = plane.positions().iter().map(|&[x, y, z]| [x, y, z + 5.0 + height]);
            let positions = sphere.positions().iter().map(|p| p.map(|x| size * x)).chain(above);
            let faces = plane.faces().iter().map(|f| f.map(|v| v + sphere.vertex_count() as u32));
            let faces = sphere.faces().iter().copied().chain(faces).collect();
            TriMesh::new(positions.collect(), faces).unwrap()
        };
        let noisy = lifted(0.01, 1.02);
        let found = middle(&noisy, lifted(0.0, 1.0), 1.0);
        for (p, q) in found.positions().iter().zip(noisy.positions()) {
            assert!(DVec3::from(*p).distance((*q).into()) < 1e-3, "{p:?}, {q:?}");
        }
    }

    /// A vertex that would pass the limit stays, up to the small later rounds.
    #[test]
    fn no_vertex_passes_the_limit() {
        let sphere = icosphere(3);
        let mut positions: Vec<_> =
            sphere.positions().iter().map(|p| p.map(|x| 1.04 * x)).collect();
        positions[7] = sphere.positions()[7].map(|x| 0.98 * x);
        let noisy = sphere.with_positions(positions).unwrap();
        let found = middle(&noisy, sphere.clone(), 0.05);
        assert!(apart(&found, &sphere, 7) < 3e-3);
        let free = middle(&noisy, sphere.clone(), 1.0);
        assert!(apart(&free, &sphere, 7) > 0.03);
        assert!(apart(&found, &noisy, 8) < 1e-3);
    }
}
