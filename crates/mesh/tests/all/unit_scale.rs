//! Meshes of any size brought near one.

use std::borrow::Cow;

use fairing_mesh::TriMesh;
use fairing_shapes as shapes;

fn scaled(exponent: i32, isolated: Option<f64>) -> TriMesh {
    let sphere = shapes::icosphere(1);
    let unit = 2f64.powi(exponent / 2) * 2f64.powi(exponent - exponent / 2);
    let mut positions: Vec<_> = sphere.positions().iter().map(|p| p.map(|x| x * unit)).collect();
    positions.extend(isolated.map(|x| [x, 0.0, -x]));
    TriMesh::new(positions, sphere.faces().to_vec()).unwrap()
}

#[test]
fn ordinary_sizes_are_kept_and_others_come_near_one() {
    for exponent in [-60, -1, 0, 20, 62] {
        let mesh = scaled(exponent, None);
        assert!(matches!(mesh.at_unit_scale(), (Cow::Borrowed(_), 1.0)), "2^{exponent}");
    }
    for exponent in [-900, -300, -70, 70, 300, 1000] {
        for isolated in [None, Some(0.5), Some(1e300), Some(1e-300)] {
            let mesh = scaled(exponent, isolated);
            let (near_one, unit) = mesh.at_unit_scale();
            let diagonal = (0..near_one.face_count())
                .map(|f| fairing_mesh::vec3::norm(near_one.triangle(f)[0]))
                .fold(0.0, f64::max);
            assert!((0.5..4.0).contains(&diagonal), "2^{exponent} {isolated:?} {diagonal}");
            // An isolated vertex far away would overflow.
            assert!(near_one.positions().as_flattened().iter().all(|x| x.is_finite()));
            let faces = mesh.faces().as_flattened().iter().map(|&v| v as usize);
            for v in faces {
                assert_eq!(near_one.positions()[v].map(|x| x * unit), mesh.positions()[v]);
            }
        }
    }
    let largest =
        TriMesh::new(vec![[f64::MAX; 3], [-f64::MAX; 3], [f64::MAX, 0.0, 1.0]], vec![[0, 1, 2]]);
    let largest = largest.unwrap();
    assert!(largest.at_unit_scale().0.positions().as_flattened().iter().all(|x| x.abs() <= 2.0));
}

#[test]
fn without_extent_there_is_nothing_to_scale() {
    let point = TriMesh::new(vec![[1e-300; 3]; 3], vec![[0, 1, 2]]).unwrap();
    let none = TriMesh::new(vec![[1e-300; 3], [1e300; 3]], vec![]).unwrap();
    assert_eq!((point.scale_unit(), none.scale_unit()), (1.0, 1.0));
}
