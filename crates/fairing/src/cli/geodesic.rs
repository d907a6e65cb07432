//! `fairing geodesic`.

use std::collections::HashMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};

use clap::Args;
use fairing::evaluation::SurfaceTree;
use fairing::mesh::io::Format;
use fairing::spectral::{HeatGeodesics, SurfacePoint, geodesic_path, isolines};
use fairing::task::{self, GeodesicLines};
use serde_json::Value;

use super::context::{Context, Failure};
use super::files::{self, Content, OptionalOutput};
use super::inputs::{Inputs, Summary, check_distinct, output_for};
use super::surface::{INPUT_FORMAT, Reading, Surface, formats};
use super::table::{Table, cell, number};

const EXAMPLES: &str = "\
Examples:
  fairing geodesic bunny.ply --from 0 -o distance.ply
  fairing geodesic bunny.ply --from 0.1:0.2:0.05 --path 1200 --lines path.obj
  fairing geodesic bunny.ply --from 0,99 --isolines 0.01 --lines rings.obj -o distance.ply
  fairing render distance.ply -o distance.png --field distance";

/// The most isolines of a mesh.
const MAX_ISOLINES: f64 = 10_000.0;

/// Measure distances along the surface, trace descent paths and draw isolines
///
/// Computes the distance to the nearest source by the heat method; the error is proportional to the
/// edge length. With --output, writes the vertex property distance, in units of the file; the
/// property defined is 0 at vertices that no source can reach (the distance there is 0 and
/// meaningless). A path follows the steepest descent of the distance; it is close to the shortest
/// path, not exactly the shortest.
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Geodesic {
    #[command(flatten)]
    inputs: Inputs,
    #[command(flatten)]
    reading: Reading,
    #[command(flatten)]
    output: OptionalOutput,
    /// Sources: vertex indices from 0, or points X:Y:Z, each projected to the nearest point of the
    /// surface
    #[arg(
        long,
        value_name = "V,V...|X:Y:Z",
        required = true,
        value_delimiter = ',',
        allow_hyphen_values = true,
        value_parser = source,
    )]
    from: Vec<Source>,
    /// Format of the standard input (file name -); --from of the other verbs
    #[arg(id = INPUT_FORMAT, long = "input-format", value_name = "NAME", value_parser = formats())]
    input_format: Option<Format>,
    /// Trace the path of steepest descent from these vertices to the nearest source, and print its
    /// length
    #[arg(long = "path", value_name = "V,V...", value_delimiter = ',')]
    starts: Vec<u32>,
    /// Draw the lines of equal distance at the multiples of D, in units of the file
    #[arg(long, value_name = "D", requires = "lines", allow_negative_numbers = true)]
    isolines: Option<f64>,
    /// Write paths and isolines to this .obj file as polylines; with several inputs, {stem} stands
    /// for the name of each
    #[arg(long, value_name = "FILE")]
    lines: Option<PathBuf>,
    #[command(flatten)]
    summary: Summary,
}

/// A source of distance.
#[derive(Clone, Copy)]
enum Source {
    Vertex(u32),
    Point([f64; 3]),
}

/// Reads `V` or `X:Y:Z`.
fn source(text: &str) -> Result<Source, String> {
    if let Ok(vertex) = text.trim().parse() {
        return Ok(Source::Vertex(vertex));
    }
    let numbers: Result<Vec<f64>, _> = text.split(':').map(|x| x.trim().parse()).collect();
    let point: Option<[f64; 3]> = numbers.ok().and_then(|numbers| numbers.try_into().ok());
    match point {
        Some(point) if point.iter().all(|x| x.is_finite()) => Ok(Source::Point(point)),
        _ => Err("must be a vertex, from 0, or a point X:Y:Z".to_owned()),
    }
}

impl Geodesic {
    pub(crate) fn run(&self, context: &Context) -> Result<(), Failure> {
        if self.output.is_given() || self.lines.is_none() {
            self.output.check(&self.inputs.paths)?;
        }
        check_distinct(self.lines.as_deref(), &self.inputs.paths)?;
        if self.lines.is_some() && self.starts.is_empty() && self.isolines.is_none() {
            return Err(Failure::usage("--lines needs --path or --isolines"));
        }
        if let Some(spacing) = self.isolines.filter(|d| !(*d > 0.0 && d.is_finite())) {
            return Err(Failure::usage(format_args!("--isolines {spacing} must be above zero")));
        }
        let columns = ["vertices", "unreached", "farthest.vertex", "farthest.distance"];
        self.inputs.each(context, self.summary, &columns, |context, input| self.one(context, input))
    }

    fn one(&self, context: &Context, input: &Path) -> Result<Value, Failure> {
        let output = self.output.if_given(context, input, Content::Fields)?;
        let lines_file = self.lines.as_deref().map(|pattern| output_for(pattern, input));
        if let Some(path) = &lines_file {
            self.output.overwrite.check(context, path, Content::Lines)?;
        }
        let (surface, fields) = self.reading.read(context, input)?;
        let mesh = surface.mesh();
        let sources = self.sources(&surface)?;
        let distance = HeatGeodesics::new(mesh)?.distance_from(&sources)?;
        let lines = self.lines_of(&surface, &sources, &distance)?;
        if let Some(path) = &lines_file {
            files::write_bytes(path, obj(&lines).as_bytes())?;
        }
        if let Some(output) = &output {
            let values = surface.spread(distance.iter().map(|d| d.unwrap_or(0.0)).collect());
            let defined: Vec<f64> =
                distance.iter().map(|d| f64::from(u8::from(d.is_some()))).collect();
            let own = vec![("distance", values), ("defined", surface.spread(defined))];
            let fields = files::with_fields(fields, own, vec![]);
            files::write_held(context, output, &surface.own, &fields)?;
        }
        self.say(context, &surface, &sources, &lines);
        let summary = task::geodesic(mesh, &sources, &distance, &lines, |v| surface.in_file(v));
        if self.summary.is_wanted() {
            return Ok(surface.add_to(summary));
        }
        context.print(table(&summary))?;
        Ok(Value::Null)
    }

