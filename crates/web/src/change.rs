//! Verbs that make a mesh of another one: `smooth`, `denoise`, `noise`, `reconstruct`, `repair`.

use std::sync::Arc;

use anyhow::{Result, bail};
use fairing::task;
use fairing_denoising::{Denoiser, automatic};
use fairing_evaluation::add_noise;
use fairing_mesh::io::VertexFields;
use fairing_mesh::{RepairOptions, Tolerance, TriMesh};
use fairing_parameters::Options as _;
use fairing_smoothing::{Method, repair_fair};
use fairing_spectral as spectral;
use serde_json::{Map, Value, json};

use crate::answer::Answer;
use crate::meshes::{Held, Meshes};
use crate::parts::{Computed, is_computed};
use crate::request::Request;
use crate::tasks::{NoiseOptions, RepairTask, SpectrumTask};
use crate::values;

/// The flow `method` on `mesh`.
pub(crate) fn smooth(meshes: &mut Meshes, request: &Request<'_>) -> Result<Answer> {
    let method = Method::with(request.text_or("method", "taubin"), &request.values()?)?;
    let mesh = meshes.held(request, "mesh")?.surface()?;
    let smoothed = method.run(&mesh, None)?;
    let report = serde_json::to_value(&smoothed.report)?;
    moved(meshes, request, smoothed.mesh, report)
}

/// The denoiser `method` on `mesh`.
pub(crate) fn denoise(meshes: &mut Meshes, request: &Request<'_>) -> Result<Answer> {
    let denoiser = Denoiser::with(request.text_or("method", "automatic"), &request.values()?)?;
    let mesh = meshes.held(request, "mesh")?.surface()?;
    let Denoiser::Automatic(options) = denoiser else {
        return moved(meshes, request, denoiser.denoise(&*mesh)?, Value::Null);
    };
    let found = automatic(&*mesh, &options)?;
    let mut report = task::denoise(&found);
    // A page gets the whole estimate, and no statistics of the surface.
    report["noise"] = serde_json::to_value(found.noise)?;
    if let Some(entries) = report.as_object_mut() {
        entries.retain(|name, _| !["area_fraction", "border_vertices"].contains(&&name[..]));
    }
    moved(meshes, request, found.mesh, report)
}

/// Noise of the kind `method` on `mesh`.
pub(crate) fn noise(meshes: &mut Meshes, request: &Request<'_>) -> Result<Answer> {
    let (kind, options) = NoiseOptions::of(request.text_or("method", "normal"), request)?;
    let mesh = meshes.held(request, "mesh")?.surface()?;
    let level = options.unit.level(options.sigma);
    let noisy = add_noise(&mesh, kind, level, options.seed.into())?;
    let report = json!({ "sigma": level.in_mesh_units(&mesh) });
    moved(meshes, request, noisy, report)
}

/// `mesh` rebuilt from its k smoothest modes.
pub(crate) fn reconstruct(meshes: &mut Meshes, request: &Request<'_>) -> Result<Answer> {
    let options = SpectrumTask::with("reconstruct", &request.values()?)?.unwrap_or_default();
    let held = meshes.held(request, "mesh")?;
    let modes = values::modes(held, &options)?;
    let mesh = Arc::clone(&held.mesh);
    let rebuilt = spectral::reconstruct(&mesh, &modes, options.k)?;
    let errors = spectral::reconstruction_errors(&mesh, &modes)?;
    let report = json!({ "displacement": errors.get(options.k), "split": rebuilt.split });
    moved(meshes, request, rebuilt.mesh, report)
}

/// Keeps a mesh with the faces of `mesh`, and with the fields of its file but normals.
fn moved(
    meshes: &mut Meshes,
    request: &Request<'_>,
    mesh: TriMesh,
    report: Value,
) -> Result<Answer> {
    let held = meshes.held(request, "mesh")?;
    let (fields, mut dropped) = of_the_file(held);
    if fields.vectors.iter().any(|(name, _)| name == "normal") {
        dropped.push("normal".to_owned());
    }
    Ok(kept(meshes, mesh, fields.without_normals(), Computed::new(), dropped, report))
}

/// The fields of a mesh that were not computed here, and the names of the others.
fn of_the_file(held: &Held) -> (VertexFields, Vec<String>) {
    let mut fields = held.fields.clone();
    fields.scalars.retain(|(name, _)| !is_computed(&held.computed, "scalar", name));
    fields.vectors.retain(|(name, _)| !is_computed(&held.computed, "vector", name));
    (fields, held.computed.iter().map(|(_, name)| name.clone()).collect())
}

/// Keeps a mesh; the answer names the fields that were `dropped`.
fn kept(
    meshes: &mut Meshes,
    mesh: TriMesh,
    fields: VertexFields,
    computed: Computed,
    dropped: Vec<String>,
    report: Value,
) -> Answer {
    let mut answer = meshes.keep(mesh, fields, computed, report);
    answer.value["dropped"] = json!(dropped);
    answer
}

