//! Holes and their triangulation of least area.

use std::collections::HashSet;

use fairing_watch as watch;
use glam::DVec3;
use rayon::prelude::*;

use super::patch::Patch;
use super::{RepairStep, Work};
use crate::TriMesh;

impl Work {
    /// Fills the holes of at most `limit` edges.
    pub(super) fn fill_holes(&mut self, limit: usize, places: &[u32]) {
        let mesh = self.mesh.clone();
        let joined = mesh.faces().iter().map(|face| face.map(|v| places[v as usize])).collect();
        let joined = TriMesh::from_checked(mesh.positions().to_vec(), joined);
        let mut positions = mesh.positions().to_vec();
        let mut faces = mesh.faces().to_vec();
        let mut chords = HashSet::new();
        let (mut filled, mut open) = (vec![], vec![]);
        for hole in mesh.topology().boundary_loops().iter().filter(|hole| hole.len() <= limit) {
            watch::check();
            let corners: Vec<u32> = hole.iter().map(|&v| places[v as usize]).collect();
            if is_one_face(&joined, &corners) {
                continue;
            }
            let lowest = hole.iter().min().and_then(|&v| self.vertex_sources[v as usize]);
            let is_loop = is_loop(&mesh, hole);
            let Some(triangles) =
                is_loop.then(|| triangulation(&joined, &corners, &chords)).flatten()
            else {
                open.push(lowest);
                continue;
            };
            chords.extend(triangles.iter().flat_map(|&[a, b, c]| {
                [[a, b], [b, c], [c, a]].map(|ends| key(ends.map(|i| corners[i as usize])))
            }));
            let points = hole.iter().map(|&v| positions[v as usize]).collect();
            let scales = hole.iter().map(|&v| mean_edge_at(&mesh, v)).collect();
            let is_taken = |ends: [u32; 2]| {
                let [a, b] = ends.map(|i| corners.get(i as usize));
                a.zip(b).is_some_and(|(&a, &b)| joined.topology().edge_between(a, b).is_some())
            };
            let patch = Patch::new(points, triangles, &is_taken);
            let (inner, triangles) = patch.refined(scales);
            let first = positions.len() as u32 - hole.len() as u32;
            let vertex = |i: u32| hole.get(i as usize).copied().unwrap_or(first + i);
            faces.extend(triangles.iter().map(|face| face.map(vertex)));
            positions.extend(inner);
            filled.push(lowest);
        }
        self.note(RepairStep::FilledHoles, filled);
        self.note(RepairStep::OpenHoles, open);
        self.vertex_sources.resize(positions.len(), None);
        self.face_sources.resize(faces.len(), None);
        self.turned.resize(faces.len(), false);
        self.mesh = TriMesh::from_checked(positions, faces);
    }
}

/// True for the rim of a single triangle, which is no hole: one of its faces has these corners.
fn is_one_face(mesh: &TriMesh, hole: &[u32]) -> bool {
    hole.len() == 3
        && mesh.incidence().corners(hole[0]).iter().any(|c| {
            let face = mesh.faces()[*c as usize / 3];
            hole.iter().all(|v| face.contains(v))
        })
}

fn key([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

fn mean_edge_at(mesh: &TriMesh, v: u32) -> f64 {
    let at = |v: u32| DVec3::from(mesh.positions()[v as usize]);
    let around = mesh.topology().neighbors(v);
    around.iter().map(|&w| at(v).distance(at(w))).sum::<f64>() / around.len().max(1) as f64
}

/// True for a closed walk along boundary edges that passes each vertex once.
fn is_loop(mesh: &TriMesh, hole: &[u32]) -> bool {
    let topology = mesh.topology();
    let distinct: HashSet<u32> = hole.iter().copied().collect();
    let is_side = |i: usize| {
        let edge = topology.edge_between(hole[i], hole[(i + 1) % hole.len()]);
        edge.is_some_and(|e| topology.is_boundary_edge(e))
    };
    hole.len() >= 3 && distinct.len() == hole.len() && (0..hole.len()).all(is_side)
}

/// The triangulation of a hole of least area, as indices into the hole; `None` if every one
/// repeats an edge of the mesh or one of `chords`, or if a place occurs twice.
///
/// Dynamic programming over the chords i j: the least area of the polygon i … j is the sum for
/// i … m and m … j and the area of the triangle i m j, for the best m between.
fn triangulation(
    mesh: &TriMesh,
    hole: &[u32],
    chords: &HashSet<[u32; 2]>,
) -> Option<Vec<[u32; 3]>> {
    let topology = mesh.topology();
    let n = hole.len();
    let distinct: HashSet<u32> = hole.iter().copied().collect();
    if distinct.len() < n {
        return None;
    }
    let points: Vec<DVec3> = hole.iter().map(|&v| mesh.positions()[v as usize].into()).collect();
    let free = |i: usize, j: usize| {
        let ends = [hole[i], hole[j]];
        let side = i == 0 && j == n - 1;
        side || (topology.edge_between(ends[0], ends[1]).is_none() && !chords.contains(&key(ends)))
    };
    // The least area of i … j and its m, in rows of equal j − i.
    let mut rows: Vec<Vec<(f64, u32)>> = vec![vec![(0.0, 0); n], vec![(0.0, 0); n]];
    for length in 2..n {
        watch::check();
        let best = |i: usize| {
            let j = i + length;
            let mut best = (f64::INFINITY, 0);
            if !free(i, j) {
                return best;
            }
            for m in i + 1..j {
                let parts = rows[m - i][i].0 + rows[j - m][m].0;
                if parts < best.0 {
                    let area = (points[m] - points[i]).cross(points[j] - points[i]).length();
                    if parts + 0.5 * area < best.0 {
                        best = (parts + 0.5 * area, m as u32);
                    }
                }
            }
            best
        };
        let row = (0..n - length).into_par_iter().with_min_len(16).map(best).collect();
        rows.push(row);
    }
    rows[n - 1][0].0.is_finite().then(|| {
        let mut triangles = vec![];
        let mut stack = vec![(0, n - 1)];
        while let Some((i, j)) = stack.pop() {
            if j - i > 1 {
                let m = rows[j - i][i].1 as usize;
                // Faces have the boundary on their right, so the walk is against it.
                triangles.push([j as u32, m as u32, i as u32]);
                stack.extend([(i, m), (m, j)]);
            }
        }
        triangles
    })
}
