//! Describing a mesh and its file.

use fairing_mesh::Diagnosis;
use fairing_mesh::io::ReadReport;
use serde_json::{Map, Value, json};

use super::object;

/// The entries of a [`Diagnosis`], with the number of elements instead of each tally.
pub fn diagnosis(diagnosis: &Diagnosis) -> Map<String, Value> {
    let Ok(Value::Object(mut entries)) = serde_json::to_value(diagnosis) else {
        return Map::new();
    };
    for value in entries.values_mut() {
        if let Some(count) = value.get("count") {
            *value = count.clone();
        }
    }
    // Behind the other counts of vertices.
    if let Some(rounded) = entries.shift_remove("rounded_vertices")
        && let Some(place) = entries.keys().position(|name| name == "bounding_box")
    {
        entries.shift_insert(place, "rounded_vertices".to_owned(), rounded);
    }
    entries
}

/// The report of a file that was read; [`ReadReport`] explains the entries.
pub fn file(report: &ReadReport) -> Value {
    object(entries(report))
}

/// The same with the `format` and, as `text`, a few lines about the file.
pub fn read(report: &ReadReport) -> Value {
    let format = [("format", json!(report.format))].into_iter();
    object(format.chain(entries(report)).chain([("text", json!(report.to_string()))]))
}

fn entries(report: &ReadReport) -> [(&'static str, Value); 8] {
    [
        ("compressed", report.compressed.into()),
        ("faces", report.file_faces.into()),
        ("polygons", report.polygons.into()),
        ("reduced_faces", report.reduced.into()),
        ("left_out_faces", report.left_out.into()),
        ("broken_vertices", report.broken_vertices.into()),
        ("broken_faces", report.broken_faces.into()),
        ("notes", json!(report.notes)),
    ]
}
