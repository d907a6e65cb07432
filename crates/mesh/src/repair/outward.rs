//! Parts with their normals outwards.

use fairing_watch::parallel;
use glam::DVec3;

use super::{RepairOptions, Work};
use crate::trimesh::TriMesh;

/// A component whose faces agree.
struct Part {
    faces: Vec<u32>,
    is_closed: bool,
    low: DVec3,
    high: DVec3,
    volume: f64,
}

impl Work {
    /// Turns closed parts that stand alone inside out, with all that they hold; with
    /// [`RepairOptions::cavities`] each closed part whose volume has the wrong sign, which depends
    /// on the number of others around it. Notes the parts that only cavities would turn.
    pub(super) fn turn_outward(&mut self, options: &RepairOptions) {
        self.nested.clear();
        let parts = parts(&self.mesh);
        if let [part] = &parts[..]
            && part.volume >= 0.0
        {
            return;
        }
        let mesh = &self.mesh;
        let around: Vec<Vec<usize>> = parallel::map(parts.len(), 1, |i| {
            let inner = &parts[i];
            let point = DVec3::from(mesh.triangle(inner.faces[0] as usize)[0]);
            let holds = |(j, outer): &(usize, &Part)| {
                *j != i
                    && outer.is_closed
                    && outer.contains_box_of(inner)
                    && outer.winds_around(mesh, point)
            };
            parts.iter().enumerate().filter(holds).map(|(j, _)| j).collect()
        });
        // Of the parts around another, the outermost has no part around itself.
        let outermost = |i: usize| around[i].iter().copied().find(|&j| around[j].is_empty());
        let is_inside_out = |i: usize| parts[i].is_closed && parts[i].volume < 0.0;
        let holder_is = |i: usize| is_inside_out(outermost(i).unwrap_or(i));
        let has_wrong_sign = |i: usize| {
            let cavity = around[i].len() % 2 == 1;
            parts[i].is_closed && parts[i].volume != 0.0 && cavity == (parts[i].volume > 0.0)
        };
        let is_turned = |i| if options.cavities { has_wrong_sign(i) } else { holder_is(i) };
        let turned: Vec<bool> = (0..parts.len()).map(is_turned).collect();
        for i in (0..parts.len()).filter(|&i| !options.cavities && has_wrong_sign(i) != turned[i]) {
            self.nested.extend(parts[i].faces.iter().find_map(|&f| self.face_sources[f as usize]));
        }
        if !turned.contains(&true) {
            return;
        }
        let mut flips = vec![false; self.mesh.face_count()];
        for part in parts.iter().zip(&turned).filter(|(_, turned)| **turned).map(|(part, _)| part) {
            for &f in &part.faces {
                flips[f as usize] = true;
                self.turned[f as usize] ^= true;
            }
        }
        self.mesh = self.mesh.turned(&flips);
    }
}

/// The components whose faces agree. If none is closed, nothing has an outside, and there are no
/// parts.
fn parts(mesh: &TriMesh) -> Vec<Part> {
    let topology = mesh.topology();
    let components = topology.components();
    let label = |v: u32| components.label(v).map_or(0, |label| label as usize);
    let at = |e: u32| label(topology.edges()[e as usize][0]);
    let (mut is_closed, mut agrees) =
        (vec![true; components.count()], vec![true; components.count()]);
    for e in 0..topology.edges().len() as u32 {
        is_closed[at(e)] &= topology.edge_faces(e).len() == 2;
    }
    for &e in topology.orientation().inconsistent_edges() {
        agrees[at(e)] = false;
    }
    if !is_closed.iter().zip(&agrees).any(|(closed, agrees)| *closed && *agrees) {
        return vec![];
    }
    let mut faces: Vec<Vec<u32>> = vec![vec![]; components.count()];
    for (f, face) in mesh.faces().iter().enumerate() {
        faces[label(face[0])].push(f as u32);
    }
    let agreeing = faces.into_iter().zip(is_closed).zip(agrees).filter(|(_, agrees)| *agrees);
    agreeing.map(|((faces, is_closed), _)| Part::new(mesh, faces, is_closed)).collect()
}

impl Part {
    fn new(mesh: &TriMesh, faces: Vec<u32>, is_closed: bool) -> Self {
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
        Self { volume: volume.sum(), faces, is_closed, low, high }
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
