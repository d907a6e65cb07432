//! `fairing compare`.

use std::path::{Path, PathBuf};

use clap::Args;
use fairing::evaluation::{ScoreOptions, Scores, SurfaceTree};
use fairing::mesh::TriMesh;
use fairing::mesh::io::VertexFields;
use fairing::task;
use serde_json::Value;

use super::context::{Context, Failure};
use super::files::{self, Content, OptionalOutput};
use super::inputs::{self, Jobs, Summary, output_for};
use super::surface::{Reading, say_orientation};

const EXAMPLES: &str = "\
Examples:
  fairing compare denoised.obj original.obj
  fairing compare a.ply b.ply --json
  fairing compare a.ply b.ply -o error.ply
  fairing render error.ply -o error.png --field distance --bar
  fairing compare denoised/*.ply 'truth/{stem}.ply' --table";

/// Score a mesh against a reference
///
/// Reports distances between the surfaces in both directions, exact in double
/// precision; angles between corresponding face normals; changes of volume, area and
/// edge length; flipped faces, self-intersections, and sharp edges lost and gained.
/// Scores that compare element by element need the same faces in both files;
/// otherwise they are missing, and the table gives the reason. Lengths are relative
/// to the diagonal of the reference's bounding box. The summary of --json has each score with its
/// value and unit, or the reason it is missing. With --output, writes the mesh with the vertex
/// properties distance, from the vertex to the surface of the reference in units of the file, and
/// closest, the nearest point of that surface.
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Compare {
    /// The mesh to score, or several
    #[arg(value_name = "MESH", required = true)]
    meshes: Vec<PathBuf>,
    /// The reference to compare with; {stem} in it is the name of each mesh without folder and
    /// extension
    reference: PathBuf,
    #[command(flatten)]
    reading: Reading,
    #[command(flatten)]
    output: OptionalOutput,
    #[command(flatten)]
    summary: Summary,
    #[command(flatten)]
    jobs: Jobs,
    /// Largest gap between the two bounds of the Hausdorff distance, in diagonals
    ///
    /// Values smaller than the rounding error of the coordinates are raised to that error. For
    /// surfaces a constant distance apart a very small gap may not be reached; the printed bounds
    /// show the gap achieved.
    #[arg(long, value_name = "FRACTION", default_value_t = ScoreOptions::default().hausdorff_tolerance)]
    hausdorff_tolerance: f64,
    /// Smallest dihedral angle of a sharp edge, in degrees
    #[arg(long, value_name = "DEGREES", default_value_t = ScoreOptions::default().feature_angle)]
    feature_angle: f64,
}

impl Compare {
    pub(crate) fn run(&self, context: &Context) -> Result<(), Failure> {
        self.output.check(&self.meshes)?;
        let meshes: Vec<&Path> = self.meshes.iter().map(PathBuf::as_path).collect();
        let columns =
            ["normal_mean", "distance_rms", "hausdorff_upper", "volume_drift", "flipped_faces"];
        let columns = columns.map(|name| format!("{name}.value"));
        let columns: Vec<&str> = columns.iter().map(String::as_str).collect();
        inputs::each(context, &meshes, &self.jobs, self.summary, &columns, |context, mesh| {
            self.one(context, mesh, &output_for(&self.reference, mesh))
        })
    }

    fn one(&self, context: &Context, mesh: &Path, reference: &Path) -> Result<Value, Failure> {
        let output = self.output.if_given(context, mesh, Content::Fields)?;
        let read = |path: &Path| {
            let (surface, fields) = self.reading.read_any(context, path)?;
            surface.say_seams(context, path);
            say_orientation(context, path, surface.mesh());
            Ok::<_, Failure>((surface, fields))
        };
        let ((mesh, fields), (reference, _)) = (read(mesh)?, read(reference)?);
        let options = ScoreOptions {
            hausdorff_tolerance: self.hausdorff_tolerance,
            feature_angle: self.feature_angle,
        };
        let scores = Scores::new(mesh.mesh(), reference.mesh(), &options)?;
        if let Some(output) = &output {
            let fields = with_closest(fields, &mesh.own, reference.mesh())?;
            files::write_held(context, output, &mesh.own, &fields)?;
        }
        if self.summary.is_wanted() {
            return Ok(mesh.add_to(task::compare(&scores)));
        }
        context.print(scores)?;
        Ok(Value::Null)
    }
}

/// The fields of a mesh, with the distances and the nearest points of the reference.
fn with_closest(
    fields: VertexFields,
    mesh: &TriMesh,
    reference: &TriMesh,
) -> Result<VertexFields, Failure> {
    let closest = SurfaceTree::new(reference)?.closest_to_all(mesh.positions());
    let distances = closest.iter().map(|closest| closest.distance).collect();
    let points = closest.iter().map(|closest| closest.point).collect();
    Ok(files::with_fields(fields, vec![("distance", distances)], vec![("closest", points)]))
}