/// `mesh` with its defects mended.
pub(crate) fn repair(meshes: &mut Meshes, request: &Request<'_>) -> Result<Answer> {
    let task = RepairTask::with("repair", &request.values()?)?.unwrap_or_default();
    let held = meshes.held(request, "mesh")?;
    let mesh = Arc::clone(&held.mesh);
    let all = (held.fields.clone(), held.computed.clone());
    let (own, dropped) = of_the_file(held);
    let options = RepairOptions {
        tolerance: if task.tolerance > 0.0 {
            Tolerance::EdgeLengths(task.tolerance)
        } else {
            Tolerance::Rounding
        },
        smallest_component: task.components,
        thin: task.thin,
        holes: task.holes,
        ..RepairOptions::default()
    };
    let (repaired, flat) = repair_fair(&mesh, &options)?;
    if repaired.mesh.face_count() == 0 && mesh.face_count() > 0 {
        bail!("no face would be left");
    }
    let counts = |notes: bool| -> Map<String, Value> {
        let changes = repaired.changes.iter().filter(|(step, _)| step.is_note() == notes);
        changes.map(|(step, changed)| (step.name().to_owned(), json!(changed.len()))).collect()
    };
    let report = json!({
        "unchanged": repaired.is_unchanged(),
        "changes": counts(false),
        "left": counts(true),
        "flat": flat.map(|error| error.to_string()),
    });
    let ((fields, computed), dropped) =
        if repaired.is_unchanged() { (all, vec![]) } else { ((own, Computed::new()), dropped) };
    let fields = repaired.carried(&mesh, fields);
    Ok(kept(meshes, repaired.mesh, fields, computed, dropped, report))
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use crate::Session;

    fn ask(session: &mut Session, request: &str, bytes: &[u8]) -> Value {
        session.call(request.as_bytes(), bytes).unwrap().value
    }

    const PLY: &[u8] = b"ply
format ascii 1.0
element vertex 5
property double x
property double y
property double z
property double nx
property double ny
property double nz
property double height
property double distance
property double direction1
element face 4
property list uchar int vertex_indices
end_header
0 0 1 0 0 1 5 0 9
1 0 0 0 0 1 4 1 9
0 1 0 0 0 1 3 2 9
-1 0 0 0 0 1 2 3 9
0 -1 0 0 0 1 1 4 9
3 0 1 2
3 0 2 3
3 0 3 4
3 0 4 1
";

    /// The fields of a file stay, normals excepted, whatever their names.
    #[test]
    fn moved_vertices_keep_the_fields_of_the_file_and_no_others() {
        let mut session = Session::new();
        ask(&mut session, r#"{"verb": "read", "name": "a.ply"}"#, PLY);
        let curved =
            ask(&mut session, r#"{"verb": "curvature", "mesh": 1, "method": "jet3"}"#, &[]);
        assert_eq!(curved["replaced"], json!([]));
        let moved = ask(&mut session, r#"{"verb": "smooth", "mesh": 1}"#, &[]);
        assert_eq!(moved["fields"], json!(["height", "distance", "direction1"]));
        assert_eq!(moved["computed"], json!([]));
        let dropped = moved["dropped"].to_string();
        for name in ["mean", "kappa2", "normal", "direction1"] {
            assert!(dropped.contains(&format!("\"{name}\"")), "{name} is not in {dropped}");
        }
        let repaired = ask(&mut session, r#"{"verb": "repair", "mesh": 1}"#, &[]);
        let names = repaired["fields"].to_string();
        assert!(names.contains("mean") && names.contains("source"), "{names}");
        assert_eq!(repaired["dropped"], json!([]));
        assert!(repaired["computed"].to_string().contains("mean"), "{repaired}");
    }

    /// A computed field takes the place of one of the file, says so, and goes as others do.
    #[test]
    fn replaced_fields_of_the_file_are_named() {
        let mut session = Session::new();
        ask(&mut session, r#"{"verb": "read", "name": "a.ply"}"#, PLY);
        let distance = r#"{"verb": "distance", "mesh": 1, "values": {"sources": "0"}}"#;
        let first = ask(&mut session, distance, &[]);
        assert_eq!(first["replaced"], json!(["distance"]));
        assert_eq!(first["computed"], json!(["distance"]));
        assert_eq!(ask(&mut session, distance, &[])["replaced"], json!([]));
        let field = ask(&mut session, r#"{"verb": "field", "mesh": 1, "name": "distance"}"#, &[]);
        assert_eq!(field["computed"], true);
        let moved = ask(&mut session, r#"{"verb": "smooth", "mesh": 1}"#, &[]);
        assert_eq!(moved["fields"], json!(["height", "direction1"]));
        assert_eq!(moved["dropped"], json!(["distance", "normal"]));
    }
}
