//! `fairing info`.

use std::path::Path;

use clap::Args;
use fairing::mesh::io::{MeshFile, ReadReport, VertexFields};
use fairing::mesh::{Diagnosis, PolygonMesh, Tally};
use fairing::task;
use serde_json::{Map, Value};

use super::context::{Context, Failure};
use super::files;
use super::inputs::{Inputs, Summary};
use super::table::{Table, number};

/// Describe a mesh: counts, topology, defects and measures
///
/// Lengths, areas and volumes are in units of the file. Vertices, edges and faces are numbered
/// from 0. Face and edge counts are those of the file, polygons included; degenerate, sliver and
/// duplicate faces are counted after splitting into triangles. For a file without faces, only the
/// counts of vertices and of duplicate positions and the bounding box are defined. If
/// `fairing repair` without further options mends a defect, the last line is that command.
#[derive(Args)]
pub(crate) struct Info {
    #[command(flatten)]
    inputs: Inputs,
    #[command(flatten)]
    summary: Summary,
}

impl Info {
    pub(crate) fn run(&self, context: &Context) -> Result<(), Failure> {
        let columns = [
            "vertices",
            "faces",
            "components",
            "boundary_loops",
            "manifold",
            "closed",
            "degenerate_faces",
            "turned_faces",
            "seam_vertices",
            "mean_edge",
        ];
        self.inputs.each(context, self.summary, &columns, |context, input| self.one(context, input))
    }

    fn one(&self, context: &Context, input: &Path) -> Result<Value, Failure> {
        let MeshFile { mesh: surface, fields, report, .. } = files::read(context, input)?;
        let mesh = surface.to_polygon_mesh();
        let diagnosis = Diagnosis::new(&surface);
        let (hints, command) = (diagnosis.hints(), repair_command(input, &diagnosis));
        let [of_vertices, of_faces] = names(&fields);
        let textured = fields.faces.texture.is_some();
        if self.summary.is_wanted() {
            let mut json = entries(&mesh, &diagnosis, &report);
            json.insert("fields".into(), of_vertices.into());
            json.insert("face_fields".into(), of_faces.into());
            json.insert("texture_coordinates".into(), textured.into());
            json.insert("hints".into(), hints.into());
            json.insert("repair".into(), command.into());
            return Ok(json.into());
        }
        let mut text = format!("{}\n", report);
        text += &as_table(&mesh, &diagnosis).to_string();
        for (what, names) in [("fields", of_vertices), ("fields of faces", of_faces)] {
            if !names.is_empty() {
                text += &format!("{what}: {}\n", names.join(", "));
            }
        }
        if textured {
            text += "texture coordinates: yes\n";
        }
        for hint in hints {
            text += &format!("hint: {hint}\n");
        }
        if let Some(command) = command {
            text += &format!("to mend it: {command}\n");
        }
        context.print(text)?;
        Ok(Value::Null)
    }
}

/// The entries of a diagnosis that points have, too.
const OF_POINTS: [&str; 4] = ["vertices", "faces", "duplicate_positions", "bounding_box"];

/// The names of the fields of vertices and of faces.
fn names(fields: &VertexFields) -> [Vec<&str>; 2] {
    let faces = &fields.faces;
    let colored =
        [&fields.colors, &faces.colors].map(|colors| colors.is_some().then_some("colors"));
    let [mut of_vertices, mut of_faces] = [&fields.scalars, &faces.scalars]
        .map(|scalars| scalars.iter().map(|(name, _)| &name[..]).collect::<Vec<_>>());
    of_vertices.extend(fields.vectors.iter().map(|(name, _)| &name[..]).chain(colored[0]));
    of_faces.extend(faces.vectors.iter().map(|(name, _)| &name[..]).chain(colored[1]));
    [of_vertices, of_faces]
}

