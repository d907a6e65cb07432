//! Verbs that describe: `info` and `compare`.

use anyhow::Result;
use fairing::task;
use fairing_evaluation::{ScoreOptions, Scores, drift, feature_edges, normal_error};
use fairing_mesh::{Diagnosis, TriMesh};
use fairing_operators::curvature::angle_defect;
use fairing_parameters::Options as _;
use fairing_smoothing::{Diffusion, largest_eigenvalue};
use serde_json::json;

use crate::answer::Answer;
use crate::meshes::{Meshes, names};
use crate::request::Request;
use crate::tasks::CompareOptions;

/// Counts, topology, defects and measures of `mesh`, and the sum of its angle defects; with
/// `roughest` also the largest eigenvalue of −L with uniform weights, null if there is none.
pub(crate) fn info(meshes: &mut Meshes, request: &Request<'_>) -> Result<Answer> {
    let held = meshes.held(request, "mesh")?;
    let mut value = serde_json::to_value(Diagnosis::new(&held.mesh))?;
    value["fields"] = json!(names(&held.fields));
    value["total_curvature"] = json!(angle_defect(&held.mesh).iter().sum::<f64>());
    if request.flag("roughest") {
        let roughest = largest_eigenvalue(&held.mesh, Diffusion::uniform(1.0));
        value["roughest_eigenvalue"] = json!(roughest.ok());
    }
    Ok(value.into())
}

/// Scores of `mesh` against `reference`; with `matching` only those that compare elements of the
/// same number: angles between normals, volume and sharp edges.
pub(crate) fn compare(meshes: &mut Meshes, request: &Request<'_>) -> Result<Answer> {
    let options = CompareOptions::with("compare", &request.values()?)?.unwrap_or_default();
    let reference = meshes.held(request, "reference")?.mesh.clone();
    let mesh = meshes.held(request, "mesh")?.mesh.clone();
    let options = ScoreOptions {
        hausdorff_tolerance: options.hausdorff_tolerance,
        feature_angle: options.feature_angle,
    };
    if request.flag("matching") {
        return matching(&mesh, &reference, options.feature_angle);
    }
    let scores = Scores::new(&mesh, &reference, &options)?;
    Ok(task::scores(&scores).into())
}

fn matching(mesh: &TriMesh, reference: &TriMesh, feature_angle: f64) -> Result<Answer> {
    let value = json!({
        "normal_mean": normal_error(mesh, reference)?.mean,
        "volume_drift": drift(mesh, reference).volume,
        "feature_f_score": feature_edges(mesh, reference, feature_angle)?.f_score(),
    });
    Ok(value.into())
}
