//! The same files read by other libraries.

use std::io::{BufReader, Cursor};

use ply_rs::parser::Parser;
use ply_rs::ply::{DefaultElement, Property};

use fairing_mesh::io::{
    FloatWidth, Format, MeshFile, Reader, VertexFields, WriteOptions, to_bytes,
};
use fairing_shapes as shapes;

fn read(name: &str, bytes: &[u8]) -> MeshFile {
    Reader::default().read_bytes(name, bytes).unwrap_or_else(|error| panic!("{error}"))
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

#[test]
fn gltf_reads_the_same() {
    let mesh = shapes::icosphere(3);
    let q: Vec<f64> = mesh.positions().iter().map(|p| p[0] * p[1]).collect();
    let fields = VertexFields::default()
        .with_scalar("q", q.clone())
        .with_vector("normal", mesh.positions().to_vec())
        .with_colors(
            mesh.positions().iter().map(|p| p.map(|x| (100.0 * x + 100.0) as u8)).collect(),
        );
    let bytes = to_bytes(Format::Glb, &mesh, &fields, &WriteOptions::default()).unwrap();
    let ours = read("a.glb", &bytes);
    assert_eq!((ours.mesh.faces(), &ours.fields.colors), (mesh.faces(), &fields.colors));
    let theirs = gltf::Gltf::from_slice(&bytes).unwrap();
    let scene = theirs.default_scene().unwrap();
    let node = scene.nodes().next().unwrap();
    let (primitive, blob) = (node.mesh().unwrap().primitives().next().unwrap(), &theirs.blob);
    assert_eq!(primitive.mode(), gltf::mesh::Mode::Triangles);
    assert!(primitive.material().double_sided());
    let reader = primitive.reader(|_| blob.as_deref());
    let rounded =
        |points: &[[f64; 3]]| points.iter().map(|p| p.map(|x| x as f32)).collect::<Vec<_>>();
    let positions = rounded(mesh.positions());
    assert!(reader.read_positions().unwrap().eq(positions.iter().copied()));
    assert!(reader.read_normals().unwrap().eq(rounded(fields.vector("normal").unwrap())));
    let corners = reader.read_indices().unwrap().into_u32();
    assert!(corners.eq(mesh.faces().as_flattened().iter().copied()));
    let bounds = primitive.bounding_box();
    for k in 0..3 {
        let of = || positions.iter().map(|p| p[k]);
        assert_eq!(bounds.min[k], of().fold(f32::INFINITY, f32::min));
        assert_eq!(bounds.max[k], of().fold(f32::NEG_INFINITY, f32::max));
    }
    let named = gltf::Semantic::Extras("q".to_owned());
    let field = primitive.get(&named).unwrap();
    assert_eq!((field.count(), field.dimensions()), (q.len(), gltf::accessor::Dimensions::Scalar));
    let colors = reader.read_colors(0).unwrap().into_rgba_f32();
    for (linear, srgb) in colors.zip(fields.colors.as_ref().unwrap()) {
        for k in 0..3 {
            let c = f32::from(srgb[k]) / 255.0;
            let expected = if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) };
            // Half a step of 16 bits.
            assert!((linear[k] - expected).abs() < 1e-5, "{linear:?} for {srgb:?}");
        }
        assert_eq!(linear[3], 1.0);
    }
}
