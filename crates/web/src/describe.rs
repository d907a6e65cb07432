//! Verbs that describe: `info` and `compare`.

use anyhow::Result;
use fairing::task;
use fairing_evaluation::{ScoreOptions, Scores};
use fairing_mesh::Diagnosis;
use fairing_operators::curvature::angle_defect;
use fairing_parameters::Options as _;
use fairing_smoothing::{Diffusion, largest_eigenvalue};

use crate::answer::Answer;
use crate::meshes::{Meshes, names};
use crate::request::Request;
use crate::tasks::CompareOptions;

/// Counts, topology, defects and measures of `mesh`, and the sum of its angle defects; with
/// `roughest` also the largest eigenvalue of −L with uniform weights, null if there is none.
pub(crate) fn info(meshes: &mut Meshes, request: &Request<'_>) -> Result<Answer> {
    let held = meshes.held(request, "mesh")?;
    let mut value = serde_json::to_value(Diagnosis::new(&held.mesh))?;
    value["fields"] = names(&held.fields).into();
    value["total_curvature"] = angle_defect(&held.mesh).iter().sum::<f64>().into();
    if request.flag("roughest") {
        let roughest = largest_eigenvalue(&held.mesh, Diffusion::uniform(1.0));
        value["roughest_eigenvalue"] = roughest.ok().into();
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
        return Ok(task::matching_scores(&mesh, &reference, options.feature_angle)?.into());
    }
    let scores = Scores::new(&mesh, &reference, &options)?;
    Ok(task::scores(&scores).into())
}
