//! Verbs that read and write: `sample`, `read`, `write`, `losses`, `adopt`, `others`, `mesh` and
//! `field`.

use std::sync::Arc;

use anyhow::{Context as _, Result, ensure};
use fairing_mesh::TriMesh;
use fairing_mesh::io::{self, Format, MeshFile, Reader, VertexFields, WriteOptions};
use fairing_operators::vertex_normals;
use serde_json::{Map, Value};

use crate::answer::{Answer, Array};
use crate::meshes::{Meshes, names};
use crate::request::Request;
use crate::{parts, sample};

/// A mesh made by formula: `name`.
pub(crate) fn sample(meshes: &mut Meshes, request: &Request<'_>) -> Result<Answer> {
    let mesh = sample::made(request.text("name")?)?;
    Ok(meshes.keep(mesh, VertexFields::default(), Default::default(), Value::Null))
}

/// The bytes of a file: `name`, whose extension counts, and `drop_broken`.
pub(crate) fn read(meshes: &mut Meshes, request: &Request<'_>) -> Result<Answer> {
    let drop_broken = request.flag("drop_broken");
    let reader = if drop_broken { Reader::dropping_broken() } else { Reader::default() };
    let file = reader.read_bytes(request.text("name")?, request.bytes)?;
    let MeshFile { mesh, fields, report, .. } = file;
    let mut value = serde_json::to_value(&report)?;
    value["text"] = report.to_string().into();
    Ok(meshes.keep(mesh, fields, Default::default(), value))
}

/// The bytes of `mesh` in a `format`, with its fields as far as the format holds them.
pub(crate) fn write(meshes: &mut Meshes, request: &Request<'_>) -> Result<Answer> {
    let format: Format = request.text("format")?.parse()?;
    let held = meshes.held(request, "mesh")?;
    let options = WriteOptions::default().dropping_fields();
    let bytes = io::to_bytes(format, &held.mesh, &held.fields, &options)?;
    Ok(Answer::from(Value::Null).with("bytes", Array::Bytes(bytes)))
}

/// For each format, by its extension, what it does not hold of `mesh`.
pub(crate) fn losses(meshes: &mut Meshes, request: &Request<'_>) -> Result<Answer> {
    let held = meshes.held(request, "mesh")?;
    let losses = Format::ALL.map(|format| {
        let lost = io::unsupported(format, &held.fields);
        (format.extensions()[0].to_owned(), lost.into())
    });
    Ok(Value::Object(Map::from_iter(losses)).into())
}

/// A mesh of the page or of an earlier session: the bytes are its positions, faces and fields, in
/// this order; `vertices` and `faces` are counts, `fields` a list as in [`parts`], and `mesh` the
/// number that it had.
pub(crate) fn adopt(meshes: &mut Meshes, request: &Request<'_>) -> Result<Answer> {
    let [vertices, faces] = [request.number("vertices")?, request.number("faces")?];
    let fields = request.list("fields");
    let wanted = parts::size(vertices, faces, fields)?;
    let found = request.bytes.len();
    ensure!(found as u64 == wanted, "{found} bytes for a mesh that has {wanted}");
    let (positions, rest) = request.bytes.split_at(24 * vertices as usize);
    let (corners, rest) = rest.split_at(12 * faces as usize);
    let mesh = TriMesh::from_flat(&parts::numbers(positions), &parts::integers(corners))?;
    let (fields, computed) = parts::unpacked(rest, vertices, faces, fields)?;
    if !request.has("mesh") {
        return Ok(meshes.keep(mesh, fields, computed, Value::Null));
    }
    meshes.adopt(request.number("mesh")?, mesh, fields, computed);
    Ok(Value::Null.into())
}

/// The fields of `mesh` that are not scalars of vertices: `fields`, a list as `adopt` takes it,
/// and the `bytes` that belong to it.
pub(crate) fn others(meshes: &mut Meshes, request: &Request<'_>) -> Result<Answer> {
    let held = meshes.held(request, "mesh")?;
    let (fields, bytes) = parts::packed(&held.fields, &held.computed);
    Ok(Answer::entry("fields", fields).with("bytes", Array::Bytes(bytes)))
}

/// Positions, faces and vertex normals of `mesh`.
pub(crate) fn mesh(meshes: &mut Meshes, request: &Request<'_>) -> Result<Answer> {
    let held = meshes.held(request, "mesh")?;
    let normals = vertex_normals(&held.mesh).into_flattened();
    Ok(Answer::entry("fields", names(&held.fields))
        .with("positions", Array::Positions(Arc::clone(&held.mesh)))
        .with("faces", Array::Faces(Arc::clone(&held.mesh)))
        .with("normals", Array::Numbers(normals)))
}

/// The scalar field `name` of `mesh`, and whether it was `computed`.
pub(crate) fn field(meshes: &mut Meshes, request: &Request<'_>) -> Result<Answer> {
    let name = request.text("name")?;
    let held = meshes.held(request, "mesh")?;
    let values = held.fields.scalar(name).with_context(|| format!("there is no field {name:?}"))?;
    let computed = parts::is_computed(&held.computed, "scalar", name);
    let values = Array::Numbers(values.to_vec());
    Ok(Answer::entry("computed", computed).with("values", values))
}
