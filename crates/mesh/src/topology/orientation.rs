//! Orientation of neighbouring faces.

use std::collections::VecDeque;

use super::edges::EdgeTables;

/// The most faces of a non-manifold edge that are compared, in all pairs.
const MAX_SHEETS: usize = 8;

/// Agreement in orientation of neighbouring faces.
///
/// Two faces at an edge agree if they run through it in opposite directions. Parts of
/// the mesh are connected by edges with exactly two faces. At an edge with more faces, two parts
/// are joined only if the pairing is unique: by two faces with the same corners, or if the faces
/// at the edge have only two different third corners.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Orientation {
    inconsistent_edges: Vec<u32>,
    flipped: Vec<bool>,
    one_sided: Vec<bool>,
    parts: Vec<u32>,
}

impl Orientation {
    /// Propagates an orientation across edges with two faces, part by part. Linear.
    pub(super) fn new(faces: &[[u32; 3]], tables: &EdgeTables) -> Self {
        let inconsistent: Vec<bool> = (0..tables.edges.len())
            .map(|e| match *tables.faces_of(e) {
                [f, g] => {
                    let ends = tables.edges[e];
                    turns_along(faces[f as usize], ends) == turns_along(faces[g as usize], ends)
                }
                _ => false,
            })
            .collect();
        let inconsistent_edges: Vec<u32> =
            (0..tables.edges.len() as u32).filter(|&e| inconsistent[e as usize]).collect();
        if inconsistent_edges.is_empty() {
            let all = |value| vec![value; faces.len()];
            return Self {
                inconsistent_edges,
                flipped: all(false),
                one_sided: all(false),
                parts: vec![],
            };
        }
        let mut spread = Spread::new(faces.len());
        for start in 0..faces.len() {
            spread.from(start, tables, &inconsistent);
        }
        let Spread { mut flipped, mut parts, one_sided, .. } = spread;
        let mut joined = Joined::new(&one_sided);
        for e in 0..tables.edges.len() {
            joined.join_at(e, faces, tables, &parts, &flipped);
        }
        for (part, flipped) in parts.iter_mut().zip(&mut flipped) {
            let (root, turned) = joined.root(*part);
            *flipped ^= turned;
            *part = root;
        }
        let one_sided = parts.iter().map(|&part| one_sided[part as usize]).collect();
        Self { inconsistent_edges, flipped, one_sided, parts }
    }

    /// The edges whose two faces run along them in the same direction,
    /// ascending.
    pub fn inconsistent_edges(&self) -> &[u32] {
        &self.inconsistent_edges
    }

    /// Returns true if all faces agree as they are.
    pub fn is_consistent(&self) -> bool {
        self.inconsistent_edges.is_empty()
    }

    /// Returns true if flipping some faces would make all faces agree.
    pub fn is_orientable(&self) -> bool {
        !self.one_sided.contains(&true)
    }

    /// The faces to flip so that all agree with the lowest face of their
    /// part; `None` if the mesh is not orientable.
    pub fn flips(&self) -> Option<&[bool]> {
        self.is_orientable().then_some(&self.flipped[..])
    }

    /// True for each face of a part that cannot be oriented, such as a Möbius band.
    pub fn one_sided_faces(&self) -> &[bool] {
        &self.one_sided
    }

    /// The faces to flip so that each part takes the winding of most of its area. In a part that
    /// cannot be oriented, disagreements remain along one cut only.
    pub(crate) fn majority_flips(&self, area: impl Fn(usize) -> f64) -> Vec<bool> {
        let count = self.parts.iter().max().map_or(0, |&part| part as usize + 1);
        let mut kept = vec![0.0; count];
        for (f, (&part, &flipped)) in self.parts.iter().zip(&self.flipped).enumerate() {
            kept[part as usize] += if flipped { -area(f) } else { area(f) };
        }
        let faces = self.parts.iter().zip(&self.flipped).zip(&self.one_sided);
        faces
            .map(|((&part, &flip), &one_sided)| flip ^ (!one_sided && kept[part as usize] < 0.0))
            .collect()
    }
}

