//! Round trips: files are read back as they were written, bit by bit.

use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::{Index, subsequence};

use crate::io::{
    Encoding, FaceFields, FloatWidth, Format, NumberType, Reader, VertexFields, WriteOptions, read,
    to_bytes, write, write_to, write_with_fields,
};
use crate::polygon::PolygonMesh;
use crate::trimesh::TriMesh;

/// Numbers of every size, zeros of both signs and 32-bit numbers among them.
fn number() -> impl Strategy<Value = f64> {
    // Far from the ends of the extents of a mesh.
    let of_a_mesh = |x: &f64| x.abs() < 1e29;
    prop_oneof![
        any::<f64>().prop_filter("not too large", of_a_mesh),
        -1e3..1e3,
        any::<f32>().prop_map(f64::from).prop_filter("not too large", of_a_mesh),
        (-9i32..9).prop_map(f64::from),
        Just(-0.0),
    ]
}

fn point() -> impl Strategy<Value = [f64; 3]> {
    [number(), number(), number()]
}

fn triangles() -> impl Strategy<Value = TriMesh> {
    let parts = (vec(point(), 3..20), vec(any::<[Index; 3]>(), 0..20));
    parts.prop_filter_map("an extent of a mesh", |(positions, faces)| {
        let n = positions.len();
        let faces = faces.iter().map(|face| face.each_ref().map(|k| k.index(n) as u32));
        let faces = faces.filter(|&[a, b, c]| a != b && b != c && c != a).collect();
        TriMesh::new(positions, faces).ok()
    })
}

fn polygons() -> impl Strategy<Value = PolygonMesh> {
    vec(point(), 3..20).prop_flat_map(|positions| {
        let all: Vec<u32> = (0..positions.len() as u32).collect();
        vec(subsequence(all, 3..=positions.len()).prop_shuffle(), 0..10)
            .prop_filter_map("an extent of a mesh", move |faces| {
                PolygonMesh::new(positions.clone(), faces).ok()
            })
    })
}

fn fields(vertices: usize) -> impl Strategy<Value = VertexFields> {
    let names = subsequence(vec!["q", "κ₁", "alpha", "red", "nx"], 0..4);
    let vectors = subsequence(vec!["normal", "direction", "d_x"], 0..3);
    let values = vec(vec(number(), vertices), 4);
    let triples = vec(vec(point(), vertices), 3);
    let colors = proptest::option::of(vec(any::<[u8; 3]>(), vertices));
    (names, vectors, values, triples, colors).prop_map(
        |(names, vectors, values, triples, colors)| {
            VertexFields {
                // `nx` and `red` would clash with the normal and the colours.
                scalars: names
                    .into_iter()
                    .filter(|&name| name != "nx" || !vectors.contains(&"normal"))
                    .filter(|&name| name != "red" || colors.is_none())
                    .map(str::to_owned)
                    .zip(values)
                    .collect(),
                vectors: vectors.into_iter().map(str::to_owned).zip(triples).collect(),
                colors,
                ..VertexFields::default()
            }
        },
    )
}

fn face_fields(faces: usize, corners: usize) -> impl Strategy<Value = FaceFields> {
    let texture = proptest::option::of(vec([number(), number()], corners));
    (fields(faces), texture).prop_map(move |(fields, texture)| match faces {
        // A file without faces has no fields of faces.
        0 => FaceFields::default(),
        _ => {
            let VertexFields { scalars, vectors, colors, types, .. } = fields;
            FaceFields { scalars, vectors, colors, types, texture, ..FaceFields::default() }
        }
    })
}

fn with_fields() -> impl Strategy<Value = (TriMesh, VertexFields)> {
    triangles().prop_flat_map(|mesh| {
        let faces = mesh.face_count();
        let fields = (fields(mesh.vertex_count()), face_fields(faces, 3 * faces));
        let fields = fields.prop_map(|(fields, faces)| VertexFields { faces, ..fields });
        (Just(mesh), fields)
    })
}

fn bits(points: &[[f64; 3]]) -> Vec<u64> {
    points.as_flattened().iter().map(|x| x.to_bits()).collect()
}

fn assert_same_fields(a: &VertexFields, b: &VertexFields) {
    assert_eq!(a, b);
    for ((_, a), (_, b)) in a.scalars.iter().zip(&b.scalars) {
        assert!(a.iter().map(|x| x.to_bits()).eq(b.iter().map(|x| x.to_bits())));
    }
    for ((_, a), (_, b)) in a.vectors.iter().zip(&b.vectors) {
        assert_eq!(bits(a), bits(b));
    }
}

