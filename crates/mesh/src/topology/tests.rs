use crate::TriMesh;

fn mesh(vertex_count: usize, faces: &[[u32; 3]]) -> TriMesh {
    let positions = (0..vertex_count).map(|i| [i as f64, (i * i) as f64, 0.0]).collect();
    TriMesh::new(positions, faces.to_vec()).unwrap()
}

fn tetrahedron() -> TriMesh {
    mesh(4, &[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
}

#[test]
fn a_tetrahedron_by_hand() {
    let mesh = tetrahedron();
    let t = mesh.topology();
    assert_eq!(t.edges(), [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]]);
    assert_eq!(t.face_edges()[1], [4, 2, 0]);
    assert_eq!(t.edge_faces(0), [0, 1]);
    assert_eq!(t.edge_between(3, 1), Some(4));
    assert_eq!(t.neighbors(2), [0, 1, 3]);
    assert_eq!(t.euler_characteristic(), 2);
    assert_eq!(t.genus(), Some(0));
    assert!(t.is_closed() && t.is_manifold() && t.orientation().is_consistent());
    assert_eq!(t.components().count(), 1);
    let ring = t.ring(3);
    assert_eq!(ring.len(), 1);
    assert!(ring[0].closed);
    assert_eq!(ring[0].faces, [1, 2, 3]);
    assert_eq!(ring[0].vertices, [0, 1, 2]);
}

#[test]
fn an_open_ring_starts_at_its_end() {
    // A square around vertex 4 with the side 3-0 missing; faces shuffled.
    let mesh = mesh(5, &[[4, 1, 2], [3, 4, 2], [0, 1, 4]]);
    let t = mesh.topology();
    let ring = t.ring(4);
    assert_eq!(ring.len(), 1);
    assert!(!ring[0].closed);
    assert_eq!(ring[0].vertices, [0, 1, 2, 3]);
    assert_eq!(ring[0].faces, [2, 0, 1]);
    assert_eq!(t.boundary_loops(), [vec![0, 1, 2, 3, 4]]);
    assert_eq!(t.genus(), Some(0));
    assert!(t.boundary_vertices().iter().all(|&b| b));
}

#[test]
fn three_faces_on_an_edge() {
    let mesh = mesh(6, &[[0, 1, 2], [1, 0, 3], [0, 1, 4]]);
    let t = mesh.topology();
    assert_eq!(t.nonmanifold_edges().collect::<Vec<_>>(), [0]);
    assert_eq!(t.edge_faces(0), [0, 1, 2]);
    assert!(t.nonmanifold_vertices().is_empty());
    assert!(!t.is_manifold());
    assert_eq!(t.genus(), None);
    assert_eq!(t.ring(0).len(), 3);
    assert_eq!(t.boundary_loops().len(), 1);
    let mut vertices = t.boundary_loops()[0].clone();
    vertices.sort_unstable();
    assert_eq!(vertices, [0, 1, 2, 3, 4]);
    assert_eq!(t.isolated_vertices().collect::<Vec<_>>(), [5]);
    assert_eq!(t.components().of_vertex(5), None);
}

#[test]
fn sheets_that_touch_in_a_vertex() {
    let mesh = mesh(5, &[[0, 1, 2], [0, 3, 4]]);
    let t = mesh.topology();
    assert_eq!(t.nonmanifold_vertices(), [0]);
    assert_eq!(t.boundary_loops(), [vec![0, 1, 2], vec![0, 3, 4]]);
    assert_eq!(t.components().count(), 1);
    assert_eq!(t.ring(0).len(), 2);
    assert_eq!(t.genus(), None);
}

#[test]
fn a_moebius_band_is_not_orientable() {
    // Five triangles in a strip, the ends joined with a twist.
    let faces: Vec<[u32; 3]> = (0..5).map(|i| [i, (i + 1) % 5, (i + 2) % 5]).collect();
    let mesh = mesh(5, &faces);
    let t = mesh.topology();
    assert!(t.is_manifold() && !t.is_closed());
    assert!(!t.orientation().is_orientable());
    assert_eq!(t.orientation().flips(), None);
    assert_eq!(t.boundary_loops().len(), 1);
    assert_eq!(t.boundary_loops()[0].len(), 5);
    assert_eq!(t.euler_characteristic(), 0);
    assert_eq!(t.genus(), None);
}

#[test]
fn flips_make_orientation_consistent() {
    let mut faces = tetrahedron().faces().to_vec();
    faces[2].swap(0, 1);
    let mesh = mesh(4, &faces);
    let orientation = mesh.topology().orientation();
    assert_eq!(orientation.inconsistent_edges().len(), 3);
    assert_eq!(orientation.flips(), Some(&[false, false, true, false][..]));
    assert_eq!(mesh.topology().genus(), Some(0));
}

#[test]
fn nothing_at_all() {
    for count in [0, 3] {
        let mesh = mesh(count, &[]);
        let t = mesh.topology();
        assert!(t.edges().is_empty() && t.boundary_loops().is_empty());
        assert!(!t.is_closed());
        assert_eq!((t.components().count(), t.genus()), (0, None));
    }
}

#[test]
fn two_faces_with_the_same_corners() {
    let mesh = mesh(3, &[[0, 1, 2], [0, 2, 1]]);
    let t = mesh.topology();
    assert!(t.is_closed() && t.is_manifold());
    assert_eq!(t.genus(), Some(0));
    assert_eq!(t.ring(0), [super::Fan { vertices: vec![1, 2], faces: vec![0, 1], closed: true }]);
}
