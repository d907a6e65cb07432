//! `fairing smooth`.

use std::ops::ControlFlow;
use std::path::PathBuf;

use clap::builder::{EnumValueParser, TypedValueParser, ValueParser};
use clap::{Args, ValueEnum};
use fairing::mesh::{Algorithm, Parameter, TriMesh};
use fairing::operators::MassKind;
use fairing::smoothing::{Approach, FlowFailure, Method, Observer, Smoothed, Step};
use serde_json::json;

use super::exit::Failure;
use super::files::{self, Output};
use super::operator::OperatorName;
use super::parameters::{Family, Parameters, foreign, names};
use super::spectrum::warn_of_split;
use super::table::{Table, number};
use super::{Context, print};

const HELP: &str = "\
Which method?
  Noise, and the size must stay     taubin (the default), or windowed-sinc: sharper
  The assignment's questions 5, 6   explicit --lambda L, implicit --lambda L
  Very smooth, in few steps         implicit --lambda 50 --iterations 3
  A physical amount of smoothing    low-pass --time T: exact heat diffusion, or --cutoff W
  The smoothest modes alone         low-pass --modes K
  Triangles of very uneven size     implicit --weights cotangent, or scale-dependent
  Even out the triangles as well    implicit --weights uniform
  A sphere out of a closed blob     conformal
  A dent, a filled hole             region --vertices LIST --order 2
  Sharp edges must survive          none of these: fairing denoise
  Faces without area, edges of      any; --operator robust takes weights that are never
  three faces, soups                negative, as do cotangents where a face has no area

The step --lambda is, for uniform weights, a fraction of the way to the mean of the
neighbours: explicit steps are stable up to 4/3 (8/7 with a boundary), implicit ones
always. For cotangents it is a diffusion time in squared mean edge lengths; explicit
ones are stable up to about 0.27 on even meshes. Instead, --time gives it in squared
units of the file. n steps of L smooth about as much as one of n L.

Vertices stay (--pin), slide along a border (--boundary sliding), or are drawn softly:
--soft 12:1,40:10:0:0:5 holds vertex 12 to its place as strongly as the flow moves it,
and draws vertex 40 to (0, 0, 5) ten times as strongly.

Examples:
  fairing smooth scan.ply -o smooth.ply
  fairing smooth scan.ply -o smooth.ply --method implicit --lambda 5 --volume rescale
  fairing smooth patch.obj -o flat.obj --method explicit --lambda 0.5 --boundary pinned
  fairing smooth noisy.off -o worse.off --method explicit --lambda 2 --unstable allow";

/// Smooth a mesh by a flow, a filter or the fairing of a region
///
/// Vertices move, faces stay; other properties of the vertices are kept, normals
/// are not, since they no longer fit. See below for which method to take.
#[derive(Args)]
#[command(after_help = HELP)]
pub(crate) struct Smooth {
    /// The mesh
    #[arg(required_unless_present = "list")]
    input: Option<PathBuf>,
    #[command(flatten)]
    output: MaybeOutput,
    /// The method; --list says what each is for
    #[arg(long, value_parser = names::<Flows>(), default_value = "taubin")]
    method: String,
    #[command(flatten)]
    parameters: Parameters<Flows>,
    /// Methods that take steps: end when no vertex moves by more than this in a step, in
    /// mean edge lengths
    #[arg(long, value_name = "S")]
    until: Option<f64>,
    /// If a step fails after others, write the mesh before it all the same; still an error
    #[arg(long)]
    last_good: bool,
    /// Print what was done as one JSON object
    #[arg(long)]
    json: bool,
    /// List the methods and what each is for
    #[arg(long, exclusive = true)]
    list: bool,
}

/// As [`Output`], but absent with `--list`.
#[derive(Args)]
struct MaybeOutput {
    /// The file to write
    #[arg(short = 'o', long = "output", value_name = "FILE", required_unless_present = "list")]
    path: Option<PathBuf>,
    #[command(flatten)]
    overwrite: files::Overwrite,
}

