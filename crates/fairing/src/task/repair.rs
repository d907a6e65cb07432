//! Mending a mesh.

use fairing_mesh::{OpenHole, RepairStep, Repaired};
use serde_json::{Value, json};

use super::object;

/// The report of a repair: the elements that each step changed, by their numbers in the input, the
/// holes that are left, and for each vertex of the input its vertex in the result, or null.
pub fn repair(repaired: &Repaired) -> Value {
    let holes = repaired.open_holes.iter();
    let holes = holes.map(|&OpenHole { vertex, edges, reason, .. }| {
        json!({ "vertex": vertex, "edges": edges, "reason": reason.name() })
    });
    let changes = repaired.changes.iter();
    json!({
        "unchanged": repaired.is_unchanged(),
        "vertices": repaired.mesh.vertex_count(),
        "faces": repaired.mesh.face_count(),
        "changes": object(changes.map(|(step, elements)| (step.name(), json!(elements)))),
        "open_holes": holes.collect::<Vec<_>>(),
        "vertex_map": repaired.vertices,
    })
}

/// The numbers of vertices and faces of a repaired mesh, and of elements that each step changed.
pub fn counts(repaired: &Repaired) -> Value {
    let totals = [
        ("unchanged", repaired.is_unchanged().into()),
        ("vertices", repaired.mesh.vertex_count().into()),
        ("faces", repaired.mesh.face_count().into()),
    ];
    let steps = RepairStep::ALL.map(|step| (step.name(), repaired.changed(step).len().into()));
    object::<_, Value>(totals.into_iter().chain(steps))
}
