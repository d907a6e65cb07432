//! `fairing noise`.

use std::path::PathBuf;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, ValueEnum};
use fairing::evaluation::{NoiseKind, NoiseLevel, add_noise};

use super::context::{Context, Failure};
use super::files::{self, Content, Output};
use super::surface::{Reading, say_orientation};
use super::table::number;

const EXAMPLES: &str = "\
Examples:
  fairing noise fandisk.off -o noisy.off --sigma 0.3
  fairing noise fandisk.off -o noisy.off --sigma 0.05 --unit model --kind axes --seed 7";

/// Add seeded noise to the positions of a mesh
///
/// The same seed gives the same noise on every machine. Vertex properties are kept,
/// except normals, which do not fit the moved vertices.
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Noise {
    /// The mesh
    input: PathBuf,
    #[command(flatten)]
    reading: Reading,
    #[command(flatten)]
    output: Output,
    /// Standard deviation of the displacement; for uniform noise, the largest shift per axis
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    sigma: f64,
    /// The unit of sigma
    #[arg(long, value_enum, default_value = "edge")]
    unit: Unit,
    /// Distribution and direction of the noise
    #[arg(long, default_value = "normal", value_parser = kinds())]
    kind: NoiseKind,
    /// Fraction of vertices that impulsive noise moves [default: 0.25]
    #[arg(long, value_name = "SHARE")]
    share: Option<f64>,
    /// Seed of the random numbers
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
}

#[derive(Clone, Copy, ValueEnum)]
enum Unit {
    /// Mean edge lengths
    Edge,
    /// Units of the file
    Model,
    /// Diagonals of the bounding box
    Diagonal,
}

fn kinds() -> impl TypedValueParser<Value = NoiseKind> {
    let names = NoiseKind::ALL.map(|kind| PossibleValue::new(kind.name()).help(kind.description()));
    PossibleValuesParser::new(names).try_map(|name| name.parse::<NoiseKind>())
}

impl Noise {
    pub(crate) fn run(&self, context: &Context) -> Result<(), Failure> {
        self.output.check(Content::Mesh)?;
        let kind = match (self.kind, self.share) {
            (kind, None) => kind,
            (NoiseKind::Impulsive { .. }, Some(share)) => NoiseKind::Impulsive { share },
            (kind, Some(_)) => {
                return Err(Failure::usage(format_args!(
                    "--share needs --kind impulsive: {kind} noise moves all vertices"
                )));
            }
        };
        let (surface, fields) = self.reading.read(context, &self.input)?;
        let mesh = surface.mesh();
        say_orientation(context, &self.input, mesh);
        let level = match self.unit {
            Unit::Edge => NoiseLevel::EdgeLengths(self.sigma),
            Unit::Model => NoiseLevel::Model(self.sigma),
            Unit::Diagonal => NoiseLevel::Diagonals(self.sigma),
        };
        let noisy = add_noise(mesh, kind, level, self.seed)?;
        context.note(format_args!(
            "sigma = {} in units of the file",
            number(level.in_mesh_units(mesh))
        ));
        files::write_moved(context, &self.output, &surface.own(noisy)?, fields)
    }
}
