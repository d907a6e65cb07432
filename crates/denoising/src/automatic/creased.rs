//! Denoising of bodies with creases: labels, then local fits within creases.

use fairing_mesh::TriMesh;
use fairing_mesh::vec3::{dot, sub};

use super::follow::Follow;
use super::local_fits::{FitRule, Regions, local_fits};
use super::mumford_shah::{PiecewiseSmooth, piecewise_smooth_normals};
use super::relabel::relabel;
use super::smooth::cauchy_weights;
use super::unfold::unfold;
use super::vote::vote;
use crate::DenoiseError;
use crate::faces::{FaceLists, FaceShapes, Hinges};
use crate::guided_normal::{GuidedNormalOptions, guided_normal};
use crate::vertex_update::{VertexUpdate, update_vertices};

/// The cosine of the angle between labels that makes a hinge a crease, 25°:
/// above the steps into which curved parts are cut, below the creases of
/// bodies.
const CREASE: f64 = 0.906;

/// Vertex steps between rounds, and at the end.
const STEPS: usize = 30;
const LAST_STEPS: usize = 60;

/// Normals that jump at creases only.
///
/// The first labels come from guided normal filtering (which stands high
/// Gaussian noise best) or, where the noise is impulsive, from a piecewise
/// smooth field whose area vectors average impulses out.
///
/// # Errors
///
/// Those of the filters.
pub(super) fn first_labels(
    mesh: &TriMesh,
    hinges: &Hinges,
    rings: &FaceLists,
    impulsive: bool,
) -> Result<Vec<[f64; 3]>, DenoiseError> {
    let normals = if impulsive {
        let options = PiecewiseSmooth { weight: 12.0, jump: 0.12, rounds: 12 };
        piecewise_smooth_normals(mesh, hinges, &options)
    } else {
        let options = GuidedNormalOptions { range: 0.3, iterations: 40, ..Default::default() };
        FaceShapes::new(&guided_normal(mesh, &options)?).normals
    };
    relabel(mesh, rings, normals, &Follow::new(mesh, rings, 0.0, f64::INFINITY))
}

/// Sharpens labels by local fits to the noisy positions and moves the vertices
/// to them, no further than `limit`. `sigma` is the noise level.
///
/// Rounds of: fits within the creases of the labels ([`local_fits`]), votes
/// among neighbouring fits ([`vote`]), faces changing sides ([`relabel`]).
/// Where the noise is `impulsive`, vertices have Cauchy weights by their
/// distance from the surface of the round before. Last, folded faces are opened
/// ([`unfold`]).
///
/// # Errors
///
/// [`DenoiseError::NonFinite`] if coordinates overflow.
pub(super) fn denoise_creased(
    mesh: &TriMesh,
    hinges: &Hinges,
    rings: &FaceLists,
    mut normals: Vec<[f64; 3]>,
    sigma: f64,
    impulsive: bool,
    limit: f64,
) -> Result<TriMesh, DenoiseError> {
    let step = VertexUpdate { steps: STEPS, limit: Some(limit) };
    let mut current = update_vertices(mesh, &normals, &step)?;
    let mut weights = vec![1.0; mesh.vertex_count()];
    let agreement = if impulsive { 1.7 } else { 1.4 };
    for _ in 0..3 {
        if impulsive {
            let moves = mesh.positions().iter().zip(current.positions());
            let moves: Vec<[f64; 3]> = moves.map(|(&p, &x)| sub(x, p)).collect();
            weights = cauchy_weights(&moves, sigma);
        }
        let crease: Vec<bool> = hinges
            .all
            .iter()
            .map(|e| {
                let [a, b] = e.faces.map(|f| normals[f as usize]);
                dot(a, b) < CREASE
            })
            .collect();
        let regions = Regions {
            noisy: mesh,
            current: &current,
            normals: &normals,
            hinges,
            crease: &crease,
            weights: &weights,
        };
        let fits = local_fits(&regions, &FitRule { sigma, agreement });
        normals = relabel(mesh, rings, vote(&regions, &fits), &Follow::new(mesh, rings, 0.0, f64::INFINITY))?;
        current = update_vertices(mesh, &normals, &step)?;
    }
    let last = VertexUpdate { steps: LAST_STEPS, limit: Some(limit) };
    let result = update_vertices(mesh, &normals, &last)?;
    unfold(mesh, result, &normals, limit)
}
