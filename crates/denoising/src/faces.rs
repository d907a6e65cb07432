//! Faces as the elements of a field: areas, normals, centroids and neighbours.

use std::ops::Range;

use fairing_mesh::TriMesh;
use fairing_watch::parallel;
use glam::DVec3;
use rayon::prelude::*;

/// Marks the side of a face that has no [`Hinge`].
pub(crate) const NO_HINGE: u32 = u32::MAX;

/// An edge between exactly two faces that run through it in opposite
/// directions, so that their normals can be compared. Borders, edges of three
/// or more faces and edges where the orientation flips are no hinges: nothing
/// is smoothed across them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Hinge {
    /// The two faces, the lower first.
    pub(crate) faces: [u32; 2],
    /// The two ends, ascending.
    pub(crate) ends: [u32; 2],
}

/// The hinges of a mesh, and the hinge at each side of each face.
#[derive(Debug)]
pub(crate) struct Hinges {
    pub(crate) all: Vec<Hinge>,
    /// Hinge `k` of a face lies opposite its corner `k`; [`NO_HINGE`] if none.
    pub(crate) of_face: Vec<[u32; 3]>,
    /// The face across each of them.
    pub(crate) beside: Vec<[u32; 3]>,
}

impl Hinges {
    pub(crate) fn new(mesh: &TriMesh) -> Self {
        let (topology, faces) = (mesh.topology(), mesh.faces());
        // True if face `f` runs along its edge `e` from the lower vertex to the higher one.
        let ascends = |f: u32, e: u32| {
            let sides = topology.face_edges()[f as usize];
            let corners = faces[f as usize];
            (0..3).any(|k| sides[k] == e && corners[(k + 1) % 3] < corners[(k + 2) % 3])
        };
        let mut all = vec![];
        let mut of_edge = vec![NO_HINGE; topology.edges().len()];
        for (e, &ends) in topology.edges().iter().enumerate() {
            if let &[f, g] = topology.edge_faces(e as u32)
                && f != g
                && ascends(f, e as u32) != ascends(g, e as u32)
            {
                of_edge[e] = all.len() as u32;
                all.push(Hinge { faces: [f.min(g), f.max(g)], ends });
            }
        }
        let of_face: Vec<[u32; 3]> =
            topology.face_edges().iter().map(|sides| sides.map(|e| of_edge[e as usize])).collect();
        let other = |f: usize, h: u32| match all.get(h as usize) {
            Some(&Hinge { faces: [a, b], .. }) if a as usize == f => b,
            Some(hinge) => hinge.faces[0],
            None => NO_HINGE,
        };
        let beside = of_face.iter().enumerate().map(|(f, row)| row.map(|h| other(f, h))).collect();
        Self { all, of_face, beside }
    }

    /// The faces across the hinges of face `f`.
    pub(crate) fn across(&self, f: usize) -> impl Iterator<Item = usize> + '_ {
        self.beside[f].into_iter().filter(|&g| g != NO_HINGE).map(|g| g as usize)
    }
}

/// The faces (or vertices) that a search has seen; cleared in constant time.
#[derive(Debug)]
pub(crate) struct Marks {
    stamps: Vec<u32>,
    current: u32,
}

impl Marks {
    /// Marks with none set.
    pub(crate) fn new(count: usize) -> Self {
        Self { stamps: vec![0; count], current: 1 }
    }

    /// Clears all marks.
    pub(crate) fn clear(&mut self) {
        self.current = self.current.wrapping_add(1);
        // After four billion searches stamps begin to repeat.
        if self.current == 0 {
            self.stamps.fill(0);
            self.current = 1;
        }
    }

    /// Marks `f`; returns `true` if it was not marked.
    pub(crate) fn insert(&mut self, f: u32) -> bool {
        let stamp = &mut self.stamps[f as usize];
        std::mem::replace(stamp, self.current) != self.current
    }
}

/// The most faces of a vertex that are all neighbours of each other.
pub(crate) const HUB: usize = 64;

/// The most steps of a search from one face or vertex to the next. Neighbourhoods of methods are a
/// few steps wide; without this bound those in a fine part of a coarse mesh would hold all of it.
const DEPTH: usize = 15;

