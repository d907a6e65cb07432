use serde_json::{Value, json};

use crate::io::tests::tetrahedron;
use crate::io::{Format, MeshFile, Reader, VertexFields, WriteOptions, to_bytes};
use crate::trimesh::TriMesh;

/// A file of this JSON and these numbers.
fn file(json: &Value, binary: &[u8]) -> Vec<u8> {
    let mut text = json.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut binary = binary.to_vec();
    binary.resize(binary.len().next_multiple_of(4), 0);
    let whole = 28 + text.len() + binary.len();
    let words = |words: [usize; 2]| words.map(|word| (word as u32).to_le_bytes()).concat();
    [
        b"glTF\x02\0\0\0",
        &(whole as u32).to_le_bytes()[..],
        &words([text.len(), 0x4e4f_534a]),
        &text,
        &words([binary.len(), 0x004e_4942]),
        &binary,
    ]
    .concat()
}

fn floats(numbers: &[f32]) -> Vec<u8> {
    numbers.iter().flat_map(|x| x.to_le_bytes()).collect()
}

fn read(bytes: &[u8]) -> MeshFile {
    Reader::default().read_bytes("", bytes).unwrap_or_else(|error| panic!("{error}"))
}

fn refusal(bytes: &[u8]) -> String {
    match Reader::default().read_bytes("", bytes) {
        Ok(file) => panic!("{}", file.report),
        Err(error) => error.to_string(),
    }
}

/// Four corners of a square, each of 16 bytes: a position and a colour of four bytes. Indices of
/// bytes follow.
fn square(indices: &[u8]) -> (Value, Vec<u8>) {
    let corners: [[f32; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let mut binary = Vec::new();
    for (k, corner) in corners.iter().enumerate() {
        binary.extend(floats(corner));
        binary.extend([255, 0, 51 * k as u8, 255]);
    }
    binary.extend(indices);
    let json = json!({
        "asset": { "version": "2.0" },
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0, "COLOR_0": 1 }, "indices": 2 }] }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3" },
            {
                "bufferView": 0, "byteOffset": 12, "componentType": 5121, "normalized": true,
                "count": 4, "type": "VEC4",
            },
            { "bufferView": 1, "componentType": 5121, "count": indices.len(), "type": "SCALAR" },
        ],
        "bufferViews": [
            { "buffer": 0, "byteLength": 64, "byteStride": 16 },
            { "buffer": 0, "byteOffset": 64, "byteLength": indices.len() },
        ],
        "buffers": [{ "byteLength": binary.len() }],
    });
    (json, binary)
}

#[test]
fn interleaved_vertices_and_every_mode_are_read() {
    let (mut json, binary) = square(&[0, 1, 2, 2, 3, 0]);
    let found = read(&file(&json, &binary));
    assert_eq!(found.mesh.positions()[2], [1.0, 1.0, 0.0]);
    assert_eq!(found.mesh.faces(), [[0, 1, 2], [2, 3, 0]]);
    // Linear 0.2 is sRGB 124.
    assert_eq!(found.fields.colors.unwrap()[..2], [[255, 0, 0], [255, 0, 124]]);
    assert_eq!(found.report.notes, [""; 0]);
    for (mode, indices, faces) in [
        (5, &[0, 1, 3, 2][..], vec![[0, 1, 3], [3, 1, 2]]),
        (6, &[0, 1, 2, 3], vec![[0, 1, 2], [0, 2, 3]]),
        (0, &[0, 1, 2, 3], vec![]),
    ] {
        let (mut json, binary) = square(indices);
        json["meshes"][0]["primitives"][0]["mode"] = json!(mode);
        let mesh = read(&file(&json, &binary)).mesh;
        assert_eq!((mesh.faces(), mesh.vertex_count()), (&faces[..], 4), "{mode}");
    }
    let primitive = &mut json["meshes"][0]["primitives"][0];
    primitive.as_object_mut().unwrap().remove("indices");
    primitive["mode"] = json!(6);
    assert_eq!(read(&file(&json, &binary)).mesh.faces(), [[0, 1, 2], [0, 2, 3]]);
    json["meshes"][0]["primitives"][0]["mode"] = json!(1);
    assert!(refusal(&file(&json, &binary)).contains("no vertices"));
}

