//! Models of which a part is cut off.

use fairing_mesh::{BuildError, TriMesh};
use glam::DVec3;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::build::Proportions;

/// The largest part of the vertices that is cut off.
const MOST: f64 = 0.7;

/// The faces of a mesh on one side of a random plane, which leaves from three in ten to all but
/// three in ten of the vertices. A mesh of which nothing would be left stays whole.
pub fn cut(mesh: &TriMesh, seed: u64) -> Result<TriMesh, BuildError> {
    let mut random = Proportions(ChaCha8Rng::seed_from_u64(seed ^ 0x00c0_7000));
    let toward = random.direction();
    let heights: Vec<f64> = mesh.positions().iter().map(|&p| toward.dot(DVec3::from(p))).collect();
    let mut sorted = heights.clone();
    sorted.sort_unstable_by(f64::total_cmp);
    let off = random.between(1.0 - MOST, MOST) * heights.len() as f64;
    let Some(&level) = sorted.get(off as usize) else { return Ok(mesh.clone()) };
    let is_kept = |face: &&[u32; 3]| face.iter().all(|&v| heights[v as usize] >= level);
    let faces: Vec<[u32; 3]> = mesh.faces().iter().filter(is_kept).copied().collect();
    if faces.is_empty() {
        return Ok(mesh.clone());
    }
    let mut numbers = vec![u32::MAX; heights.len()];
    faces.iter().flatten().for_each(|&v| numbers[v as usize] = 0);
    let mut positions = vec![];
    for (number, &p) in numbers.iter_mut().zip(mesh.positions()).filter(|(n, _)| **n == 0) {
        *number = positions.len() as u32;
        positions.push(p);
    }
    let faces = faces.iter().map(|face| face.map(|v| numbers[v as usize])).collect();
    TriMesh::new(positions, faces)
}
