//! Subdivision of shapes with a known result.

use fairing_mesh::{subdivide_loop, subdivide_midpoint};
use fairing_shapes as shapes;
use glam::DVec3;

#[test]
fn midpoints_leave_the_surface() {
    let coarse = shapes::torus(3.0, 1.0, 12, 8);
    let fine = subdivide_midpoint(&coarse).unwrap();
    assert_eq!(fine.face_count(), 4 * coarse.face_count());
    assert_eq!(fine.topology().genus(), Some(1));
    // One rounding per face.
    assert!((fine.area() / coarse.area() - 1.0).abs() < 1e-13);
    assert!((fine.signed_volume() / coarse.signed_volume() - 1.0).abs() < 1e-13);
}

/// The weights sum to one, and on a regular grid Loop's scheme has linear precision: a
/// plane and its inner vertices are reproduced.
#[test]
fn loop_keeps_a_regular_plane() {
    let plane = shapes::plane(6, 6, shapes::Diagonals::Regular);
    let fine = subdivide_loop(&plane).unwrap();
    let old = plane.positions();
    for v in 0..plane.vertex_count() {
        let [x, y, _] = old[v];
        if plane.topology().is_boundary_vertex(v as u32) {
            let corner = [x, y].iter().all(|&t| t == 0.0 || t == 1.0);
            let moved = DVec3::from(old[v]).distance(fine.positions()[v].into());
            // A corner moves by ¼ of the way to the midpoint of its
            // neighbours, √2 / 12.
            let expected = if corner { 2f64.sqrt() / 48.0 } else { 0.0 };
            assert!((moved - expected).abs() < 1e-15);
        } else {
            assert!(DVec3::from(old[v]).distance(fine.positions()[v].into()) < 1e-15);
        }
    }
    assert!(fine.positions().iter().all(|p| p[2] == 0.0));
}