/// Vertices welded one by one; each corner is compared with all before.
fn welded(mesh: &TriMesh, round: impl Fn(f64) -> f64) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let mut positions: Vec<[f64; 3]> = Vec::new();
    let faces = mesh.faces().iter().map(|face| {
        face.map(|v| {
            let p = mesh.positions()[v as usize].map(&round);
            let known = positions.iter().position(|&q| p == q);
            known.unwrap_or_else(|| {
                positions.push(p);
                positions.len() - 1
            }) as u32
        })
    });
    let faces: Vec<[u32; 3]> = faces.collect();
    let area = |&[a, b, c]: &[u32; 3]| a != b && b != c && c != a;
    (positions, faces.into_iter().filter(area).collect())
}

proptest! {
    #[test]
    fn ply_holds_everything((mesh, fields) in with_fields(), ascii: bool) {
        let encoding = if ascii { Encoding::Ascii } else { Encoding::Binary };
        for width in [FloatWidth::Lossless, FloatWidth::Double] {
            let mut options = WriteOptions::default().with_float_width(width);
            options.encoding = encoding;
            let bytes = to_bytes(Format::Ply, &mesh, &fields, &options).unwrap();
            let file = Reader::strict().read_bytes("a.ply", &bytes).unwrap();
            prop_assert_eq!(bits(file.mesh.positions()), bits(mesh.positions()));
            prop_assert_eq!(file.mesh.faces(), mesh.faces());
            assert_same_fields(&file.fields, &fields);
        }
    }

    #[test]
    fn every_format_gives_back_the_content_that_it_holds((mesh, fields) in with_fields()) {
        for format in Format::ALL.into_iter().filter(|&format| format != Format::Stl) {
            let options = WriteOptions::default().dropping_fields();
            let holds = format.holds();
            let round = |x: &mut f64| *x = if holds.exact { *x } else { f64::from(*x as f32) };
            let mut positions = mesh.positions().to_vec();
            positions.as_flattened_mut().iter_mut().for_each(round);
            // Small extents vanish in 32 bits.
            let Ok(expected) = TriMesh::new(positions, mesh.faces().to_vec()) else { continue };
            let bytes = to_bytes(format, &mesh, &fields, &options).unwrap();
            let file = Reader::strict().read_bytes("", &bytes).unwrap();
            prop_assert_eq!(bits(file.mesh.positions()), bits(expected.positions()));
            prop_assert_eq!(file.mesh.faces(), expected.faces());
            let mut held = fields.clone();
            held.scalars.retain(|_| holds.fields);
            held.vectors.retain(|(name, _)| holds.fields || holds.normals && name == "normal");
            held.scalars.iter_mut().for_each(|(_, values)| values.iter_mut().for_each(round));
            let vectors = held.vectors.iter_mut();
            vectors.for_each(|(_, v)| v.as_flattened_mut().iter_mut().for_each(round));
            held.colors = held.colors.filter(|_| holds.colors);
            let texture = held.faces.texture.take().filter(|_| holds.texture);
            held.faces = if holds.face_fields { held.faces } else { FaceFields::default() };
            held.faces.texture = texture;
            assert_same_fields(&file.fields, &held);
        }
    }

    #[test]
    fn stl_holds_welded_triangles(mesh in triangles(), ascii: bool) {
        let options = if ascii { WriteOptions::ascii() } else { WriteOptions::default() };
        let large = |p: &[f64; 3]| p.iter().any(|x| (*x as f32).is_infinite());
        let written = to_bytes(Format::Stl, &mesh, &VertexFields::default(), &options);
        if !ascii && mesh.positions().iter().any(large) {
            prop_assert!(written.is_err());
            return Ok(());
        }
        prop_assume!(mesh.face_count() > 0);
        let round = |x: f64| if ascii { x } else { f64::from(x as f32) };
        let (positions, faces) = welded(&mesh, round);
        // Without the isolated vertices the extent may be too small.
        prop_assume!(TriMesh::new(positions.clone(), faces.clone()).is_ok());
        let file = Reader::default().read_bytes("a.stl", &written.unwrap()).unwrap();
        prop_assert_eq!(bits(file.mesh.positions()), bits(&positions));
        prop_assert_eq!(file.mesh.faces(), &faces[..]);
    }

    #[test]
    fn files_hold_polygons(mesh in polygons()) {
        let folder = tempfile::tempdir().unwrap();
        let formats = Format::ALL.into_iter().filter(|format| format.holds().polygons);
        for name in formats.flat_map(|format| [format!("a.{format}"), format!("a.{format}.gz")]) {
            let path = folder.path().join(&name);
            let fields = VertexFields::default();
            for options in [WriteOptions::default(), WriteOptions::ascii()] {
                let split = mesh.triangulate();
                let report = write_with_fields(&path, &split, &fields, &options).unwrap();
                prop_assert_eq!(report.split_polygons, 0);
                if !name.ends_with(".gz") {
                    let bytes = to_bytes(report.format, &split, &fields, &options).unwrap();
                    prop_assert_eq!(std::fs::read(&path).unwrap(), bytes);
                }
                let file = read(&path).unwrap();
                prop_assert_eq!(&file.mesh.to_polygon_mesh(), &mesh);
                prop_assert_eq!(&file.mesh, &split);
                let larger = mesh.polygons().filter(|polygon| polygon.len() > 3).count();
                prop_assert_eq!(file.report.polygons, larger);
                prop_assert_eq!(file.mesh.polygons().is_some(), larger > 0);
            }
        }
    }
}

