//! A piecewise smooth normal field from noisy area vectors.

use fairing_mesh::TriMesh;
use fairing_mesh::vec3::{add, distance, norm, scale, sub};
use rayon::prelude::*;

use crate::conjugate_gradients::conjugate_gradients;
use crate::faces::{Hinges, NO_HINGE, unit_or_zero};

/// The jump starts at sixteen times the wanted one, where the energy is
/// practically convex.
const FIRST_JUMP_OCTAVES: f64 = 4.0;

/// The weights of the energy.
#[derive(Debug, Clone, Copy)]
pub(super) struct PiecewiseSmooth {
    /// The weight L of the jumps, in mean edge lengths.
    pub(super) weight: f64,
    /// The jump τ between unit normals beyond which an edge is a crease.
    pub(super) jump: f64,
    /// Reweighted solves.
    pub(super) rounds: usize,
}

/// Unit normals along a stationary point, over fields of vectors n, of
///
/// ```text
/// Σ_faces A ‖n − N/A‖² + L Σ_hinges ℓ φ(‖n_f − n_g‖),    φ(t) = t² / (1 + t²/τ²)
/// ```
///
/// with the area vectors N of the mesh, which independent noise of the vertices
/// leaves unbiased. φ counts a jump far above τ as one crease, however high:
/// the Mumford–Shah energy in the form of Geman and McClure. Reweighted least
/// squares, from an almost convex energy to the wanted one over the first half
/// of the rounds. A face without area follows its neighbours.
///
/// Source: \[mumford1989\], \[geman1985\].
pub(super) fn piecewise_smooth_normals(
    mesh: &TriMesh,
    hinges: &Hinges,
    options: &PiecewiseSmooth,
) -> Vec<[f64; 3]> {
    let h = mesh.mean_edge_length();
    // In units of h, so that numbers do not depend on the scale.
    let vectors: Vec<[f64; 3]> =
        (0..mesh.face_count()).map(|f| scale(mesh.area_vector(f), 1.0 / (h * h))).collect();
    let areas: Vec<f64> = vectors.iter().map(|v| norm(*v).max(1e-9)).collect();
    let positions = mesh.positions();
    let lengths: Vec<f64> = hinges
        .all
        .iter()
        .map(|e| distance(positions[e.ends[0] as usize], positions[e.ends[1] as usize]) / h)
        .collect();
    let mut normals: Vec<[f64; 3]> = vectors.iter().map(|v| unit_or_zero(*v)).collect();
    for round in 0..options.rounds {
        fairing_watch::check();
        let progress = (2.0 * round as f64 / options.rounds as f64).min(1.0);
        let jump = options.jump * libm::exp2(FIRST_JUMP_OCTAVES * (1.0 - progress));
        let weights: Vec<f64> = hinges
            .all
            .par_iter()
            .zip(&lengths)
            .map(|(e, length)| {
                let [a, b] = e.faces.map(|f| normals[f as usize]);
                // The noisy normals themselves say nothing about creases.
                let t = if round == 0 { 0.0 } else { distance(a, b) / jump };
                options.weight * length / (1.0 + t * t).powi(2)
            })
            .collect();
        let apply = |x: &[[f64; 3]]| -> Vec<[f64; 3]> {
            (0..x.len())
                .into_par_iter()
                .map(|f| {
                    let sides = hinges.of_face[f].into_iter().filter(|&e| e != NO_HINGE);
                    sides.fold(scale(x[f], areas[f]), |s, e| {
                        let [a, b] = hinges.all[e as usize].faces;
                        let g = if a as usize == f { b } else { a } as usize;
                        add(s, scale(sub(x[f], x[g]), weights[e as usize]))
                    })
                })
                .collect()
        };
        let diagonal: Vec<f64> = (0..areas.len())
            .into_par_iter()
            .map(|f| {
                let sides = hinges.of_face[f].into_iter().filter(|&e| e != NO_HINGE);
                areas[f] + sides.map(|e| weights[e as usize]).sum::<f64>()
            })
            .collect();
        // An inner solve need not be exact: the next one starts from it.
        normals = conjugate_gradients(apply, &diagonal, &vectors, normals, 1e-4, 300).0;
    }
    normals.into_iter().map(unit_or_zero).collect()
}
