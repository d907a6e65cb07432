//! Checks of a mesh and of a result, and ways back where one fails.

use fairing_mesh::TriMesh;
use glam::DVec3;
use rayon::prelude::*;

use super::follow::{Follow, within};
use crate::DenoiseError;
use crate::noise_level::NoisyParts;

/// Rounds of opening faces that oppose their normal, and of going back.
const ROUNDS: usize = 4;

/// Vertex steps of a round.
const STEPS: usize = 20;

/// Rounds of relaxing the corners of faces that still oppose their normal.
const RELAXATIONS: usize = 40;

/// A result and the number of its faces that oppose their normals.
pub(super) struct Unflipped {
    pub(super) mesh: TriMesh,
    pub(super) flipped: usize,
}

/// Opens the faces of a result that oppose their normal. Where that does not
/// help, the vertices of those that agreed with it in the noisy mesh go back
/// half of their way, again and again; then corners of those that are left
/// slide towards the middle of their neighbours.
pub(super) fn without_flips(
    noisy: &TriMesh,
    mut mesh: TriMesh,
    normals: &[DVec3],
    follow: &Follow<'_>,
) -> Result<Unflipped, DenoiseError> {
    let mut fewest = opposing(&mesh, normals).len();
    for _ in 0..ROUNDS {
        if fewest == 0 {
            return Ok(Unflipped { mesh, flipped: 0 });
        }
        let next = follow.run(mesh.positions(), normals, STEPS)?;
        let count = opposing(&next, normals).len();
        if count >= fewest {
            break;
        }
        (fewest, mesh) = (count, next);
    }
    for _ in 0..ROUNDS {
        let flipped = opposing(&mesh, normals);
        let mut positions = mesh.positions().to_vec();
        let mut back = vec![false; positions.len()];
        for f in flipped {
            if DVec3::from(noisy.area_vector(f)).dot(normals[f]) > 0.0 {
                noisy.faces()[f].iter().for_each(|&v| back[v as usize] = true);
            }
        }
        for (v, _) in back.iter().enumerate().filter(|(_, back)| **back) {
            let (moved, start) = (DVec3::from(positions[v]), DVec3::from(noisy.positions()[v]));
            positions[v] = (0.5 * (moved + start)).to_array();
        }
        let next = mesh.with_positions(positions)?;
        let count = opposing(&next, normals).len();
        if count >= fewest {
            break;
        }
        (fewest, mesh) = (count, next);
    }
    let mut next = mesh.clone();
    for _ in 0..RELAXATIONS {
        let flipped = opposing(&next, normals);
        if flipped.len() < fewest {
            (fewest, mesh) = (flipped.len(), next.clone());
        }
        if flipped.is_empty() {
            break;
        }
        next = relaxed(&next, normals, flipped, follow)?;
    }
    Ok(Unflipped { mesh, flipped: fewest })
}

/// Moves the corners of faces towards the middle of their neighbours, across the surface only.
fn relaxed(
    mesh: &TriMesh,
    normals: &[DVec3],
    faces: Vec<usize>,
    follow: &Follow<'_>,
) -> Result<TriMesh, DenoiseError> {
    let mut corners: Vec<u32> = faces.into_iter().flat_map(|f| mesh.faces()[f]).collect();
    corners.sort_unstable();
    corners.dedup();
    let mut positions = mesh.positions().to_vec();
    for v in corners {
        let ring = mesh.topology().neighbors(v);
        let at = |w: u32| DVec3::from(mesh.positions()[w as usize]);
        let sum: DVec3 = ring.iter().map(|&w| at(w)).sum();
        let around = mesh.incidence().corners(v).iter().map(|&c| normals[c as usize / 3]);
        let to_middle = sum / ring.len().max(1) as f64 - at(v);
        positions[v as usize] =
            follow.held(v as usize, at(v) + within(around, to_middle)).to_array();
    }
    Ok(mesh.with_positions(positions)?)
}

/// The faces that oppose their normals.
fn opposing(mesh: &TriMesh, normals: &[DVec3]) -> Vec<usize> {
    (0..mesh.face_count())
        .into_par_iter()
        .filter(|&f| DVec3::from(mesh.area_vector(f)).dot(normals[f]) < 0.0)
        .collect()
}

/// The length of a face over the displacement of its far end: the normals of a denoised mesh are
/// off by some 3°, or one part in 20.
const LEVER: f64 = 20.0;

