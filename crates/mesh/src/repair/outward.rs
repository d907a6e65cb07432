//! Closed components with their normals outwards.

use glam::DVec3;
use rayon::prelude::*;

use super::Work;
use crate::TriMesh;

/// A closed component whose faces agree.
struct Closed {
    faces: Vec<u32>,
    low: DVec3,
    high: DVec3,
    volume: f64,
}

impl Work {
    /// Turns closed components whose volume has the wrong sign: negative, or positive for a
    /// component inside an odd number of others.
    pub(super) fn turn_outward(&mut self) {
        let closed = closed_components(&self.mesh);
        if closed.len() == 1 && closed[0].volume >= 0.0 {
            return;
        }
        let mesh = &self.mesh;
        let wrong: Vec<bool> = closed
            .par_iter()
            .enumerate()
            .map(|(i, inner)| {
                let point = DVec3::from(mesh.triangle(inner.faces[0] as usize)[0]);
                let around = closed.iter().enumerate().filter(|(j, outer)| {
                    *j != i && outer.contains_box_of(inner) && outer.winds_around(mesh, point)
                });
                let cavity = around.count() % 2 == 1;
                if cavity { inner.volume > 0.0 } else { inner.volume < 0.0 }
            })
            .collect();
        if !wrong.contains(&true) {
            return;
        }
        let mut flips = vec![false; self.mesh.face_count()];
        for component in closed.iter().zip(&wrong).filter(|(_, wrong)| **wrong).map(|(c, _)| c) {
            for &f in &component.faces {
                flips[f as usize] = true;
                self.turned[f as usize] ^= true;
            }
        }
        self.mesh = self.mesh.turned(&flips);
    }
}

/// The components without a boundary whose edges have two faces each that agree.
fn closed_components(mesh: &TriMesh) -> Vec<Closed> {
    let topology = mesh.topology();
    let components = topology.components();
    let label = |v: u32| components.label(v).map_or(0, |label| label as usize);
    let mut open = vec![false; components.count()];
    for e in 0..topology.edges().len() as u32 {
        if topology.edge_faces(e).len() != 2 {
            open[label(topology.edges()[e as usize][0])] = true;
        }
    }
    for &e in topology.orientation().inconsistent_edges() {
        open[label(topology.edges()[e as usize][0])] = true;
    }
    let mut faces: Vec<Vec<u32>> = vec![vec![]; components.count()];
    for (f, face) in mesh.faces().iter().enumerate() {
        faces[label(face[0])].push(f as u32);
    }
    let closed = faces.into_iter().zip(open).filter(|(_, open)| !open);
    closed.map(|(faces, _)| Closed::new(mesh, faces)).collect()
}

impl Closed {
    fn new(mesh: &TriMesh, faces: Vec<u32>) -> Self {
        let corners = |f: &u32| mesh.triangle(*f as usize).map(DVec3::from);
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for p in faces.iter().flat_map(corners) {
            (low, high) = (low.min(p), high.max(p));
        }
        let origin = 0.5 * (low + high);
        let volume = faces.iter().map(|f| {
            let [a, b, c] = corners(f).map(|p| p - origin);
            a.dot(b.cross(c))
        });
        Self { volume: volume.sum(), faces, low, high }
    }

    fn contains_box_of(&self, other: &Self) -> bool {
        self.low.cmple(other.low).all() && self.high.cmpge(other.high).all()
    }

    /// True if the winding number of the component around a point is nearer to ±1 than to 0: the
    /// sum of the solid angles of its faces over 4π [vanoosterom1983].
    ///
    /// [vanoosterom1983]: https://doi.org/10.1109/TBME.1983.325207
    fn winds_around(&self, mesh: &TriMesh, point: DVec3) -> bool {
        let half_angles = self.faces.iter().map(|&f| {
            let [a, b, c] = mesh.triangle(f as usize).map(|p| DVec3::from(p) - point);
            let (la, lb, lc) = (a.length(), b.length(), c.length());
            let denominator = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
            libm::atan2(a.dot(b.cross(c)), denominator)
        });
        half_angles.sum::<f64>().abs() > std::f64::consts::PI
    }
}
