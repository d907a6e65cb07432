//! Meshes by number.

use std::collections::BTreeMap;
use std::sync::Arc;

use anyhow::{Context as _, Result, bail};
use fairing_mesh::TriMesh;
use fairing_mesh::io::VertexFields;
use fairing_spectral::{HeatGeodesics, Spectrum};
use serde_json::{Value, json};

use crate::answer::{Answer, Array};
use crate::parts::{Computed, is_computed};
use crate::request::Request;

/// The meshes of a session.
#[derive(Default)]
pub(crate) struct Meshes {
    held: BTreeMap<u32, Held>,
    last: u32,
}

/// A mesh with its fields.
pub(crate) struct Held {
    pub(crate) mesh: Arc<TriMesh>,
    pub(crate) fields: VertexFields,
    /// The fields that were computed here; all others are values of the file.
    pub(crate) computed: Computed,
    /// The last spectrum, with the options that it was computed with.
    pub(crate) spectrum: Option<(String, Arc<Spectrum>)>,
    /// The factors for distances, with the options that they were computed with.
    pub(crate) geodesics: Option<(String, Arc<HeatGeodesics>)>,
}

impl Held {
    /// The mesh for a verb that needs neighbours: refused if its faces share no corners.
    pub(crate) fn surface(&self) -> Result<Arc<TriMesh>> {
        if self.mesh.is_unwelded() {
            bail!(
                "{} of {} vertices coincide with another vertex: the faces do not share \
                 their corners, so that none has neighbours; repair the mesh first",
                self.mesh.seam_vertices(),
                self.mesh.vertex_count()
            );
        }
        Ok(Arc::clone(&self.mesh))
    }

    /// Sets a computed scalar field, in place of one of the same name. Returns true if that one
    /// was of the file.
    pub(crate) fn set(&mut self, name: &str, values: Vec<f64>) -> bool {
        let replaced = put(&mut self.fields.scalars, name, values);
        self.computed.insert(("scalar", name.to_owned())) && replaced
    }

    /// The same for a vector field.
    pub(crate) fn set_vectors(&mut self, name: &str, values: Vec<[f64; 3]>) -> bool {
        let replaced = put(&mut self.fields.vectors, name, values);
        self.computed.insert(("vector", name.to_owned())) && replaced
    }

    /// The names of the scalar fields, of those that were computed, and of fields of the file that
    /// a request has `replaced`.
    pub(crate) fn listed(&self, replaced: &[&str]) -> Value {
        json!({
            "fields": names(&self.fields),
            "computed": self.computed_names(),
            "replaced": replaced,
        })
    }

    fn computed_names(&self) -> Vec<&str> {
        names(&self.fields)
            .into_iter()
            .filter(|name| is_computed(&self.computed, "scalar", name))
            .collect()
    }
}

/// Puts a field into a list. Returns true if it replaces one of the same name.
fn put<T>(fields: &mut Vec<(String, T)>, name: &str, values: T) -> bool {
    let before = fields.len();
    fields.retain(|(n, _)| n != name);
    let replaced = fields.len() < before;
    fields.push((name.to_owned(), values));
    replaced
}

impl Meshes {
    /// The mesh that a field of the request names.
    pub(crate) fn held(&mut self, request: &Request<'_>, name: &str) -> Result<&mut Held> {
        let number = request.number(name)?;
        self.held.get_mut(&number).with_context(|| format!("there is no mesh {number}"))
    }

    /// Forgets a mesh; one that is not there is no error.
    pub(crate) fn forget(&mut self, number: u32) {
        self.held.remove(&number);
    }

    /// Keeps a mesh under a number that it had in an earlier session.
    pub(crate) fn adopt(
        &mut self,
        number: u32,
        mesh: TriMesh,
        fields: VertexFields,
        computed: Computed,
    ) {
        self.last = self.last.max(number);
        let mesh = Arc::new(mesh);
        self.held.insert(number, Held { mesh, fields, computed, spectrum: None, geodesics: None });
    }

    /// Keeps a mesh, and answers with its number and what else is known of it.
    pub(crate) fn keep(
        &mut self,
        mesh: TriMesh,
        fields: VertexFields,
        computed: Computed,
        report: Value,
    ) -> Answer {
        self.last += 1;
        let mut value = json!({
            "mesh": self.last,
            "vertices": mesh.vertex_count(),
            "faces": mesh.face_count(),
            "unwelded": mesh.is_unwelded(),
            "turned": mesh.turned_faces().len(),
            "seams": mesh.seam_vertices(),
            "report": report,
        });
        let number = self.last;
        self.adopt(number, mesh, fields, computed);
        let held = &self.held[&number];
        value["fields"] = json!(names(&held.fields));
        value["computed"] = json!(held.computed_names());
        let positions = Array::Positions(Arc::clone(&held.mesh));
        Answer::from(value).with("positions", positions)
    }
}

/// The names of the scalar fields.
pub(crate) fn names(fields: &VertexFields) -> Vec<&str> {
    fields.scalars.iter().map(|(name, _)| name.as_str()).collect()
}
