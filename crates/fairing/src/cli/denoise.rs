//! `fairing denoise`.

use std::path::PathBuf;

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use fairing::denoising::{Automatic, Denoiser, FaceKind, SurfaceKind, automatic};
use serde_json::{Map, Value, json};

use super::exit::Failure;
use super::files::{self, Output};
use super::table::number;
use super::{Context, print};

const EXAMPLES: &str = "\
Examples:
  fairing denoise scan.ply -o clean.ply
  fairing denoise part.obj -o clean.obj --json
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
    /// Print the noise and the kinds of surface that were found as one JSON object, with the
    /// share of the area that is flat, curved, or at a crease
    #[arg(long)]
    json: bool,
}

fn denoisers() -> impl TypedValueParser<Value = Denoiser> {
    let names = Denoiser::ALL.map(|d| PossibleValue::new(d.name()).help(d.description()));
    PossibleValuesParser::new(names).try_map(|name| name.parse::<Denoiser>())
}

impl Denoise {
    pub(crate) fn run(&self, context: &Context) -> Result<(), Failure> {
        self.output.check()?;
        if self.json && self.method != Denoiser::Automatic {
            return Err(Failure::usage(format_args!(
                "--json says what the method automatic found; {} looks for nothing",
                self.method
            )));
        }
        let file = files::read(&self.input)?;
        files::say_report(context, &self.input, &file.report);
        let mesh = if self.method == Denoiser::Automatic {
            let result = automatic(&file.mesh)?;
            context.note(format_args!("{}", summary(&result)));
            if self.json {
                print(format_args!("{:#}\n", as_json(&result)))?;
            }
            result.mesh
        } else {
            self.method.denoise(&file.mesh)?
        };
        files::write_moved(context, &self.output, &mesh, file.fields)
    }
}

/// One line about what was found.
fn summary(result: &Automatic) -> String {
    let Some(noise) = result.noise else {
        return "too few vertices to measure noise; nothing is moved".into();
    };
    let kind = match result.kind {
        SurfaceKind::Creased => "a surface with creases",
        SurfaceKind::Smooth => "a surface without creases",
        _ => "no noise to remove",
    };
    format!("noise of {} in units of the file; {kind}", number(noise.sigma))
}

/// The noise, and what the surface is like.
fn as_json(result: &Automatic) -> Value {
    let kind = match result.kind {
        SurfaceKind::Creased => "creased",
        SurfaceKind::Smooth => "smooth",
        _ => "clean",
    };
    let shares: Map<String, Value> = (FaceKind::ALL.iter())
        .map(|&kind| (kind.name().to_owned(), json!(result.share(kind))))
        .collect();
    let topology = result.mesh.topology();
    let border =
        (0..result.mesh.vertex_count() as u32).filter(|&v| topology.is_boundary_vertex(v)).count();
    json!({
        "noise": result.noise.map(|noise| json!({
            "sigma": noise.sigma,
            "tail_ratio": noise.tail_ratio,
            "impulsive": noise.is_impulsive(),
        })),
        "kind": kind,
        "area_share": shares,
        "border_vertices": border,
        "displacement_limit": result.limit,
    })
}
