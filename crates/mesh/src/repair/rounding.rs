//! Vertices near each other, and those that rounding has moved apart.

use std::collections::{HashMap, HashSet};

use glam::DVec3;

use crate::trimesh::TriMesh;
use crate::weld::places_of;

/// Four units in the last place of single precision, as a fraction of the largest number.
const UNITS: f64 = 4.0 * (f32::EPSILON as f64);

/// The distance up to which coordinates of single precision may differ by rounding, in mesh units.
pub(crate) fn distance(mesh: &TriMesh) -> f64 {
    let numbers = mesh.positions().as_flattened();
    let largest = if numbers.iter().all(|&x| f64::from(x as f32) == x) {
        numbers.iter().fold(0.0, |max: f64, x| max.max(x.abs()))
    } else {
        let side =
            |[low, high]: [[f64; 3]; 2]| (0..3).map(|k| high[k] - low[k]).fold(0.0, f64::max);
        mesh.bounding_box().map_or(0.0, side)
    };
    UNITS * largest
}

/// The vertices that [`places`] merges with one at another position.
pub(crate) fn apart(mesh: &TriMesh) -> Vec<u32> {
    let exact = places_of(mesh.positions());
    let places = places(mesh, distance(mesh));
    (0..places.len() as u32).filter(|&v| places[v as usize] != exact[v as usize]).collect()
}

/// The first vertex at the place of each vertex, where vertices on the boundary that differ by at
/// most a distance are at one place, as far as [`Tolerance::Rounding`](super::Tolerance) allows.
pub(super) fn places(mesh: &TriMesh, distance: f64) -> Vec<u32> {
    let exact = places_of(mesh.positions());
    let surface = joined(mesh, &exact);
    let border = surface.topology().boundary_vertices();
    let border: Vec<u32> = (0..exact.len() as u32).filter(|&v| border[v as usize]).collect();
    if distance == 0.0 || border.is_empty() {
        return exact;
    }
    // Within half of the shortest edge at either end two neighbours cannot come to one place.
    let mut limits = vec![f64::INFINITY; exact.len()];
    for (edge, length) in surface.topology().edges().iter().zip(surface.edge_lengths()) {
        edge.iter().for_each(|&v| limits[v as usize] = limits[v as usize].min(0.49 * length));
    }
    let near = within(mesh.positions(), &border, distance, |v| limits[v as usize]);
    let worse = made_worse(&surface, &near);
    let place = |&v: &u32| if worse.contains(&near[v as usize]) { v } else { near[v as usize] };
    exact.iter().map(place).collect()
}

/// The mesh with the vertices at each place joined, without the faces that collapse. No face
/// collapses where [`within`] has joined them.
fn joined(mesh: &TriMesh, places: &[u32]) -> TriMesh {
    let faces = mesh.faces().iter().map(|face| face.map(|v| places[v as usize]));
    let faces = faces.filter(|&[a, b, c]| a != b && b != c && c != a).collect();
    TriMesh::from_checked(mesh.positions().to_vec(), faces)
}

/// The places where joining gives an edge an odd number of faces above one, lays two faces flat
/// onto each other across an edge, or gives two faces the same corners and winding.
///
/// Separating the vertices there leaves no such place: it makes no edge shared by more faces.
fn made_worse(surface: &TriMesh, places: &[u32]) -> HashSet<u32> {
    let joined = joined(surface, places);
    let topology = joined.topology();
    let mut worse = HashSet::new();
    if joined.faces() == surface.faces() {
        return worse;
    }
    for e in 0..topology.edges().len() as u32 {
        let (ends, faces) = (topology.edges()[e as usize], topology.edge_faces(e));
        let is_flat = || match *faces {
            [f, g] => !share_an_edge(surface, [f, g]) && are_folded(&joined, ends, [f, g]),
            _ => false,
        };
        if (faces.len() > 2 && faces.len() % 2 == 1) || is_flat() {
            worse.extend(ends);
        }
    }
    let mut seen = HashMap::new();
    for (&[a, b, c], f) in joined.faces().iter().zip(0..) {
        let low = a.min(b).min(c);
        let turned = if low == a {
            [a, b, c]
        } else if low == b {
            [b, c, a]
        } else {
            [c, a, b]
        };
        if let Some(earlier) = seen.insert(turned, f)
            && !share_an_edge(surface, [earlier, f])
        {
            worse.extend(turned);
        }
    }
    worse
}

fn share_an_edge(mesh: &TriMesh, faces: [u32; 2]) -> bool {
    let [f, g] = faces.map(|f| mesh.faces()[f as usize]);
    f.iter().filter(|v| g.contains(v)).count() > 1
}

/// True if the angle between two faces at their edge is below a thousandth: sheets that are closer
/// to each other than that fraction of their height.
fn are_folded(mesh: &TriMesh, ends: [u32; 2], faces: [u32; 2]) -> bool {
    let at = |v: u32| DVec3::from(mesh.positions()[v as usize]);
    let along = (at(ends[1]) - at(ends[0])).normalize_or_zero();
    let [u, v] = faces.map(|f| {
        let third = mesh.faces()[f as usize].into_iter().find(|v| !ends.contains(v));
        third.map_or(DVec3::ZERO, |third| (at(third) - at(ends[0])).reject_from_normalized(along))
    });
    u.dot(v) > 0.0 && u.cross(v).length() < 1e-3 * u.dot(v)
}

/// For each of some ascending vertices the first of them within a distance that is not itself
/// merged, so that vertices are not merged in chains; for the others these themselves. No two are
/// merged that are farther apart than the limit of either.
pub(super) fn within(
    positions: &[[f64; 3]],
    vertices: &[u32],
    distance: f64,
    limit: impl Fn(u32) -> f64,
) -> Vec<u32> {
    // Cells are no finer than coordinates are, and their numbers fit.
    let largest = positions.as_flattened().iter().fold(0.0, |max: f64, x| max.max(x.abs()));
    let side = distance.max(1e-12 * largest);
    let cell = |p: DVec3| (p / side).floor().to_array().map(|x| x as i64);
    let mut cells: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
    let around = |p: DVec3| {
        let [low, high] = [cell(p - distance), cell(p + distance)];
        let [x, y, z] = std::array::from_fn(|k| low[k]..=high[k]);
        x.flat_map(move |x| y.clone().map(move |y| [x, y]))
            .flat_map(move |[x, y]| z.clone().map(move |z| [x, y, z]))
    };
    let mut first: Vec<u32> = (0..positions.len() as u32).collect();
    for &v in vertices {
        let p = DVec3::from(positions[v as usize]);
        let near = around(p).filter_map(|cell| cells.get(&cell)).flatten().copied();
        let near = near.filter(|&w| {
            let limit = distance.min(limit(v)).min(limit(w));
            p.distance(positions[w as usize].into()) <= limit
        });
        match near.min() {
            Some(w) => first[v as usize] = w,
            None => cells.entry(cell(p)).or_default().push(v),
        }
    }
    first
}
