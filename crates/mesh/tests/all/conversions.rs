//! Meshes of other crates, behind features.

#[cfg(any(feature = "nalgebra", feature = "parry3d", feature = "ply-rs", feature = "tobj"))]
use {fairing_mesh::TriMesh, fairing_shapes as shapes};

#[cfg(feature = "nalgebra")]
#[test]
fn points_of_nalgebra_are_the_positions() {
    let mesh = shapes::icosphere(2);
    let points: Vec<nalgebra::Point3<f64>> = (&mesh).into();
    assert_eq!(TriMesh::from_points(&points, mesh.faces().to_vec()).unwrap(), mesh);
    let matrix = nalgebra::Matrix3xX::from(&mesh);
    assert_eq!((matrix.ncols(), matrix.as_slice()), (162, mesh.positions().as_flattened()));
    let turned = nalgebra::Rotation3::from_axis_angle(&nalgebra::Vector3::z_axis(), 1.0) * matrix;
    let turned = turned.column_iter().map(|column| [column[0], column[1], column[2]]).collect();
    let turned = mesh.with_positions(turned).unwrap();
    assert!((turned.area() - mesh.area()).abs() < 1e-12 * mesh.area());
}

#[cfg(feature = "parry3d")]
#[test]
fn parry_measures_the_same_mesh() {
    use parry3d_f64::shape::{self, Shape as _};
    let mesh = shapes::icosphere(3);
    let theirs = shape::TriMesh::try_from(&mesh).unwrap();
    assert_eq!(TriMesh::try_from(&theirs).unwrap(), mesh);
    // The mass of density 1 is the volume.
    let volume = theirs.mass_properties(1.0).mass();
    assert!((volume - mesh.signed_volume()).abs() < 1e-9, "{volume}");
    let points = TriMesh::new(vec![[0.0; 3]], vec![]).unwrap();
    assert!(shape::TriMesh::try_from(&points).is_err());
}

#[cfg(feature = "tobj")]
#[test]
fn meshes_of_tobj_are_read() {
    let mesh = shapes::icosphere(2);
    let theirs = tobj::Mesh::from(&mesh);
    let again = TriMesh::try_from(&theirs).unwrap();
    assert_eq!(again.faces(), mesh.faces());
    for (p, q) in again.positions().iter().zip(mesh.positions()) {
        assert_eq!(*p, q.map(|x| f64::from(x as f32)));
    }
    let quad = tobj::Mesh {
        positions: vec![0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0],
        indices: vec![0, 1, 2, 3, 2, 1, 0],
        face_arities: vec![4, 3],
        ..tobj::Mesh::default()
    };
    assert_eq!(TriMesh::try_from(&quad).unwrap().faces(), [[0, 1, 2], [0, 2, 3], [2, 1, 0]]);
    let short = tobj::Mesh { face_arities: vec![4, 4], ..quad.clone() };
    assert!(TriMesh::try_from(&short).is_ok());
    let missing = tobj::Mesh { face_arities: vec![4, 3, 3], ..quad.clone() };
    let error = TriMesh::try_from(&missing).unwrap_err().to_string();
    assert!(error.contains("face 2 has 0 corners"), "{error}");
    let uneven = tobj::Mesh { positions: vec![0.0; 4], ..quad };
    let error = TriMesh::try_from(&uneven).unwrap_err().to_string();
    assert!(error.contains("4 coordinates are not a multiple of three"), "{error}");
}

#[cfg(feature = "ply-rs")]
#[test]
fn content_of_ply_rs_is_read_and_written() {
    use fairing_mesh::io::Reader;
    use ply_rs::ply::{DefaultElement, Ply, Property};
    let mesh = shapes::icosphere(2);
    let mut ply = Ply::<DefaultElement>::from(&mesh);
    assert_eq!(TriMesh::try_from(&ply).unwrap(), mesh);
    let mut bytes = Vec::new();
    ply_rs::writer::Writer::new().write_ply(&mut bytes, &mut ply).unwrap();
    assert_eq!(Reader::strict().read_bytes("", &bytes).unwrap().mesh, mesh);
    let corners = Property::ListInt(vec![0, 1, -1]);
    ply.payload["face"][3].insert("vertex_indices".to_owned(), corners);
    let error = TriMesh::try_from(&ply).unwrap_err().to_string();
    assert!(error.contains("a corner of face 3"), "{error}");
    ply.payload["vertex"][2].shift_remove("y");
    ply.payload["face"].clear();
    let error = TriMesh::try_from(&ply).unwrap_err().to_string();
    assert!(error.contains("vertex 2 has the coordinates"), "{error}");
}
