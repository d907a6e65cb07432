//! `fairing compare`.

use std::path::{Path, PathBuf};

use clap::Args;
use fairing::evaluation::{ScoreOptions, Scores};
use serde_json::{Map, Value, json};

use super::context::{Context, Failure};
use super::surface::{Reading, say_orientation};

const EXAMPLES: &str = "\
Examples:
  fairing compare denoised.obj original.obj
  fairing compare a.ply b.ply --json";

/// Score a mesh against a reference
///
/// Reports distances between the surfaces in both directions, exact in double
/// precision; angles between corresponding face normals; changes of volume, area and
/// edge length; flipped faces, self-intersections, and sharp edges lost and gained.
/// Scores that compare element by element need the same faces in both files;
/// otherwise they are missing, and the table gives the reason. Lengths are relative
/// to the diagonal of the reference's bounding box.
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Compare {
    /// The mesh to score
    mesh: PathBuf,
    /// The reference to compare it with
    reference: PathBuf,
    #[command(flatten)]
    reading: Reading,
    /// Print one JSON object: each score with its value and unit, or the reason it is missing
    #[arg(long)]
    json: bool,
    /// Largest gap between the two bounds of the Hausdorff distance, in diagonals
    ///
    /// Values below the rounding of the coordinates are raised to it. Between surfaces at a
    /// constant distance, very small gaps are not reached; the printed bounds show it.
    #[arg(long, value_name = "SHARE", default_value_t = ScoreOptions::default().hausdorff_tolerance)]
    hausdorff_tolerance: f64,
    /// Smallest dihedral angle of a sharp edge, in degrees
    #[arg(long, value_name = "DEGREES", default_value_t = ScoreOptions::default().feature_angle)]
    feature_angle: f64,
}

impl Compare {
    pub(crate) fn run(&self, context: &Context) -> Result<(), Failure> {
        let read = |path: &Path| {
            let (surface, _) = self.reading.read_any(context, path)?;
            surface.say_seams(context, path);
            say_orientation(context, path, surface.mesh());
            Ok::<_, Failure>(surface)
        };
        let (mesh, reference) = (read(&self.mesh)?, read(&self.reference)?);
        let options = ScoreOptions {
            hausdorff_tolerance: self.hausdorff_tolerance,
            feature_angle: self.feature_angle,
        };
        let scores = Scores::new(mesh.mesh(), reference.mesh(), &options)?;
        match self.json {
            true => {
                let mut summary = as_json(&scores);
                mesh.add_to(&mut summary);
                context.print(format_args!("{summary:#}\n"))
            }
            false => context.print(scores),
        }
    }
}

fn as_json(scores: &Scores) -> Value {
    let entries = scores.entries().into_iter().map(|score| {
        let entry = match score.value {
            Ok(value) => json!({ "value": value, "unit": score.unit.to_string() }),
            Err(reason) => json!({ "value": null, "reason": reason }),
        };
        (score.name.to_owned(), entry)
    });
    let mut object = Map::from_iter([("diagonal".to_owned(), json!(scores.diagonal))]);
    object.extend(entries);
    Value::Object(object)
}
