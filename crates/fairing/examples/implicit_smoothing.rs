//! Implicit smoothing by the cotangent Laplacian with a fixed boundary.
//!
//! `cargo run --example implicit_smoothing -- scan.ply smooth.ply`

use anyhow::{Result, bail};
use fairing::mesh::io;
use fairing::smoothing::{Boundary, Constraints, Diffusion, Implicit, implicit};

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [input, output] = &arguments[..] else { bail!("expected an input and an output") };
    run(input, output)
}

pub(crate) fn run(input: &str, output: &str) -> Result<()> {
    let mesh = io::read(input)?.mesh;
    // Five squared mean edge lengths a step.
    let options = Implicit {
        iterations: 3,
        constraints: Constraints::boundary(Boundary::Pinned),
        ..Implicit::new(Diffusion::cotangent(5.0))
    };
    let smoothed = implicit(&mesh, &options, None)?;
    io::write(output, &smoothed.mesh)?;
    Ok(())
}