/// A child turned by a right angle below a parent that is moved and mirrored.
#[test]
fn nodes_place_their_meshes() {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let (mut json, binary) = square(&[0, 1, 2]);
    json["scene"] = json!(1);
    json["scenes"] = json!([{ "nodes": [] }, { "nodes": [1, 0] }]);
    json["nodes"] = json!([
        { "mesh": 0, "rotation": [0.0, 0.0, half, half] },
        { "mesh": 0, "children": [2], "translation": [10.0, 0.0, 0.0], "scale": [1.0, 1.0, -2.0] },
        { "mesh": 0, "matrix": [0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 3, 1] },
    ]);
    json["accessors"]
        .as_array_mut()
        .unwrap()
        .push(json!({ "bufferView": 2, "componentType": 5126, "count": 4, "type": "VEC3" }));
    json["bufferViews"]
        .as_array_mut()
        .unwrap()
        .push(json!({ "buffer": 0, "byteOffset": 68, "byteLength": 48 }));
    json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = json!(3);
    let slanted = floats(&[0.6, 0.0, 0.8].repeat(4));
    let found = read(&file(&json, &[&binary[..], &[0], &slanted].concat()));
    let expected = [
        ([10.0, 0.0, 0.0], [0.6, 0.0, -0.4]),
        ([10.0, 0.0, -6.0], [0.0, 0.6, -0.4]),
        ([0.0, 0.0, 0.0], [0.0, 0.6, 0.8]),
    ];
    let normals = found.fields.vector("normal").unwrap();
    for (k, (position, normal)) in expected.into_iter().enumerate() {
        assert_eq!(found.mesh.positions()[4 * k], position);
        let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
        for (x, y) in normals[4 * k].iter().zip(normal.map(|x: f64| x / length)) {
            assert!((x - y).abs() < 1e-6, "{k}: {:?}", normals[4 * k]);
        }
    }
    assert_eq!(found.mesh.positions()[6], [9.0, 1.0, -6.0]);
    assert_eq!(found.mesh.faces(), [[0, 2, 1], [4, 6, 5], [8, 9, 10]]);
    assert_eq!(found.report.notes, ["one of 2 scenes is read", "3 meshes are one mesh"]);
}

/// Primitives of one list of vertices, as files of several materials have them.
#[test]
fn primitives_share_their_vertices() {
    let (mut json, binary) = square(&[0, 1, 2, 2, 3, 0]);
    let mut second = json["accessors"][2].clone();
    second["count"] = json!(3);
    json["accessors"][2]["count"] = json!(3);
    second["byteOffset"] = json!(3);
    json["accessors"].as_array_mut().unwrap().push(second);
    let mut primitive = json["meshes"][0]["primitives"][0].clone();
    primitive["indices"] = json!(3);
    json["meshes"][0]["primitives"].as_array_mut().unwrap().push(primitive);
    let found = read(&file(&json, &binary));
    assert_eq!((found.mesh.vertex_count(), found.mesh.face_count()), (4, 2));
    // Another list of vertices: without colours.
    json["meshes"][0]["primitives"][1]["attributes"] = json!({ "POSITION": 0, "TEXCOORD_0": 1 });
    let found = read(&file(&json, &binary));
    assert_eq!((found.mesh.vertex_count(), found.mesh.face_count()), (8, 2));
    assert_eq!(found.mesh.faces()[1], [6, 7, 4]);
    let notes =
        ["data of vertices are ignored: TEXCOORD_0", "only 4 vertices have colours: left out"];
    assert_eq!(found.report.notes, notes);
}

