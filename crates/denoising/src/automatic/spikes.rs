//! Vertices far from everything around them.

use std::borrow::Cow;

use fairing_mesh::TriMesh;
use glam::DVec3;

use crate::noise_level::{NoiseEstimate, noisy_parts};
use crate::{DenoiseError, Masked};

/// The least height of a spike over its neighbours, in noise levels: higher than the impulses in
/// the training data.
const FAR: f64 = 15.0;

/// The least height of a spike, as a fraction of the mean distance of its neighbours: less can be
/// curvature.
const STEEP: f64 = 0.25;

/// The height of a spike's highest neighbour on the same side, as a fraction of its own.
const ALONE: f64 = 1.0 / 3.0;

/// The least fraction of vertices that are spikes: fewer may be tips.
const MIN_FRACTION: f64 = 0.01;

/// Rounds; spikes beside others, and smaller ones, come out in later ones.
const ROUNDS: usize = 4;

/// The mesh with its spikes at the height of their neighbours, its noise level then, and the
/// largest distance of a spike from there. The mesh itself unless its noise is impulsive and
/// spikes are more than tips.
///
/// A spike is a vertex whose height over the plane of its neighbours is above [`FAR`] noise
/// levels, above a quarter of their distance, and above three times the height of each neighbour
/// on the same side: along creases and on curved surfaces neighbours are as high. Without noise
/// there are no spikes, and a fixed vertex is none.
pub(super) fn without_spikes(
    input: Masked<'_>,
    mut level: NoiseEstimate,
) -> Result<(Cow<'_, TriMesh>, NoiseEstimate, f64), DenoiseError> {
    let mesh = input.mesh();
    let (mut current, mut farthest) = (Cow::Borrowed(mesh), 0.0f64);
    if !level.is_impulsive() {
        return Ok((current, level, farthest));
    }
    let free = (0..mesh.vertex_count()).filter(|&v| !input.is_fixed(v)).count();
    for round in 0..ROUNDS {
        let heights = heights(&current);
        let spikes: Vec<u32> = (0..current.vertex_count() as u32)
            .filter(|&v| !input.is_fixed(v as usize))
            .filter(|&v| is_spike(&current, &heights, v, FAR * level.sigma))
            .collect();
        let fraction = spikes.len() as f64 / free.max(1) as f64;
        if spikes.is_empty() || (round == 0 && fraction < MIN_FRACTION) {
            break;
        }
        let mut positions = current.positions().to_vec();
        for v in spikes {
            let Height { height, up, .. } = heights[v as usize];
            let moved = DVec3::from(positions[v as usize]) - height * up;
            positions[v as usize] = moved.to_array();
            farthest = farthest.max(height.abs());
        }
        current = Cow::Owned(current.with_positions(positions)?);
        match noisy_parts(input.on(&current)).first() {
            Some(next) => level = next.level,
            None => level.sigma = 0.0,
        }
        if level.sigma <= 0.0 {
            break;
        }
    }
    Ok((current, level, farthest))
}

/// A vertex over its neighbours.
#[derive(Clone, Copy, Default)]
struct Height {
    /// Over their plane.
    height: f64,
    /// The normal of their plane.
    up: DVec3,
    /// Their mean distance from their mean.
    reach: f64,
}

/// The height of each inner vertex over the plane of its neighbours, and that plane's normal: the
/// area vector of the polygon of the neighbours, through their mean. Zero for vertices on borders.
fn heights(mesh: &TriMesh) -> Vec<Height> {
    let topology = mesh.topology();
    let incidence = mesh.incidence();
    let faces = mesh.faces();
    let at = |v: u32| DVec3::from(mesh.positions()[v as usize]);
    (0..mesh.vertex_count() as u32)
        .map(|v| {
            let (ring, corners) = (topology.neighbors(v), incidence.corners(v));
            if ring.len() < 3 || corners.len() != ring.len() {
                return Height::default();
            }
            let x = at(v);
            let mut sum = DVec3::ZERO;
            for &c in corners {
                let (f, k) = (c as usize / 3, c as usize % 3);
                let [p, q] = [1, 2].map(|i| at(faces[f][(k + i) % 3]));
                // Over a closed polygon the sum does not depend on x.
                sum += (p - x).cross(q - x);
            }
            let length = sum.length();
            if length <= 0.0 {
                return Height::default();
            }
            let up = sum * (1.0 / length);
            let mean = ring.iter().fold(DVec3::ZERO, |s, &w| s + at(w));
            let mean = mean * (1.0 / ring.len() as f64);
            let reach = ring.iter().map(|&w| at(w).distance(mean)).sum::<f64>();
            Height { height: up.dot(x - mean), up, reach: reach / ring.len() as f64 }
        })
        .collect()
}

fn is_spike(mesh: &TriMesh, heights: &[Height], v: u32, least: f64) -> bool {
    let Height { height, reach, .. } = heights[v as usize];
    height.abs() > least.max(STEEP * reach)
        && mesh.topology().neighbors(v).iter().all(|&w| {
            let other = heights[w as usize].height;
            other * height <= 0.0 || other.abs() < ALONE * height.abs()
        })
}

#[cfg(test)]
mod tests {
    use fairing_shapes as shapes;

    use super::*;
    use crate::noise_level;

    /// Each 25th vertex of a sphere is lifted by an edge or more: they return to the surface, and
    /// nothing else moves.
    #[test]
    fn spikes_return_to_the_surface() {
        let truth = shapes::icosphere(4);
        let noisy = shapes::jittered(&truth, 0.02, 3, |p| p);
        let h = noisy.mean_edge_length();
        let mut positions = noisy.positions().to_vec();
        for v in (0..positions.len()).step_by(25) {
            let factor = 1.0 + h * (1.0 + (v % 3) as f64);
            positions[v] = positions[v].map(|x| factor * x);
        }
        let input = noisy.with_positions(positions).unwrap();
        let level = noise_level(&input).unwrap();
        let (found, after, farthest) = without_spikes((&input).into(), level).unwrap();
        assert!(after.sigma < 0.5 * level.sigma + 0.05 * h, "{} {}", after.sigma, level.sigma);
        assert!((2.5 * h..4.0 * h).contains(&farthest), "{} h", farthest / h);
        let (mut back, mut all) = (0, 0);
        for (v, (&p, &q)) in found.positions().iter().zip(noisy.positions()).enumerate() {
            let distance = DVec3::from(p).distance(q.into());
            if v % 25 == 0 {
                (back, all) = (back + usize::from(distance < 0.3 * h), all + 1);
            } else {
                assert!(p == q, "vertex {v}: {} h", distance / h);
            }
        }
        // Two that are neighbours and alike stay.
        assert!(back * 10 > all * 9, "{back} of {all}");
    }

    /// Creases, corners and tips are none, at any noise.
    #[test]
    fn corners_are_no_spikes() {
        let cube = shapes::cube(10, shapes::Diagonals::Alternating);
        let block = shapes::cad_block(0.1);
        for truth in [cube, block] {
            for amount in [0.001, 0.02, 0.2] {
                let noisy = shapes::jittered(&truth, amount, 3, |p| p);
                if let Some(mut level) = noise_level(&noisy) {
                    level.tail_ratio = 2.0;
                    let (found, ..) = without_spikes((&noisy).into(), level).unwrap();
                    assert!(matches!(found, Cow::Borrowed(_)), "{amount}");
                }
            }
        }
    }
}
