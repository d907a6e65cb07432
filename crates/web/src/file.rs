//! Verbs that read and write: `sample`, `read`, `write`, `adopt`, `mesh` and `field`.

use std::sync::Arc;

use anyhow::{Context as _, Result, ensure};
use fairing_mesh::TriMesh;
use fairing_mesh::io::{self, Format, MeshFile, ReadOptions, VertexFields, WriteOptions};
use fairing_operators::vertex_normals;
use serde_json::{Value, json};

use crate::answer::{Answer, Array};
use crate::meshes::{Meshes, names};
use crate::request::Request;
use crate::sample;

/// A mesh made by formula: `name`.
pub(crate) fn sample(meshes: &mut Meshes, request: &Request<'_>) -> Result<Answer> {
    let mesh = sample::made(request.text("name")?)?;
    Ok(meshes.keep(mesh, VertexFields::default(), Value::Null))
}

/// The bytes of a file: `name`, whose extension counts, and `drop_broken`.
pub(crate) fn read(meshes: &mut Meshes, request: &Request<'_>) -> Result<Answer> {
    let options = match request.flag("drop_broken") {
        true => ReadOptions::dropping_broken(),
        false => ReadOptions::default(),
    };
    let file = io::read_bytes(request.text("name")?, request.bytes, &options)?;
    let MeshFile { mesh, fields, report, .. } = file;
    let mut value = serde_json::to_value(&report)?;
    value["text"] = json!(report.to_string());
    Ok(meshes.keep(mesh, fields, value))
}

/// The bytes of `mesh` in a `format`, with its fields as far as the format holds them.
pub(crate) fn write(meshes: &mut Meshes, request: &Request<'_>) -> Result<Answer> {
    let format: Format = request.text("format")?.parse()?;
    let held = meshes.held(request, "mesh")?;
    let options = WriteOptions::default().dropping_fields();
    let bytes = io::to_bytes(format, &held.mesh, &held.fields, &options)?;
    Ok(Answer::from(Value::Null).with("bytes", Array::Bytes(bytes)))
}

/// A mesh of the page or of an earlier session: the bytes are its positions, faces and scalar
/// fields, in this order; `vertices`, `faces` and `fields` are counts and names, `mesh` the number
/// that it had.
pub(crate) fn adopt(meshes: &mut Meshes, request: &Request<'_>) -> Result<Answer> {
    let [vertices, faces] = [request.number("vertices")?, request.number("faces")?];
    let [vertices, faces] = [vertices as usize, faces as usize];
    let names = request.texts("fields")?;
    let (wanted, found) = (vertices * (24 + 8 * names.len()) + 12 * faces, request.bytes.len());
    ensure!(found == wanted, "{found} bytes for a mesh that has {wanted}");
    let (positions, rest) = request.bytes.split_at(24 * vertices);
    let (corners, scalars) = rest.split_at(12 * faces);
    let corners: Vec<u32> =
        corners.as_chunks().0.iter().map(|bytes| u32::from_le_bytes(*bytes)).collect();
    let mesh = TriMesh::from_flat(&numbers(positions), &corners)?;
    let mut fields = VertexFields::default();
    for (name, values) in names.iter().zip(scalars.chunks_exact((8 * vertices).max(1))) {
        fields = fields.with_scalar(*name, numbers(values));
    }
    if !request.has("mesh") {
        return Ok(meshes.keep(mesh, fields, Value::Null));
    }
    meshes.adopt(request.number("mesh")?, mesh, fields);
    Ok(Value::Null.into())
}

fn numbers(bytes: &[u8]) -> Vec<f64> {
    bytes.as_chunks().0.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect()
}

/// Positions, faces and vertex normals of `mesh`.
pub(crate) fn mesh(meshes: &mut Meshes, request: &Request<'_>) -> Result<Answer> {
    let held = meshes.held(request, "mesh")?;
    let normals = vertex_normals(&held.mesh).into_flattened();
    let value = json!({ "fields": names(&held.fields) });
    Ok(Answer::from(value)
        .with("positions", Array::Positions(Arc::clone(&held.mesh)))
        .with("faces", Array::Faces(Arc::clone(&held.mesh)))
        .with("normals", Array::Numbers(normals)))
}

/// The scalar field `name` of `mesh`.
pub(crate) fn field(meshes: &mut Meshes, request: &Request<'_>) -> Result<Answer> {
    let name = request.text("name")?;
    let held = meshes.held(request, "mesh")?;
    let values = held.fields.scalar(name).with_context(|| format!("there is no field {name:?}"))?;
    Ok(Answer::from(Value::Null).with("values", Array::Numbers(values.to_vec())))
}
