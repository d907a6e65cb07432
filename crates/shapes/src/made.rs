//! Assembly of a shape.

use fairing_mesh::TriMesh;

/// Returns the mesh of positions and faces whose validity the parameters of a shape guarantee.
pub(crate) fn made(positions: Vec<[f64; 3]>, faces: Vec<[u32; 3]>) -> TriMesh {
    match TriMesh::new(positions, faces) {
        Ok(mesh) => mesh,
        Err(error) => panic!("the parameters of a shape give no mesh: {error}"),
    }
}
