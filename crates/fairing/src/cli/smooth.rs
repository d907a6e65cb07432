//! `fairing smooth`.

use std::ops::ControlFlow;
use std::path::Path;

use clap::Args;
use fairing::mesh::TriMesh;
use fairing::parameters::{self, Algorithm};
use fairing::smoothing::{Approach, FlowError, FlowFailure, Method, Observer, Report, Step};
use fairing::task;
use serde_json::Value;

use super::context::{Context, Failure};
use super::files::{self, Content, Output};
use super::inputs::{Inputs, Summary};
use super::mask::{Mask, keep_others};
use super::operator::say_too_thin;
use super::parameters::{Parameters, foreign, list, names};
use super::spectrum::warn_of_split;
use super::surface::{Reading, Surface, say_orientation};
use super::table::{Table, cell, number};

const HELP: &str = "\
Choosing a method
  Remove noise, keep the size       taubin (the default), windowed-sinc or hc, on finely
                                    meshed shapes; coarse shapes and borders shrink
  Strong noise, smooth shape        explicit, which loses volume, or low-pass --modes K
  Very smooth, in few steps         implicit --lambda 50 --iterations 3
  A physical amount of smoothing    low-pass --time T: exact heat diffusion, or --cutoff W
  The smoothest modes alone         low-pass --modes K
  Triangles of very uneven size     implicit --weights cotangent, or scale-dependent
  Even out the triangles as well    implicit --weights uniform
  Turn a closed blob into a sphere  conformal
  Repair a dent or a filled hole    region --vertices LIST --order 2
  Keep sharp edges                  none of these: use fairing denoise
  Zero-area faces, non-manifold     any; --operator robust has no negative weights and is
  edges, triangle soups             the default if a face is too thin for cotangents

With uniform weights, --lambda is the fraction of the distance to the mean of the
neighbours that a vertex moves in a step. Explicit steps are stable up to 4/3 (8/7 with a
boundary), implicit steps always. With cotangents, --lambda is a diffusion time in squared
mean edge lengths, and explicit steps are stable up to about 0.27 on regular meshes; --time
gives it in squared units of the file. n implicit steps of L smooth about as much as one
of n L.

--pin fixes vertices, --where fixes all vertices that a property of the file does not
select, and --boundary sliding lets border vertices move along the border only. --soft
12:1,40:10:0:0:5 draws vertex 12 to its input position as strongly as the flow moves it,
and vertex 40 to (0, 0, 5) ten times as strongly.

Examples:
  fairing smooth scan.ply -o smooth.ply
  fairing smooth scan.ply -o smooth.ply --method implicit --lambda 5 --volume rescale
  fairing smooth patch.obj -o flat.obj --method explicit --lambda 0.5 --boundary pinned
  fairing smooth noisy.off -o smooth.off --method low-pass --modes 100";

/// Smooth a mesh by a flow, by a filter or by fairing a region
///
/// Moves the vertices and keeps the faces, including polygons and materials of the file. Vertex
/// properties are kept, except normals, which do not fit the moved vertices. The list below the
/// options helps to choose a method.
#[derive(Args)]
#[command(after_help = HELP)]
pub(crate) struct Smooth {
    #[command(flatten)]
    inputs: Inputs,
    #[command(flatten)]
    reading: Reading,
    #[command(flatten)]
    output: Output,
    #[command(flatten)]
    mask: Mask,
    /// Method; --list describes each
    #[arg(long, value_parser = names::<Method>(), default_value = "taubin")]
    method: String,
    #[command(flatten)]
    parameters: Parameters<Method>,
    /// Stop when no vertex moves by more than this in a step, in mean edge lengths (methods that
    /// take steps)
    #[arg(long, value_name = "S")]
    until: Option<f64>,
    /// If a step after the first fails, write the mesh before it, and still exit with an error
    #[arg(long)]
    last_good: bool,
    #[command(flatten)]
    summary: Summary,
    /// List the methods, their uses and their parameters
    #[arg(long, exclusive = true)]
    list: bool,
}

/// Returns true for methods that take steps: `--until` and `--last-good` need them.
fn takes_steps(algorithm: &Algorithm) -> bool {
    algorithm.parameter("iterations").is_some()
}

impl Smooth {
    pub(crate) fn run(&self, context: &Context) -> Result<(), Failure> {
        if self.list {
            return context.print(list::<Method>());
        }
        self.output.check(&self.inputs.paths)?;
        self.check()?;
        let columns = [
            "method",
            "iterations",
            "largest_displacement",
            "volume_change_percent",
            "area_change_percent",
        ];
        self.inputs.each(context, self.summary, &columns, |context, input| self.one(context, input))
    }

