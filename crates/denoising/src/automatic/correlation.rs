//! The variance of means over many vertices, where the noise is correlated.

use fairing_mesh::TriMesh;
use glam::DVec3;
use rayon::prelude::*;

use super::state::State;

/// A vertex with more neighbours than this is not looked past.
const HUB: usize = 32;

/// The variance of positions across the surface, times the sum of their correlations: the
/// variance of the mean of n positions is this over n.
pub(super) fn variance_of_means(state: &State<'_>) -> f64 {
    state.variance * correlation_sum(state.mesh(), &displacements(state))
}

/// The displacements of vertices from the surface, along its normals and times their trust.
fn displacements(state: &State<'_>) -> Vec<f64> {
    let mut up = vec![DVec3::ZERO; state.mesh().vertex_count()];
    for (face, &n) in state.mesh().faces().iter().zip(&state.normals) {
        face.iter().for_each(|&v| up[v as usize] += n);
    }
    let positions = state.mesh().positions().iter().zip(state.surface.positions());
    (positions.zip(up).zip(&state.vertex_trust))
        .map(|(((&p, &x), n), t)| t * n.normalize_or_zero().dot(DVec3::from(p) - DVec3::from(x)))
        .collect()
}

/// The sum of the correlations of the displacement of a vertex with those of all vertices up to two
/// edges away, itself included (beyond a vertex with many neighbours none); at least one. The
/// variance of a mean over many vertices is so many times that of independent noise.
fn correlation_sum(mesh: &TriMesh, offsets: &[f64]) -> f64 {
    let topology = mesh.topology();
    let terms: Vec<[f64; 2]> = (0..offsets.len() as u32)
        .into_par_iter()
        .map_init(Vec::new, |disc: &mut Vec<u32>, v| {
            disc.clear();
            disc.push(v);
            for &w in topology.neighbors(v) {
                disc.push(w);
                let ring = topology.neighbors(w);
                if ring.len() <= HUB {
                    disc.extend_from_slice(ring);
                }
            }
            disc.sort_unstable();
            disc.dedup();
            let sum: f64 = disc.iter().map(|&w| offsets[w as usize]).sum();
            let r = offsets[v as usize];
            [r * sum, r * r]
        })
        .collect();
    let [products, squares] = terms.iter().fold([0.0; 2], |s, t| [s[0] + t[0], s[1] + t[1]]);
    if squares > 0.0 { (products / squares).max(1.0) } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use fairing_shapes as shapes;

    use super::*;

    /// Independent displacements count one by one, apart from chance; means of them over two rings
    /// count as the number of vertices of about such a mean.
    #[test]
    fn correlated_displacements_are_told_by_their_sums() {
        let mesh = shapes::plane(60, 60, shapes::Diagonals::Alternating);
        let noisy = shapes::jittered(&mesh, 0.1, 3, |p| p);
        let topology = noisy.topology();
        let mut state = 1u64;
        let white: Vec<f64> = (0..noisy.vertex_count())
            .map(|_| {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                (state >> 40) as f64 / (1u64 << 23) as f64 - 1.0
            })
            .collect();
        let averaged = |x: &[f64]| -> Vec<f64> {
            (0..x.len() as u32)
                .map(|v| {
                    let ring = topology.neighbors(v);
                    let sum: f64 = ring.iter().map(|&w| x[w as usize]).sum();
                    (sum + x[v as usize]) / (ring.len() + 1) as f64
                })
                .collect()
        };
        let correlated = correlation_sum(&noisy, &averaged(&averaged(&white)));
        assert!((7.0..20.0).contains(&correlated), "{correlated}");
        let independent = correlation_sum(&noisy, &white);
        assert!((1.0..1.4).contains(&independent), "{independent}");
        assert_eq!(correlation_sum(&noisy, &vec![0.0; noisy.vertex_count()]), 1.0);
    }
}
