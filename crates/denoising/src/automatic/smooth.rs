//! Denoising of surfaces without creases: thin-plate smoothing of a strength
//! that the data choose.

use fairing_mesh::TriMesh;
use fairing_mesh::vec3::{add, dot, scale, sub};
use rayon::prelude::*;

use super::residuals::residuals;
use super::thin_plate::ThinPlate;
use super::unfold::hold;
use crate::DenoiseError;
use crate::faces::{FaceShapes, unit_or_zero};
use crate::vertex_update::{VertexUpdate, rebuild, update_vertices};

/// The strengths λ tried, from hardly any smoothing to a radius of four edges;
/// the radius grows with the fourth root.
const STRENGTHS: [f64; 7] = [1.0, 3.0, 8.0, 18.0, 40.0, 90.0, 250.0];

/// The strength that gives the normals along which vertices are moved.
const PILOT: f64 = 10.0;

/// Averages of the estimated risk over one-rings: its own noise must sink
/// below the differences between strengths.
const RISK_AVERAGES: usize = 60;

/// Differences of the risk of a twentieth of σ² decide between strengths.
const RISK_SCALE: f64 = 0.05;

/// The scale of the Cauchy weights, in noise levels: twice the level of the
/// better half of the vertices is where impulses begin.
const CAUCHY_SCALE: f64 = 2.0;

/// Rounds of reweighting under impulsive noise.
const REWEIGHTINGS: usize = 4;

/// With more folded faces than this, vertices have moved within the surface
/// too: noise along the normals alone hardly folds any.
const FOLDED_SHARE: f64 = 0.01;

/// Rounds of evening out folded faces.
const UNFOLDINGS: usize = 10;

/// The strength of the last smoothing, which blends neighbouring choices.
const LAST: f64 = 1.5;

/// A first smoothing, which tells normals and folds.
pub(super) struct Pilot {
    plate: ThinPlate,
    mesh: TriMesh,
    /// The share of faces that oppose the smoothed surface.
    pub(super) folded: f64,
}

impl Pilot {
    /// Smooths with one strength, reweighted where the noise is `impulsive`.
    ///
    /// # Errors
    ///
    /// [`DenoiseError::NotSolved`] if a linear system is not solved to its
    /// tolerance.
    pub(super) fn new(mesh: &TriMesh, sigma: f64, impulsive: bool) -> Result<Self, DenoiseError> {
        let mut plate = ThinPlate::new(mesh);
        let noisy = mesh.positions();
        let mut moves = plate.displacements(noisy, PILOT, vec![[0.0; 3]; noisy.len()])?;
        let rounds = if impulsive { REWEIGHTINGS } else { 0 };
        for _ in 0..rounds {
            plate.weights = cauchy_weights(&moves, sigma);
            moves = plate.displacements(noisy, PILOT, moves)?;
        }
        let pilot = rebuild(mesh, moved(noisy, &moves))?;
        let folded = (0..mesh.face_count())
            .filter(|&f| dot(mesh.area_vector(f), pilot.area_vector(f)) < 0.0)
            .count();
        let folded = folded as f64 / mesh.face_count().max(1) as f64;
        Ok(Self { plate, mesh: pilot, folded })
    }
}

