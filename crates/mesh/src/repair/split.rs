//! Sheets: the faces around a vertex that are connected by manifold edges or by pairs.

use glam::DVec3;

use crate::trimesh::TriMesh;

/// For each corner the number of its sheet; corners of one vertex in one sheet share a number.
///
/// An edge with two faces connects them. The faces of an edge with more are paired, and a pair
/// that would leave three or more faces at an edge of the result is cut.
pub(super) fn sheets(mesh: &TriMesh) -> Vec<[u32; 3]> {
    let topology = mesh.topology();
    let mut pairs: Vec<(u32, Vec<[u32; 2]>)> =
        topology.nonmanifold_edges().map(|e| (e, pairs_at(mesh, e))).collect();
    loop {
        let mut sets = Corners::new(mesh);
        for e in 0..topology.edges().len() as u32 {
            if let &[f, g] = topology.edge_faces(e) {
                sets.join(mesh, e, [f, g]);
            }
        }
        for (e, pairs) in &pairs {
            pairs.iter().for_each(|&pair| sets.join(mesh, *e, pair));
        }
        let mut cut = false;
        for (e, pairs) in &mut pairs {
            if let Some(crowded) = sets.crowded(mesh, *e) {
                let last = pairs.iter().rposition(|pair| pair.iter().any(|f| crowded.contains(f)));
                cut |= last.map(|last| pairs.remove(last)).is_some();
            }
        }
        if !cut {
            return sets.roots();
        }
    }
}

/// Pairs of the faces at an edge that bound a wedge of the inside between them: in the order of
/// angles around the edge, a face that runs along it and the next one, on its inner side, that
/// runs against it, as brackets match.
fn pairs_at(mesh: &TriMesh, e: u32) -> Vec<[u32; 2]> {
    let topology = mesh.topology();
    let [from, to] = topology.edges()[e as usize];
    let [a, b] = [from, to].map(|v| DVec3::from(mesh.positions()[v as usize]));
    let axis = (b - a).normalize_or_zero();
    let across = |f: u32| {
        let third = mesh.faces()[f as usize].into_iter().find(|v| ![from, to].contains(v));
        let out = third.map_or(DVec3::ZERO, |v| DVec3::from(mesh.positions()[v as usize]) - a);
        out - axis * axis.dot(out)
    };
    let faces = topology.edge_faces(e);
    let x = across(faces[0]).normalize_or_zero();
    let y = axis.cross(x);
    let mut around: Vec<(f64, u32, bool)> = faces
        .iter()
        .map(|&f| {
            let out = across(f);
            let face = mesh.faces()[f as usize];
            let along = (0..3).any(|k| face[k] == from && face[(k + 1) % 3] == to);
            (libm::atan2(out.dot(y), out.dot(x)), f, along)
        })
        .collect();
    // Normals of faces that run along the edge point to larger angles, so that the inside of each
    // lies towards smaller ones. Of faces at one angle, those that end a wedge come first.
    around.sort_by(|p, q| q.0.total_cmp(&p.0).then(p.2.cmp(&q.2)).then(p.1.cmp(&q.1)));
    let mut pairs = vec![];
    let mut open = vec![];
    // Twice around, because a wedge may contain the angle where the order begins.
    let mut paired = vec![false; around.len()];
    for i in (0..around.len()).chain(0..around.len()) {
        match around[i].2 {
            _ if paired[i] => {}
            true if !open.contains(&i) => open.push(i),
            true => {}
            false => {
                if let Some(first) = open.pop() {
                    (paired[first], paired[i]) = (true, true);
                    pairs.push([around[first].1, around[i].1]);
                }
            }
        }
    }
    pairs
}

/// Corners in disjoint sets.
struct Corners(Vec<u32>);

impl Corners {
    fn new(mesh: &TriMesh) -> Self {
        Self((0..3 * mesh.face_count() as u32).collect())
    }

    fn root(&mut self, corner: u32) -> u32 {
        let mut at = corner;
        while self.0[at as usize] != at {
            let up = self.0[self.0[at as usize] as usize];
            self.0[at as usize] = up;
            at = up;
        }
        at
    }

    /// Joins the corners of two faces at both ends of an edge.
    fn join(&mut self, mesh: &TriMesh, e: u32, faces: [u32; 2]) {
        for v in mesh.topology().edges()[e as usize] {
            let [a, b] = faces.map(|f| self.root(corner(mesh, f, v)));
            self.0[a.max(b) as usize] = a.min(b);
        }
    }

    /// The faces at an edge that would share both its ends, if they are more than two.
    fn crowded(&mut self, mesh: &TriMesh, e: u32) -> Option<Vec<u32>> {
        let ends = mesh.topology().edges()[e as usize];
        let mut faces: Vec<([u32; 2], u32)> = (mesh.topology().edge_faces(e).iter())
            .map(|&f| (ends.map(|v| self.root(corner(mesh, f, v))), f))
            .collect();
        faces.sort_unstable();
        let crowded = faces.chunk_by(|x, y| x.0 == y.0).find(|group| group.len() > 2)?;
        Some(crowded.iter().map(|&(_, f)| f).collect())
    }

    fn roots(mut self) -> Vec<[u32; 3]> {
        (0..self.0.len() as u32 / 3).map(|f| [0, 1, 2].map(|k| self.root(3 * f + k))).collect()
    }
}

/// The corner of face `f` at vertex `v`, one of its three.
fn corner(mesh: &TriMesh, f: u32, v: u32) -> u32 {
    let k = mesh.faces()[f as usize].iter().position(|&w| w == v).unwrap_or_default();
    3 * f + k as u32
}