/// Appends to `found` what `accept` takes of the neighbours of its items, of theirs and so on, up
/// to [`DEPTH`] steps away. `accept` takes each once.
pub(crate) fn search<'a>(
    found: &mut Vec<u32>,
    neighbors: impl Fn(u32) -> &'a [u32],
    mut accept: impl FnMut(u32) -> bool,
) {
    let mut begin = 0;
    for _ in 0..DEPTH {
        let end = found.len();
        for next in begin..end {
            found.extend(neighbors(found[next]).iter().filter(|&&k| accept(k)));
        }
        begin = end;
    }
}

/// Appends the faces around `v` that half of [`HUB`] hinges or fewer connect to face `f`.
fn nearest_around(v: u32, f: usize, faces: &[[u32; 3]], hinges: &Hinges, list: &mut Vec<u32>) {
    for start in (0..3).filter(|&k| faces[f][k] != v) {
        // The side of face g opposite its corner k is crossed.
        let (mut g, mut k) = (f, start);
        for _ in 0..HUB / 2 {
            let next = hinges.beside[g][k];
            if next == NO_HINGE || next as usize == f {
                break;
            }
            list.push(next);
            let shared = (0..3).find(|&j| j != k && faces[g][j] != v).map(|j| faces[g][j]);
            g = next as usize;
            let Some(opposite) = (0..3).find(|&j| Some(faces[g][j]) == shared) else { break };
            k = opposite;
        }
    }
}

/// Faces whose lists a thread gathers or fills at a time.
const BLOCK: usize = 4096;

/// Lists of faces, one for each face, in compressed rows.
#[derive(Debug)]
pub(crate) struct FaceLists {
    offsets: Vec<usize>,
    items: Vec<u32>,
}

impl FaceLists {
    /// Gathers the rows that `row` writes, in parallel, in the order of faces.
    pub(crate) fn gather(
        face_count: usize,
        row: impl Fn(usize, &mut Vec<u32>, &mut Marks) + Sync + Send,
    ) -> Self {
        let blocks: Vec<(Vec<usize>, Vec<u32>)> = (0..face_count.div_ceil(BLOCK))
            .into_par_iter()
            .map_init(
                || Marks::new(face_count),
                |marks, block| {
                    let (mut lengths, mut items, mut list) = (vec![], vec![], vec![]);
                    for f in block * BLOCK..((block + 1) * BLOCK).min(face_count) {
                        list.clear();
                        row(f, &mut list, marks);
                        lengths.push(list.len());
                        items.extend_from_slice(&list);
                    }
                    (lengths, items)
                },
            )
            .collect();
        let mut offsets = Vec::with_capacity(face_count + 1);
        offsets.push(0);
        let mut total = 0;
        for length in blocks.iter().flat_map(|(lengths, _)| lengths) {
            total += length;
            offsets.push(total);
        }
        Self { offsets, items: blocks.into_iter().flat_map(|(_, items)| items).collect() }
    }

    /// The faces that share a vertex with each face, itself left out, ascending. At a vertex of
    /// more than [`HUB`] faces only the nearest ones around it, half of that number to either
    /// side: all of them would be neighbours of each other. Sharing stays mutual.
    pub(crate) fn rings(mesh: &TriMesh) -> Self {
        let (incidence, faces) = (mesh.incidence(), mesh.faces());
        let is_hub = |v: u32| incidence.corners(v).len() > HUB;
        let hinges = (0..mesh.vertex_count() as u32).any(is_hub).then(|| Hinges::new(mesh));
        Self::gather(faces.len(), |f, list, _| {
            for &v in &faces[f] {
                match &hinges {
                    Some(hinges) if is_hub(v) => nearest_around(v, f, faces, hinges, list),
                    _ => list.extend(incidence.corners(v).iter().map(|c| c / 3)),
                }
            }
            list.sort_unstable();
            list.dedup();
            list.retain(|&g| g as usize != f);
        })
    }

