//! Input meshes of verbs: read in the format of the standard input, and welded on request.

use std::path::Path;

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use fairing::mesh::io::{Format, VertexFields};
use fairing::mesh::{TriMesh, Welded};
use fairing::parameters::{self, WeightedVertex};
use serde_json::Value;

use super::context::{Context, Failure};
use super::files;

/// Options for reading a mesh.
#[derive(Args)]
pub(crate) struct Reading {
    /// Treat vertices at exactly the same position as one, for files with seams or unshared
    /// corners; the output keeps the file's vertices
    #[arg(long)]
    weld: bool,
}

/// A mesh to compute on, and the map back to the vertices of its file.
pub(crate) struct Surface {
    /// The mesh of the file.
    pub(crate) own: TriMesh,
    welded: Option<Welded>,
}

impl Reading {
    /// Reads a mesh with its fields; refuses one whose faces share no corners.
    pub(crate) fn read(
        &self,
        context: &Context,
        path: &Path,
    ) -> Result<(Surface, VertexFields), Failure> {
        let (surface, fields) = self.read_any(context, path)?;
        let mesh = surface.mesh();
        if mesh.is_unwelded() {
            return Err(Failure::input(anyhow::anyhow!(
                "{}: {} of {} vertices coincide with another vertex: the faces do not share \
                 their corners, so that none has neighbours; add --weld",
                path.display(),
                mesh.seam_vertices(),
                mesh.vertex_count()
            )));
        }
        surface.say_seams(context, path);
        Ok((surface, fields))
    }

    /// Reads a mesh, with its fields.
    pub(crate) fn read_any(
        &self,
        context: &Context,
        path: &Path,
    ) -> Result<(Surface, VertexFields), Failure> {
        let file = files::read_surface(context, path)?;
        files::say_report(context, path, &file.report);
        let welded = self.weld.then(|| file.mesh.welded());
        if let Some(Welded { mesh, left_out, .. }) = &welded {
            let name = path.display();
            context.note(format_args!("{name}: welded to {} vertices", mesh.vertex_count()));
            if !left_out.is_empty() {
                context.note(format_args!(
                    "{name}: {} faces with two corners in one place are left out of the computation",
                    left_out.len()
                ));
            }
        }
        Ok((Surface { own: file.mesh, welded }, file.fields))
    }
}

impl Surface {
    /// The mesh to compute on.
    pub(crate) fn mesh(&self) -> &TriMesh {
        self.welded.as_ref().map_or(&self.own, |welded| &welded.mesh)
    }

    /// Notes boundary vertices that coincide with others.
    pub(crate) fn say_seams(&self, context: &Context, path: &Path) {
        let seams = self.mesh().seam_vertices();
        if seams > 0 {
            context.note(format_args!(
                "{}: {seams} boundary vertices coincide with another vertex, as at seams of \
                 texture coordinates, or between sheets that a repair has split; --weld joins them",
                path.display()
            ));
        }
    }

    /// A report with the changes made to the mesh before the computation.
    pub(crate) fn add_to(&self, mut report: Value) -> Value {
        let mesh = self.mesh();
        let entries = [
            ("turned_faces", mesh.turned_faces().len()),
            ("one_sided_faces", mesh.one_sided_faces().len()),
            ("welded_vertices", self.own.vertex_count() - mesh.vertex_count()),
        ];
        if let Value::Object(report) = &mut report {
            report.extend(entries.map(|(name, count)| (name.to_owned(), count.into())));
        }
        report
    }

    /// Values at the vertices of the file, from values at the vertices computed on.
    pub(crate) fn spread<T: Clone>(&self, values: Vec<T>) -> Vec<T> {
        match &self.welded {
            None => values,
            Some(welded) => welded.spread(&values),
        }
    }

    /// The mesh of the file with the positions of a result.
    pub(crate) fn own(&self, moved: TriMesh) -> Result<TriMesh, Failure> {
        match &self.welded {
            None => Ok(moved),
            Some(welded) => Ok(self.own.with_positions(welded.spread(moved.positions()))?),
        }
    }

    /// The number of file vertices that each vertex stands for.
    pub(crate) fn copies(&self) -> Vec<u32> {
        let mut copies = vec![0; self.mesh().vertex_count()];
        match &self.welded {
            None => copies.fill(1),
            Some(welded) => welded.vertices.iter().for_each(|&v| copies[v as usize] += 1),
        }
        copies
    }

    /// The vertex of the mesh computed on that a vertex of the file stands for.
    pub(crate) fn number(&self, v: u32) -> u32 {
        let Some(welded) = &self.welded else { return v };
        welded.vertices.get(v as usize).map_or(v, |&v| v)
    }

    /// The first vertex of the file that a vertex of the mesh computed on stands for.
    pub(crate) fn in_file(&self, v: u32) -> u32 {
        let Some(welded) = &self.welded else { return v };
        welded.vertices.iter().position(|&w| w == v).map_or(v, |own| own as u32)
    }

    /// The value with vertices of the file as vertices of the mesh computed on.
    pub(crate) fn renumbered(&self, value: &parameters::Value) -> parameters::Value {
        use parameters::Value;
        match value {
            Value::Vertices(vertices) => {
                Value::Vertices(vertices.iter().map(|&v| self.number(v)).collect())
            }
            Value::Weighted(vertices) => {
                let weighted = vertices.iter();
                let numbered =
                    weighted.map(|&w| WeightedVertex { vertex: self.number(w.vertex), ..w });
                Value::Weighted(numbered.collect())
            }
            other => other.clone(),
        }
    }
}

/// Notes inconsistently oriented faces, for verbs whose results depend on orientation.
pub(crate) fn say_orientation(context: &Context, path: &Path, mesh: &TriMesh) {
    let (turned, one_sided) = (mesh.turned_faces(), mesh.one_sided_faces());
    let (name, faces) = (path.display(), mesh.face_count());
    if let Some(first) = turned.first() {
        context.note(format_args!(
            "{name}: {} of {faces} faces turn against the rest of their part (the first: {first}) \
             and count as flipped; the output keeps the winding of the file",
            turned.len(),
        ));
    }
    if let Some(first) = one_sided.first() {
        context.note(format_args!(
            "{name}: {} of {faces} faces are on one-sided parts (the first: {first}), which have \
             no outside, as a Möbius band has none: signs and volumes are not defined there",
            one_sided.len(),
        ));
    }
}

/// The identifier of the option for the format of the standard input. A verb whose own option is
/// called `--from` has one of this identifier under another name.
pub(super) const INPUT_FORMAT: &str = "input_format";

/// The formats by the extensions of their files.
pub(super) fn formats() -> impl TypedValueParser<Value = Format> {
    let names = Format::ALL
        .into_iter()
        .map(|format| PossibleValue::new(format.extensions()[0]).help(format.name()));
    PossibleValuesParser::new(names).try_map(|name| {
        Format::from_path(Path::new(&format!("stdin.{name}"))).map(|named| named.format).ok_or(name)
    })
}
