//! Principal curvatures and directions as fields of a PLY file.
//!
//! `cargo run --example principal_directions -- bunny.ply curved.ply`

use anyhow::{Result, bail};
use fairing::mesh::io::{self, VertexFields};
use fairing::operators::curvature::Estimator;

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [input, output] = &arguments[..] else { bail!("expected an input and an output") };
    run(input, output)
}

pub(crate) fn run(input: &str, output: &str) -> Result<()> {
    let mesh = io::read(input)?.mesh;
    let field = Estimator::RECOMMENDED.estimate(&mesh)?;
    let mut fields = VertexFields::default()
        .with_scalar("kappa1", field.kappa1)
        .with_scalar("kappa2", field.kappa2);
    if let Some([first, second]) = field.directions {
        fields = fields.with_vector("direction1", first).with_vector("direction2", second);
    }
    io::write_with_fields(output, &mesh, &fields, &Default::default())?;
    Ok(())
}
