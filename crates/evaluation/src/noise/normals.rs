//! Displacements along the vertex normals.

use fairing_mesh::TriMesh;
use fairing_operators::{NormalWeight, weighted_vertex_normals};
use glam::DVec3;
use rand_chacha::ChaCha8Rng;

use super::field::{correlated, waves};
use super::kind::NoiseKind;
use crate::normal::standard_normal;

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
