//! Some of the connected parts of a mesh as a mesh of its own.

use std::borrow::Cow;

use fairing_mesh::TriMesh;

use crate::{DenoiseError, Masked};

/// A mesh of some of the parts, with vertices and faces in their order.
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
        if components.len() == parts.count() {
            let vertices: Vec<u32> = (0..whole.vertex_count() as u32).collect();
            return Ok(Self { mesh: Cow::Borrowed(whole), fixed: flags(&vertices), vertices });
        }
        let mut number = vec![u32::MAX; whole.vertex_count()];
        let mut vertices = vec![];
        for v in 0..whole.vertex_count() as u32 {
            if parts.label(v).is_some_and(|part| components.binary_search(&part).is_ok()) {
                number[v as usize] = vertices.len() as u32;
                vertices.push(v);
            }
        }
        let taken = whole.faces().iter().map(|face| face.map(|v| number[v as usize]));
        let faces = taken.filter(|face| face[0] != u32::MAX).collect();
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

#[cfg(test)]
mod tests {
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
}
