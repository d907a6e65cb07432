//! A mesh that resembles a scan more than a sphere does, and that everybody can generate.

use std::path::Path;

use anyhow::{Context as _, Result};
use fairing_mesh::{TriMesh, io};
use fairing_shapes::implicit::{implicit, onto};
use fairing_shapes::jittered;
use glam::DVec3;
use rand::seq::SliceRandom as _;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

/// Waves of the surface.
const WAVES: usize = 40;
/// Cells of the grid along each axis: 142 thousand vertices.
const RESOLUTION: usize = 240;
/// The fraction of the least height of its triangles by which a vertex is moved.
const JITTER: f64 = 0.45;

/// Writes the zero set of the distance from the unit sphere plus a sum of plane waves: a closed
/// surface with uneven triangles, and with vertices and faces in random order.
pub(crate) fn write(path: &Path) -> Result<()> {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let mut uniform = || random.random_range(-1.0..1.0);
    let waves: Vec<(DVec3, f64)> = (0..WAVES)
        .map(|_| (20.0 * DVec3::from_array([(); 3].map(|()| uniform())), 3.0 * uniform()))
        .collect();
    let field = |p: [f64; 3]| {
        let p = DVec3::from(p);
        let wave = |(k, phase): &(DVec3, f64)| libm::sin(k.dot(p) + phase) / (4.0 + k.length());
        p.length() - 1.0 + 0.2 * waves.iter().map(wave).sum::<f64>()
    };
    let net = implicit(field, 1.5, RESOLUTION);
    let uneven = jittered(&net, JITTER, 2, |p| onto(&field, p, 3.0 / RESOLUTION as f64));
    io::write(path, &shuffled(&uneven, &mut random)?)?;
    Ok(())
}

/// The same mesh with vertices and faces in random order.
fn shuffled(mesh: &TriMesh, random: &mut ChaCha8Rng) -> Result<TriMesh> {
    let mut order: Vec<u32> = (0..mesh.vertex_count() as u32).collect();
    order.shuffle(random);
    let mut place = vec![0; order.len()];
    for (new, &old) in order.iter().enumerate() {
        place[old as usize] = new as u32;
    }
    let positions = order.iter().map(|&v| mesh.positions()[v as usize]).collect();
    let mut faces: Vec<_> =
        mesh.faces().iter().map(|face| face.map(|v| place[v as usize])).collect();
    faces.shuffle(random);
    TriMesh::new(positions, faces).context("the shuffled mesh")
}
