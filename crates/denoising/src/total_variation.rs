//! Total variation of the normal field.

use fairing_mesh::TriMesh;
use fairing_mesh::vec3::{add, distance, norm, scale, sub};
use rayon::prelude::*;

use super::DenoiseError;
use super::conjugate_gradients::solve;
use super::error::positive;
use super::faces::{FaceShapes, Hinges, NO_HINGE, unit_or_zero};
use super::unit_scale::at_unit_scale;
use super::vertex_update::{VertexUpdate, update_vertices};

/// Parameters of [`total_variation`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TotalVariationOptions {
    /// The weight of the variation against fidelity, in mean edge lengths: a
    /// jump of one across an edge costs as much as an error of one over a strip
    /// of this width beside it.
    pub weight: f64,
    /// Steps of the alternating direction method.
    pub iterations: usize,
    /// Vertex steps at the end.
    pub vertex_steps: usize,
}

impl Default for TotalVariationOptions {
    /// Weight 0.7, 40 iterations, 20 vertex steps.
    fn default() -> Self {
        Self { weight: 0.7, iterations: 40, vertex_steps: 20 }
    }
}

/// Denoises by total variation of face normals.
///
/// The normals n minimise, with noisy normals m, areas A, lengths ℓ of the
/// hinges and weight α in units of h,
///
/// ```text
/// ½ Σ_faces A ‖n − m‖² + α Σ_edges w ℓ ‖n_f − n_g‖,    w = exp(−‖m̄_f − m̄_g‖⁴)
/// ```
///
/// over fields of vectors, by the alternating direction method of multipliers
/// (the penalty is 2 α / h), followed by scaling to unit length. The weights w spare strong
/// creases; m̄ are the normals after one averaging over the faces across the
/// edges, so that noise does not pass for a crease. The vertices follow
/// ([`update_vertices`]). This is the variation of first order, under which
/// curved parts turn into facets, and not the generalised one of second order.
///
/// # Errors
///
/// [`DenoiseError::InvalidOption`] for a weight that is not positive;
/// [`DenoiseError::NotSolved`] if conjugate gradients stall.
///
/// Source: \[zhang2015variational\].
pub fn total_variation(
    mesh: &TriMesh,
    options: &TotalVariationOptions,
) -> Result<TriMesh, DenoiseError> {
    at_unit_scale(mesh, |mesh| filter(mesh, options))
}

fn filter(mesh: &TriMesh, options: &TotalVariationOptions) -> Result<TriMesh, DenoiseError> {
    positive("weight", options.weight)?;
    let hinges = Hinges::new(mesh);
    let shapes = FaceShapes::new(mesh);
    let h = mesh.mean_edge_length();
    if h <= 0.0 {
        return Ok(mesh.clone());
    }
    // In units of h, so that the numbers do not depend on the scale.
    let areas: Vec<f64> = shapes.areas.iter().map(|a| (a / (h * h)).max(1e-6)).collect();
    let averaged: Vec<[f64; 3]> = (0..areas.len())
        .into_par_iter()
        .map(|f| {
            let own = scale(shapes.normals[f], areas[f]);
            unit_or_zero(
                hinges.across(f).fold(own, |s, g| add(s, scale(shapes.normals[g], areas[g]))),
            )
        })
        .collect();
    let positions = mesh.positions();
    let (lengths, thresholds): (Vec<f64>, Vec<f64>) = hinges
        .all
        .par_iter()
        .map(|hinge| {
            let [a, b] = hinge.ends.map(|v| positions[v as usize]);
            let [m, n] = hinge.faces.map(|f| averaged[f as usize]);
            (distance(a, b) / h, options.weight * libm::exp(-distance(m, n).powi(4)))
        })
        .unzip();
    let penalty = 2.0 * options.weight;
    let jump = |x: &[[f64; 3]], e: usize| {
        let [f, g] = hinges.all[e].faces;
        sub(x[f as usize], x[g as usize])
    };
    let diverge = |values: &[[f64; 3]]| -> Vec<[f64; 3]> {
        (0..areas.len())
            .into_par_iter()
            .map(|f| {
                hinges.of_face[f].into_iter().filter(|&e| e != NO_HINGE).fold([0.0; 3], |s, e| {
                    let e = e as usize;
                    let sign = if hinges.all[e].faces[0] as usize == f { 1.0 } else { -1.0 };
                    add(s, scale(values[e], sign * lengths[e]))
                })
            })
            .collect()
    };
    let edges = hinges.all.len();
    let apply = |x: &[[f64; 3]]| -> Vec<[f64; 3]> {
        let jumps: Vec<_> =
            (0..edges).into_par_iter().map(|e| scale(jump(x, e), penalty)).collect();
        let spread = diverge(&jumps);
        (0..x.len()).into_par_iter().map(|f| add(scale(x[f], areas[f]), spread[f])).collect()
    };
    let diagonal: Vec<f64> = (0..areas.len())
        .into_par_iter()
        .map(|f| {
            let sides = hinges.of_face[f].into_iter().filter(|&e| e != NO_HINGE);
            areas[f] + penalty * sides.map(|e| lengths[e as usize]).sum::<f64>()
        })
        .collect();
    let data: Vec<[f64; 3]> =
        shapes.normals.iter().zip(&areas).map(|(n, a)| scale(*n, *a)).collect();
    let mut normals = shapes.normals.clone();
    // Scaled dual variables, one per hinge.
    let mut dual = vec![[0.0; 3]; edges];
    fairing_watch::stage("steps", options.iterations as u64);
    for step in 0..options.iterations {
        fairing_watch::advance(1);
        let shrunk: Vec<[f64; 3]> = (0..edges)
            .into_par_iter()
            .map(|e| {
                let q = add(jump(&normals, e), dual[e]);
                let size = norm(q);
                let kept = size - thresholds[e] / penalty;
                if kept > 0.0 { scale(q, kept / size) } else { [0.0; 3] }
            })
            .collect();
        let target: Vec<[f64; 3]> =
            (0..edges).into_par_iter().map(|e| scale(sub(shrunk[e], dual[e]), penalty)).collect();
        let b: Vec<[f64; 3]> = data.iter().zip(diverge(&target)).map(|(d, t)| add(*d, t)).collect();
        normals = solve(apply, &diagonal, &b, normals, 1e-5, 1000, step)?;
        dual = (0..edges)
            .into_par_iter()
            .map(|e| add(dual[e], sub(jump(&normals, e), shrunk[e])))
            .collect();
    }
    let normals: Vec<[f64; 3]> = normals.into_par_iter().map(unit_or_zero).collect();
    update_vertices(mesh, &normals, &VertexUpdate { steps: options.vertex_steps, limit: None })
}
