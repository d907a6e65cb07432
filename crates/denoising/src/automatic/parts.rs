//! Some of the connected parts of a mesh as a mesh of its own, numbered so that neighbours are near
//! in memory.

use std::borrow::Cow;

use fairing_mesh::TriMesh;

use crate::{DenoiseError, Masked};

/// The distance between numbers of vertices beyond which their data are not loaded together.
const FAR: u32 = 1 << 10;

/// A mesh of some of the parts, with vertices and faces in their order unless that is scattered.
pub(super) struct Part<'a> {
    pub(super) mesh: Cow<'a, TriMesh>,
    /// The vertex of the whole mesh that each vertex is.
    vertices: Vec<u32>,
    /// A flag for each vertex.
    fixed: Vec<bool>,
}

impl<'a> Part<'a> {
    /// The parts of these numbers, ascending; the whole mesh if these are all.
    pub(super) fn new(input: Masked<'a>, components: &[u32]) -> Result<Self, DenoiseError> {
        let whole = input.mesh();
        let flags =
            |vertices: &[u32]| vertices.iter().map(|&v| input.is_fixed(v as usize)).collect();
        let parts = whole.topology().components();
        let scattered = is_scattered(whole);
        let mut vertices: Vec<u32> = match scattered {
            true => breadth_first(whole),
            false => (0..whole.vertex_count() as u32).collect(),
        };
        if components.len() == parts.count() && !scattered {
            return Ok(Self { mesh: Cow::Borrowed(whole), fixed: flags(&vertices), vertices });
        }
        vertices.retain(|&v| {
            parts.label(v).is_some_and(|part| components.binary_search(&part).is_ok())
        });
        let mut number = vec![u32::MAX; whole.vertex_count()];
        for (new, &v) in (0..).zip(&vertices) {
            number[v as usize] = new;
        }
        let taken = whole.faces().iter().map(|face| face.map(|v| number[v as usize]));
        let mut faces: Vec<[u32; 3]> = taken.filter(|face| face[0] != u32::MAX).collect();
        if scattered {
            faces.sort_by_key(|face| face.iter().min().copied());
        }
        let positions = vertices.iter().map(|&v| whole.positions()[v as usize]).collect();
        let mesh = Cow::Owned(TriMesh::new(positions, faces)?);
        Ok(Self { mesh, fixed: flags(&vertices), vertices })
    }

    /// The mesh with its fixed vertices.
    pub(super) fn masked(&self) -> Result<Masked<'_>, DenoiseError> {
        Ok(Masked::new(&self.mesh, &self.fixed)?)
    }

    /// Writes the positions of a mesh with these vertices where they belong.
    pub(super) fn put_back(&self, mesh: &TriMesh, positions: &mut [[f64; 3]]) {
        for (&v, &p) in self.vertices.iter().zip(mesh.positions()) {
            positions[v as usize] = p;
        }
    }
}

/// Returns true if one face in four has a corner that is far from all corners of the eight faces
/// before it, so that each use of a vertex waits for memory.
fn is_scattered(mesh: &TriMesh) -> bool {
    let far = mesh.faces().windows(9).map(|faces| {
        let before = faces[..8].as_flattened();
        faces[8].iter().filter(|v| before.iter().all(|w| v.abs_diff(*w) > FAR)).count()
    });
    4 * far.sum::<usize>() > mesh.face_count()
}

/// All vertices, neighbours after neighbours, beginning at the first of each part.
fn breadth_first(mesh: &TriMesh) -> Vec<u32> {
    let incidence = mesh.incidence();
    let mut order = Vec::with_capacity(mesh.vertex_count());
    let mut seen = vec![false; mesh.vertex_count()];
    let mut done = 0;
    for first in 0..mesh.vertex_count() as u32 {
        if !std::mem::replace(&mut seen[first as usize], true) {
            order.push(first);
        }
        while let Some(&v) = order.get(done) {
            done += 1;
            for &w in incidence.sides(v).as_flattened() {
                if !std::mem::replace(&mut seen[w as usize], true) {
                    order.push(w);
                }
            }
        }
    }
    order
}

#[cfg(test)]
mod tests {
    use fairing_shapes as shapes;

    use super::*;

    #[test]
    fn parts_are_taken_out_and_put_back() {
        let positions: Vec<[f64; 3]> =
            (0..11).map(|i| [f64::from(i), f64::from(i * i), 0.0]).collect();
        // Three parts whose vertices alternate; vertex 9 is isolated.
        let faces = vec![[0, 3, 6], [1, 4, 7], [2, 5, 8], [10, 3, 0]];
        let whole = TriMesh::new(positions.clone(), faces).unwrap();
        let part = Part::new((&whole).into(), &[0, 2]).unwrap();
        assert_eq!(part.vertices, [0, 2, 3, 5, 6, 8, 10]);
        assert_eq!(part.mesh.faces(), [[0, 2, 4], [1, 3, 5], [6, 2, 0]]);
        assert_eq!(part.mesh.positions()[6], positions[10]);
        let moved = part.mesh.positions().iter().map(|p| [p[0], p[1], 1.0]).collect();
        let mut found = positions;
        part.put_back(&part.mesh.with_positions(moved).unwrap(), &mut found);
        let raised: Vec<usize> = (0..11).filter(|&v| found[v][2] == 1.0).collect();
        assert_eq!(raised, [0, 2, 3, 5, 6, 8, 10]);
        assert_eq!(found[10][..2], [10.0, 100.0]);
    }

    /// Random numbers become near ones, and each vertex goes back to its place.
    #[test]
    fn scattered_parts_are_renumbered() {
        let mesh = shapes::torus(1.0, 0.4, 300, 150);
        assert!(!is_scattered(&mesh));
        let n = mesh.vertex_count() as u32;
        // Factors without common divisors permute.
        let to = |v: u32| (u64::from(v) * 23_456_789 % u64::from(n)) as u32;
        let mut positions = vec![[0.0; 3]; n as usize];
        for (v, &p) in (0..).zip(mesh.positions()) {
            positions[to(v) as usize] = p;
        }
        let faces = (0..mesh.face_count())
            .map(|f| mesh.faces()[f * 34_567 % mesh.face_count()].map(to))
            .collect();
        let whole = TriMesh::new(positions.clone(), faces).unwrap();
        assert!(is_scattered(&whole));
        let fixed: Vec<bool> = (0..n).map(|v| v % 3 == 0).collect();
        let part = Part::new(Masked::new(&whole, &fixed).unwrap(), &[0]).unwrap();
        assert!(!is_scattered(&part.mesh));
        assert!(part.vertices.iter().zip(&part.fixed).all(|(v, fixed)| *fixed == (v % 3 == 0)));
        assert_eq!(part.mesh.face_count(), whole.face_count());
        let corner = |mesh: &TriMesh, v: u32| mesh.positions()[v as usize].map(f64::to_bits);
        let sorted = |mesh: &TriMesh| {
            let mut faces: Vec<_> =
                mesh.faces().iter().map(|face| face.map(|v| corner(mesh, v))).collect();
            faces.sort_unstable();
            faces
        };
        assert_eq!(sorted(&part.mesh), sorted(&whole));
        let mut found = vec![[0.0; 3]; n as usize];
        part.put_back(&part.mesh, &mut found);
        assert_eq!(found, positions);
    }
}
