//! Faces of grids, open or joined at their ends, and the mesh made of them.

use fairing_mesh::TriMesh;

/// The diagonals by which the squares of a grid are cut into triangles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Diagonals {
    /// All parallel, along (1, 1): six faces at each inner vertex.
    #[default]
    Regular,
    /// In turn along (1, 1) and (1, −1), like a chessboard: four and eight
    /// faces at inner vertices.
    Alternating,
}

/// The two faces of the square `a b c d`, counter-clockwise, cut along `a c`
/// or `b d`.
pub(super) fn square([a, b, c, d]: [u32; 4], along_ac: bool) -> [[u32; 3]; 2] {
    if along_ac { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] }
}

/// The faces of `columns × rows` squares over vertices `id(i, j)`,
/// counter-clockwise for `i` to the right and `j` upwards; row after row.
pub(super) fn grid_faces(
    columns: u32,
    rows: u32,
    diagonals: Diagonals,
    id: impl Fn(u32, u32) -> u32,
) -> Vec<[u32; 3]> {
    let mut faces = Vec::with_capacity(2 * columns as usize * rows as usize);
    for j in 0..rows {
        for i in 0..columns {
            let along_ac = diagonals == Diagonals::Regular || (i + j) % 2 == 0;
            let corners = [id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)];
            faces.extend(square(corners, along_ac));
        }
    }
    faces
}

/// Returns the mesh of positions and faces whose validity the parameters of a shape guarantee.
pub(crate) fn made(positions: Vec<[f64; 3]>, faces: Vec<[u32; 3]>) -> TriMesh {
    match TriMesh::new(positions, faces) {
        Ok(mesh) => mesh,
        Err(error) => panic!("the parameters of a shape give no mesh: {error}"),
    }
}
