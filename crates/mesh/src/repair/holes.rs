//! Holes and their triangulation of least area.

use std::collections::{HashMap, HashSet};

use fairing_watch as watch;
use fairing_watch::parallel;
use glam::DVec3;

use super::patch::Patch;
use super::{OpenHole, OpenReason, RepairStep, Work};
use crate::trimesh::TriMesh;

/// The numbers of common places of two holes whose arcs are exchanged. Holes with more lie along
/// each other.
const SHARED: std::ops::RangeInclusive<usize> = 2..=8;

/// The most edges of a hole for which arcs are exchanged: all are triangulated several times.
const MAX_EXCHANGED: usize = 200;

impl Work {
    /// Fills the holes of at most `limit` edges. Returns those that stay open if the patches do
    /// not stay.
    pub(super) fn fill_holes(&mut self, limit: usize, places: &[u32]) -> Vec<OpenHole> {
        let mesh = self.mesh.clone();
        let joined = mesh.faces().iter().map(|face| face.map(|v| places[v as usize])).collect();
        let joined = TriMesh::from_checked(mesh.positions().to_vec(), joined);
        let mut positions = mesh.positions().to_vec();
        let mut faces = mesh.faces().to_vec();
        let mut chords = HashSet::new();
        let (mut filled, mut open) = (vec![], vec![]);
        let loops = mesh.topology().boundary_loops().to_vec();
        let (walks, others): (Vec<_>, Vec<_>) = loops.into_iter().partition(|b| is_walk(&mesh, b));
        let holes = walks.iter().flat_map(|walk| holes_of(walk, places)).collect();
        let holes = exchanged(&joined, holes, places, limit).into_iter().map(|hole| (hole, true));
        for (hole, is_walk) in holes.chain(others.into_iter().map(|boundary| (boundary, false))) {
            watch::check();
            let corners: Vec<u32> = hole.iter().map(|&v| places[v as usize]).collect();
            let triangles = match () {
                () if is_one_face(&joined, &corners) => Err(OpenReason::LoneFace),
                () if hole.len() > limit => Err(OpenReason::TooLarge),
                () if !is_walk => Err(OpenReason::NoPatch),
                () => triangulation(&joined, &corners, &chords).ok_or(OpenReason::NoPatch),
            };
            let triangles = triangles.map(|(_, triangles)| triangles);
            let source = hole.iter().filter_map(|&v| self.vertex_sources[v as usize]).min();
            let reason = *triangles.as_ref().err().unwrap_or(&OpenReason::PatchRemoved);
            open.extend(source.map(|vertex| OpenHole { vertex, edges: hole.len(), reason }));
            let Ok(triangles) = triangles else { continue };
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
            filled.push(source);
        }
        self.note(RepairStep::FilledHoles, filled);
        self.vertex_sources.resize(positions.len(), None);
        self.face_sources.resize(faces.len(), None);
        self.turned.resize(faces.len(), false);
        self.mesh = TriMesh::from_checked(positions, faces);
        open
    }
}

/// The holes of a walk along the boundary: one for each time that it comes back to a place, so that
/// none passes a place twice.
fn holes_of(boundary: &[u32], places: &[u32]) -> Vec<Vec<u32>> {
    let place = |v: u32| places[v as usize];
    let (mut holes, mut walk): (Vec<Vec<u32>>, Vec<u32>) = (vec![], vec![]);
    let mut index = HashMap::new();
    for &v in boundary {
        if let Some(&at) = index.get(&place(v)) {
            let hole = walk.split_off(at);
            for &v in &hole {
                index.remove(&place(v));
            }
            holes.push(hole);
        }
        index.insert(place(v), walk.len());
        walk.push(v);
    }
    holes.push(walk);
    holes
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

/// True for a closed walk along boundary edges.
fn is_walk(mesh: &TriMesh, boundary: &[u32]) -> bool {
    let topology = mesh.topology();
    let is_side = |i: usize| {
        let edge = topology.edge_between(boundary[i], boundary[(i + 1) % boundary.len()]);
        edge.is_some_and(|e| topology.is_boundary_edge(e))
    };
    (0..boundary.len()).all(is_side)
}

/// Holes that share several places, with arcs between these exchanged where that makes patches of
/// less area: around an island that touches a rim twice there are two holes, and not the rim and
/// the island's own.
fn exchanged(
    joined: &TriMesh,
    mut holes: Vec<Vec<u32>>,
    places: &[u32],
    limit: usize,
) -> Vec<Vec<u32>> {
    let place = |v: &u32| places[*v as usize];
    let mut at: HashMap<u32, Vec<usize>> = HashMap::new();
    for (i, hole) in holes.iter().enumerate() {
        hole.iter().for_each(|v| at.entry(place(v)).or_default().push(i));
    }
    let mut pairs: Vec<[usize; 2]> = vec![];
    for holes in at.into_values() {
        pairs.extend(
            (1..holes.len())
                .flat_map(|j| holes[..j].iter().map(|&i| [i, holes[j]]).collect::<Vec<_>>()),
        );
    }
    pairs.sort_unstable();
    let pairs = pairs.chunk_by(|x, y| x == y).filter(|pair| SHARED.contains(&pair.len()));
    let area = |hole: &Vec<u32>| {
        let corners: Vec<u32> = hole.iter().map(place).collect();
        let patch = (corners.len() <= limit.min(MAX_EXCHANGED))
            .then(|| triangulation(joined, &corners, &HashSet::new()))
            .flatten();
        patch.map_or(f64::INFINITY, |(area, _)| area)
    };
    for &[i, j] in pairs.map(|pair| &pair[0]) {
        let shared: Vec<u32> = holes[i].iter().map(place).collect();
        for x in shared {
            let found = [i, j].map(|h| holes[h].iter().position(|v| place(v) == x));
            let [Some(a), Some(b)] = found else { continue };
            let (mut first, mut second) = (holes[i].clone(), holes[j].clone());
            first.rotate_left(a);
            second.rotate_left(b);
            // The next place along the first that the second passes, too.
            let meets = |k: &usize| second.iter().position(|v| place(v) == place(&first[*k]));
            let Some((k, l)) = (1..first.len()).find_map(|k| meets(&k).map(|l| (k, l))) else {
                continue;
            };
            let [one, other] =
                [[&first[..k], &second[l..]].concat(), [&second[..l], &first[k..]].concat()];
            if area(&one) + area(&other) < area(&first) + area(&second) {
                (holes[i], holes[j]) = (one, other);
            }
        }
    }
    holes
}

/// The triangulation of a hole of least area, as indices into the hole, after this area; `None` if
/// every one repeats an edge of the mesh or one of `chords`, if a place occurs twice, or for two
/// edges.
///
/// Dynamic programming over the chords i j: the least area of the polygon i … j is the sum for
/// i … m and m … j and the area of the triangle i m j, for the best m between.
fn triangulation(
    mesh: &TriMesh,
    hole: &[u32],
    chords: &HashSet<[u32; 2]>,
) -> Option<(f64, Vec<[u32; 3]>)> {
    let topology = mesh.topology();
    let n = hole.len();
    let distinct: HashSet<u32> = hole.iter().copied().collect();
    if distinct.len() < n || n < 3 {
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
        let row = parallel::map(n - length, 16, best);
        rows.push(row);
    }
    let area = rows[n - 1][0].0;
    area.is_finite().then(|| {
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
        (area, triangles)
    })
}