#[test]
fn polygons_of_more_than_a_byte_of_corners_are_held() {
    let circle: Vec<[f64; 3]> = (0..300)
        .map(|k| f64::from(k) / 300.0 * std::f64::consts::TAU)
        .map(|t| [t.cos(), t.sin(), 0.0])
        .collect();
    let mesh = PolygonMesh::new(circle, [(0..300).collect::<Vec<u32>>(), vec![0, 2, 1]]).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.ply");
    write(&path, &mesh.triangulate()).unwrap();
    assert_eq!(read(&path).unwrap().mesh.to_polygon_mesh(), mesh);
}

/// A PLY file with properties of every type and texture coordinates, on triangles or larger
/// polygons.
fn typed(order: &str, faces: &[&[u32]]) -> Vec<u8> {
    let mut file = format!("ply\nformat {order} 1.0\nelement vertex 5\n");
    for axis in ["x", "y", "z"] {
        file += &format!("property float {axis}\n");
    }
    let types = ["char", "uchar", "short", "ushort", "int", "uint", "float", "double"];
    let scalars: String = types.iter().map(|t| format!("property {t} of_{t}\n")).collect();
    let normal = "property double nx\nproperty double ny\nproperty double nz\n";
    let colors = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
    file += &format!("{scalars}{normal}{colors}element face {}\n", faces.len());
    file += "property list uchar int vertex_indices\nproperty list uchar float texcoord\n";
    file += &format!("{scalars}{normal}{colors}end_header\n");
    let values =
        |k: usize| format!("-{k} {k} -{k}00 {k}00 -{k}00000 {k}00000 {k} {k} 0 0 1 {k} 2 3");
    for (v, position) in ["0 0 0", "1 0 0", "1 1 0", "0 1 0", "0 0 1"].iter().enumerate() {
        file += &format!("{position} {}\n", values(v + 1));
    }
    for (f, face) in faces.iter().enumerate() {
        let corners: String = face.iter().map(|v| format!(" {v}")).collect();
        let texture: String = (0..face.len()).map(|k| format!(" {k} {f}.5")).collect();
        let (n, values) = (face.len(), values(f + 1));
        file += &format!("{n}{corners} {}{texture} {values}\n", 2 * n);
    }
    file.into_bytes()
}

#[test]
fn properties_of_ply_keep_their_types() {
    let file = typed("ascii", &[&[0, 1, 2], &[0, 2, 3]]);
    let read = |bytes: &[u8]| Reader::strict().read_bytes("a.ply", bytes).unwrap();
    let first = read(&file);
    assert_eq!(first.report.notes, [""; 0]);
    assert_eq!(first.fields.types["of_double"], NumberType::F64);
    assert_eq!(first.fields.faces.types["of_short"], NumberType::I16);
    assert_eq!(first.fields.faces.colors, Some(vec![[1, 2, 3], [2, 2, 3]]));
    assert_eq!(first.fields.faces.texture.as_ref().unwrap()[5], [2.0, 1.5]);
    let binary = to_bytes(Format::Ply, &first.mesh, &first.fields, &WriteOptions::default());
    let second = read(&binary.unwrap());
    assert_eq!((&second.mesh, &second.fields), (&first.mesh, &first.fields));
    assert_eq!(second.fields.types, first.fields.types);
    assert_eq!(second.fields.faces.types, first.fields.faces.types);
    let text = to_bytes(Format::Ply, &second.mesh, &second.fields, &WriteOptions::ascii()).unwrap();
    assert_eq!(String::from_utf8(text).unwrap(), String::from_utf8(file).unwrap());
    // A value that the type does not hold takes a wider one.
    let mut changed = first.fields.clone();
    changed.scalars[4].1[2] = 0.5;
    changed.faces.scalars[0].1[0] = -0.0;
    let written = to_bytes(Format::Ply, &first.mesh, &changed, &WriteOptions::default());
    let third = read(&written.unwrap());
    assert_eq!(third.fields, changed);
    assert_eq!(third.fields.types["of_int"], NumberType::F32);
    assert_eq!(third.fields.types["of_uint"], NumberType::U32);
    assert_eq!(third.fields.faces.types["of_char"], NumberType::F32);
}

