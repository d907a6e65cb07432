#![no_main]

use std::sync::LazyLock;

use fairing_mesh::TriMesh;
use fairing_mesh::io::{self, Format, Reader, VertexFields, WriteOptions};

/// The name of the file, by the environment variable `NAME`; without one the content decides.
static NAME: LazyLock<String> = LazyLock::new(|| std::env::var("NAME").unwrap_or_default());

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let mut reader = Reader::default();
    reader.max_bytes = 1 << 20;
    check(&NAME, bytes, &reader);
    if NAME.ends_with(".gz") {
        // A sound header, which damaged and sound streams follow.
        check(&NAME, &[&[0x1f, 0x8b, 8, 0, 0, 0, 0, 0, 0, 0xff], bytes].concat(), &reader);
    }
});

/// Any bytes are read without panic or hang; the mesh is valid, and written as PLY it reads back as
/// the same, with the values of its fields.
fn check(name: &str, bytes: &[u8], reader: &Reader) {
    let Ok(file) = reader.read_bytes(name, bytes) else { return };
    let (positions, faces) = (file.mesh.positions().to_vec(), file.mesh.faces().to_vec());
    TriMesh::new(positions, faces).expect("what is read is valid");
    for options in [WriteOptions::default(), WriteOptions::ascii()] {
        let write = |fields| io::to_bytes(Format::Ply, &file.mesh, fields, &options);
        // A file may have two fields of one name.
        let (written, mut fields) = match write(&file.fields) {
            Ok(written) => (written, file.fields.clone()),
            Err(_) => {
                let none = VertexFields::default();
                (write(&none).expect("a valid mesh can be written"), none)
            }
        };
        // PLY holds no objects, groups and materials.
        fields.faces.statements = Default::default();
        let again = Reader::strict().read_bytes("", &written);
        let again = again.expect("what is written can be read");
        assert_eq!(again.mesh, file.mesh);
        assert_eq!(values(&again.fields), values(&fields));
    }
}

/// The values of all fields. Names have other rules in PLY.
fn values(fields: &VertexFields) -> impl PartialEq + std::fmt::Debug {
    fn unnamed<T: Clone>(all: &[(String, Vec<T>)]) -> Vec<Vec<T>> {
        all.iter().map(|(_, values)| values.clone()).collect()
    }
    let VertexFields { scalars, vectors, colors, faces, .. } = fields;
    let of_vertices = (unnamed(scalars), unnamed(vectors), colors.clone());
    let of_faces = (unnamed(&faces.scalars), unnamed(&faces.vectors), faces.colors.clone());
    (of_vertices, of_faces, faces.texture.clone())
}
