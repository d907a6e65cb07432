//! `fairing denoise`.

use std::path::Path;

use clap::Args;
use fairing::denoising::{Automatic, AutomaticOptions, Denoiser, Masked, SurfaceKind, automatic};
use fairing::mesh::io::VertexFields;
use fairing::parameters::{Kind, Value as Given};
use fairing::task;
use serde_json::Value;

use super::context::{Context, Failure};
use super::files::{self, Content, Output};
use super::inputs::{Inputs, Summary};
use super::mask::Mask;
use super::parameters::{Parameters, list, names};
use super::surface::{Reading, Surface, say_orientation};
use super::table::number;

const EXAMPLES: &str = "\
Examples:
  fairing denoise scan.ply -o clean.ply
  fairing denoise part.obj -o clean.obj --json
  fairing denoise scan.ply -o smoother.ply --strength 2
  fairing denoise scan.ply -o clean.ply --where noisy --pin 12,40-59
  fairing denoise part.obj -o clean.obj --method guided-normal --iterations 30";

const AUTOMATIC: Denoiser = Denoiser::Automatic(AutomaticOptions::DEFAULT);

/// Remove noise from a mesh and keep its creases
///
/// Estimates from the mesh the noise, the distance over which the noise of a depth camera is
/// correlated, and the kind of surface. --strength multiplies the estimated noise: 2 removes more,
/// 0.5 less; try 2 for laser scans. Smooth waves of scans that were fused from many views can be
/// mistaken for shape. Relief a few edges wide that cannot be distinguished from noise is kept, and
/// the summary reports its height; --strength 2 removes it. Vertices far away from their neighbours
/// are moved back first, and counted. The other methods serve for comparison. The summary of --json
/// has the estimated noise and kind of surface, with the fractions of the area that are flat,
/// curved, or at a crease.
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Denoise {
    #[command(flatten)]
    inputs: Inputs,
    #[command(flatten)]
    reading: Reading,
    #[command(flatten)]
    output: Output,
    #[command(flatten)]
    mask: Mask,
    /// Fixed vertices: numbers from 0 and ranges such as 10-19, separated by commas
    #[arg(long, value_name = "LIST", value_parser = vertices)]
    pin: Vec<Given>,
    /// Denoiser; --list describes each
    #[arg(
        long,
        value_name = "NAME",
        value_parser = names::<Denoiser>(),
        default_value = AUTOMATIC.name(),
    )]
    method: String,
    #[command(flatten)]
    parameters: Parameters<Denoiser>,
    /// List the denoisers, their uses and their parameters
    #[arg(long, exclusive = true)]
    list: bool,
    #[command(flatten)]
    summary: Summary,
}

/// Reads a list of vertices.
fn vertices(text: &str) -> Result<Given, String> {
    Kind::Vertices.read(text.into()).map_err(|expected| format!("it must be {expected}"))
}

impl Denoise {
    pub(crate) fn run(&self, context: &Context) -> Result<(), Failure> {
        if self.list {
            return context.print(list::<Denoiser>());
        }
        self.output.check(&self.inputs.paths)?;
        self.parameters.check(&self.method)?;
        let denoiser = Denoiser::with(&self.method, self.parameters.given());
        let denoiser = denoiser.map_err(Failure::usage)?;
        if self.summary.is_wanted() && !matches!(denoiser, Denoiser::Automatic(_)) {
            return Err(Failure::usage(format_args!(
                "--json and --table need the method automatic; {denoiser} estimates nothing"
            )));
        }
        let columns = [
            "noise.sigma",
            "noise.correlation_length",
            "kind",
            "approach",
            "expected_error",
            "undecided",
            "spikes",
            "uneven_vertices",
        ];
        self.inputs.each(context, self.summary, &columns, |context, input| {
            self.one(context, input, &denoiser)
        })
    }

    fn one(&self, context: &Context, input: &Path, denoiser: &Denoiser) -> Result<Value, Failure> {
        let output = self.output.of(context, input, Content::Mesh)?;
        let (surface, fields) = self.reading.read(context, input)?;
        say_orientation(context, input, surface.mesh());
        let fixed = self.fixed(context, input, &surface, &fields)?;
        let masked = Masked::new(surface.mesh(), &fixed).map_err(Failure::usage)?;
        let mut summary = Value::Null;
        let mesh = match denoiser {
            Denoiser::Automatic(options) => {
                let found = automatic(masked, options)?;
                say(context, &found);
                if self.summary.is_wanted() {
                    summary = surface.add_to(task::denoise(&found));
                }
                found.mesh
            }
            other => other.denoise(masked)?,
        };
        let written = files::write_moved(context, &output, &surface.own(mesh)?, fields)?;
        Ok(files::with_split(summary, &written))
    }

    /// A flag for each vertex computed on, true for those that do not move.
    fn fixed(
        &self,
        context: &Context,
        input: &Path,
        surface: &Surface,
        fields: &VertexFields,
    ) -> Result<Vec<bool>, Failure> {
        let selected = self.mask.of(context, input, surface, fields)?;
        let selected = selected.unwrap_or_else(|| vec![true; surface.mesh().vertex_count()]);
        let mut fixed: Vec<bool> = selected.iter().map(|selected| !selected).collect();
        let count = surface.own.vertex_count();
        for list in &self.pin {
            let Given::Vertices(vertices) = list else { continue };
            for &v in vertices {
                if v as usize >= count {
                    let file = input.display();
                    return Err(Failure::usage(format_args!(
                        "{file}: --pin names vertex {v}, but there are {count} vertices"
                    )));
                }
                fixed[surface.number(v) as usize] = true;
            }
        }
        Ok(fixed)
    }
}

/// Notes what was found, and what was left as it was.
fn say(context: &Context, found: &Automatic) {
    context.note(summary(found));
    if found.spikes > 0 {
        context.note(format_args!(
            "{} of {} vertices, farther from the surface around them than noise explains, were \
             first moved back to it; --pin keeps vertices in place",
            found.spikes,
            found.mesh.vertex_count()
        ));
    }
    if found.uneven_vertices > 0 {
        context.note(format_args!(
            "{} vertices are on parts whose faces are too uneven (a CAD tessellation?): these parts \
             stay as they are; --method guided-normal moves them, too",
            found.uneven_vertices
        ));
    }
    if found.undecided > 0.1 * found.noise.map_or(0.0, |noise| noise.sigma) {
        context.note(format_args!(
            "of this, {} may be relief instead of noise, and is kept; --strength 2 removes it",
            number(found.undecided)
        ));
    }
    if found.flipped_faces > 0 {
        context.note(format_args!(
            "{} faces are flipped against the surface around them",
            found.flipped_faces
        ));
    }
}

/// One line about the noise and the kind of surface.
fn summary(found: &Automatic) -> String {
    let Some(noise) = found.noise else {
        return "too few vertices to measure noise; nothing is moved".into();
    };
    let kind = match found.kind {
        SurfaceKind::Creased => "a surface with creases",
        SurfaceKind::Smooth => "a surface without creases",
        SurfaceKind::Uneven => "nothing is moved",
        _ => "no noise to remove",
    };
    let correlated = match noise.correlation_length {
        length if length > 0.0 => {
            format!(", correlated over {length} edges, where it is {}", number(noise.wide_sigma))
        }
        _ => String::new(),
    };
    let expected = found
        .expected_error
        .map_or(String::new(), |error| format!("; expected mean error of normals {error:.1}°"));
    format!("noise of {} in units of the file{correlated}; {kind}{expected}", number(noise.sigma))
}