    /// The sources on the mesh.
    fn sources(&self, surface: &Surface) -> Result<Vec<SurfacePoint>, Failure> {
        let mesh = surface.mesh();
        let needs_tree = self.from.iter().any(|source| matches!(source, Source::Point(_)));
        let tree = if needs_tree { Some(SurfaceTree::new(mesh)?) } else { None };
        let place = |source: &Source| match (*source, &tree) {
            (Source::Point(point), Some(tree)) => {
                let closest = tree.closest(point);
                Ok(SurfacePoint::projected(mesh, closest.face, closest.point)?)
            }
            (Source::Vertex(v), _) => Ok(SurfacePoint::vertex(surface.number(v))),
            (Source::Point(_), None) => Err(Failure::usage("a point needs faces")),
        };
        self.from.iter().map(place).collect()
    }

    fn lines_of(
        &self,
        surface: &Surface,
        sources: &[SurfacePoint],
        distance: &[Option<f64>],
    ) -> Result<GeodesicLines, Failure> {
        let mesh = surface.mesh();
        let trace = |&v: &u32| {
            let path = geodesic_path(mesh, distance, sources, surface.number(v));
            Ok((v, path?))
        };
        let paths: Result<_, Failure> = self.starts.iter().map(trace).collect();
        let mut rings = vec![];
        if let Some(spacing) = self.isolines {
            let count = (task::farthest(distance).map_or(0.0, |(_, d)| d) / spacing).floor();
            if count > MAX_ISOLINES {
                return Err(Failure::usage(format_args!(
                    "--isolines {spacing} would draw {count} isolines, more than {MAX_ISOLINES}"
                )));
            }
            for k in 1..=count as u32 {
                let level = f64::from(k) * spacing;
                rings.push((level, isolines(mesh, distance, level)?));
            }
        }
        Ok(GeodesicLines { paths: paths?, isolines: rings })
    }

    /// Notes how far points are from the surface, and paths that end away from a source.
    fn say(
        &self,
        context: &Context,
        surface: &Surface,
        sources: &[SurfacePoint],
        lines: &GeodesicLines,
    ) {
        let mesh = surface.mesh();
        for (source, point) in self.from.iter().zip(sources) {
            if let Source::Point(wanted) = source {
                let away = length(&[*wanted, point.position(mesh)]);
                if away > mesh.mean_edge_length() {
                    let [x, y, z] = wanted.map(number);
                    context.note(format_args!("{x}:{y}:{z} is {} off the surface", number(away)));
                }
            }
        }
        for (start, path) in &lines.paths {
            if let Some(end) = path.end
                && !sources.contains(&SurfacePoint::vertex(end))
            {
                context.note(format_args!(
                    "warning: the path from {start} ends at vertex {}, which is not a source: the \
                     distance has a minimum there",
                    surface.in_file(end)
                ));
            }
        }
    }
}

fn length(points: &[[f64; 3]]) -> f64 {
    let steps = points.windows(2).map(|pair| {
        let square: f64 = (0..3).map(|k| (pair[0][k] - pair[1][k]).powi(2)).sum();
        square.sqrt()
    });
    steps.sum()
}

fn table(summary: &Value) -> Table {
    let mut table = Table::new();
    table.row(["vertices".into(), cell(&summary["vertices"])]);
    table.row(["unreached".into(), cell(&summary["unreached"])]);
    table.row(["largest distance".into(), cell(&summary["farthest"]["distance"])]);
    table.row(["at vertex".into(), cell(&summary["farthest"]["vertex"])]);
    for path in summary["paths"].as_array().into_iter().flatten() {
        table.row([format!("path from {}", path["from"]), cell(&path["length"])]);
    }
    for line in summary["isolines"].as_array().into_iter().flatten() {
        table.row([format!("isoline {}", cell(&line["distance"])), cell(&line["length"])]);
    }
    table
}

/// Paths and isolines as the polylines of an OBJ file; points in the same place are one vertex.
fn obj(lines: &GeodesicLines) -> String {
    let (mut vertices, mut elements) = (String::new(), String::new());
    let mut numbers: HashMap<[u64; 3], usize> = HashMap::new();
    let mut line = |points: &[[f64; 3]]| {
        let _ = write!(elements, "l");
        for point in points {
            let next = numbers.len() + 1;
            let at = *numbers.entry(point.map(|x| (x + 0.0).to_bits())).or_insert_with(|| {
                let [x, y, z] = point;
                let _ = writeln!(vertices, "v {x} {y} {z}");
                next
            });
            let _ = write!(elements, " {at}");
        }
        elements.push('\n');
    };
    lines.paths.iter().for_each(|(_, path)| line(&path.points));
    for isoline in lines.isolines.iter().flat_map(|(_, pieces)| pieces) {
        let back = isoline.closed.then(|| isoline.points[0]);
        line(&isoline.points.iter().copied().chain(back).collect::<Vec<_>>());
    }
    vertices + &elements
}
