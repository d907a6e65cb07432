//! Opens the faces of a result that oppose their normals.

use fairing_mesh::TriMesh;
use fairing_watch::parallel;
use glam::DVec3;

use super::follow::{Follow, within};
use crate::error::DenoiseError;

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
    let opposes = |&f: &usize| DVec3::from(mesh.area_vector(f)).dot(normals[f]) < 0.0;
    let found = parallel::map_ranges(mesh.face_count(), 1024, |faces| {
        faces.filter(opposes).collect::<Vec<usize>>()
    });
    found.concat()
}
