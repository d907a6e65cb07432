//! Verbs that make a mesh of another one: `smooth`, `denoise`, `noise`, `reconstruct`, `repair`.

use std::sync::Arc;

use anyhow::{Result, bail};
use fairing_denoising::{Approach, Denoiser, automatic};
use fairing_evaluation::{NoiseLevel, add_noise};
use fairing_mesh::io::VertexFields;
use fairing_mesh::{RepairOptions, TriMesh};
use fairing_parameters::Options as _;
use fairing_smoothing::{Method, repair_fair};
use fairing_spectral as spectral;
use serde_json::{Map, Value, json};

use crate::answer::Answer;
use crate::meshes::Meshes;
use crate::request::Request;
use crate::tasks::{NoiseOptions, NoiseUnit, RepairTask, SpectrumTask};
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
    let report = json!({
        "noise": found.noise.as_ref().map(serde_json::to_value).transpose()?,
        "kind": found.kind.name(),
        "approach": found.approach.map(Approach::name),
        "uneven_vertices": found.uneven_vertices,
        "displacement_limit": found.limit,
    });
    moved(meshes, request, found.mesh, report)
}

/// Noise of the kind `method` on `mesh`.
pub(crate) fn noise(meshes: &mut Meshes, request: &Request<'_>) -> Result<Answer> {
    let (kind, options) = NoiseOptions::of(request.text_or("method", "normal"), request)?;
    let mesh = meshes.held(request, "mesh")?.surface()?;
    let level = match options.unit {
        NoiseUnit::Edge => NoiseLevel::EdgeLengths(options.sigma),
        NoiseUnit::Model => NoiseLevel::Model(options.sigma),
        NoiseUnit::Diagonal => NoiseLevel::Diagonals(options.sigma),
    };
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
    let displacement = errors.get(options.k);
    let report = json!({ "displacement": displacement, "split": values::split(rebuilt.split) });
    moved(meshes, request, rebuilt.mesh, report)
}

/// Keeps a mesh with the faces of `mesh`, and with those of its fields that fit other positions.
fn moved(
    meshes: &mut Meshes,
    request: &Request<'_>,
    mesh: TriMesh,
    report: Value,
) -> Result<Answer> {
    let fields = meshes.held(request, "mesh")?.fields.clone();
    let (fields, dropped) = without(fields, |name| name == "normal" || values::is_computed(name));
    Ok(kept(meshes, mesh, fields.without_normals(), dropped, report))
}

/// The fields of vertices whose names do not satisfy a condition, and the names of the others.
fn without(mut fields: VertexFields, drop: fn(&str) -> bool) -> (VertexFields, Vec<String>) {
    let names = fields.scalars.iter().map(|(name, _)| name);
    let names = names.chain(fields.vectors.iter().map(|(name, _)| name));
    let dropped = names.filter(|name| drop(name)).cloned().collect();
    fields.scalars.retain(|(name, _)| !drop(name));
    fields.vectors.retain(|(name, _)| !drop(name));
    (fields, dropped)
}

/// Keeps a mesh; the answer names the fields that were `dropped`.
fn kept(
    meshes: &mut Meshes,
    mesh: TriMesh,
    fields: VertexFields,
    dropped: Vec<String>,
    report: Value,
) -> Answer {
    let mut answer = meshes.keep(mesh, fields, report);
    answer.value["dropped"] = json!(dropped);
    answer
}

/// `mesh` with its defects mended.
pub(crate) fn repair(meshes: &mut Meshes, request: &Request<'_>) -> Result<Answer> {
    let task = RepairTask::with("repair", &request.values()?)?.unwrap_or_default();
    let held = meshes.held(request, "mesh")?;
    let (mesh, fields) = (Arc::clone(&held.mesh), held.fields.clone());
    let options = RepairOptions {
        tolerance: task.tolerance,
        smallest_component: task.components,
        thin: task.thin,
        holes: task.holes,
        ..RepairOptions::default()
    };
    let (repaired, flat) = repair_fair(&mesh, &options)?;
    if repaired.mesh.face_count() == 0 && mesh.face_count() > 0 {
        bail!("no face would be left");
    }
    let counts = repaired.changes.iter();
    let counts: Map<String, Value> =
        counts.map(|(step, changed)| (step.name().to_owned(), json!(changed.len()))).collect();
    let flat = flat.map(|error| error.to_string());
    let report = json!({ "unchanged": repaired.is_unchanged(), "changes": counts, "flat": flat });
    let (fields, dropped) = match repaired.is_unchanged() {
        true => (fields, vec![]),
        false => without(fields, values::is_computed),
    };
    let fields = repaired.carried(&mesh, fields);
    Ok(kept(meshes, repaired.mesh, fields, dropped, report))
}

#[cfg(test)]
mod tests {
    use serde_json::Value;

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
element face 4
property list uchar int vertex_indices
end_header
0 0 1 0 0 1 5 0
1 0 0 0 0 1 4 1
0 1 0 0 0 1 3 2
-1 0 0 0 0 1 2 3
0 -1 0 0 0 1 1 4
3 0 1 2
3 0 2 3
3 0 3 4
3 0 4 1
";

    /// The fields of a file stay, except those that describe positions.
    #[test]
    fn moved_vertices_have_no_fields_of_other_positions() {
        let mut session = Session::new();
        ask(&mut session, r#"{"verb": "read", "name": "a.ply"}"#, PLY);
        ask(&mut session, r#"{"verb": "curvature", "mesh": 1, "method": "jet3"}"#, &[]);
        let moved = ask(&mut session, r#"{"verb": "smooth", "mesh": 1}"#, &[]);
        assert_eq!(moved["fields"], serde_json::json!(["height"]));
        let dropped = moved["dropped"].to_string();
        for name in ["mean", "kappa2", "distance", "normal", "direction1"] {
            assert!(dropped.contains(&format!("\"{name}\"")), "{name} is not in {dropped}");
        }
        let repaired = ask(&mut session, r#"{"verb": "repair", "mesh": 1}"#, &[]);
        let names = repaired["fields"].to_string();
        assert!(names.contains("mean") && names.contains("source"), "{names}");
        assert_eq!(repaired["dropped"], serde_json::json!([]));
    }
}
