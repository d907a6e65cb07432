//! `fairing repair`.

use std::path::Path;

use clap::{Args, ValueEnum};
use fairing::mesh::{
    OpenHole, OpenReason, RepairError, RepairOptions, RepairStep, Repaired, Tolerance, TriMesh,
};
use fairing::smoothing::repair_fair;
use fairing::task::{self, Unit};
use serde_json::Value;

use super::context::{Context, Failure};
use super::files::{self, Content, OptionalOutput};
use super::inputs::{Inputs, Summary};
use super::noise::units;
use super::table::Table;

const EXAMPLES: &str = "\
Examples:
  fairing repair scan.stl -o clean.ply
  fairing repair scan.ply --dry-run
  fairing repair scan.ply -o closed.ply --components 100 --thin 0.002 --holes 50
  fairing repair scan.ply -o welded.ply --skip orient,split --tolerance 0.01
  fairing repair part.stl -o part.ply --tolerance 0.05 --unit model";

/// Mend a mesh: unmerged vertices, duplicate or flipped faces, non-manifold edges, holes
///
/// Without options no vertex moves by more than rounding. Merges vertices at the same place, and
/// boundary vertices that single precision does not distinguish; drops faces with the corners of an
/// earlier face; flips faces that disagree with their neighbours, and closed parts that are inside
/// out with all parts inside them; separates sheets that touch at an edge or a vertex; drops
/// isolated vertices. The other vertices keep their order and properties; the property source is
/// the vertex of the input, from 0, or -1 in the patch of a hole. A second run changes nothing,
/// except with --tolerance in mean edges or diagonals, which the first run may have changed.
///
/// The summary of --json lists the elements that each step changed, by their numbers in the input,
/// from 0. Its open_holes lists each hole that stays open, with the reason, and vertex_map the
/// vertex in the output for each vertex of the input, or null if it was dropped. The rows of
/// --table have counts.
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Repair {
    #[command(flatten)]
    inputs: Inputs,
    #[command(flatten)]
    output: OptionalOutput,
    /// Report what would change, and write nothing
    #[arg(long, conflicts_with_all = ["path", "force"])]
    dry_run: bool,
    /// Skip some steps
    #[arg(long, value_name = "STEP", value_delimiter = ',')]
    skip: Vec<Skip>,
    /// Merge vertices up to this distance; 0 merges equal positions only [default: four units in
    /// the last place of single precision, at boundaries, where no face collapses]
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    tolerance: Option<f64>,
    /// The unit of the tolerance
    #[arg(
        long,
        value_name = "UNIT",
        value_parser = units(),
        default_value = "edge",
        requires = "tolerance",
    )]
    unit: Unit,
    /// Drop components with fewer faces than this
    #[arg(long, value_name = "FACES", default_value_t = 0)]
    components: usize,
    /// Collapse needles and flip caps whose height is below this fraction of their longest edge,
    /// from 0 to 0.1; 0.002 removes what `fairing info` calls slivers
    #[arg(long, value_name = "RATIO", default_value_t = 0.0, allow_negative_numbers = true)]
    thin: f64,
    /// Fill holes of at most this many edges, at most 2000, so that the patch continues the
    /// surface around it; the boundary of an open surface counts as a hole, too
    #[arg(long, value_name = "EDGES", default_value_t = 0)]
    holes: usize,
    /// Flip closed parts inside others so that orientations alternate: a solid inside a solid
    /// becomes a cavity
    #[arg(long)]
    cavities: bool,
    #[command(flatten)]
    summary: Summary,
}

/// A step that changes no geometry.
#[derive(Debug, Clone, Copy, PartialEq, ValueEnum)]
enum Skip {
    /// Vertices at one place stay separate
    Merge,
    /// Faces with the same corners stay
    Duplicates,
    /// No face is flipped
    Orient,
    /// Non-manifold edges and vertices stay
    Split,
    /// Vertices without a face stay
    Isolated,
}