/// Moves vertices along smoothed normals by thin-plate smoothing,
///
/// ```text
/// min ‖x − p‖² + λ ‖L x‖²
/// ```
///
/// where L is the random-walk Laplacian, whose rows at border vertices see the
/// neighbours along the border only. Weights by edge counts, not by angles,
/// are right here: the noise is the same at every vertex, so every vertex is
/// worth the same.
///
/// λ is chosen at each vertex among a ladder by Stein's unbiased estimate of
/// the risk, `(residual)² + 2 σ² h − σ²`, with the mean leverage h of the
/// linear smoother from a random probe and averaged over a neighbourhood;
/// close calls are blended. Last, the result moves to where the noisy vertices
/// are on average, which makes up for the shrinkage of smoothing, and folded
/// faces are evened out. σ is the noise level in mesh units, `limit` the
/// largest displacement.
///
/// Where more than one face in a hundred opposes the smoothed surface, the noise
/// has folded the surface; vertices then also move within it, which unfolds it,
/// and the risk counts three components.
///
/// Where the noise is `impulsive`, vertices have Cauchy weights
/// `1/(1 + (r/2σ)²)` in the first term and in the risk, with the residuals r of
/// the strength before; moved vertices then count for little.
///
/// # Errors
///
/// [`DenoiseError::NotSolved`] if a linear system is not solved to its
/// tolerance.
///
/// Source of the risk estimate: \[stein1981\].
pub(super) fn denoise_smooth(
    mesh: &TriMesh,
    pilot: Pilot,
    sigma: f64,
    limit: f64,
) -> Result<TriMesh, DenoiseError> {
    let noisy = mesh.positions();
    let rest = vec![[0.0; 3]; noisy.len()];
    let probe: Vec<[f64; 3]> = (0..noisy.len() as u64).map(signs).collect();
    let free = pilot.folded > FOLDED_SHARE;
    let normals = vertex_normals(&pilot.mesh);
    let mut plate = pilot.plate;
    let dimensions = if free { 3.0 } else { 1.0 };
    let variance = sigma * sigma;
    // Of each strength: the moves, and the local risk over σ².
    let mut candidates: Vec<(Vec<[f64; 3]>, Vec<f64>)> = vec![];
    let (mut offsets, mut response) = (rest.clone(), rest.clone());
    for strength in STRENGTHS {
        offsets = plate.displacements(noisy, strength, offsets)?;
        response = plate.displacements(&probe, strength, response)?;
        let trace: f64 = response.iter().zip(&probe).map(|(d, b)| dot(*d, *b)).sum();
        let leverage = 1.0 + trace / (3 * noisy.len().max(1)) as f64;
        let moves: Vec<[f64; 3]> = offsets
            .iter()
            .zip(&normals)
            .map(|(&offset, &n)| if free { offset } else { scale(n, dot(n, offset)) })
            .collect();
        let risk = moves
            .iter()
            .zip(&plate.weights)
            .map(|(m, w)| w * (dot(*m, *m) / variance + dimensions * (2.0 * leverage - 1.0)))
            .collect();
        candidates.push((moves, average(mesh, risk)));
    }
    let positions = (0..noisy.len())
        .map(|v| {
            let least = candidates.iter().map(|(_, r)| r[v]).fold(f64::INFINITY, f64::min);
            let (mut sum, mut total) = ([0.0; 3], 0.0);
            for (moves, risk) in &candidates {
                let w = libm::exp((least - risk[v]) / RISK_SCALE);
                sum = add(sum, scale(moves[v], w));
                total += w;
            }
            add(noisy[v], scale(sum, 1.0 / total))
        })
        .collect();
    let blended = rebuild(mesh, positions)?;
    let weights = std::mem::replace(&mut plate.weights, vec![1.0; noisy.len()]);
    let last = plate.displacements(blended.positions(), LAST, rest)?;
    let last = rebuild(mesh, moved(blended.positions(), &last))?;
    let target = FaceShapes::new(&last).normals;
    let update = VertexUpdate { steps: 10, limit: None };
    let result = update_vertices(&blended, &target, &update)?;
    let result = restore_size(mesh, &result, &weights)?;
    let result = unfold(&result)?;
    let held = result.positions().iter().zip(noisy).map(|(&x, &p)| hold(p, x, limit)).collect();
    rebuild(mesh, held)
}

