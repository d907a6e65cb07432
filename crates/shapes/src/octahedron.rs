//! The regular octahedron.

use fairing_mesh::TriMesh;

use super::made::made;

/// The regular octahedron with vertices at distance 1 along the axes: +x, −x, +y, −y, +z, −z, in
/// this order.
///
/// Four faces around the upper vertex, then four around the lower one. Its uniform Laplacian has
/// the eigenvalues 0, −1 (three times) and −3/2 (twice), the least that a closed triangle mesh can
/// have.
pub fn octahedron() -> TriMesh {
    let axis = |v: usize| {
        let mut p = [0.0; 3];
        p[v / 2] = if v.is_multiple_of(2) { 1.0 } else { -1.0 };
        p
    };
    let upper = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4]];
    let lower = [[2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    made((0..6).map(axis).collect(), [upper, lower].concat())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_closed_and_turned_outward() {
        let mesh = octahedron();
        assert!(mesh.topology().is_closed());
        assert!((mesh.signed_volume() - 4.0 / 3.0).abs() < 1e-15);
    }
}