/// Parts and flips found so far.
struct Spread {
    parts: Vec<u32>,
    flipped: Vec<bool>,
    /// True for each part that cannot be oriented.
    one_sided: Vec<bool>,
    queue: VecDeque<usize>,
}

impl Spread {
    fn new(faces: usize) -> Self {
        Self {
            parts: vec![u32::MAX; faces],
            flipped: vec![false; faces],
            one_sided: vec![],
            queue: VecDeque::new(),
        }
    }

    /// Finds the part of a face, unless it is known. Breadth first, so that disagreements in a
    /// part that cannot be oriented stay along a short cut.
    fn from(&mut self, start: usize, tables: &EdgeTables, inconsistent: &[bool]) {
        if self.parts[start] != u32::MAX {
            return;
        }
        let part = self.one_sided.len() as u32;
        self.one_sided.push(false);
        self.parts[start] = part;
        self.queue.push_back(start);
        while let Some(f) = self.queue.pop_front() {
            for e in tables.face_edges[f].map(|e| e as usize) {
                let [a, b] = *tables.faces_of(e) else { continue };
                let other = if a as usize == f { b as usize } else { a as usize };
                let wanted = self.flipped[f] != inconsistent[e];
                if self.parts[other] == u32::MAX {
                    self.parts[other] = part;
                    self.flipped[other] = wanted;
                    self.queue.push_back(other);
                } else if self.flipped[other] != wanted {
                    self.one_sided[part as usize] = true;
                }
            }
        }
    }
}

/// Parts joined across edges with more than two faces: a disjoint-set forest whose links store
/// whether a part disagrees with its parent.
struct Joined<'a> {
    above: Vec<(u32, bool)>,
    one_sided: &'a [bool],
}

impl<'a> Joined<'a> {
    fn new(one_sided: &'a [bool]) -> Self {
        Self { above: (0..one_sided.len() as u32).map(|part| (part, false)).collect(), one_sided }
    }

    /// The root of a part, which is the lowest part joined with it, and whether the two disagree.
    fn root(&mut self, part: u32) -> (u32, bool) {
        let (mut at, mut turned) = (part, false);
        while self.above[at as usize].0 != at {
            turned ^= self.above[at as usize].1;
            at = self.above[at as usize].0;
        }
        self.above[part as usize] = (at, turned);
        (at, turned)
    }

    /// Joins the parts at an edge with more than two faces where the pairing is unique.
    fn join_at(
        &mut self,
        e: usize,
        faces: &[[u32; 3]],
        tables: &EdgeTables,
        parts: &[u32],
        flipped: &[bool],
    ) {
        let (around, ends) = (tables.faces_of(e), tables.edges[e]);
        if !(3..=MAX_SHEETS).contains(&around.len()) {
            return;
        }
        let third = |f: u32| faces[f as usize].into_iter().find(|v| !ends.contains(v));
        let mut sheets: Vec<_> = around.iter().map(|&f| third(f)).collect();
        sheets.sort_unstable();
        sheets.dedup();
        let turns = |f: u32| turns_along(faces[f as usize], ends) != flipped[f as usize];
        for (i, &f) in around.iter().enumerate() {
            for &g in &around[..i] {
                let same = third(f) == third(g);
                if !same && sheets.len() != 2 {
                    continue;
                }
                let (p, q) = (parts[f as usize], parts[g as usize]);
                if self.one_sided[p as usize] || self.one_sided[q as usize] {
                    continue;
                }
                let ((p, p_turned), (q, q_turned)) = (self.root(p), self.root(q));
                // Two faces with the same corners turn the same way; the two sides of an edge run
                // through it in opposite directions.
                let disagree = (turns(f) == turns(g)) != same;
                let (low, high) = (p.min(q), p.max(q));
                if low != high {
                    self.above[high as usize] = (low, disagree ^ p_turned ^ q_turned);
                }
            }
        }
    }
}

/// Returns true if the face runs from the first end of the edge to the second.
fn turns_along(face: [u32; 3], [a, b]: [u32; 2]) -> bool {
    (0..3).any(|k| face[k] == a && face[(k + 1) % 3] == b)
}