#[test]
fn fields_are_attributes_under_their_names() {
    let unit = [0.6, 0.0, 0.8];
    let fields = VertexFields::default()
        .with_scalar("κ₁", vec![0.5, -0.0, 1e-30, 3.0])
        .with_vector("normal", vec![unit; 4])
        .with_vector("direction", vec![[2.0, 0.0, 1.0]; 4])
        .with_colors(vec![[0, 1, 2], [253, 254, 255], [7, 77, 177], [8; 3]]);
    let bytes = to_bytes(Format::Glb, &tetrahedron(), &fields, &WriteOptions::default()).unwrap();
    assert_eq!(bytes.len() % 4, 0);
    let text = String::from_utf8_lossy(&bytes);
    for name in ["\"_κ₁\"", "\"NORMAL\"", "\"_direction\"", "\"COLOR_0\"", "\"doubleSided\":true"]
    {
        assert!(text.contains(name), "{name}");
    }
    let bounds = f64::from(0.1_f32);
    assert!(text.contains(&format!("\"min\":[{bounds},")), "{text}");
    let found = read(&bytes);
    assert_eq!(found.fields.colors, fields.colors);
    assert_eq!(found.fields.scalar("κ₁").unwrap()[2], f64::from(1e-30_f32));
    assert_eq!(found.fields.vectors[0].0, "normal");
    assert_eq!(found.fields.vector("direction"), fields.vector("direction"));
    let report = crate::io::write_to(
        std::io::sink(),
        Format::Glb,
        &tetrahedron(),
        &fields,
        &WriteOptions::default(),
    );
    assert_eq!(report.unwrap().notes, ["GLB rounds to 32 bits: positions, κ₁, normal"]);
    // Vectors of other lengths are not the normals of the format.
    let long = VertexFields::default().with_vector("normal", vec![[2.0, 0.0, 0.0]; 4]);
    let bytes = to_bytes(Format::Glb, &tetrahedron(), &long, &WriteOptions::default()).unwrap();
    assert!(String::from_utf8_lossy(&bytes).contains("\"_normal\""));
    assert_eq!(read(&bytes).fields, long);
    let far = TriMesh::new(vec![[1e40, 0.0, 0.0], [0.0; 3]], vec![]);
    if let Ok(far) = far {
        let none = VertexFields::default();
        let error = to_bytes(Format::Glb, &far, &none, &WriteOptions::default()).unwrap_err();
        assert!(error.to_string().contains("as a 32-bit number"), "{error}");
    }
}

