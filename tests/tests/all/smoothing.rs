//! Flows compared with theory.

use std::ops::ControlFlow;

use fairing_mesh::TriMesh;
use fairing_shapes as shapes;
use fairing_smoothing::{
    Approach, Boundary, Constraints, Diffusion, Explicit, FlowFailure, Implicit, SoftConstraint,
    Stability, Time, Volume, explicit, implicit, stable_limit,
};
use glam::DVec3;

mod boundaries;
mod broken;
mod eigenmodes;
mod flows;
mod hard_cases;
mod mean_curvature;
mod runs;
mod sizes;
mod solvers;
mod spectra;

/// The octahedron at other positions. Its uniform Laplacian has the eigenvalues 0, −1 (three times)
/// and −3/2 (twice).
fn octahedron(positions: Vec<[f64; 3]>) -> TriMesh {
    shapes::octahedron().with_positions(positions).unwrap()
}

fn distance(p: [f64; 3], q: [f64; 3]) -> f64 {
    DVec3::from(p).distance(q.into())
}

/// The largest distance between corresponding vertices.
fn largest_distance(a: &TriMesh, b: &TriMesh) -> f64 {
    a.positions()
        .iter()
        .zip(b.positions())
        .map(|(&p, &q)| DVec3::from(p).distance(q.into()))
        .fold(0.0, f64::max)
}

/// The volume by the divergence theorem.
fn volume(mesh: &TriMesh) -> f64 {
    (0..mesh.face_count())
        .map(|f| {
            let [a, b, c] = mesh.triangle(f).map(DVec3::from);
            a.dot(b.cross(c)) / 6.0
        })
        .sum()
}

fn mean_radius(mesh: &TriMesh) -> f64 {
    mesh.positions().iter().map(|&p| DVec3::from(p).length()).sum::<f64>()
        / mesh.vertex_count() as f64
}
