//! `fairing noise`.

use std::path::Path;

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use fairing::evaluation::{NoiseKind, add_noise};
use fairing::task::{Unit, noise_kind};
use serde_json::Value;

use super::context::{Context, Failure};
use super::files::{self, Content, Output};
use super::inputs::{Inputs, Summary};
use super::mask::{Mask, keep_others};
use super::surface::{Reading, say_orientation};
use super::table::number;

const EXAMPLES: &str = "\
Examples:
  fairing noise fandisk.off -o noisy.off --sigma 0.3
  fairing noise fandisk.off -o noisy.off --sigma 0.05 --unit model --kind axes --seed 7
  fairing noise face.ply -o noisy.ply --sigma 0.67 --kind depth-camera --camera 0,0,500";

/// Add seeded noise to the positions of a mesh
///
/// The same seed gives the same noise on every machine. Vertex properties are kept,
/// except normals, which do not fit the moved vertices.
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Noise {
    #[command(flatten)]
    inputs: Inputs,
    #[command(flatten)]
    reading: Reading,
    #[command(flatten)]
    output: Output,
    #[command(flatten)]
    mask: Mask,
    /// Standard deviation of the displacement; for uniform noise, the largest shift per axis; for
    /// a depth camera and fused views, the root mean square
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    sigma: f64,
    /// The unit of sigma
    #[arg(long, value_name = "UNIT", value_parser = units(), default_value = "edge")]
    unit: Unit,
    #[command(flatten)]
    kind: Kind,
    /// Position of the camera of rays and depth-camera [default: three diagonals of the bounding
    /// box from its centre along +z]
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = point)]
    camera: Option<Point>,
    /// Seed of the random numbers
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
}

/// The kind of noise, with its parameters other than the camera.
#[derive(Args)]
pub(crate) struct Kind {
    /// Distribution and direction of the noise [default: normal; for scan,
    /// depth-camera]
    #[arg(long, value_parser = kinds())]
    kind: Option<NoiseKind>,
    /// Fraction of vertices that impulsive noise moves [default: 0.25]
    #[arg(long, value_name = "F")]
    fraction: Option<f64>,
    /// Correlation length in mean edge lengths: where the correlation is 1/e [default: 2 for
    /// correlated, 5 for depth-camera, 25 for fused]
    #[arg(long, value_name = "L")]
    length: Option<f64>,
}

impl Kind {
    /// The kind with the parameters that are given; `default` names it if it is not given.
    pub(crate) fn or(&self, default: &str, camera: Option<Point>) -> Result<NoiseKind, Failure> {
        let kind = self.kind.map_or_else(|| default.parse(), Ok)?;
        let camera = camera.map(|Point(camera)| camera);
        let refused = |option| Failure::usage(format_args!("{kind} noise has no --{option}"));
        noise_kind(kind, self.fraction, self.length, camera).map_err(refused)
    }

    /// Returns true if any is given.
    pub(crate) fn is_given(&self) -> bool {
        self.kind.is_some() || self.fraction.is_some() || self.length.is_some()
    }
}

/// A point written as `X,Y,Z`.
#[derive(Clone, Copy)]
pub(crate) struct Point(pub(crate) [f64; 3]);

/// Reads `X,Y,Z`.
pub(crate) fn point(text: &str) -> Result<Point, String> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|x| x.trim().parse()).collect();
    let point = numbers.ok().and_then(|numbers| numbers.try_into().ok());
    point.map(Point).ok_or_else(|| "must be three numbers: X,Y,Z".to_owned())
}

/// The parser of `--unit`.
pub(crate) fn units() -> impl TypedValueParser<Value = Unit> {
    let names = Unit::CHOICES.iter().map(|unit| PossibleValue::new(unit.name).help(unit.about));
    PossibleValuesParser::new(names).try_map(|name| name.parse::<Unit>())
}

fn kinds() -> impl TypedValueParser<Value = NoiseKind> {
    let names = NoiseKind::ALL.map(|kind| PossibleValue::new(kind.name()).help(kind.description()));
    PossibleValuesParser::new(names).try_map(|name| name.parse::<NoiseKind>())
}

impl Noise {
    pub(crate) fn run(&self, context: &Context) -> Result<(), Failure> {
        self.output.check(&self.inputs.paths)?;
        self.inputs.each(context, Summary::default(), &[], |context, input| {
            self.one(context, input).map(|()| Value::Null)
        })
    }

    fn one(&self, context: &Context, input: &Path) -> Result<(), Failure> {
        let output = self.output.of(context, input, Content::Mesh)?;
        let kind = self.kind.or("normal", self.camera)?;
        let (surface, fields) = self.reading.read(context, input)?;
        let mesh = surface.mesh();
        say_orientation(context, input, mesh);
        let selected = self.mask.of(context, input, &surface, &fields)?;
        let level = self.unit.level(self.sigma);
        let noisy = add_noise(mesh, kind, level, self.seed)?;
        let noisy = keep_others(mesh, noisy, selected.as_deref())?;
        let sigma = number(level.in_mesh_units(mesh));
        context.note(format_args!("sigma = {sigma} in units of the file"));
        files::write_moved(context, &output, &surface.own(noisy)?, fields).map(drop)
    }
}
