//! Denoising of surfaces without creases: thin-plate smoothing of a strength
//! that the data choose.

use fairing_mesh::TriMesh;
use fairing_mesh::vec3::{add, dot, scale, sub};
use rayon::prelude::*;

use crate::denoise::DenoiseError;
use crate::denoise::conjugate_gradients::solve;
use crate::denoise::faces::{FaceShapes, unit_or_zero};
use crate::denoise::vertex_update::{VertexUpdate, rebuild, update_vertices};

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

/// The strength of the last smoothing, which blends neighbouring choices.
const LAST: f64 = 1.5;

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
/// close calls are blended. σ is the noise level in mesh units, `limit` the
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
/// [`DenoiseError::NotSolved`] if conjugate gradients stall.
///
/// Source of the risk estimate: \[stein1981\].
pub(super) fn denoise_smooth(
    mesh: &TriMesh,
    sigma: f64,
    impulsive: bool,
    limit: f64,
) -> Result<TriMesh, DenoiseError> {
    let mut plate = ThinPlate::new(mesh);
    let noisy = mesh.positions();
    let probe: Vec<[f64; 3]> = (0..noisy.len() as u64).map(signs).collect();
    let mut pilot = plate.smooth(noisy, PILOT)?;
    let rounds = if impulsive { REWEIGHTINGS } else { 0 };
    for _ in 0..rounds {
        plate.weights = cauchy_weights(noisy, &pilot, sigma);
        pilot = plate.smooth(noisy, PILOT)?;
    }
    let pilot = rebuild(mesh, pilot)?;
    let normals = vertex_normals(&pilot);
    let folded = (0..mesh.face_count())
        .filter(|&f| dot(mesh.area_vector(f), pilot.area_vector(f)) < 0.0)
        .count();
    let free = folded as f64 > FOLDED_SHARE * mesh.face_count() as f64;
    let dimensions = if free { 3.0 } else { 1.0 };
    let variance = sigma * sigma;
    // Of each strength: the moves, and the local risk over σ².
    let mut candidates: Vec<(Vec<[f64; 3]>, Vec<f64>)> = vec![];
    for strength in STRENGTHS {
        let smoothed = plate.smooth(noisy, strength)?;
        let response = plate.smooth(&probe, strength)?;
        let trace: f64 = response.iter().zip(&probe).map(|(a, b)| dot(*a, *b)).sum();
        let leverage = trace / (3 * noisy.len().max(1)) as f64;
        let moves: Vec<[f64; 3]> = (0..noisy.len())
            .map(|v| {
                let offset = sub(smoothed[v], noisy[v]);
                if free { offset } else { scale(normals[v], dot(normals[v], offset)) }
            })
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
                let w = ((least - risk[v]) / RISK_SCALE).exp();
                sum = add(sum, scale(moves[v], w));
                total += w;
            }
            add(noisy[v], scale(sum, 1.0 / total))
        })
        .collect();
    let blended = rebuild(mesh, positions)?;
    plate.weights.fill(1.0);
    let last = rebuild(mesh, plate.smooth(blended.positions(), LAST)?)?;
    let target = FaceShapes::new(&last).normals;
    let update = VertexUpdate { steps: 10, limit: None };
    let result = update_vertices(&blended, &target, &update)?;
    let held = result.positions().iter().zip(noisy).map(|(&x, &p)| hold(p, x, limit)).collect();
    rebuild(mesh, held)
}

