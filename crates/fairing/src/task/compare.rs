//! Scoring a mesh against a reference.

use fairing_evaluation::{EvaluationError, Scores, drift, feature_edges, normal_error};
use fairing_mesh::TriMesh;
use serde_json::{Value, json};

use super::object;

/// Scores by name, each with its value and unit, or with the reason for its absence; and the
/// diagonal of the reference.
pub fn compare(scores: &Scores) -> Value {
    let entries = scores.entries().into_iter().map(|score| {
        let entry = match score.value {
            Ok(value) => json!({ "value": value, "unit": score.unit.to_string() }),
            Err(reason) => json!({ "value": null, "reason": reason }),
        };
        (score.name, entry)
    });
    object([("diagonal", json!(scores.diagonal))].into_iter().chain(entries))
}

/// The same as a list of `scores`, each with its name, label and unit.
pub fn scores(scores: &Scores) -> Value {
    let entries = scores.entries().into_iter().map(|score| {
        let (name, label, unit) = (score.name, score.label, score.unit.to_string());
        match score.value {
            Ok(value) => json!({ "name": name, "label": label, "unit": unit, "value": value }),
            Err(reason) => json!({ "name": name, "label": label, "unit": unit, "reason": reason }),
        }
    });
    json!({ "diagonal": scores.diagonal, "scores": entries.collect::<Vec<_>>() })
}

/// The scores that compare elements of the same number: the mean angle between normals, the drift
/// of the volume, and the F score of edges sharper than `feature_angle` degrees.
///
/// # Errors
///
/// [`EvaluationError`] if the meshes do not correspond.
pub fn matching_scores(
    mesh: &TriMesh,
    reference: &TriMesh,
    feature_angle: f64,
) -> Result<Value, EvaluationError> {
    Ok(json!({
        "normal_mean": normal_error(mesh, reference)?.mean,
        "volume_drift": drift(mesh, reference).volume,
        "feature_f_score": feature_edges(mesh, reference, feature_angle)?.f_score(),
    }))
}
