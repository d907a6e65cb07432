//! Needles and caps.

use std::collections::HashSet;

use fairing_watch as watch;
use glam::DVec3;

use super::{RepairStep, Work};
use crate::trimesh::TriMesh;

/// The most passes over the thin faces; neighbours of a changed face wait for the next pass.
const MAX_PASSES: usize = 50;

/// The ratio of shortest to longest edge below which a thin face is a needle, in units of the
/// limit of heights. At the limit itself the apex would lie straight above one end.
const NEEDLE: f64 = 5.0;

/// Faces at a vertex above which it is not merged into another one: all of them would move.
const HUB: usize = 256;

impl Work {
    /// Collapses the shortest edge of needles and flips the longest edge of caps among the faces
    /// whose height is below `limit` × their longest edge.
    pub(super) fn mend_thin_faces(&mut self, limit: f64) {
        for _ in 0..MAX_PASSES {
            watch::check();
            let mut pass = Pass::new(&self.mesh, limit);
            for f in 0..self.mesh.face_count() as u32 {
                if quality(self.mesh.triangle(f as usize).map(DVec3::from)) < limit {
                    pass.mend(f);
                }
            }
            let Pass { faces, keep, changed, .. } = pass;
            if changed.is_empty() {
                return;
            }
            let sources: Vec<_> = changed.iter().map(|&f| self.face_sources[f as usize]).collect();
            self.note(RepairStep::ThinFaces, sources);
            self.face_sources = super::kept(&self.face_sources, &keep);
            self.turned = super::kept(&self.turned, &keep);
            let before = used(self.mesh.vertex_count(), self.mesh.faces());
            let faces = super::kept(&faces, &keep);
            let after = used(self.mesh.vertex_count(), &faces);
            self.mesh = TriMesh::from_checked(self.mesh.positions().to_vec(), faces);
            // Vertices that lost their last face were collapsed; others were isolated before.
            let keep: Vec<bool> = before.iter().zip(after).map(|(b, a)| a || !b).collect();
            if keep.contains(&false) {
                self.keep_vertices(&keep);
            }
        }
    }
}

fn used(count: usize, faces: &[[u32; 3]]) -> Vec<bool> {
    let mut used = vec![false; count];
    faces.iter().flatten().for_each(|&v| used[v as usize] = true);
    used
}

/// The ratio of height to longest edge: twice the area over the square of the longest edge.
fn quality([a, b, c]: [DVec3; 3]) -> f64 {
    let longest = a.distance_squared(b).max(b.distance_squared(c)).max(c.distance_squared(a));
    if longest > 0.0 { (b - a).cross(c - a).length() / longest } else { 0.0 }
}

/// One pass over the thin faces. The neighbours and faces that a change examines are those after
/// the others: two changes may share the hub of a fan, which neither removes.
struct Pass<'a> {
    mesh: &'a TriMesh,
    limit: f64,
    faces: Vec<[u32; 3]>,
    keep: Vec<bool>,
    /// Vertices of changed faces, and the neighbours of merged vertices.
    touched: HashSet<u32>,
    /// Touched vertices whose own neighbours have changed: ends of collapsed edges, and the corners
    /// of the faces of a flip.
    ends: HashSet<u32>,
    /// Touched vertices that have lost faces and gained none.
    gone: HashSet<u32>,
    changed: Vec<u32>,
}

impl<'a> Pass<'a> {
    fn new(mesh: &'a TriMesh, limit: f64) -> Self {
        Self {
            mesh,
            limit,
            faces: mesh.faces().to_vec(),
            keep: vec![true; mesh.face_count()],
            touched: HashSet::new(),
            ends: HashSet::new(),
            gone: HashSet::new(),
            changed: vec![],
        }
    }

    fn at(&self, v: u32) -> DVec3 {
        self.mesh.positions()[v as usize].into()
    }

    fn corners(&self, face: [u32; 3]) -> [DVec3; 3] {
        face.map(|v| self.at(v))
    }

    fn mend(&mut self, f: u32) {
        let face = self.mesh.faces()[f as usize];
        let corners = self.corners(face);
        let length = |k: usize| corners[(k + 1) % 3].distance(corners[(k + 2) % 3]);
        let order = |j: &usize, k: &usize| length(*j).total_cmp(&length(*k));
        let (Some(short), Some(long)) = ((0..3).min_by(order), (0..3).max_by(order)) else {
            return;
        };
        let edges = self.mesh.topology().face_edges()[f as usize];
        let needle = length(short) <= NEEDLE * self.limit * length(long);
        if !(needle && self.collapse(edges[short])) {
            self.flip(f, edges[long]);
        }
    }

