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
/// The same seed gives the same noise on every machine. Other properties of the
/// vertices are kept, except normals, which are no longer right.
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Noise {
    /// The mesh
    input: PathBuf,
    #[command(flatten)]
    reading: Reading,
    #[command(flatten)]
    output: Output,
    /// Standard deviation (of each moved vertex; for uniform noise the largest shift per axis)
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    sigma: f64,
    /// The unit of sigma
    #[arg(long, value_enum, default_value = "edge")]
    unit: Unit,
    /// How vertices are moved
    #[arg(long, default_value = "normal", value_parser = kinds())]
    kind: NoiseKind,
    /// The share of vertices that impulsive noise moves; 0.25 unless set
    #[arg(long, value_name = "SHARE")]
    share: Option<f64>,
    /// The seed of the random numbers
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
                    "--share is for --kind impulsive: noise of the kind {kind} moves all vertices"
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
