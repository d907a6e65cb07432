//! The mean curvature at each vertex of a file.
//!
//! `cargo run --example mean_curvature -- bunny.ply`

use anyhow::{Context as _, Result};
use fairing::mesh::io;
use fairing::operators::curvature::{CurvatureField, Estimator};

fn main() -> Result<()> {
    let path = std::env::args().nth(1).context("missing mesh file")?;
    for (vertex, mean) in run(&path)?.mean.iter().enumerate() {
        println!("{vertex} {mean}");
    }
    Ok(())
}

pub(crate) fn run(path: &str) -> Result<CurvatureField> {
    let mesh = io::read(path)?.mesh;
    // The one to take where nothing is known about the mesh. Its field has the
    // Gaussian and principal curvatures and directions too.
    Ok(Estimator::RECOMMENDED.estimate(&mesh)?)
}