/// Moves a result along its normals to where the noisy vertices are on average,
/// weighted, over neighbourhoods: noise averages out there, shrinkage does not.
fn restore_size(
    noisy: &TriMesh,
    result: &TriMesh,
    weights: &[f64],
) -> Result<TriMesh, DenoiseError> {
    let off = residuals(noisy, result);
    let off = average(noisy, off.iter().zip(weights).map(|(r, w)| r * w).collect());
    let total = average(noisy, weights.to_vec());
    let normals = vertex_normals(result);
    let positions = (0..off.len())
        .map(|v| add(result.positions()[v], scale(normals[v], off[v] / total[v])))
        .collect();
    rebuild(result, positions)
}

/// Evens out the vertices of faces that oppose the faces around them, within
/// the surface: thin faces fold under any noise.
fn unfold(mesh: &TriMesh) -> Result<TriMesh, DenoiseError> {
    let topology = mesh.topology();
    let mut current = mesh.clone();
    for _ in 0..UNFOLDINGS {
        fairing_watch::check();
        let normals = vertex_normals(&current);
        let mut folded = vec![false; mesh.vertex_count()];
        for (f, face) in mesh.faces().iter().enumerate() {
            let around = face.iter().fold([0.0; 3], |s, &v| add(s, normals[v as usize]));
            if dot(current.area_vector(f), around) < 0.0 {
                face.iter().for_each(|&v| folded[v as usize] = true);
            }
        }
        if !folded.contains(&true) {
            break;
        }
        let x = current.positions();
        let next = (0..x.len())
            .map(|v| {
                let ring = topology.neighbors(v as u32);
                if !folded[v] || topology.is_boundary_vertex(v as u32) || ring.is_empty() {
                    return x[v];
                }
                let sum = ring.iter().fold([0.0; 3], |s, &w| add(s, x[w as usize]));
                let offset = sub(scale(sum, 1.0 / ring.len() as f64), x[v]);
                let along = sub(offset, scale(normals[v], dot(normals[v], offset)));
                add(x[v], scale(along, 0.5))
            })
            .collect();
        current = rebuild(&current, next)?;
    }
    Ok(current)
}

/// Area-weighted unit normals; zero where undefined.
pub(super) fn vertex_normals(mesh: &TriMesh) -> Vec<[f64; 3]> {
    (0..mesh.vertex_count() as u32)
        .into_par_iter()
        .map(|v| {
            unit_or_zero(
                mesh.incidence()
                    .corners(v)
                    .iter()
                    .fold([0.0; 3], |s, &c| add(s, mesh.area_vector(c as usize / 3))),
            )
        })
        .collect()
}

/// Repeated averages of a vertex field over one-rings.
fn average(mesh: &TriMesh, mut field: Vec<f64>) -> Vec<f64> {
    let topology = mesh.topology();
    for _ in 0..RISK_AVERAGES {
        fairing_watch::check();
        field = (0..field.len())
            .into_par_iter()
            .map(|v| {
                let ring = topology.neighbors(v as u32);
                let sum: f64 = ring.iter().map(|&w| field[w as usize]).sum();
                (field[v] + sum) / (ring.len() + 1) as f64
            })
            .collect();
    }
    field
}

/// Three signs from a hash of the index (splitmix64): a probe that needs no
/// random stream.
fn signs(index: u64) -> [f64; 3] {
    let mut x = index.wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    x ^= x >> 31;
    [0, 1, 2].map(|k| if (x >> k) & 1 == 0 { 1.0 } else { -1.0 })
}

/// `p + d`.
fn moved(p: &[[f64; 3]], d: &[[f64; 3]]) -> Vec<[f64; 3]> {
    p.iter().zip(d).map(|(&p, &d)| add(p, d)).collect()
}

/// Cauchy weights of displacements from noisy to smoothed positions.
pub(super) fn cauchy_weights(displacements: &[[f64; 3]], sigma: f64) -> Vec<f64> {
    let scale = 1.0 / (CAUCHY_SCALE * sigma).powi(2);
    displacements.iter().map(|&d| 1.0 / (1.0 + scale * dot(d, d))).collect()
}
