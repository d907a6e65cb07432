//! Verbs that describe: `info` and `compare`.

use anyhow::Result;
use fairing_evaluation::{ScoreOptions, Scores};
use fairing_mesh::Diagnosis;
use fairing_parameters::Options as _;
use serde_json::{Value, json};

use crate::answer::Answer;
use crate::meshes::{Meshes, names};
use crate::request::Request;
use crate::tasks::CompareOptions;

/// Counts, topology, defects and measures of `mesh`.
pub(crate) fn info(meshes: &mut Meshes, request: &Request<'_>) -> Result<Answer> {
    let held = meshes.held(request, "mesh")?;
    let mut value = serde_json::to_value(Diagnosis::new(&held.mesh))?;
    value["fields"] = json!(names(&held.fields));
    Ok(value.into())
}

/// Scores of `mesh` against `reference`.
pub(crate) fn compare(meshes: &mut Meshes, request: &Request<'_>) -> Result<Answer> {
    let options = CompareOptions::with("compare", &request.values()?)?.unwrap_or_default();
    let reference = meshes.held(request, "reference")?.mesh.clone();
    let mesh = meshes.held(request, "mesh")?.mesh.clone();
    let options = ScoreOptions {
        hausdorff_tolerance: options.hausdorff_tolerance,
        feature_angle: options.feature_angle,
    };
    let scores = Scores::new(&mesh, &reference, &options)?;
    let entries = scores.entries().into_iter().map(|score| {
        let (name, label, unit) = (score.name, score.label, score.unit.to_string());
        match score.value {
            Ok(value) => json!({ "name": name, "label": label, "unit": unit, "value": value }),
            Err(reason) => json!({ "name": name, "label": label, "unit": unit, "reason": reason }),
        }
    });
    let entries: Vec<Value> = entries.collect();
    Ok(json!({ "diagonal": scores.diagonal, "scores": entries }).into())
}
