//! Solves −Δu = f with u = 0 at the boundary, and with the matrices themselves.
//!
//! `cargo run --example poisson -- patch.ply`

use anyhow::{Context as _, Result};
use fairing::mesh::io;
use fairing::operators::{Laplacian, MassMatrix};
use fairing::sparse::multiply;
use fairing::spectral::Poisson;

fn main() -> Result<()> {
    let path = std::env::args().nth(1).context("missing mesh file")?;
    let (solution, energy) = run(&path)?;
    let largest = solution.iter().fold(0.0, |m: f64, u| m.max(*u));
    println!("largest value {largest}, energy {energy}");
    Ok(())
}

pub(crate) fn run(path: &str) -> Result<(Vec<f64>, f64)> {
    let mesh = io::read(path)?.mesh;
    let laplacian = Laplacian::auto(&mesh)?;
    let boundary: Vec<u32> = (0..mesh.vertex_count() as u32)
        .filter(|&v| mesh.topology().is_boundary_vertex(v))
        .collect();
    let f = vec![1.0; mesh.vertex_count()];
    let u = Poisson::new(&laplacian, &boundary)?.solve(&f, &vec![0.0; boundary.len()])?;

    // The stiffness S and the mass M are plain matrices: uᵀSu = ∫ |∇u|², uᵀMf = ∫ u f.
    let stiffness = multiply(laplacian.stiffness(), &u);
    let energy: f64 = u.iter().zip(&stiffness).map(|(u, s)| u * s).sum();
    if let MassMatrix::Lumped(mass) = laplacian.mass() {
        let work: f64 = u.iter().zip(mass).map(|(u, m)| u * m).sum();
        assert!((energy - work).abs() <= 1e-9 * energy.abs());
    }
    Ok((u, energy))
}