#[test]
fn what_is_not_read_is_named() {
    let (json, binary) = square(&[0, 1, 2]);
    let changed = |change: &dyn Fn(&mut Value)| {
        let mut json = json.clone();
        change(&mut json);
        refusal(&file(&json, &binary))
    };
    for (change, expected) in [
        (
            &(|j: &mut Value| j["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]))
                as &dyn Fn(&mut Value),
            "KHR_draco_mesh_compression, which it requires",
        ),
        (
            &|j| j["buffers"][0]["uri"] = json!("a.bin"),
            "without its folder, at buffers[0].uri, found \"a.bin\"",
        ),
        (
            &|j| j["extensionsRequired"] = json!(["EXT_meshopt_compression"]),
            "EXT_meshopt_compression, which it requires: gltf-transform can save it without",
        ),
        (&|j| j["buffers"][0]["uri"] = json!("data:,"), "data in base64 at buffers[0].uri"),
        (&|j| j["buffers"][0]["uri"] = json!("data:x;base64,AAA="), "67 bytes at buffers[0].uri"),
        (&|j| j["accessors"][0]["sparse"] = json!({}), "values at accessors[0].sparse"),
        (&|j| j["accessors"][0]["bufferView"] = Value::Null, "a bufferView at accessors[0]"),
        (&|j| j["accessors"][0]["count"] = json!(1u64 << 62), "found a bufferView of 64 bytes"),
        (&|j| j["accessors"][0]["count"] = json!(5), "5 elements of 12 bytes from byte 0"),
        (&|j| j["accessors"][0]["count"] = json!(3), "expected 3 elements of"),
        (&|j| j["accessors"][0]["byteOffset"] = json!(u64::MAX), "found a bufferView of 64 bytes"),
        (&|j| j["accessors"][0]["type"] = json!("VEC2"), "3 components at"),
        (&|j| j["bufferViews"][0]["byteStride"] = json!(0), "a byteStride of 12 or more"),
        (&|j| j["bufferViews"][1]["byteLength"] = json!(u64::MAX), "found a buffer of 68 bytes"),
        (&|j| j["accessors"][2]["componentType"] = json!(5126), "4 bytes"),
        (&|j| j["nodes"][0]["children"] = json!([0]), "a node in one place"),
        (&|j| j["nodes"][0]["mesh"] = json!(7), "meshes[7]"),
        (
            &|j| j["nodes"][0]["matrix"] = json!([1, 2]),
            "16 numbers at nodes[0].matrix, found [1,2]",
        ),
        (&|j| j["nodes"][0]["rotation"] = json!([0, 0, 0, 0]), "a rotation as a unit quaternion"),
        (&|j| j["nodes"][0]["mesh"] = json!(-1), "an integer at nodes[0].mesh, found -1"),
        (&|j| j["scene"] = json!(3), "scenes[3]"),
    ] {
        let found = changed(change);
        assert!(found.contains(expected), "{expected}: {found}");
    }
    let mut third = binary.clone();
    third[66] = 4;
    let found = refusal(&file(&json, &third));
    assert!(found.contains("face 0 names vertex 4"), "{found}");
    let old = [b"glTF\x01\0\0\0", &[0; 20][..]].concat();
    assert!(refusal(&old).contains("byte 4: expected version 2 of glTF, found 1"));
}

/// Nodes and primitives may repeat what the file holds once, up to a limit.
#[test]
fn copies_without_end_are_refused() {
    let (mut json, mut binary) = square(&[0, 1, 2]);
    let count = 100_000;
    binary = [binary, vec![0; 12 * count]].concat();
    json["bufferViews"][0] = json!({ "buffer": 0, "byteOffset": 68, "byteLength": 12 * count });
    json["accessors"][0]["count"] = json!(count);
    json["meshes"][0]["primitives"][0]["attributes"] = json!({ "POSITION": 0 });
    json["nodes"] = json!(vec![json!({ "mesh": 0 }); 1000]);
    json["scenes"] = json!([{ "nodes": (0..1000).collect::<Vec<_>>() }]);
    let found = refusal(&file(&json, &binary));
    assert!(found.contains("hundreds of copies"), "{found}");
}

#[test]
fn quantized_positions_are_read() {
    let (mut json, mut binary) = square(&[0, 1, 2]);
    let shorts = [[0_i16, 0, 0, 0], [32767, 0, 0, 0], [0, -32768, 0, 0]];
    binary.push(0);
    binary.extend(shorts.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
    json["bufferViews"][0] =
        json!({ "buffer": 0, "byteOffset": 68, "byteLength": 24, "byteStride": 8 });
    json["accessors"][0] = json!(
        { "bufferView": 0, "componentType": 5122, "normalized": true, "count": 3, "type": "VEC3" }
    );
    json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    json["meshes"][0]["primitives"][0]["attributes"] = json!({ "POSITION": 0 });
    let mesh = read(&file(&json, &binary)).mesh;
    assert_eq!(mesh.positions(), [[0.0; 3], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]);
}

/// The square with two corners moved: from its array, and from zeros.
#[test]
fn sparse_arrays_are_read() {
    let (mut json, mut binary) = square(&[0, 1, 2, 0, 2, 3]);
    binary.resize(72, 0);
    binary.extend([1u16, 3].iter().flat_map(|k| k.to_le_bytes()));
    binary.extend(floats(&[2.0, 0.0, 1.0, 0.0, 3.0, 1.0]));
    json["buffers"][0]["byteLength"] = json!(binary.len());
    let views = json["bufferViews"].as_array_mut().unwrap();
    views[1]["byteLength"] = json!(6);
    views.push(json!({ "buffer": 0, "byteOffset": 72, "byteLength": 4 }));
    views.push(json!({ "buffer": 0, "byteOffset": 76, "byteLength": 24 }));
    json["accessors"][0]["sparse"] = json!({
        "count": 2,
        "indices": { "bufferView": 2, "componentType": 5123 },
        "values": { "bufferView": 3 },
    });
    let [moved, raised] = [[2.0, 0.0, 1.0], [0.0, 3.0, 1.0]];
    let found = read(&file(&json, &binary)).mesh;
    assert_eq!(found.positions(), [[0.0; 3], moved, [1.0, 1.0, 0.0], raised]);
    let mut alone = json.clone();
    alone["accessors"][0].as_object_mut().unwrap().remove("bufferView");
    let found = read(&file(&alone, &binary)).mesh;
    assert_eq!(found.positions(), [[0.0; 3], moved, [0.0; 3], raised]);
    // Bounds, and a count that the file does not hold.
    for (change, expected) in [
        (
            &(|j: &mut Value| j["accessors"][0]["count"] = json!(3)) as &dyn Fn(&mut Value),
            "indices of 3 elements at accessors[0].sparse.indices, found 3",
        ),
        (&|j| j["accessors"][0]["count"] = json!(1u64 << 40), "hundreds of copies"),
        (&|j| j["accessors"][0]["sparse"]["count"] = json!(3), "3 elements of 2 bytes"),
        (&|j| j["bufferViews"][3]["byteLength"] = json!(23), "2 elements of 12 bytes"),
        (
            &|j| j["accessors"][0]["sparse"]["indices"]["componentType"] = json!(5126),
            "unsigned integers",
        ),
    ] {
        let mut json = alone.clone();
        change(&mut json);
        let found = refusal(&file(&json, &binary));
        assert!(found.contains(expected), "{expected}: {found}");
    }
}

/// JSON with its buffer in a file beside it, in its URI, and nowhere.
#[test]
fn json_is_read_with_its_buffers() {
    use base64::Engine;
    let (mut json, binary) = square(&[0, 1, 2, 0, 2, 3]);
    json["bufferViews"][1]["byteLength"] = json!(6);
    json["buffers"][0]["byteLength"] = json!(binary.len());
    let expected = read(&file(&json, &binary));
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path().join("a.gltf");
    std::fs::create_dir(folder.path().join("below")).unwrap();
    std::fs::write(folder.path().join("below/a b.bin"), &binary).unwrap();
    let beside = |uri: &str| {
        let mut json = json.clone();
        json["buffers"][0]["uri"] = json!(uri);
        std::fs::write(&place, json.to_string()).unwrap();
        crate::io::read(&place)
    };
    let data = base64::engine::general_purpose::STANDARD.encode(&binary);
    for uri in ["below/a%20b.bin", "./below/a b.bin", &format!("data:any/thing;base64,{data}")] {
        let found = beside(uri).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!((&found.mesh, &found.fields), (&expected.mesh, &expected.fields));
    }
    for uri in [
        "/etc/hosts",
        "../a.bin",
        "below/../../a.bin",
        "%2e%2e/a.bin",
        "below//a",
        "C:\\a.bin",
        "http://a/b.bin",
        "file:a.bin",
        "%zz",
    ] {
        let found = beside(uri).unwrap_err().to_string();
        assert!(found.contains("buffers[0].uri") && found.contains("beside") || uri == "%zz");
    }
    for uri in ["none.bin", "below"] {
        let found = beside(uri).unwrap_err().to_string();
        assert!(found.contains(&format!("expected the file {uri:?} at buffers[0].uri")), "{found}");
    }
    // Two buffers of one file, and a file that is too short.
    json["buffers"][0]["uri"] = json!("below/a b.bin");
    let write = |json: &Value| {
        std::fs::write(&place, json.to_string()).unwrap();
        crate::io::read(&place).unwrap_err().to_string()
    };
    let mut twice = json.clone();
    twice["buffers"] = json!([json["buffers"][0], json["buffers"][0]]);
    assert!(write(&twice).contains("no other buffer at buffers[1].uri"));
    json["buffers"][0]["byteLength"] = json!(1000);
    assert!(write(&json).contains("expected 1000 bytes at buffers[0].uri, found 70 bytes"));
    let stream = refusal(json.to_string().as_bytes());
    assert!(stream.contains("without its folder, at buffers[0].uri"), "{stream}");
}