/// The methods of [`Smooth`].
struct Flows;

impl Family for Flows {
    const WHAT: &'static str = "method";

    fn algorithms() -> Vec<&'static Algorithm> {
        Method::algorithms()
    }

    fn parser(parameter: &Parameter) -> Option<(ValueParser, &'static str)> {
        let name = |operator: OperatorName| {
            let value = operator.to_possible_value();
            value.map(|value| value.get_name().to_owned()).unwrap_or_default()
        };
        let parser = EnumValueParser::<OperatorName>::new().map(name);
        (parameter.name == "operator").then(|| (parser.into(), "auto"))
    }
}

/// The value of the parameter `operator` that takes over where cotangents do not exist.
const ROBUST: &str = "robust";

/// Whether an algorithm takes steps, which `--until` watches.
fn takes_steps(algorithm: &Algorithm) -> bool {
    algorithm.parameter("iterations").is_some()
}

impl Smooth {
    pub(crate) fn run(&self, context: &Context) -> Result<(), Failure> {
        if self.list {
            return print(list());
        }
        let (Some(input), Some(path)) = (&self.input, &self.output.path) else {
            return Err(Failure::usage("which mesh, and where to?"));
        };
        self.output.overwrite.check(path)?;
        self.check()?;
        let (operator, area) = self.operator()?;
        let file = files::read(input)?;
        files::say_report(context, input, &file.report);
        let small = self.until.map(|until| until * file.mesh.mean_edge_length());
        let mut settle = |step: &Step<'_>| match small {
            Some(small) if step.largest_displacement() <= small => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        };
        let mut run = |operator| -> Result<_, Failure> {
            let mut values = self.parameters.given();
            for (_, value) in values.iter_mut().filter(|(name, _)| *name == "operator") {
                *value = operator;
            }
            if operator == ROBUST && self.parameters.get("operator").is_none() {
                values.push(("operator", ROBUST));
            }
            let method = Method::with(&self.method, &values, &file.mesh).map_err(Failure::usage)?;
            let observer = small.map(|_| &mut settle as &mut Observer<'_>);
            Ok((method.run(&file.mesh, observer), method))
        };
        let (mut result, mut method) = run(operator.of_flow())?;
        if let Err(error) = &result
            && let FlowFailure::Operator(thin) = &error.failure
            && error.iteration == 0
            && operator.gives_way(context, thin, area)
        {
            (result, method) = run(ROBUST)?;
        }
        let output = Output {
            path: path.clone(),
            overwrite: files::Overwrite { force: self.output.overwrite.force },
        };
        let smoothed = match result {
            Ok(smoothed) => smoothed,
            Err(error) => {
                return Err(match error.failure {
                    FlowFailure::InvalidOption { .. } | FlowFailure::Unsupported { .. } => {
                        Failure::usage(error.failure)
                    }
                    _ => {
                        if self.last_good && error.iteration > 1 {
                            files::write_moved(context, &output, &error.last_good, file.fields)?;
                        }
                        Failure::from(error)
                    }
                });
            }
        };
        let warns = self.parameters.get("unstable") == Some("warn");
        if let (true, Some(limit)) =
            (smoothed.report.unstable && warns, smoothed.report.stable_limit)
        {
            context.note(format_args!(
                "warning: the step is beyond the stable limit {}; some modes grew",
                number(limit)
            ));
        } else if smoothed.report.unstable && warns {
            context.note("warning: modes of the pass band grew by more than two");
        }
        if let Approach::Modes { count } = smoothed.report.approach {
            warn_of_split(context, smoothed.report.split, count, "--modes");
        }
        self.summarise(context, &method, &file.mesh, &smoothed)?;
        files::write_moved(context, &output, &smoothed.mesh, file.fields)
    }

