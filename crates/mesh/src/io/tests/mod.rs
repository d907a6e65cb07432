//! Tests of reading and writing together.

mod broken;
mod kinds;
mod losses;
mod mutations;
mod round_trips;

use crate::io::{MeshFile, Reader};
use crate::trimesh::TriMesh;

/// Reads bytes under a name.
pub(crate) fn read(name: &str, bytes: &[u8]) -> MeshFile {
    Reader::default().read_bytes(name, bytes).unwrap_or_else(|error| panic!("{error}"))
}

/// The error for bytes that reading must refuse.
pub(crate) fn refusal(name: &str, bytes: &[u8], reader: &Reader) -> String {
    match reader.read_bytes(name, bytes) {
        Ok(file) => panic!("{name} was read: {}", file.report),
        Err(error) => error.to_string(),
    }
}

/// A tetrahedron with coordinates that no 32-bit number holds.
pub(crate) fn tetrahedron() -> TriMesh {
    let positions = vec![[0.1, 0.2, 0.3], [1.1, 0.2, 0.3], [0.1, 1.2, 0.3], [0.1, 0.2, 1.3]];
    let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    TriMesh::new(positions, faces).unwrap()
}
