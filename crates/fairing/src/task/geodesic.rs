//! Distances along a surface.

use fairing_mesh::TriMesh;
use fairing_spectral::{GeodesicPath, Isoline, SurfacePoint};
use serde_json::{Value, json};

/// Descent paths with the vertex where each starts, and isolines with the distance of each.
#[derive(Debug, Clone, Default)]
pub struct GeodesicLines {
    /// The paths; numbers of starts are those of the file.
    pub paths: Vec<(u32, GeodesicPath)>,
    /// The isolines of each distance.
    pub isolines: Vec<(f64, Vec<Isoline>)>,
}

/// The report of a distance: the positions of its sources, the number of vertices and of those that
/// no source can reach, the farthest vertex, and the lengths of the lines. `in_file` is the number
/// that a vertex of the mesh has in its file.
pub fn geodesic(
    mesh: &TriMesh,
    sources: &[SurfacePoint],
    distance: &[Option<f64>],
    lines: &GeodesicLines,
    in_file: impl Fn(u32) -> u32,
) -> Value {
    let paths = lines.paths.iter().map(|(start, path)| {
        json!({
            "from": start,
            "length": path.length(),
            "points": path.points.len(),
            "end": path.end.map(&in_file),
        })
    });
    let isolines = lines.isolines.iter().map(|(level, pieces)| {
        let total: f64 = pieces.iter().map(Isoline::length).sum();
        json!({ "distance": level, "length": total, "pieces": pieces.len() })
    });
    json!({
        "sources": sources.iter().map(|source| source.position(mesh)).collect::<Vec<_>>(),
        "vertices": distance.len(),
        "unreached": distance.iter().filter(|d| d.is_none()).count(),
        "farthest": farthest(distance).map(|(v, d)| json!({ "vertex": in_file(v), "distance": d })),
        "paths": paths.collect::<Vec<_>>(),
        "isolines": isolines.collect::<Vec<_>>(),
    })
}

/// The vertex with the largest distance, and its distance; `None` if no vertex is reached.
pub fn farthest(distance: &[Option<f64>]) -> Option<(u32, f64)> {
    let reached = distance.iter().enumerate().filter_map(|(v, d)| d.map(|d| (v as u32, d)));
    reached.reduce(|best, next| if next.1 > best.1 { next } else { best })
}
