//! `fairing denoise`.

use std::path::PathBuf;

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use fairing::denoising::{Denoiser, SurfaceKind, automatic};

use super::Context;
use super::exit::Failure;
use super::files::{self, Output};
use super::table::number;

const EXAMPLES: &str = "\
Examples:
  fairing denoise scan.ply -o clean.ply
  fairing denoise part.obj -o clean.obj --method guided-normal";

/// Remove noise from a mesh and keep its creases
///
/// Needs no parameters: the noise and the kind of surface are estimated from the
/// mesh. The published methods are for comparison.
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Denoise {
    /// The mesh
    input: PathBuf,
    #[command(flatten)]
    output: Output,
    /// The denoiser, with its default options
    #[arg(long, value_name = "NAME", default_value = "automatic", value_parser = denoisers())]
    method: Denoiser,
}

fn denoisers() -> impl TypedValueParser<Value = Denoiser> {
    let names = Denoiser::ALL.map(|d| PossibleValue::new(d.name()).help(d.description()));
    PossibleValuesParser::new(names).try_map(|name| name.parse::<Denoiser>())
}

impl Denoise {
    pub(crate) fn run(&self, context: &Context) -> Result<(), Failure> {
        self.output.check()?;
        let file = files::read(&self.input)?;
        files::say_report(context, &self.input, &file.report);
        let mesh = if self.method == Denoiser::Automatic {
            let result = automatic(&file.mesh)?;
            let kind = match result.kind {
                SurfaceKind::Creased => "a surface with creases",
                SurfaceKind::Smooth => "a surface without creases",
                _ => "no noise to remove",
            };
            if let Some(noise) = result.noise {
                let sigma = number(noise.sigma);
                context.note(format_args!("noise of {sigma} in units of the file; {kind}"));
            } else {
                context.note("too few vertices to measure noise; nothing is moved");
            }
            result.mesh
        } else {
            self.method.denoise(&file.mesh)?
        };
        files::write_moved(context, &self.output, &mesh, file.fields)
    }
}
