//! `fairing smooth`.

use std::ops::ControlFlow;
use std::path::PathBuf;

use clap::Args;
use fairing::mesh::TriMesh;
use fairing::smoothing::{Approach, FlowFailure, Method, Observer, Operator, Smoothed, Step};
use serde_json::json;

use super::exit::Failure;
use super::files::{self, Output};
use super::operator::OperatorName;
use super::spectrum::warn_of_split;
use super::table::{Table, number};
use super::{Context, print};

mod options;

use options::{Area, Border, Keep, Name, Soft, Unstable, Weights, When, WindowName};

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
    #[arg(long, value_enum, default_value = "taubin")]
    method: Name,
    /// The weights of the Laplacian; uniform unless said, for explicit, implicit and region
    #[arg(long, value_enum)]
    weights: Option<Weights>,
    /// The step: dimensionless, or in squared mean edge lengths for cotangents
    #[arg(long, value_name = "L", allow_negative_numbers = true)]
    lambda: Option<f64>,
    /// The step of cotangents in squared units of the file; the time of low-pass
    #[arg(long, value_name = "T", conflicts_with = "lambda", allow_negative_numbers = true)]
    time: Option<f64>,
    /// The number of steps; pairs of steps for taubin
    #[arg(long, value_name = "N")]
    iterations: Option<usize>,
    /// The areas of vertices for cotangents; barycentric unless said
    #[arg(long, value_enum)]
    area: Option<Area>,
    /// How cotangents are made; auto unless said
    #[arg(long, value_enum)]
    operator: Option<OperatorName>,
    /// What happens at the boundary of an open mesh; free unless said
    #[arg(long, value_enum)]
    boundary: Option<Border>,
    /// Vertices that stay, as numbers from 0 joined by commas
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pin: Vec<u32>,
    /// Vertices drawn to where they are, or to a point, joined by commas; a weight of 1
    /// ends a step half-way between the flow and the point
    #[arg(long, value_name = "V:W[:X:Y:Z]", value_delimiter = ',', allow_hyphen_values = true)]
    soft: Vec<Soft>,
    /// What happens to the volume of a closed mesh; it drifts unless said
    #[arg(long, value_enum)]
    volume: Option<Keep>,
    /// What happens to explicit steps beyond the stable limit, and to pairs of taubin that
    /// amplify a mode by more than two; refused unless said
    #[arg(long, value_enum)]
    unstable: Option<Unstable>,
    /// The growing step of taubin, below -lambda
    #[arg(long, value_name = "M", allow_negative_numbers = true)]
    mu: Option<f64>,
    /// taubin, windowed-sinc: modes with -eigenvalue below this are kept (0 to 2)
    #[arg(long, value_name = "K", conflicts_with = "mu")]
    pass_band: Option<f64>,
    /// windowed-sinc: the degree of the filter
    #[arg(long, value_name = "N")]
    degree: Option<usize>,
    /// windowed-sinc: the window
    #[arg(long, value_enum)]
    window: Option<WindowName>,
    /// hc: how much differences are taken to the input (0 to 1)
    #[arg(long, value_name = "A")]
    alpha: Option<f64>,
    /// hc: how much of its own difference a vertex is given back (0 to 1)
    #[arg(long, value_name = "B")]
    beta: Option<f64>,
    /// scale-dependent: the fraction of the largest stable step (0 to 1)
    #[arg(long, value_name = "F")]
    fraction: Option<f64>,
    /// low-pass: where a Butterworth filter halves, a wavelength in units of the file
    #[arg(long, value_name = "W", conflicts_with = "time")]
    cutoff: Option<f64>,
    /// low-pass: keep the K smoothest modes and nothing else
    #[arg(long, value_name = "K", conflicts_with_all = ["time", "cutoff"])]
    modes: Option<usize>,
    /// region: 1 soap film, 2 thin plate, 3 least variation of curvature; low-pass:
    /// how steeply a Butterworth filter falls
    #[arg(long, value_name = "K")]
    order: Option<u32>,
    /// region: the vertices to replace, as numbers from 0 joined by commas
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    vertices: Vec<u32>,
    /// implicit: when the operator is taken anew; never unless said
    #[arg(long, value_enum)]
    update: Option<When>,
    /// implicit, conformal: the relative residual of the linear systems
    #[arg(long, value_name = "R")]
    tolerance: Option<f64>,
    /// conformal: ends when no vertex moves by more than this, in roots of the area
    #[arg(long, value_name = "S")]
    settled: Option<f64>,
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
        let file = files::read(input)?;
        files::say_report(context, input, &file.report);
        let small = self.until.map(|until| until * file.mesh.mean_edge_length());
        let mut settle = |step: &Step<'_>| match small {
            Some(small) if step.largest_displacement() <= small => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        };
        let mut run = |operator| -> Result<_, Failure> {
            let method = self.method(&file.mesh, operator)?;
            let observer = small.map(|_| &mut settle as &mut Observer<'_>);
            Ok((method.run(&file.mesh, observer), method))
        };
        let name = self.operator.unwrap_or(OperatorName::Auto);
        let (mut result, mut method) = run(name.of_flow(self.area()))?;
        if let Err(error) = &result
            && let FlowFailure::Operator(thin) = &error.failure
            && error.iteration == 0
            && name.gives_way(context, thin, self.area().into())
        {
            (result, method) = run(Operator::Robust)?;
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
        let warns = matches!(self.unstable, Some(Unstable::Warn));
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
    for method in Method::defaults() {
        table.row([format!("{}: {}", method.name(), method.description())]);
    }
    table
}