    /// Merges one end of an edge into the other, if the surface stays manifold and no face turns
    /// over or gets thinner than both the limit and the thinnest face before. Returns true if it
    /// did.
    fn collapse(&mut self, e: u32) -> bool {
        let topology = self.mesh.topology();
        let [a, b] = topology.edges()[e as usize];
        let apexes: Vec<u32> = (topology.edge_faces(e).iter())
            .flat_map(|&f| self.mesh.faces()[f as usize])
            .filter(|v| ![a, b].contains(v))
            .collect();
        let neighbors = |v: u32| topology.neighbors(v);
        let [few, many] = if neighbors(a).len() < neighbors(b).len() { [a, b] } else { [b, a] };
        let common = neighbors(few).iter().filter(|v| neighbors(many).binary_search(v).is_ok());
        if topology.edge_faces(e).len() > 2 || common.count() != apexes.len() {
            return false;
        }
        let border = |v: u32| topology.is_boundary_vertex(v);
        if border(a) && border(b) && !topology.is_boundary_edge(e) {
            return false;
        }
        let ends = if border(b) && !border(a) { vec![[b, a]] } else { vec![[a, b], [b, a]] };
        for [stays, goes] in ends {
            let is_hub = self.mesh.incidence().corners(goes).len() > HUB;
            if border(goes) && !border(stays) || is_hub {
                continue;
            }
            let faces: Vec<u32> = self.faces_at(goes).collect();
            let reached = faces.iter().flat_map(|&f| self.mesh.faces()[f as usize]);
            let mut reached: Vec<u32> = reached.chain([stays]).collect();
            reached.sort_unstable();
            reached.dedup();
            if !self.is_apart(&reached, &[goes, stays]) {
                continue;
            }
            let moved = |face: [u32; 3]| face.map(|v| if v == goes { stays } else { v });
            let old = |f: u32| self.mesh.faces()[f as usize];
            let left: Vec<u32> =
                faces.iter().copied().filter(|&f| !old(f).contains(&stays)).collect();
            let before: Vec<[u32; 3]> = faces.iter().map(|&f| old(f)).collect();
            let after: Vec<[u32; 3]> = left.iter().map(|&f| moved(old(f))).collect();
            let upright = left.iter().zip(&after).all(|(&f, &new)| {
                let thin = quality(self.corners(old(f))) < self.limit;
                thin || self.normal(old(f)).dot(self.normal(new)) > 0.0
            });
            if !upright || !self.is_better(&before, &after) {
                continue;
            }
            for &f in &faces {
                self.faces[f as usize] = moved(self.faces[f as usize]);
                if !left.contains(&f) {
                    self.keep[f as usize] = false;
                    self.changed.push(f);
                }
            }
            self.touched.extend(reached);
            self.ends.extend([goes, stays]);
            self.gone.insert(goes);
            return true;
        }
        false
    }

    /// Exchanges the longest edge of a cap for the other diagonal of its two faces; drops a cap
    /// whose longest edge is on the boundary.
    fn flip(&mut self, f: u32, e: u32) {
        let topology = self.mesh.topology();
        let face = self.mesh.faces()[f as usize];
        let ends = topology.edges()[e as usize];
        let third = |f: u32| self.mesh.faces()[f as usize].into_iter().find(|v| !ends.contains(v));
        let Some(apex) = third(f) else { return };
        match *topology.edge_faces(e) {
            // Its apex stays on a face only if it has another one.
            [_] if self.mesh.incidence().corners(apex).len() > 1
                && self.is_apart(&face, &[apex]) =>
            {
                self.keep[f as usize] = false;
                self.changed.push(f);
                self.touched.extend(face);
                self.ends.extend(face);
                self.gone.insert(apex);
            }
            [g, h] => {
                let other = if g == f { h } else { g };
                let Some(far) = third(other) else { return };
                if far == apex || topology.edge_between(apex, far).is_some() {
                    return;
                }
                let four = [apex, far, ends[0], ends[1]];
                if !self.is_apart(&four, &four) {
                    return;
                }
                // In `face` the end before the apex, and the one after it.
                let k = face.iter().position(|&v| v == apex).unwrap_or_default();
                let [after, before] = [face[(k + 1) % 3], face[(k + 2) % 3]];
                let far_face = self.mesh.faces()[other as usize];
                let agree = (0..3).any(|k| far_face[k] == before && far_face[(k + 1) % 3] == after);
                let new = [[apex, after, far], [apex, far, before]];
                let sum = self.normal(face) + self.normal(far_face);
                let upright = new.iter().all(|&face| self.normal(face).dot(sum) > 0.0);
                if !agree || !upright || !self.is_better(&[face, far_face], &new) {
                    return;
                }
                self.faces[f as usize] = new[0];
                self.faces[other as usize] = new[1];
                self.changed.extend([f, other]);
                self.touched.extend(four);
                self.ends.extend(four);
            }
            _ => {}
        }
    }