/// Faces that are split, reduced or left out take their values along.
#[test]
fn face_properties_follow_their_faces() {
    let file = typed("ascii", &[&[0, 1, 2, 3], &[0, 0, 1], &[4, 4, 0, 1], &[1, 2, 9]]);
    let reader = Reader::dropping_broken();
    let read = reader.read_bytes("a.ply", &file).unwrap();
    assert_eq!(read.mesh.faces(), [[0, 1, 2], [0, 2, 3], [4, 0, 1]]);
    let faces = &read.fields.faces;
    assert_eq!(faces.scalars[3].1, [100.0, 100.0, 300.0]);
    let texture: Vec<f64> = faces.texture.iter().flatten().map(|uv| uv[0]).collect();
    assert_eq!(texture, [0.0, 1.0, 2.0, 0.0, 2.0, 3.0, 0.0, 2.0, 3.0]);
    // They are written with their polygons, and read back alike.
    let bytes = to_bytes(Format::Ply, &read.mesh, &read.fields, &WriteOptions::default()).unwrap();
    let again = reader.read_bytes("a.ply", &bytes).unwrap();
    assert_eq!((&again.mesh, &again.fields), (&read.mesh, &read.fields));
    assert_eq!(again.mesh.polygons(), read.mesh.polygons());
    assert_eq!(again.mesh.polygons().unwrap().offsets(), [0, 4, 7]);
    // A value for half a polygon is not lost: the triangles are written.
    let mut halved = read.fields.clone();
    halved.faces.scalars[3].1[1] = 7.0;
    let mut bytes = vec![];
    let (format, options_of_file) = (Format::Ply, WriteOptions::default());
    let report = write_to(&mut bytes, format, &read.mesh, &halved, &options_of_file).unwrap();
    assert_eq!(report.split_polygons, 1);
    assert!(report.notes[0].contains("polygon 0"), "{:?}", report.notes);
    let again = reader.read_bytes("a.ply", &bytes).unwrap();
    assert_eq!((again.mesh.polygons(), again.fields), (None, halved));
}

/// Polygons stay through changes of positions, in every format that holds them, with the values
/// and texture coordinates of their corners where there are any; the others say that they split.
#[test]
fn moved_meshes_are_written_with_their_polygons() {
    let file = typed("ascii", &[&[0, 1, 2, 3], &[4, 3, 2], &[0, 4, 1, 2]]);
    let read = |name: &str, bytes: &[u8]| Reader::strict().read_bytes(name, bytes).unwrap();
    let first = read("a.ply", &file);
    let moved = first.mesh.positions().iter().map(|p| p.map(|x| 2.0 * x)).collect();
    let moved = first.mesh.with_positions(moved).unwrap();
    let options = WriteOptions::default().dropping_fields();
    for format in Format::ALL {
        let mut bytes = vec![];
        let report = write_to(&mut bytes, format, &moved, &first.fields, &options).unwrap();
        let again = read("", &bytes);
        if !format.holds().polygons {
            assert_eq!((report.split_polygons, again.mesh.face_count()), (2, 5), "{format}");
            let note = "2 polygons are split into triangles";
            assert!(report.notes.iter().any(|found| found.starts_with(note)), "{report:?}");
            continue;
        }
        assert_eq!(again.mesh.polygons(), first.mesh.polygons(), "{format}");
        assert_eq!(again.mesh.positions(), moved.positions(), "{format}");
        if format.holds().face_fields {
            assert_eq!(again.fields.faces.scalars, first.fields.faces.scalars, "{format}");
        }
        if format.holds().texture {
            assert_eq!(again.fields.faces.texture, first.fields.faces.texture, "{format}");
        }
    }
}
