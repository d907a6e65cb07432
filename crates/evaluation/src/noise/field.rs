//! Random fields on a mesh.

use fairing_mesh::TriMesh;
use fairing_operators::{NormalWeight, weighted_vertex_normals};
use fairing_watch::parallel;
use glam::DVec3;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::kind::NoiseKind;
use crate::normal::standard_normal;

/// The number of neighbours above which correlation does not pass through a
/// vertex: each of n neighbours would sum over all others.
const HUB: usize = 256;

/// The number of waves of a field in space.
const WAVES: usize = 256;

/// The shortest wave of a field in space, in mean edge lengths.
const SHORTEST: f64 = 3.0;

/// Independent heights averaged over the vertices within 3/2 of the correlation length, with
/// weights that leave their variance.
pub(super) fn correlated(mesh: &TriMesh, heights: &[f64], length: f64) -> Vec<f64> {
    let topology = mesh.topology();
    let rings = (1.5 * length).floor() as u32;
    let weights: Vec<f64> =
        (0..=rings).map(|d| libm::exp(-2.0 * f64::from(d).powi(2) / (length * length))).collect();
    // A thread's marks are as many as vertices: for few runs of vertices only.
    let run = heights.len().div_ceil(64);
    (0..heights.len())
        .into_par_iter()
        .with_min_len(run)
        .map_init(
            || (vec![u32::MAX; heights.len()], vec![]),
            |(found_for, found), v| {
                let v = v as u32;
                found.clear();
                found.push(v);
                found_for[v as usize] = v;
                let (mut from, mut sum, mut square) = (0, 0.0, 0.0);
                for weight in &weights {
                    let end = found.len();
                    for &w in &found[from..end] {
                        sum += weight * heights[w as usize];
                        square += weight * weight;
                    }
                    for k in from..end {
                        let neighbors = topology.neighbors(found[k]);
                        if neighbors.len() > HUB && found[k] != v {
                            continue;
                        }
                        for &w in neighbors {
                            if std::mem::replace(&mut found_for[w as usize], v) != v {
                                found.push(w);
                            }
                        }
                    }
                    from = end;
                }
                sum / square.sqrt()
            },
        )
        .collect()
}

/// A random field at all vertices, whose correlation falls with the distance r as exp(−r/ℓ) with
/// ℓ in mean edge lengths: a sum of [`WAVES`] cosines, none shorter than [`SHORTEST`].
pub(super) fn waves(mesh: &TriMesh, length: f64, rng: &mut ChaCha8Rng) -> Vec<f64> {
    let unit = length * mesh.mean_edge_length();
    let Some([low, _]) = mesh.bounding_box().filter(|_| unit > 0.0) else {
        return vec![0.0; mesh.vertex_count()];
    };
    let largest = std::f64::consts::TAU * length / SHORTEST;
    let waves: Vec<(DVec3, f64)> = (0..WAVES)
        .map(|_| {
            let wave = loop {
                // Over the size of a fourth Gaussian: a Cauchy distribution, whose characteristic
                // function is exp(−|t|).
                let [x, y, z, size] = std::array::from_fn(|_| standard_normal(rng));
                let wave = DVec3::new(x, y, z) / size.abs();
                if wave.length() <= largest {
                    break wave;
                }
            };
            (wave, rng.random_range(0.0..std::f64::consts::TAU))
        })
        .collect();
    let low = DVec3::from(low);
    parallel::map(mesh.positions().len(), 64, |i| {
        let p = mesh.positions()[i];
        let q = (DVec3::from(p) - low) / unit;
        let sum: f64 = waves.iter().map(|(wave, phase)| libm::cos(wave.dot(q) + phase)).sum();
        sum * (2.0 / WAVES as f64).sqrt()
    })
}

/// The displacements for σ = 1 of a noise along the normals.
pub(super) fn along_normals(mesh: &TriMesh, kind: NoiseKind, rng: &mut ChaCha8Rng) -> Vec<DVec3> {
    let normals = weighted_vertex_normals(mesh, NormalWeight::Area);
    if let NoiseKind::Fused { length } = kind {
        let heights = waves(mesh, length, rng);
        return scaled(normals.iter().zip(heights).map(|(&n, g)| g * DVec3::from(n)).collect());
    }
    let mut heights: Vec<f64> = normals.iter().map(|_| standard_normal(rng)).collect();
    match kind {
        NoiseKind::Correlated { length } => heights = correlated(mesh, &heights, length),
        NoiseKind::Varying => {
            for (height, &p) in heights.iter_mut().zip(mesh.positions()) {
                *height *= level_at(mesh, p);
            }
        }
        _ => {}
    }
    normals.iter().zip(heights).map(|(&n, height)| height * DVec3::from(n)).collect()
}

/// The level of varying noise at a point, for σ = 1.
fn level_at(mesh: &TriMesh, p: [f64; 3]) -> f64 {
    let Some([low, high]) = mesh.bounding_box() else { return 1.0 };
    let share = |k: usize| {
        let width = high[k] - low[k];
        if width > 0.0 { (p[k] - low[k]) / width } else { 0.0 }
    };
    let t = (share(0) + share(1) + share(2)) / 3.0;
    1.0 + 0.75 * libm::sin(std::f64::consts::TAU * t)
}

/// Displacements whose root mean square is one, unless all are zero.
fn scaled(mut displacements: Vec<DVec3>) -> Vec<DVec3> {
    let squares: f64 = displacements.iter().map(|d| d.length_squared()).sum();
    if squares > 0.0 {
        let scale = (displacements.len() as f64 / squares).sqrt();
        displacements.iter_mut().for_each(|d| *d *= scale);
    }
    displacements
}
