//! `fairing reconstruct`.

use std::path::Path;

use clap::Args;
use fairing::operators::{LaplacianKind, MassKind};
use fairing::spectral::{SpectrumOptions, reconstruct, reconstruction_errors};
use serde_json::Value;

use super::context::{Context, Failure};
use super::files::{self, Content, Output};
use super::inputs::{Inputs, Summary};
use super::operator;
use super::spectrum;
use super::surface::Reading;
use super::table::number;

const EXAMPLES: &str = "\
Examples:
  fairing reconstruct armadillo.obj -k 50 -o smooth.obj
  fairing reconstruct scan.ply -k 300 -o smooth.ply --force";

/// Rebuild a mesh from its k smoothest modes
///
/// Projects the positions onto the k smoothest modes of the Laplace-Beltrami operator,
/// in the inner product of the mass. If a face is too thin for cotangents, uses the
/// robust operator and prints a note. Prints the area-weighted root mean square of the
/// displacement, in units of the file. Warns if K splits a cluster of eigenvalues,
/// since the result is then arbitrary. Vertices without faces stay fixed; normals in
/// the file are dropped, other properties are kept.
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Reconstruct {
    #[command(flatten)]
    inputs: Inputs,
    /// Number of modes
    #[arg(short, value_name = "K", value_parser = spectrum::at_least_one)]
    k: usize,
    /// The stiffness of the Laplacian
    #[arg(long, value_parser = operator::kinds(), default_value_t = LaplacianKind::Auto)]
    operator: LaplacianKind,
    #[command(flatten)]
    reading: Reading,
    #[command(flatten)]
    output: Output,
}

impl Reconstruct {
    pub(crate) fn run(&self, context: &Context) -> Result<(), Failure> {
        self.output.check(&self.inputs.paths)?;
        self.inputs.each(context, Summary::default(), &[], |context, input| {
            self.one(context, input).map(|()| Value::Null)
        })
    }

    fn one(&self, context: &Context, input: &Path) -> Result<(), Failure> {
        let output = self.output.of(context, input, Content::Mesh)?;
        let (surface, fields) = self.reading.read(context, input)?;
        let mesh = surface.mesh();
        let laplacian = operator::assemble(context, mesh, self.operator, MassKind::Barycentric)?;
        let options = SpectrumOptions::default();
        let modes = fairing::spectral::spectrum(&laplacian, self.k, &options)?;
        spectrum::warn_of_split(context, modes.split(self.k), self.k, "-k");
        let rebuilt = reconstruct(mesh, &modes, self.k)?.mesh;
        let errors = reconstruction_errors(mesh, &modes)?;
        files::write_moved(context, &output, &surface.own(rebuilt)?, fields)?;
        context.note(format_args!("displacement: {} (RMS)", number(errors[self.k])));
        Ok(())
    }
}