    /// For each face the others whose centroids lie within `radius` of its own
    /// and that at most [`DEPTH`] such faces connect to it through shared vertices, in the order
    /// in which a search reaches them.
    pub(crate) fn within(rings: &Self, centroids: &[DVec3], radius: f64) -> Self {
        Self::gather(centroids.len(), |f, list, marks| {
            marks.clear();
            marks.insert(f as u32);
            list.push(f as u32);
            let inside = |k: u32| centroids[f].distance(centroids[k as usize]) < radius;
            search(list, |g| rings.row(g as usize), |k| inside(k) && marks.insert(k));
            list.remove(0);
        })
    }

    pub(crate) fn row(&self, f: usize) -> &[u32] {
        &self.items[self.range(f)]
    }

    /// The mean of the numbers of face `f` and of those in its row.
    pub(crate) fn mean(&self, numbers: &[f64], f: usize) -> f64 {
        let row = self.row(f);
        let sum: f64 = numbers[f] + row.iter().map(|&g| numbers[g as usize]).sum::<f64>();
        sum / (row.len() + 1) as f64
    }

    /// The range of the row of face `f` in the list of all rows.
    pub(crate) fn range(&self, f: usize) -> Range<usize> {
        self.offsets[f]..self.offsets[f + 1]
    }

    /// A number for each item of each row, in the order of the rows, which
    /// `row(f, value, numbers)` writes over zeros, together with a value of its
    /// own for each face. In parallel.
    pub(crate) fn fill<T: Send>(
        &self,
        values: &mut [T],
        row: impl Fn(usize, &mut T, &mut [f64]) + Sync,
    ) -> Vec<f64> {
        let mut numbers = vec![0.0; self.items.len()];
        let mut rest = &mut numbers[..];
        let mut blocks = Vec::with_capacity(values.len().div_ceil(BLOCK));
        for (block, values) in values.chunks_mut(BLOCK).enumerate() {
            let first = block * BLOCK;
            let length = self.offsets[first + values.len()] - self.offsets[first];
            let (now, later) = std::mem::take(&mut rest).split_at_mut(length);
            blocks.push((first, values, now));
            rest = later;
        }
        parallel::for_each(blocks, |(first, values, mut numbers)| {
            for (k, value) in values.iter_mut().enumerate() {
                let length = self.range(first + k).len();
                let (now, later) = std::mem::take(&mut numbers).split_at_mut(length);
                row(first + k, value, now);
                numbers = later;
            }
        });
        numbers
    }
}

/// Areas, unit normals (zero for a face without area) and centroids of faces.
#[derive(Debug, Clone)]
pub(crate) struct FaceShapes {
    pub(crate) areas: Vec<f64>,
    pub(crate) normals: Vec<DVec3>,
    pub(crate) centroids: Vec<DVec3>,
}

impl FaceShapes {
    pub(crate) fn new(mesh: &TriMesh) -> Self {
        let vector = |f: usize| DVec3::from(mesh.area_vector(f));
        let areas = parallel::map(mesh.face_count(), 64, |f| vector(f).length());
        let normals = parallel::map(mesh.face_count(), 64, |f| vector(f).normalize_or_zero());
        let centroids = parallel::map(mesh.face_count(), 64, |f| {
            let [a, b, c] = mesh.triangle(f).map(DVec3::from);
            (a + b + c) * (1.0 / 3.0)
        });
        Self { areas, normals, centroids }
    }
}

/// The longest side of face `f`.
pub(crate) fn longest_side(mesh: &TriMesh, f: usize) -> f64 {
    let [a, b, c] = mesh.triangle(f).map(DVec3::from);
    a.distance(b).max(b.distance(c)).max(c.distance(a))
}

/// The mean distance of the centroids across hinges, in mesh units; zero
/// without hinges.
pub(crate) fn mean_centroid_distance(hinges: &Hinges, centroids: &[DVec3]) -> f64 {
    if hinges.all.is_empty() {
        return 0.0;
    }
    let sum: f64 = hinges
        .all
        .iter()
        .map(|h| {
            let [a, b] = h.faces.map(|f| centroids[f as usize]);
            a.distance(b)
        })
        .sum();
    sum / hinges.all.len() as f64
}
