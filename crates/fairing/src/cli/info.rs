//! `fairing info`.

use std::path::PathBuf;

use clap::Args;
use fairing::mesh::io::{self, PolygonFile, ReadReport};
use fairing::mesh::{Diagnosis, PolygonMesh, Tally};
use serde_json::{Value, json};

use super::context::{Context, Failure};
use super::files;
use super::table::{Table, number};

/// Describe a mesh: counts, topology, defects and measures
///
/// Lengths, areas and volumes are in units of the file. Vertices, edges and faces are
/// numbered from 0. Face and edge counts are those of the file, polygons included;
/// degenerate, sliver and duplicate faces are counted after splitting into triangles.
#[derive(Args)]
pub(crate) struct Info {
    /// The mesh
    file: PathBuf,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

impl Info {
    pub(crate) fn run(&self, context: &Context) -> Result<(), Failure> {
        let PolygonFile { mesh, fields, report, .. } =
            io::read_polygons_with(&self.file, &files::reading(context))
                .map_err(files::unreadable)?;
        let diagnosis = Diagnosis::new(&mesh.triangulate());
        let mut names: Vec<&str> = fields.scalars.iter().map(|(name, _)| &name[..]).collect();
        names.extend(fields.vectors.iter().map(|(name, _)| &name[..]));
        names.extend(fields.colors.is_some().then_some("colors"));
        if self.json {
            return context
                .print(format_args!("{:#}\n", as_json(&mesh, &diagnosis, &report, &names)));
        }
        let mut text = format!("{}\n", report);
        text += &as_table(&mesh, &diagnosis).to_string();
        if !names.is_empty() {
            text += &format!("fields: {}\n", names.join(", "));
        }
        context.print(text)
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

fn yes(flag: bool) -> String {
    if flag { "yes" } else { "no" }.to_owned()
}

fn tally(tally: Tally) -> String {
    match tally.first {
        Some(first) => format!("{} (the first: {first})", tally.count),
        None => "0".to_owned(),
    }
}
