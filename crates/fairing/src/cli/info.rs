//! `fairing info`.

use std::path::Path;

use clap::Args;
use fairing::mesh::io::{PolygonFile, ReadReport};
use fairing::mesh::{Diagnosis, PolygonMesh, RepairOptions, Tally, TriMesh};
use serde_json::{Value, json};

use super::context::{Context, Failure};
use super::files;
use super::inputs::{Inputs, Summary};
use super::memory;
use super::table::{Table, number};

/// Describe a mesh: counts, topology, defects and measures
///
/// Lengths, areas and volumes are in units of the file. Vertices, edges and faces are
/// numbered from 0. Face and edge counts are those of the file, polygons included;
/// degenerate, sliver and duplicate faces are counted after splitting into triangles. Ends with
/// the command that would mend what was found.
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
        let PolygonFile { mesh, fields, report, .. } =
            files::read_polygons(context, input, &files::reading(context))?;
        let surface = mesh.triangulate();
        memory::require_for_mesh(surface.vertex_count())?;
        let diagnosis = Diagnosis::new(&surface);
        let (hints, command) = (diagnosis.hints(), repair_command(input, &surface, &diagnosis));
        let mut names: Vec<&str> = fields.scalars.iter().map(|(name, _)| &name[..]).collect();
        names.extend(fields.vectors.iter().map(|(name, _)| &name[..]));
        names.extend(fields.colors.is_some().then_some("colors"));
        if self.summary.is_wanted() {
            let mut json = as_json(&mesh, &diagnosis, &report, &names);
            json["hints"] = json!(hints);
            json["repair"] = json!(command);
            return Ok(json);
        }
        let mut text = format!("{}\n", report);
        text += &as_table(&mesh, &diagnosis).to_string();
        if !names.is_empty() {
            text += &format!("fields: {}\n", names.join(", "));
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

fn as_json(mesh: &PolygonMesh, d: &Diagnosis, report: &ReadReport, fields: &[&str]) -> Value {
    json!({
        "format": report.format.to_string(),
        "vertices": d.vertices,
        "faces": mesh.polygon_count(),
        "triangles": d.faces,
        "edges": mesh.edge_count(),
        "components": d.components,
        "boundary_loops": d.boundary_loops,
        "euler_characteristic": d.euler_characteristic,
        "genus": d.genus,
        "manifold": d.manifold,
        "closed": d.closed,
        "orientable": d.orientable,
        "isolated_vertices": d.isolated_vertices.count,
        "degenerate_faces": d.degenerate_faces.count,
        "sliver_faces": d.sliver_faces.count,
        "duplicate_faces": d.duplicate_faces.count,
        "duplicate_positions": d.duplicate_positions.count,
        "nonmanifold_edges": d.nonmanifold_edges.count,
        "nonmanifold_vertices": d.nonmanifold_vertices.count,
        "inconsistent_edges": d.inconsistent_edges.count,
        "turned_faces": d.turned_faces.count,
        "seam_vertices": d.seam_vertices,
        "bounding_box": d.bounding_box,
        "area": d.area,
        "volume": d.volume,
        "shortest_edge": d.shortest_edge,
        "mean_edge": d.mean_edge,
        "longest_edge": d.longest_edge,
        "fields": fields,
        "file": {
            "compressed": report.compressed,
            "faces": report.file_faces,
            "polygons": report.polygons,
            "reduced_faces": report.reduced,
            "left_out_faces": report.left_out,
            "broken_vertices": report.broken_vertices,
            "broken_faces": report.broken_faces,
            "notes": report.notes,
        },
    })
}

fn as_table(mesh: &PolygonMesh, d: &Diagnosis) -> Table {
    let mut table = Table::new();
    let mut row = |name: &str, value: String| table.row([name.to_owned(), value]);
    row("vertices", d.vertices.to_string());
    row("faces", mesh.polygon_count().to_string());
    if mesh.polygon_count() != d.faces {
        row("triangles", d.faces.to_string());
    }
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
    row("duplicate positions", tally(d.duplicate_positions));
    row("non-manifold edges", tally(d.nonmanifold_edges));
    row("non-manifold vertices", tally(d.nonmanifold_vertices));
    row("inconsistent edges", tally(d.inconsistent_edges));
    row("turned faces", tally(d.turned_faces));
    row("seam vertices", d.seam_vertices.to_string());
    if let Some([lo, hi]) = d.bounding_box {
        row("lowest corner", lo.map(number).join(", "));
        row("highest corner", hi.map(number).join(", "));
    }
    row("area", number(d.area));
    row("volume", d.volume.map_or_else(|| "undefined".to_owned(), number));
    row("shortest edge", number(d.shortest_edge));
    row("mean edge", number(d.mean_edge));
    row("longest edge", number(d.longest_edge));
    table
}

/// The command that mends what was found; `None` if there is nothing to mend.
fn repair_command(input: &Path, mesh: &TriMesh, d: &Diagnosis) -> Option<String> {
    let found = [
        d.isolated_vertices.count,
        d.duplicate_faces.count,
        d.seam_vertices,
        d.nonmanifold_edges.count,
        d.nonmanifold_vertices.count,
        d.inconsistent_edges.count,
        d.degenerate_faces.count,
        d.sliver_faces.count,
    ];
    let inside_out = d.volume.is_some_and(|volume| volume < 0.0);
    // The longest boundary may be the rim of the surface, the others are holes.
    let mut loops: Vec<usize> = mesh.topology().boundary_loops().iter().map(Vec::len).collect();
    loops.sort_unstable();
    let holes = loops.iter().rev().skip(1).copied().find(|n| *n <= RepairOptions::MAX_HOLE);
    if d.faces == 0 || (found == [0; 8] && !inside_out && holes.is_none()) {
        return None;
    }
    let mut name = input.display().to_string();
    if name.contains(|c: char| !c.is_alphanumeric() && !"/._-+".contains(c)) {
        name = format!("'{}'", name.replace('\'', r"'\''"));
    }
    let mut command = format!("fairing repair {name} -o repaired.ply");
    if d.degenerate_faces.count + d.sliver_faces.count > 0 {
        command += &format!(" --thin {}", Diagnosis::SLIVER);
    }
    if let Some(edges) = holes {
        command += &format!(" --holes {edges}");
    }
    Some(command)
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
