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
/// Distances between the surfaces, both ways, exact in double precision; angles
/// between matching face normals; drift of volume, area and edge length; flipped
/// faces, self-intersections, sharp edges lost and gained. Scores that compare
/// element by element need the same faces in both files; where the faces differ
/// they are absent, and the table says why. Lengths are shares of the diagonal of
/// the reference's bounding box.
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Compare {
    /// The mesh to score
    mesh: PathBuf,
    /// The mesh to compare it with
    reference: PathBuf,
    #[command(flatten)]
    reading: Reading,
    /// Print one JSON object: each score with value and unit, or the reason why there is none
    #[arg(long)]
    json: bool,
    /// How far apart the two bounds of the Hausdorff distance may be, in diagonals
    ///
    /// Values below the rounding of the coordinates are taken as that; where surfaces run
    /// at a constant distance, very small ones are not reached, and the bounds say so.
    #[arg(long, value_name = "SHARE", default_value_t = ScoreOptions::default().hausdorff_tolerance)]
    hausdorff_tolerance: f64,
    /// The dihedral angle from which an edge counts as sharp, in degrees
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