/// `x`, or the point towards it at the distance `limit` from `p`.
fn hold(p: [f64; 3], x: [f64; 3], limit: f64) -> [f64; 3] {
    let offset = sub(x, p);
    let length = dot(offset, offset).sqrt();
    if length > limit { add(p, scale(offset, limit / length)) } else { x }
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

/// Cauchy weights of the distances between noisy and smoothed positions.
pub(super) fn cauchy_weights(noisy: &[[f64; 3]], smooth: &[[f64; 3]], sigma: f64) -> Vec<f64> {
    let scale = 1.0 / (CAUCHY_SCALE * sigma).powi(2);
    noisy
        .iter()
        .zip(smooth)
        .map(|(&p, &x)| {
            let d = sub(p, x);
            1.0 / (1.0 + scale * dot(d, d))
        })
        .collect()
}

/// The rows of L, each an average over some neighbours minus the vertex, and
/// its columns; and the weights of the data.
struct ThinPlate {
    weights: Vec<f64>,
    offsets: Vec<u32>,
    items: Vec<u32>,
    column_offsets: Vec<u32>,
    columns: Vec<u32>,
}

impl ThinPlate {
    fn new(mesh: &TriMesh) -> Self {
        let topology = mesh.topology();
        let count = mesh.vertex_count();
        let (mut offsets, mut items) = (vec![0u32], vec![]);
        for v in 0..count as u32 {
            let border = topology.is_boundary_vertex(v);
            items.extend(topology.neighbors(v).iter().copied().filter(|&w| {
                !border || topology.edge_between(v, w).is_some_and(|e| topology.is_boundary_edge(e))
            }));
            offsets.push(items.len() as u32);
        }
        let mut column_offsets = vec![0u32; count + 1];
        for &w in &items {
            column_offsets[w as usize + 1] += 1;
        }
        for v in 0..count {
            column_offsets[v + 1] += column_offsets[v];
        }
        let mut next = column_offsets.clone();
        let mut columns = vec![0; items.len()];
        for v in 0..count {
            for &w in &items[offsets[v] as usize..offsets[v + 1] as usize] {
                columns[next[w as usize] as usize] = v as u32;
                next[w as usize] += 1;
            }
        }
        Self { weights: vec![1.0; count], offsets, items, column_offsets, columns }
    }

    fn row(&self, v: usize) -> &[u32] {
        &self.items[self.offsets[v] as usize..self.offsets[v + 1] as usize]
    }

    fn column(&self, v: usize) -> &[u32] {
        &self.columns[self.column_offsets[v] as usize..self.column_offsets[v + 1] as usize]
    }

    /// Solves `(W + λ LᵀL) x = W p` with the weights W of the data.
    fn smooth(&self, p: &[[f64; 3]], strength: f64) -> Result<Vec<[f64; 3]>, DenoiseError> {
        let apply = |x: &[[f64; 3]]| -> Vec<[f64; 3]> {
            // Each row already divided by its length, for the columns.
            let bends: Vec<([f64; 3], [f64; 3])> = (0..x.len())
                .into_par_iter()
                .map(|v| {
                    let row = self.row(v);
                    if row.is_empty() {
                        return ([0.0; 3], [0.0; 3]);
                    }
                    let share = 1.0 / row.len() as f64;
                    let sum = row.iter().fold([0.0; 3], |s, &w| add(s, x[w as usize]));
                    let bend = sub(scale(sum, share), x[v]);
                    (bend, scale(bend, share))
                })
                .collect();
            (0..x.len())
                .into_par_iter()
                .map(|v| {
                    let spread = self
                        .column(v)
                        .iter()
                        .fold(scale(bends[v].0, -1.0), |s, &u| add(s, bends[u as usize].1));
                    add(scale(x[v], self.weights[v]), scale(spread, strength))
                })
                .collect()
        };
        let diagonal: Vec<f64> = (0..p.len())
            .map(|v| {
                let own = if self.row(v).is_empty() { 0.0 } else { 1.0 };
                let others: f64 = self
                    .column(v)
                    .iter()
                    .map(|&u| (self.row(u as usize).len() as f64).powi(-2))
                    .sum();
                self.weights[v] + strength * (own + others)
            })
            .collect();
        // Far from the origin the right-hand side hides the noise: solve for
        // positions around their centre.
        let centre = p.iter().fold([0.0; 3], |s, &x| add(s, x));
        let centre = scale(centre, 1.0 / p.len().max(1) as f64);
        let start: Vec<[f64; 3]> = p.iter().map(|&x| sub(x, centre)).collect();
        let b: Vec<[f64; 3]> =
            start.iter().zip(&self.weights).map(|(&x, &w)| scale(x, w)).collect();
        let x = solve(apply, &diagonal, &b, start, 1e-7, 2000, 0)?;
        Ok(x.into_iter().map(|x| add(x, centre)).collect())
    }
}
