//! The same files read by other libraries.

use std::io::{BufReader, Cursor};

use ply_rs::parser::Parser;
use ply_rs::ply::{DefaultElement, Property};

use fairing_mesh::io::{
    FloatWidth, Format, MeshFile, ReadOptions, VertexFields, WriteOptions, read_bytes, to_bytes,
};
use fairing_shapes as shapes;

fn read(name: &str, bytes: &[u8]) -> MeshFile {
    read_bytes(name, bytes, &ReadOptions::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// tobj keeps the order of vertices only if faces use them in that order, and reads
/// 32 bits, so positions are compared after rounding.
#[test]
fn tobj_reads_the_same() {
    for mesh in [
        shapes::icosphere(3),
        shapes::cube(4, shapes::Diagonals::Alternating),
        shapes::torus(3.0, 1.0, 24, 12),
    ] {
        let bytes =
            to_bytes(Format::Obj, &mesh, &VertexFields::default(), &WriteOptions::default())
                .unwrap();
        let ours = read("a.obj", &bytes).mesh;
        assert_eq!(ours, mesh);
        let options = tobj::LoadOptions { triangulate: true, ..Default::default() };
        let no_materials =
            |_: &std::path::Path| tobj::MTLLoadResult::Err(tobj::LoadError::OpenFileFailed);
        let (models, _) =
            tobj::load_obj_buf(&mut BufReader::new(Cursor::new(&bytes)), &options, no_materials)
                .unwrap();
        let theirs = &models[0].mesh;
        assert_eq!(theirs.indices.len(), 3 * ours.face_count());
        // tobj numbers vertices by first use: compare corner by corner.
        for (corner, (&a, &b)) in theirs.indices.iter().zip(ours.faces().as_flattened()).enumerate()
        {
            for k in 0..3 {
                let (a, b) =
                    (theirs.positions[3 * a as usize + k], ours.positions()[b as usize][k]);
                assert_eq!(a, b as f32, "corner {corner}");
            }
        }
    }
}

fn number(property: &Property) -> f64 {
    match *property {
        Property::Float(x) => f64::from(x),
        Property::Double(x) => x,
        Property::UChar(x) => f64::from(x),
        ref other => panic!("{other:?}"),
    }
}

#[test]
fn ply_rs_reads_the_same() {
    let mesh = shapes::icosphere(3);
    let q: Vec<f64> = mesh.positions().iter().map(|p| p[0] * p[1]).collect();
    let fields = VertexFields::default()
        .with_scalar("q", q)
        .with_vector("normal", mesh.positions().to_vec())
        .with_colors(
            mesh.positions().iter().map(|p| p.map(|x| (100.0 * x + 100.0) as u8)).collect(),
        );
    for options in [WriteOptions::default(), WriteOptions::ascii()] {
        for width in [FloatWidth::Single, FloatWidth::Double] {
            let options = options.clone().with_float_width(width);
            let bytes = to_bytes(Format::Ply, &mesh, &fields, &options).unwrap();
            let ours = read("a.ply", &bytes);
            let theirs =
                Parser::<DefaultElement>::new().read_ply(&mut Cursor::new(&bytes)).unwrap();
            let vertices = &theirs.payload["vertex"];
            assert_eq!(vertices.len(), mesh.vertex_count());
            for (v, vertex) in vertices.iter().enumerate() {
                let names = ["x", "y", "z", "q", "nx", "ny", "nz", "red", "green", "blue"];
                let theirs = names.map(|name| number(&vertex[name]));
                let [x, y, z] = ours.mesh.positions()[v];
                let [nx, ny, nz] = ours.fields.vector("normal").unwrap()[v];
                let [r, g, b] = ours.fields.colors.as_ref().unwrap()[v].map(f64::from);
                let q = ours.fields.scalar("q").unwrap()[v];
                assert_eq!([x, y, z, q, nx, ny, nz, r, g, b], theirs, "vertex {v}");
            }
            for (face, ours) in theirs.payload["face"].iter().zip(ours.mesh.faces()) {
                let Property::ListInt(corners) = &face["vertex_indices"] else {
                    panic!("{face:?}")
                };
                assert!(corners.iter().map(|&v| v as u32).eq(ours.iter().copied()));
            }
        }
    }
}
