//! `fairing denoise`.

use std::path::PathBuf;

use clap::Args;
use fairing::denoising::{DenoiseError, Denoiser, SurfaceKind, automatic};
use fairing::mesh::{Algorithm, TriMesh};

use super::exit::Failure;
use super::files::{self, MaybeOutput};
use super::parameters::{Family, Parameters, list, names};
use super::table::number;
use super::{Context, print};

const EXAMPLES: &str = "\
Examples:
  fairing denoise scan.ply -o clean.ply
  fairing denoise part.obj -o clean.obj --method guided-normal --iterations 30";

/// Remove noise from a mesh and keep its creases
///
/// Needs no parameters: the noise and the kind of surface are estimated from the
/// mesh. The published methods are for comparison.
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Denoise {
    /// The mesh
    #[arg(required_unless_present = "list")]
    input: Option<PathBuf>,
    #[command(flatten)]
    output: MaybeOutput,
    /// The denoiser; --list says what each is for
    #[arg(
        long,
        value_name = "NAME",
        value_parser = names::<Denoisers>(),
        default_value = Denoiser::Automatic.name(),
    )]
    method: String,
    #[command(flatten)]
    parameters: Parameters<Denoisers>,
    /// List the denoisers, what each does, and their parameters
    #[arg(long, exclusive = true)]
    list: bool,
}

/// The methods of [`Denoise`].
struct Denoisers;

impl Family for Denoisers {
    const WHAT: &'static str = "method";

    fn algorithms() -> Vec<&'static Algorithm> {
        Denoiser::ALL.iter().map(|denoiser| denoiser.algorithm()).collect()
    }
}

impl Denoise {
    pub(crate) fn run(&self, context: &Context) -> Result<(), Failure> {
        if self.list {
            return print(list::<Denoisers>());
        }
        let (input, output) = (self.input.as_ref(), self.output.given());
        let (Some(input), Some(output)) = (input, output) else {
            return Err(Failure::usage("which mesh, and where to?"));
        };
        output.check()?;
        self.parameters.check(&self.method)?;
        let denoiser: Denoiser = self.method.parse().map_err(Failure::usage)?;
        let file = files::read(input)?;
        files::say_report(context, input, &file.report);
        let mesh = match denoiser {
            Denoiser::Automatic => automatically(context, &file.mesh)?,
            other => match other.denoise_with(&file.mesh, &self.parameters.given()) {
                Err(DenoiseError::InvalidOption { option, value, expected }) => {
                    let option = option.replace('_', "-");
                    let said = format_args!("--{option} is {value}, but must be {expected}");
                    return Err(Failure::usage(said));
                }
                Err(DenoiseError::Parameter(error)) => return Err(Failure::usage(error)),
                other => other?,
            },
        };
        files::write_moved(context, &output, &mesh, file.fields)
    }
}

/// Denoises without parameters, and says what noise was found.
fn automatically(context: &Context, mesh: &TriMesh) -> Result<TriMesh, Failure> {
    let result = automatic(mesh)?;
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
    Ok(result.mesh)
}
