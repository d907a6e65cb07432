//! `fairing curvature`.

use std::path::Path;

use clap::Args;
use fairing::mesh::TriMesh;
use fairing::operators::curvature::{CurvatureField, Estimator, laplacian_curvature};
use fairing::operators::{Laplacian, LaplacianKind, LumpedArea, MassKind, OperatorError};
use fairing::parameters::Algorithm;
use fairing::task;
use serde_json::Value;

use super::context::{Context, Failure};
use super::files::{self, Content, OptionalOutput};
use super::inputs::{Inputs, Summary};
use super::operator::{self, say_too_thin};
use super::parameters::{Parameters, foreign, list, names};
use super::surface::{Reading, say_orientation};
use super::table::{Table, cell};

const EXAMPLES: &str = "\
Examples:
  fairing curvature --list
  fairing curvature bunny.ply -o curved.ply
  fairing curvature scan.ply -o curved.ply --noise correlated
  fairing curvature bunny.ply -o curved.ply --estimator corrected
  fairing render curved.ply -o mean.png --field mean";

/// Estimate the curvature at each vertex
///
/// Prints a summary; with --output, writes the vertex properties mean, gaussian, kappa1 >= kappa2
/// and, if the estimator provides them, the principal unit directions direction1 and direction2,
/// the standard errors mean_error and gaussian_error, and scale, the radius with the largest weight
/// in mean, in units of the file. The property defined is 0 at vertices without a value (the values
/// there are 0 and meaningless); boundary is 1 at boundary vertices, whose values are one-sided.
/// PLY and VTP files hold these properties. Units are 1/length of the file, for gaussian 1/length².
/// Curvature is positive on a sphere whose faces are counter-clockwise seen from outside. Other
/// properties of the file are kept.
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Curvature {
    #[command(flatten)]
    inputs: Inputs,
    #[command(flatten)]
    reading: Reading,
    #[command(flatten)]
    output: OptionalOutput,
    /// Estimator; --list describes each
    #[arg(
        long,
        value_name = "NAME",
        value_parser = names::<Estimator>(),
        default_value = Estimator::RECOMMENDED.name(),
    )]
    estimator: String,
    #[command(flatten)]
    parameters: Parameters<Estimator>,
    /// Laplacian of the estimator cotangent, over barycentric areas unless --area is given;
    /// by default cotangents over mixed areas, or robust if a face is too thin
    #[arg(long, value_parser = operator::kinds())]
    operator: Option<LaplacianKind>,
    #[command(flatten)]
    summary: Summary,
    /// List the estimators, their uses and their parameters
    #[arg(long, exclusive = true)]
    list: bool,
}

impl Curvature {
    pub(crate) fn run(&self, context: &Context) -> Result<(), Failure> {
        if self.list {
            return context.print(list::<Estimator>());
        }
        self.output.check(&self.inputs.paths)?;
        let estimator = self.estimator()?;
        let columns = [
            "vertices",
            "undefined",
            "interior.mean.least",
            "interior.mean.median",
            "interior.mean.greatest",
            "interior.gaussian.median",
            "accuracy.mean_error.median",
        ];
        self.inputs.each(context, self.summary, &columns, |context, input| {
            self.one(context, input, &estimator)
        })
    }

    fn one(
        &self,
        context: &Context,
        input: &Path,
        estimator: &Estimator,
    ) -> Result<Value, Failure> {
        let output = self.output.if_given(context, input, Content::Fields)?;
        let (surface, fields) = self.reading.read(context, input)?;
        say_orientation(context, input, surface.mesh());
        let field = self.estimate(estimator, surface.mesh())?;
        if let Some(output) = &output {
            let (scalars, vectors) = task::fields(&field);
            let scalars = scalars.into_iter().map(|(name, x)| (name, surface.spread(x)));
            let vectors = vectors.into_iter().map(|(name, x)| (name, surface.spread(x)));
            let fields = files::with_fields(fields, scalars.collect(), vectors.collect());
            files::write_held(context, output, &surface.own, &fields)?;
        }
        if let Some(face) = field.too_thin {
            say_too_thin(context, face);
        }
        let report = task::curvature(estimator.name(), &field);
        if self.summary.is_wanted() {
            return Ok(surface.add_to(report));
        }
        say(context, &field, &report)?;
        Ok(Value::Null)
    }
}

/// Prints ranges and medians, and notes vertices without a value.
fn say(context: &Context, field: &CurvatureField, report: &Value) -> Result<(), Failure> {
    let mut table = Table::new();
    table.row(["interior", "least", "median", "greatest"].map(str::to_owned));
    let ranges = ["interior", "accuracy"].into_iter().filter_map(|part| report[part].as_object());
    for (name, range) in ranges.flatten() {
        let [least, median, greatest] = ["least", "median", "greatest"].map(|n| cell(&range[n]));
        table.row([name.clone(), least, median, greatest]);
    }
    context.print(table)?;
    let (vertices, narrowed, undefined) = (field.len(), field.narrowed, &report["undefined"]);
    if narrowed > 0 {
        context.note(format_args!(
            "fewer rings or a lower degree at {narrowed} of {vertices} vertices, where the \
             neighbourhood turns by more than 60°"
        ));
    }
    if *undefined != 0 {
        let reasons = task::undefined_because(field);
        let reasons: Vec<String> = reasons.iter().map(|(why, n)| format!("{why}: {n}")).collect();
        let reasons = reasons.join(", ");
        context.note(format_args!("undefined at {undefined} of {vertices} vertices ({reasons})"));
    }
    Ok(())
}

impl Curvature {
    /// The estimator with its parameters.
    fn estimator(&self) -> Result<Estimator, Failure> {
        let name = &self.estimator;
        self.parameters.check(name)?;
        let estimator = Estimator::with(name, self.parameters.given()).map_err(Failure::usage)?;
        match (self.operator, estimator) {
            (None, _) => Ok(estimator),
            (Some(LaplacianKind::Robust), Estimator::Cotangent(_))
                if self.mass(estimator) != MassKind::Barycentric =>
            {
                Err(Failure::usage(
                    "--operator robust has barycentric areas only: leave out --area",
                ))
            }
            (Some(_), Estimator::Cotangent(_)) => Ok(estimator),
            (Some(_), _) => {
                let takes = |algorithm: &Algorithm| algorithm.parameter("area").is_some();
                Err(foreign::<Estimator>(name, "operator", takes))
            }
        }
    }

    /// The mass of the Laplacian of `--operator`.
    fn mass(&self, estimator: Estimator) -> MassKind {
        match estimator {
            Estimator::Cotangent(options) if self.parameters.get("area").is_some() => {
                options.area.into()
            }
            _ => LumpedArea::Barycentric.into(),
        }
    }

    fn estimate(&self, estimator: &Estimator, mesh: &TriMesh) -> Result<CurvatureField, Failure> {
        let Some(kind) = self.operator else {
            return match estimator.estimate(mesh) {
                Err(error @ OperatorError::Option(_)) => Err(Failure::usage(error)),
                other => Ok(other?),
            };
        };
        let laplacian = Laplacian::new(mesh, kind, self.mass(*estimator))?;
        Ok(laplacian_curvature(mesh, &laplacian)?)
    }
}