impl Repair {
    pub(crate) fn run(&self, context: &Context) -> Result<(), Failure> {
        self.output.check(&self.inputs.paths)?;
        if !self.dry_run && !self.output.is_given() {
            return Err(Failure::usage("give --output, or --dry-run to see what would change"));
        }
        let does = |step| !self.skip.contains(&step);
        let options = RepairOptions {
            merge: does(Skip::Merge),
            tolerance: self.tolerance.map_or(Tolerance::Rounding, |t| self.unit.tolerance(t)),
            duplicates: does(Skip::Duplicates),
            orient: does(Skip::Orient),
            cavities: self.cavities,
            split: does(Skip::Split),
            smallest_component: self.components,
            thin: self.thin,
            isolated: does(Skip::Isolated),
            holes: self.holes,
        };
        let columns = [
            "unchanged",
            "vertices",
            "faces",
            "merged-vertices",
            "duplicate-faces",
            "turned-faces",
            "split-vertices",
            "small-components",
            "isolated-vertices",
            "filled-holes",
            "open-holes",
        ];
        self.inputs.each(context, self.summary, &columns, |context, input| {
            self.one(context, input, &options)
        })
    }

    fn one(
        &self,
        context: &Context,
        input: &Path,
        options: &RepairOptions,
    ) -> Result<Value, Failure> {
        let output = self.output.if_given(context, input, Content::Mesh)?;
        let file = files::read(context, input)?;
        files::say_report(context, input, &file.report);
        let (repaired, flat) = repair_fair(&file.mesh, options).map_err(|error| match error {
            RepairError::Option(error) => Failure::usage(error),
            error => error.into(),
        })?;
        if let Some(error) = flat {
            context.note(format_args!("the patches of holes stay flat: {error}"));
        }
        if repaired.mesh.face_count() == 0 && file.mesh.face_count() > 0 {
            let small = match repaired.changed(RepairStep::SmallComponents) {
                [] => String::new(),
                small => format!(": --components drops {}", small.len()),
            };
            let input = input.display();
            let error =
                anyhow::anyhow!("{input}: no face would be left{small}; nothing is written");
            return Err(error.into());
        }
        let summary = match (self.summary.json, self.summary.table) {
            (true, _) => task::repair(&repaired),
            (_, Some(_)) => task::counts(&repaired),
            _ => {
                let text = as_table(&file.mesh, &repaired);
                if self.dry_run {
                    context.print(text)?;
                } else {
                    context.note(text.trim_end());
                }
                Value::Null
            }
        };
        let Some(output) = &output else { return Ok(summary) };
        let fields = repaired.carried(&file.mesh, file.fields);
        files::write_held(context, output, &repaired.mesh, &fields)?;
        Ok(summary)
    }
}

const WORDS: [(RepairStep, &str); 12] = [
    (RepairStep::MergedVertices, "vertices merged"),
    (RepairStep::MovedVertices, "vertices moved by merging"),
    (RepairStep::CollapsedFaces, "faces collapsed by merging"),
    (RepairStep::DuplicateFaces, "duplicate faces dropped"),
    (RepairStep::TurnedFaces, "faces flipped"),
    (RepairStep::SplitVertices, "vertices split"),
    (RepairStep::SmallComponents, "faces of small components dropped"),
    (RepairStep::ThinFaces, "thin faces mended"),
    (RepairStep::IsolatedVertices, "isolated vertices dropped"),
    (RepairStep::FilledHoles, "holes filled"),
    (RepairStep::TouchingVertices, "vertices that touch others without a common edge, kept apart"),
    (RepairStep::NestedParts, "closed parts within others, which --cavities would flip, kept"),
];

const REASONS: [(OpenReason, &str); 4] = [
    (OpenReason::TooLarge, "more edges than --holes"),
    (OpenReason::LoneFace, "the rim of a single face"),
    (OpenReason::NoPatch, "every patch would repeat an edge"),
    (OpenReason::PatchRemoved, "other steps would remove the patch"),
];

fn as_table(input: &TriMesh, repaired: &Repaired) -> String {
    let mut table = Table::new();
    for (step, words) in WORDS {
        if let elements @ [first, ..] = repaired.changed(step) {
            table.row([words.to_owned(), format!("{} (the first: {first})", elements.len())]);
        }
    }
    for (reason, words) in REASONS {
        let open = || repaired.open_holes.iter().filter(|hole| hole.reason == reason);
        if let Some(OpenHole { vertex, edges, .. }) = open().next() {
            let first = format!("{} (the first: {vertex}, {edges} edges)", open().count());
            table.row([format!("holes left open, {words}"), first]);
        }
    }
    let mesh = &repaired.mesh;
    if repaired.is_unchanged() {
        let nothing = if repaired.changes.is_empty() { "nothing to mend" } else { "no change" };
        return format!("{table}{nothing}\n");
    }
    table.row(["vertices".into(), format!("{} -> {}", input.vertex_count(), mesh.vertex_count())]);
    table.row(["faces".into(), format!("{} -> {}", input.face_count(), mesh.face_count())]);
    table.to_string()
}