    /// True if a change of faces with these vertices is compatible with those before it in this
    /// pass, where `ends` get or lose neighbours, the first of them perhaps all faces.
    ///
    /// Either the ends are touched by none and none has ends here, or at most one vertex is shared,
    /// which does not lose faces.
    fn is_apart(&self, vertices: &[u32], ends: &[u32]) -> bool {
        if !ends.iter().any(|v| self.touched.contains(v)) {
            return !vertices.iter().any(|v| self.ends.contains(v)) || self.shares_one(vertices);
        }
        !self.touched.contains(&ends[0]) && self.shares_one(vertices)
    }

    /// True if at most one of these vertices was touched, and has not lost faces.
    fn shares_one(&self, vertices: &[u32]) -> bool {
        let mut touched = vertices.iter().filter(|v| self.touched.contains(v));
        touched.next().is_none_or(|v| !self.gone.contains(v)) && touched.next().is_none()
    }

    fn faces_at(&self, v: u32) -> impl Iterator<Item = u32> + use<'a> {
        self.mesh.incidence().corners(v).iter().map(|c| c / 3)
    }

    /// Along the normal of a face, as long as twice its area.
    fn normal(&self, face: [u32; 3]) -> DVec3 {
        let [a, b, c] = self.corners(face);
        (b - a).cross(c - a)
    }

    /// True if no new face is thinner than both the limit and all old ones.
    fn is_better(&self, before: &[[u32; 3]], after: &[[u32; 3]]) -> bool {
        let thinnest = |faces: &[[u32; 3]]| {
            faces.iter().map(|&face| quality(self.corners(face))).fold(f64::INFINITY, f64::min)
        };
        let new = thinnest(after);
        new >= self.limit || new > thinnest(before)
    }
}

#[cfg(test)]
mod tests {
    use super::super::{RepairOptions, RepairStep, repair};
    use crate::diagnosis::Diagnosis;
    use crate::trimesh::TriMesh;

    /// A disc around a hub and a cone over a disc: changes on opposite sides of a hub are made in
    /// one pass, so that few passes do for thousands of thin faces.
    #[test]
    fn thin_faces_around_a_hub_are_mended() {
        let n = 20_000u32;
        let rim = |i: u32| {
            let angle = std::f64::consts::TAU * f64::from(i) / f64::from(n);
            [angle.cos(), angle.sin(), 0.0]
        };
        let positions = [[0.0; 3], [0.0, 0.0, 1.0]].into_iter().chain((0..n).map(rim));
        let positions: Vec<_> = positions.collect();
        let disc: Vec<_> = (0..n).map(|i| [0, 2 + (i + 1) % n, 2 + i]).collect();
        let cone = disc.iter().map(|&[_, a, b]| [1, b, a]).chain(disc.iter().copied()).collect();
        for (faces, closed) in [(disc, false), (cone, true)] {
            let mesh = TriMesh::new(positions.clone(), faces).unwrap();
            let before = Diagnosis::new(&mesh);
            assert_eq!(before.sliver_faces.count, mesh.face_count());
            let options = RepairOptions { thin: Diagnosis::SLIVER, ..RepairOptions::DEFAULT };
            let repaired = repair(&mesh, &options).unwrap();
            let after = Diagnosis::new(&repaired.mesh);
            assert_eq!((after.sliver_faces.count, after.degenerate_faces.count), (0, 0));
            assert_eq!((after.manifold, after.closed), (true, closed));
            assert_eq!(after.euler_characteristic, if closed { 2 } else { 1 });
            assert!(!repaired.changed(RepairStep::ThinFaces).is_empty());
            // Chords of less than 2·2e-3 cut off less than a millionth.
            assert!((after.area / before.area - 1.0).abs() < 1e-5, "{}", after.area);
        }
    }
}
