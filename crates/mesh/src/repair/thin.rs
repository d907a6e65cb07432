//! Needles and caps.

use std::collections::HashSet;

use fairing_watch as watch;
use glam::DVec3;

use super::{RepairStep, Work};
use crate::TriMesh;

/// The most passes over the thin faces; neighbours of a changed face wait for the next pass.
const MAX_PASSES: usize = 50;

/// The ratio of shortest to longest edge below which a thin face is a needle, in units of the
/// limit of heights. At the limit itself the apex would lie straight above one end.
const NEEDLE: f64 = 5.0;

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
    match longest > 0.0 {
        true => (b - a).cross(c - a).length() / longest,
        false => 0.0,
    }
}

/// One pass over the thin faces, each change at a distance from the others.
struct Pass<'a> {
    mesh: &'a TriMesh,
    limit: f64,
    faces: Vec<[u32; 3]>,
    keep: Vec<bool>,
    touched: HashSet<u32>,
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
        let common = topology.neighbors(a).iter().filter(|v| topology.neighbors(b).contains(v));
        if topology.edge_faces(e).len() > 2 || common.count() != apexes.len() {
            return false;
        }
        let border = |v: u32| topology.is_boundary_vertex(v);
        if border(a) && border(b) && !topology.is_boundary_edge(e) {
            return false;
        }
        let ends = if border(b) && !border(a) { vec![[b, a]] } else { vec![[a, b], [b, a]] };
        for [stays, goes] in ends {
            if border(goes) && !border(stays) {
                continue;
            }
            let faces: Vec<u32> = self.faces_at(goes).collect();
            let reached = faces.iter().flat_map(|&f| self.mesh.faces()[f as usize]);
            let reached: Vec<u32> = reached.chain([stays]).collect();
            if reached.iter().any(|v| self.touched.contains(v)) {
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
        if face.iter().any(|v| self.touched.contains(v)) {
            return;
        }
        match *topology.edge_faces(e) {
            // Its apex stays on a face only if it has another one.
            [_] if self.faces_at(apex).count() > 1 => {
                self.keep[f as usize] = false;
                self.changed.push(f);
                self.touched.extend(face);
            }
            [g, h] => {
                let other = if g == f { h } else { g };
                let Some(far) = third(other) else { return };
                if far == apex || topology.edge_between(apex, far).is_some() {
                    return;
                }
                if self.touched.contains(&far) {
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
                self.touched.extend(face.into_iter().chain([far]));
            }
            _ => {}
        }
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
