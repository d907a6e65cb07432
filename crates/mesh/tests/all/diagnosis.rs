//! Diagnoses of sound surfaces.

use fairing_mesh::{Diagnosis, TriMesh};
use fairing_shapes as shapes;

#[test]
fn a_sphere_is_clean() {
    let diagnosis = Diagnosis::new(&shapes::icosphere(2));
    assert!(diagnosis.is_clean() && diagnosis.closed && diagnosis.orientable);
    assert_eq!((diagnosis.vertices, diagnosis.edges, diagnosis.faces), (162, 480, 320));
    assert_eq!((diagnosis.genus, diagnosis.euler_characteristic), (Some(0), 2));
    assert_eq!((diagnosis.components, diagnosis.boundary_loops), (1, 0));
}

#[test]
fn a_body_turned_inside_out_has_negative_volume() {
    let sphere = shapes::icosphere(2);
    let faces = sphere.faces().iter().map(|&[a, b, c]| [a, c, b]).collect();
    let turned = TriMesh::new(sphere.positions().to_vec(), faces).unwrap();
    let (inward, outward) = (Diagnosis::new(&turned), Diagnosis::new(&sphere));
    assert_eq!(inward.volume.map(|v| -v), outward.volume);
}