/// The least fraction of uneven vertices in an uneven part.
const FRACTION: f64 = 0.1;

/// Returns `true` for each connected part whose faces are so long that errors of their normals
/// would do more harm than the noise.
///
/// A vertex is uneven if a twentieth of the longest side of its faces is more than their least
/// height, so that faces fold, and more than the noise, so that positions get worse. A part is
/// uneven if more than one vertex in ten is: CAD tessellations, with faces across a whole plane
/// beside small or thin ones.
pub(super) fn uneven_parts(mesh: &TriMesh, groups: &[NoisyParts]) -> Vec<bool> {
    let mut longest = vec![0.0f64; mesh.vertex_count()];
    let mut lowest = vec![f64::INFINITY; mesh.vertex_count()];
    for (f, &face) in mesh.faces().iter().enumerate() {
        let [a, b, c] = mesh.triangle(f).map(DVec3::from);
        let side = a.distance(b).max(b.distance(c)).max(c.distance(a));
        let height = if side > 0.0 { 2.0 * mesh.face_area(f) / side } else { 0.0 };
        for v in face.map(|v| v as usize) {
            longest[v] = longest[v].max(side);
            lowest[v] = lowest[v].min(height);
        }
    }
    let parts = mesh.topology().components();
    let mut noise = vec![0.0; parts.count()];
    for group in groups {
        group.components.iter().for_each(|&part| noise[part as usize] = group.level.wide_sigma);
    }
    let mut counts = vec![[0usize; 2]; parts.count()];
    for (v, (side, low)) in longest.into_iter().zip(lowest).enumerate() {
        if let Some(part) = parts.label(v as u32) {
            let [all, uneven] = &mut counts[part as usize];
            *all += 1;
            *uneven += usize::from(side > LEVER * low.max(noise[part as usize]));
        }
    }
    counts.into_iter().map(|[all, uneven]| uneven as f64 > FRACTION * all as f64).collect()
}

#[cfg(test)]
mod tests {
    use fairing_shapes as shapes;

    use super::*;
    use crate::noise_level::noisy_parts;

    /// A tube around the z axis whose sides go from end to end.
    fn tessellated_tube(sides: u32) -> TriMesh {
        let tube = shapes::cylinder(1.0, 2.0, sides, 1, shapes::Ends::Open);
        shapes::jittered(&tube, 0.05, 3, |p| p)
    }

    #[test]
    fn tessellations_are_uneven_and_noisy_scans_are_not() {
        let uneven = |mesh: &TriMesh| uneven_parts(mesh, &noisy_parts(mesh));
        assert_eq!(uneven(&tessellated_tube(200)), [true]);
        for mesh in [shapes::icosphere(3), shapes::cad_block(0.2), shapes::creature(24)] {
            assert_eq!(uneven(&shapes::jittered(&mesh, 0.3, 2, |p| p)), [false]);
        }
    }

    #[test]
    fn a_tessellation_stays_as_it_is_beside_a_denoised_part() {
        let (tube, sphere) = (tessellated_tube(200), shapes::icosphere(3));
        let sphere = shapes::jittered(&sphere, 0.2, 4, |p| p);
        let alone = crate::automatic(&tube, &crate::AutomaticOptions::default()).unwrap();
        assert_eq!(alone.mesh, tube);
        assert_eq!(alone.kind, crate::SurfaceKind::Uneven);
        assert_eq!(alone.uneven_vertices, tube.vertex_count());

        let n = tube.vertex_count();
        let far = sphere.positions().iter().map(|p| [p[0] + 9.0, p[1], p[2]]);
        let positions: Vec<[f64; 3]> = tube.positions().iter().copied().chain(far).collect();
        let others = sphere.faces().iter().map(|face| face.map(|v| v + n as u32));
        let faces = tube.faces().iter().copied().chain(others).collect();
        let both = TriMesh::new(positions, faces).unwrap();
        let found = crate::automatic(&both, &crate::AutomaticOptions::default()).unwrap();
        assert_eq!(found.uneven_vertices, n);
        assert_eq!(found.mesh.positions()[..n], tube.positions()[..]);
        let moved = (n..both.vertex_count())
            .filter(|&v| found.mesh.positions()[v] != both.positions()[v])
            .count();
        assert!(moved > sphere.vertex_count() / 2, "{moved}");
    }
}
