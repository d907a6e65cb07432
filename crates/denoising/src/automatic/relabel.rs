//! Faces on the wrong side of a crease change sides.

use fairing_mesh::TriMesh;
use glam::DVec3;
use rayon::prelude::*;

use super::follow::Follow;
use crate::DenoiseError;
use crate::faces::{FaceLists, FaceShapes};

/// The least cosine between the label of a face and its geometry: 11.5°.
const AGREE: f64 = 0.98;

/// Rounds; later ones move hardly any face.
const ROUNDS: usize = 4;

/// Gives a face whose geometry contradicts its label the label of a neighbour.
///
/// The vertices of the noisy mesh follow the labels for twenty steps. A face
/// whose geometry then differs from its label by more than 11.5° sits on the
/// wrong side of a crease: its other faces hold its vertices elsewhere. Such
/// faces are left out, the update is done again, and each takes the label of
/// the agreeing face around it that is closest to its new geometry. Four
/// rounds, or fewer when all agree.
pub(super) fn relabel(
    mesh: &TriMesh,
    rings: &FaceLists,
    mut labels: Vec<DVec3>,
    follow: &Follow<'_>,
) -> Result<Vec<DVec3>, DenoiseError> {
    let noisy = mesh.positions();
    for _ in 0..ROUNDS {
        fairing_watch::check();
        let geometry = FaceShapes::new(&follow.run(noisy, &labels, 20)?).normals;
        let kept: Vec<DVec3> = labels
            .iter()
            .zip(&geometry)
            .map(|(&n, &g)| if n.dot(g) < AGREE { DVec3::ZERO } else { n })
            .collect();
        if kept == labels {
            break;
        }
        let geometry = FaceShapes::new(&follow.run(noisy, &kept, 20)?).normals;
        labels = (0..labels.len())
            .into_par_iter()
            .map(|f| {
                if kept[f] != DVec3::ZERO {
                    return kept[f];
                }
                let neighbours = rings.row(f).iter().map(|&g| kept[g as usize]);
                neighbours
                    .filter(|n| *n != DVec3::ZERO)
                    .max_by(|a, b| (*a).dot(geometry[f]).total_cmp(&(*b).dot(geometry[f])))
                    .unwrap_or(labels[f])
            })
            .collect();
    }
    Ok(labels)
}
