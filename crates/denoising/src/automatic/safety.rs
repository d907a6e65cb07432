//! Checks of a result, and ways back where one fails.

use fairing_mesh::TriMesh;
use glam::DVec3;
use rayon::prelude::*;

use super::follow::Follow;
use crate::DenoiseError;

/// Rounds of opening faces that oppose their normal, and of going back.
const ROUNDS: usize = 4;

/// Vertex steps of a round.
const STEPS: usize = 20;

/// Opens the faces of a result that oppose their normal. Where that does not
/// help, the vertices of those that agreed with it in the noisy mesh go back
/// half of their way, again and again.
pub(super) fn without_flips(
    noisy: &TriMesh,
    mut mesh: TriMesh,
    normals: &[DVec3],
    follow: &Follow<'_>,
) -> Result<TriMesh, DenoiseError> {
    let mut fewest = opposing(&mesh, normals).len();
    for _ in 0..ROUNDS {
        if fewest == 0 {
            return Ok(mesh);
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
    Ok(mesh)
}

/// The faces that oppose their normals.
fn opposing(mesh: &TriMesh, normals: &[DVec3]) -> Vec<usize> {
    (0..mesh.face_count())
        .into_par_iter()
        .filter(|&f| DVec3::from(mesh.area_vector(f)).dot(normals[f]) < 0.0)
        .collect()
}