    /// Refuses flags that the method does not have.
    fn check(&self) -> Result<(), Failure> {
        let algorithm = self.parameters.check(&self.method)?;
        match self.until {
            Some(_) if !takes_steps(algorithm) => {
                Err(foreign::<Flows>(&self.method, "until", takes_steps))
            }
            _ => Ok(()),
        }
    }

    /// The operator that is asked for, and the areas of its vertices.
    fn operator(&self) -> Result<(OperatorName, MassKind), Failure> {
        let name = self.parameters.get("operator").unwrap_or("auto");
        let operator = OperatorName::from_str(name, false).map_err(Failure::usage)?;
        let area = self.parameters.get("area").map(str::parse).transpose()?;
        Ok((operator, area.unwrap_or_default()))
    }

    /// Says what was done.
    fn summarise(
        &self,
        context: &Context,
        method: &Method,
        before: &TriMesh,
        smoothed: &Smoothed,
    ) -> Result<(), Failure> {
        let (report, after) = (&smoothed.report, &smoothed.mesh);
        let change = |old: f64, new: f64| (old != 0.0).then(|| 100.0 * (new / old - 1.0));
        // A flat closed mesh has no volume but rounding; a ball of its area has (area/π)^(3/2)/6 or less.
        let none = 1e-12 * libm::pow(before.area(), 1.5);
        let volume = match before.signed_volume() {
            old if before.topology().is_closed() && old.abs() > none => {
                change(old, after.signed_volume())
            }
            _ => None,
        };
        let area = change(before.area(), after.area());
        let farthest = before
            .positions()
            .iter()
            .zip(after.positions())
            .map(|(&p, &q)| fairing::mesh::vec3::distance(p, q))
            .fold(0.0, f64::max);
        if self.json {
            // As `fairing spectrum` calls them; null where no number of modes was kept.
            let gaps = match report.approach {
                Approach::Modes { count } => match report.split {
                    Some(split) => (Some(split.below), split.above),
                    None => (Some(count), Some(count)),
                },
                _ => (None, None),
            };
            let summary = json!({
                "gap_below": gaps.0,
                "gap_above": gaps.1,
                "method": method.name(),
                "iterations": report.iterations,
                "stopped": report.stopped,
                "stable_limit": report.stable_limit,
                "unstable": report.unstable,
                "degenerate_faces": report.degenerate_faces,
                "computed_by": approach(report.approach),
                "worst_residual": report.worst_residual,
                "volume_change_percent": volume,
                "area_change_percent": area,
                "largest_displacement": farthest,
            });
            return print(format_args!("{summary:#}\n"));
        }
        let mut table = Table::new();
        let percent = |x: Option<f64>| x.map_or("-".to_owned(), |x| format!("{} %", number(x)));
        table.row(["method".into(), method.name().into()]);
        table.row(["iterations".into(), report.iterations.to_string()]);
        table.row(["computed by".into(), approach(report.approach)]);
        if report.degenerate_faces > 0 {
            table.row(["degenerate faces".into(), report.degenerate_faces.to_string()]);
        }
        table.row(["largest displacement".into(), number(farthest)]);
        table.row(["volume".into(), percent(volume)]);
        table.row(["area".into(), percent(area)]);
        context.note(table.to_string().trim_end());
        Ok(())
    }
}

/// How the steps were computed, in words.
fn approach(approach: Approach) -> String {
    match approach {
        Approach::Stepping => "steps".into(),
        Approach::Series { degree } => format!("series of degree {degree}"),
        Approach::Resolvent { degree } => format!("series of degree {degree} in the resolvent"),
        Approach::ConjugateGradients { iterations } => {
            format!("conjugate gradients, {iterations} iterations")
        }
        Approach::Modes { count } => format!("{count} modes"),
        Approach::Cholesky { factorisations } => format!("Cholesky, {factorisations} factors"),
        other => format!("{other:?}"),
    }
}

/// The methods and what each is for.
fn list() -> Table {
    let mut table = Table::new();
    for algorithm in Method::algorithms() {
        table.row([format!("{}: {}", algorithm.name, algorithm.description)]);
    }
    table
}
