//! Fifty eigenpairs of the Laplacian as an npz file, and the heat kernel signature as fields of a
//! PLY file.
//!
//! `cargo run --example signature -- bunny.ply modes.npz signature.ply`

use anyhow::{Result, bail};
use fairing::mesh::io::{self, VertexFields};
use fairing::operators::Laplacian;
use fairing::spectral::{SpectrumOptions, heat_kernel_signature, heat_kernel_times, spectrum};

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [mesh, modes, signature] = &arguments[..] else { bail!("expected a mesh and two outputs") };
    run(mesh, modes, signature)
}

pub(crate) fn run(mesh: &str, modes: &str, signature: &str) -> Result<()> {
    let mesh = io::read(mesh)?.mesh;
    let spectrum = spectrum(&Laplacian::auto(&mesh)?, 50, &SpectrumOptions::default())?;
    // In Python: numpy.load("modes.npz")["modes"]
    spectrum.save(modes)?;

    let times = heat_kernel_times(&spectrum, 8);
    let values = heat_kernel_signature(&spectrum, &times)?;
    let mut fields = VertexFields::default();
    for (i, column) in values.columns().into_iter().enumerate() {
        fields = fields.with_scalar(format!("heat{i}"), column.to_vec());
    }
    io::write_with_fields(signature, &mesh, &fields, &Default::default())?;
    Ok(())
}