/// The format, the counts and measures, and the file.
fn entries(mesh: &PolygonMesh, d: &Diagnosis, report: &ReadReport) -> Map<String, Value> {
    let mut entries = task::diagnosis(d);
    if d.faces == 0 {
        let of_faces = entries.iter_mut().filter(|(name, _)| !OF_POINTS.contains(&&name[..]));
        of_faces.for_each(|(_, value)| *value = Value::Null);
    } else {
        entries.insert("edges".to_owned(), mesh.edge_count().into());
    }
    entries.insert("faces".to_owned(), mesh.polygon_count().into());
    entries.shift_insert(2, "triangles".to_owned(), d.faces.into());
    entries.shift_insert(0, "format".to_owned(), report.format.to_string().into());
    entries.insert("file".to_owned(), task::file(report));
    entries
}

fn as_table(mesh: &PolygonMesh, d: &Diagnosis) -> Table {
    let mut table = Table::new();
    let mut row = |name: &str, value: String| table.row([name.to_owned(), value]);
    let has_faces = d.faces > 0;
    row("vertices", d.vertices.to_string());
    row("faces", mesh.polygon_count().to_string());
    if mesh.polygon_count() != d.faces {
        row("triangles", d.faces.to_string());
    }
    if has_faces {
        row("edges", mesh.edge_count().to_string());
        row("components", d.components.to_string());
        row("boundary loops", d.boundary_loops.to_string());
        row("Euler characteristic", d.euler_characteristic.to_string());
        row("genus", d.genus.map_or_else(|| "undefined".to_owned(), |g| g.to_string()));
        row("manifold", yes(d.manifold));
        row("closed", yes(d.closed));
        row("orientable", yes(d.orientable));
        row("isolated vertices", tally(d.isolated_vertices));
        row("degenerate faces", tally(d.degenerate_faces));
        row("sliver faces", tally(d.sliver_faces));
        row("duplicate faces", tally(d.duplicate_faces));
    }
    row("duplicate positions", tally(d.duplicate_positions));
    if has_faces {
        row("non-manifold edges", tally(d.nonmanifold_edges));
        row("non-manifold vertices", tally(d.nonmanifold_vertices));
        row("inconsistent edges", tally(d.inconsistent_edges));
        row("flipped faces", tally(d.turned_faces));
        row("seam vertices", d.seam_vertices.to_string());
        row("apart by rounding", tally(d.rounded_vertices));
    }
    if let Some([lo, hi]) = d.bounding_box {
        row("lowest corner", lo.map(number).join(", "));
        row("highest corner", hi.map(number).join(", "));
    }
    if has_faces {
        row("area", number(d.area));
        row("volume", d.volume.map_or_else(|| "undefined".to_owned(), number));
        row("shortest edge", number(d.shortest_edge));
        row("mean edge", number(d.mean_edge));
        row("longest edge", number(d.longest_edge));
    }
    table
}

/// The command that mends what was counted; `None` if `repair` without options mends none of it.
fn repair_command(input: &Path, d: &Diagnosis) -> Option<String> {
    let defects = [
        d.isolated_vertices,
        d.duplicate_faces,
        d.nonmanifold_edges,
        d.nonmanifold_vertices,
        d.turned_faces,
        d.rounded_vertices,
    ];
    let inside_out = d.volume.is_some_and(|volume| volume < 0.0);
    let found = defects.iter().any(|tally| tally.count > 0) || inside_out || d.seam_vertices > 0;
    if d.faces == 0 || !found {
        return None;
    }
    let mut name = input.display().to_string();
    if name.contains(|c: char| !c.is_alphanumeric() && !"/._-+".contains(c)) {
        name = format!("'{}'", name.replace('\'', r"'\''"));
    }
    Some(format!("fairing repair {name} -o repaired.ply"))
}

fn yes(flag: bool) -> String {
    if flag { "yes" } else { "no" }.to_owned()
}

fn tally(tally: Tally) -> String {
    match tally.first {
        Some(first) => format!("{} (the first: {first})", tally.count),
        None => "0".to_owned(),
    }
}
