//! Files of large meshes.

use fairing_mesh::io::{VertexFields, WriteOptions, read, write_with_fields};

fn bits(points: &[[f64; 3]]) -> Vec<u64> {
    points.as_flattened().iter().map(|x| x.to_bits()).collect()
}

/// Larger than the pieces of the parallel parsers and writers.
#[test]
fn large_meshes_come_back_whole() {
    let mesh = fairing_shapes::icosphere(6);
    let wave = mesh.positions().iter().map(|p| (9.0 * p[0]).sin()).collect();
    let fields = VertexFields::default()
        .with_scalar("wave", wave)
        .with_vector("normal", mesh.positions().to_vec())
        .with_colors(mesh.positions().iter().map(|p| p.map(|x| (127.0 * x) as u8)).collect());
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.ply", "a.obj", "a.off", "a.ply.gz"] {
        let path = folder.path().join(name);
        for options in [WriteOptions::default(), WriteOptions::ascii()] {
            write_with_fields(&path, &mesh, &fields, &options.dropping_fields()).unwrap();
            let file = read(&path).unwrap();
            assert_eq!(bits(file.mesh.positions()), bits(mesh.positions()), "{name}");
            assert_eq!(file.mesh.faces(), mesh.faces(), "{name}");
            assert_eq!(file.fields.colors, fields.colors, "{name}");
        }
        if name.contains("ply") {
            assert_eq!(read(&path).unwrap().fields, fields);
        }
    }
}