    fn one(&self, context: &Context, input: &Path) -> Result<Value, Failure> {
        let output = self.output.of(context, input, Content::Mesh)?;
        let (surface, fields) = self.reading.read(context, input)?;
        let mesh = surface.mesh();
        say_orientation(context, input, mesh);
        let selected = self.mask.of(context, input, &surface, &fields)?;
        let method = self.method_on(&surface, selected.as_deref())?;
        let small = self.until.map(|until| until * mesh.mean_edge_length());
        let mut settle = |step: &Step<'_>| match small {
            Some(small) if step.largest_displacement() <= small => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        };
        let observer = small.map(|_| &mut settle as &mut Observer<'_>);
        let write =
            |moved: TriMesh| files::write_moved(context, &output, &surface.own(moved)?, fields);
        let mut smoothed = match method.run(mesh, observer) {
            Ok(smoothed) => smoothed,
            Err(FlowError {
                failure: failure @ (FlowFailure::Option(_) | FlowFailure::Unsupported { .. }),
                ..
            }) => return Err(Failure::usage(failure)),
            Err(error) => {
                if self.last_good && error.iteration > 1 {
                    let last_good = TriMesh::clone(&error.last_good);
                    write(keep_others(mesh, last_good, selected.as_deref())?)?;
                }
                return Err(Failure::from(error));
            }
        };
        smoothed.mesh = keep_others(mesh, smoothed.mesh, selected.as_deref())?;
        self.say(context, &smoothed.report);
        let mut report = task::smooth(&method, mesh, &smoothed);
        if self.summary.is_wanted() {
            report = surface.add_to(report);
        } else {
            context.note(table(&report).to_string().trim_end());
            report = Value::Null;
        }
        Ok(files::with_split(report, &write(smoothed.mesh)?))
    }

    /// The method with its parameters; vertices in them are numbered as in the file. Vertices that
    /// are not selected are pinned, if the method has pins, and are outside the region of one that
    /// replaces a region.
    fn method_on(&self, surface: &Surface, selected: Option<&[bool]>) -> Result<Method, Failure> {
        let algorithm = self.algorithm()?;
        let given = self.parameters.given().iter();
        let mut values: Vec<(&str, parameters::Value)> =
            given.map(|(name, value)| (*name, surface.renumbered(value))).collect();
        // A projection on modes has none.
        let pins = algorithm.parameter("pin").is_some() && self.parameters.get("modes").is_none();
        if let Some(selected) = selected.filter(|_| pins) {
            let others = (0..).zip(selected).filter(|(_, selected)| !**selected);
            let mut pins = parameters::Value::Vertices(others.map(|(v, _)| v).collect());
            if let Some(i) = values.iter().position(|(name, _)| *name == "pin") {
                pins = values.swap_remove(i).1.and(pins);
            }
            values.push(("pin", pins));
        }
        let others = selected.filter(|_| algorithm.parameter("vertices").is_some());
        if let Some(selected) = others {
            let is_selected = |v: &u32| selected.get(*v as usize).is_none_or(|selected| *selected);
            match values.iter_mut().find(|(name, _)| *name == "vertices") {
                Some((_, parameters::Value::Vertices(region))) => region.retain(is_selected),
                Some(_) => {}
                None => {
                    let region = (0..selected.len() as u32).filter(is_selected).collect();
                    values.push(("vertices", parameters::Value::Vertices(region)));
                }
            }
        }
        Method::with(&self.method, &values).map_err(Failure::usage)
    }

    /// Notes an automatic choice of operator, an unstable step and a split cluster.
    fn say(&self, context: &Context, report: &Report) {
        if let Some(face) = report.too_thin {
            say_too_thin(context, face);
        }
        if report.unstable && self.parameters.get("unstable") == Some(&"warn".into()) {
            match report.stable_limit {
                Some(limit) => context.note(format_args!(
                    "warning: the step is beyond the stable limit {}; some modes grew",
                    number(limit)
                )),
                None => context.note("warning: modes of the pass band grew by more than two"),
            }
        }
        if let Approach::Modes { count } = report.approach {
            warn_of_split(context, report.split, count, "--modes");
        }
    }

    /// The method; `--where` may stand for the vertices of a region.
    fn algorithm(&self) -> Result<Algorithm, Failure> {
        let region = self.mask.is_given().then_some("vertices");
        self.parameters.check_but(&self.method, region)
    }

    /// Refuses flags that do not belong to the method.
    fn check(&self) -> Result<(), Failure> {
        let algorithm = self.algorithm()?;
        let of_steps = [(self.until.is_some(), "until"), (self.last_good, "last-good")];
        match of_steps.into_iter().find(|(given, _)| *given && !takes_steps(&algorithm)) {
            Some((_, flag)) => Err(foreign::<Method>(&self.method, flag, takes_steps)),
            None => Ok(()),
        }
    }
}

/// The main entries of a report as a table.
fn table(report: &Value) -> Table {
    let rows = [
        ("method", "method", ""),
        ("iterations", "iterations", ""),
        ("computed by", "computed_by", ""),
        ("degenerate faces", "degenerate_faces", ""),
        ("largest displacement", "largest_displacement", ""),
        ("volume", "volume_change_percent", " %"),
        ("area", "area_change_percent", " %"),
    ];
    let mut table = Table::new();
    for (label, entry, unit) in rows {
        let value = &report[entry];
        let unit = if value.is_null() { "" } else { unit };
        if entry != "degenerate_faces" || *value != 0 {
            table.row([label.into(), cell(value) + unit]);
        }
    }
    table
}
