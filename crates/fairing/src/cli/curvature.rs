//! `fairing curvature`.

use std::collections::BTreeMap;
use std::path::Path;

use clap::Args;
use fairing::mesh::TriMesh;
use fairing::mesh::io::VertexFields;
use fairing::operators::curvature::{
    Accuracy, CurvatureField, Estimator, VertexStatus, laplacian_curvature,
};
use fairing::operators::{Laplacian, LaplacianKind, LumpedArea, MassKind, OperatorError};
use fairing::parameters::Algorithm;
use fairing::sparse::median;
use serde_json::{Value, json};

use super::context::{Context, Failure};
use super::files::{self, Content, OptionalOutput};
use super::inputs::{Inputs, Summary};
use super::operator::{self, say_too_thin};
use super::parameters::{Parameters, foreign, list, names};
use super::surface::{Reading, Surface, say_orientation};
use super::table::{Table, number};

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
/// and the standard errors mean_error and gaussian_error with the radius scale that decided.
/// The property defined is 0 at vertices without a value (the values there are 0 and meaningless);
/// boundary is 1 at boundary vertices, whose values are one-sided. PLY and VTP files hold these
/// properties. Units are 1/length of the file, for gaussian 1/length². Curvature
/// is positive on a sphere whose faces are counter-clockwise seen from outside. Other
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
        let output = self.output.of(context, input, Content::Fields)?;
        let (surface, fields) = self.reading.read(context, input)?;
        say_orientation(context, input, surface.mesh());
        let field = self.estimate(estimator, surface.mesh())?;
        if let Some(output) = &output {
            let fields = with_curvature(fields, &field, &surface);
            files::write_held(context, output, &surface.own, &fields)?;
        }
        if let Some(face) = field.too_thin {
            say_too_thin(context, face);
        }
        let reasons = reasons(&field);
        let undefined: usize = reasons.values().sum();
        if self.summary.is_wanted() {
            let mut summary = json!({
                "estimator": estimator.name(),
                "vertices": field.len(),
                "undefined": undefined,
                "undefined_because": reasons,
                "too_thin_face": field.too_thin,
                "narrowed": field.narrowed,
                "boundary": field.boundary.iter().filter(|&&b| b).count(),
                "interior": summary(&field, &columns(&field)),
                "accuracy": field.accuracy.as_ref().map(|found| summary(&field, &trust(found))),
            });
            surface.add_to(&mut summary);
            return Ok(summary);
        }
        let mut table = Table::new();
        table.row(["interior", "least", "median", "greatest"].map(str::to_owned));
        let trust = field.accuracy.as_ref().map(trust);
        for (name, values) in columns(&field).into_iter().chain(trust.into_iter().flatten()) {
            let spread = spread(&field, values).map(|s| s.map(number));
            let [least, median, greatest] =
                spread.unwrap_or_else(|| ["-", "-", "-"].map(str::to_owned));
            table.row([name.to_owned(), least, median, greatest]);
        }
        context.print(table)?;
        if field.narrowed > 0 {
            context.note(format_args!(
                "fewer rings or a lower degree at {} of {} vertices, where the neighbourhood turns \
                 by more than 60°",
                field.narrowed,
                field.len()
            ));
        }
        if undefined > 0 {
            let reasons: Vec<String> =
                reasons.iter().map(|(reason, count)| format!("{reason}: {count}")).collect();
            context.note(format_args!(
                "undefined at {undefined} of {} vertices ({})",
                field.len(),
                reasons.join(", ")
            ));
        }
        Ok(Value::Null)
    }
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

/// Why there is no value, and at how many vertices.
fn reasons(field: &CurvatureField) -> BTreeMap<String, usize> {
    let mut reasons = BTreeMap::new();
    for status in &field.status {
        if let VertexStatus::Undefined(reason) = status {
            *reasons.entry(reason.to_string()).or_default() += 1;
        }
    }
    reasons
}

fn columns(field: &CurvatureField) -> [(&'static str, &[f64]); 4] {
    [
        ("mean", &field.mean),
        ("gaussian", &field.gaussian),
        ("kappa1", &field.kappa1),
        ("kappa2", &field.kappa2),
    ]
}

/// The standard errors and the radius that decided.
fn trust(found: &Accuracy) -> [(&'static str, &[f64]); 3] {
    [
        ("mean_error", &found.mean_error),
        ("gaussian_error", &found.gaussian_error),
        ("scale", &found.scale),
    ]
}

/// Minimum, median and maximum over the interior vertices.
fn spread(field: &CurvatureField, values: &[f64]) -> Option<[f64; 3]> {
    let interior = (0..field.len() as u32).filter(|&v| field.is_interior(v));
    let mut sorted: Vec<f64> = interior.map(|v| values[v as usize]).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    Some([*sorted.first()?, median(&sorted)?, *sorted.last()?])
}

fn summary(field: &CurvatureField, columns: &[(&str, &[f64])]) -> Value {
    let entries = columns.iter().map(|&(name, values)| {
        let spread = spread(field, values)
            .map(|[least, median, greatest]| json!({ "least": least, "median": median, "greatest": greatest }));
        (name.to_owned(), json!(spread))
    });
    Value::Object(entries.collect())
}

/// The fields of the file and those of the curvature, which replace fields of the same names.
fn with_curvature(
    mut fields: VertexFields,
    field: &CurvatureField,
    surface: &Surface,
) -> VertexFields {
    let flags = |flags: &mut dyn Iterator<Item = bool>| {
        surface.spread(flags.map(|b| f64::from(u8::from(b))).collect())
    };
    let mut scalars: Vec<(&str, Vec<f64>)> =
        columns(field).map(|(name, values)| (name, surface.spread(values.to_vec()))).into();
    let trust = field.accuracy.as_ref().map(trust).into_iter().flatten();
    scalars.extend(trust.map(|(name, values)| (name, surface.spread(values.to_vec()))));
    scalars.push(("defined", flags(&mut field.status.iter().map(|s| s.is_defined()))));
    scalars.push(("boundary", flags(&mut field.boundary.iter().copied())));
    fields.scalars.retain(|(name, _)| scalars.iter().all(|(n, _)| n != name));
    fields.scalars.extend(scalars.into_iter().map(|(name, values)| (name.to_owned(), values)));
    if let Some([first, second]) = &field.directions {
        let vectors = [("direction1", first), ("direction2", second)];
        fields.vectors.retain(|(name, _)| vectors.iter().all(|(n, _)| n != name));
        fields.vectors.extend(
            vectors.map(|(name, values)| (name.to_owned(), surface.spread(values.clone()))),
        );
    }
    fields
}
