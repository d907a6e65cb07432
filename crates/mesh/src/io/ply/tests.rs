use super::*;
use crate::polygon::Polygons;

fn outcome(bytes: &[u8]) -> Result<Parsed, String> {
    parse(bytes, Broken::Refused).map_err(|fault| format!("{}{}", fault.at, fault.problem))
}

fn ascii(header: &str, body: &str) -> Vec<u8> {
    format!("ply\nformat ascii 1.0\n{header}\nend_header\n{body}").into_bytes()
}

const XYZ: &str = "property float x\nproperty float y\nproperty float z";
const THREE: &str = "0 0 0\n1 0 0\n0 1 0\n";
const LIST: &str = "property list uchar int vertex_indices";

fn square(order: &str, big_endian: bool) -> Vec<u8> {
    let mut bytes = format!(
        "ply\nformat {order} 1.0\ncomment c\nelement camera 2\nproperty double f\nproperty list \
         ushort char name\nelement vertex 4\nproperty uchar red\nproperty double z\nproperty float \
         quality\nproperty float x\nproperty uchar green\nproperty short y\nproperty uchar \
         blue\nelement face 2\nproperty int flag\nproperty list int ushort \
         vertex_index\nproperty list uchar float texcoord\nend_header\n"
    )
    .into_bytes();
    let mut put = |little: &[u8]| {
        let mut little = little.to_vec();
        if big_endian {
            little.reverse();
        }
        bytes.extend(little);
    };
    for length in [3u16, 0] {
        put(&1.5f64.to_le_bytes());
        put(&length.to_le_bytes());
        (0..length).for_each(|_| put(&[7]));
    }
    for v in 0..4u8 {
        put(&[v]);
        put(&(f64::from(v) + 0.1).to_le_bytes());
        put(&(f32::from(v) / 2.0).to_le_bytes());
        put(&(f32::from(v) * 3.0).to_le_bytes());
        put(&[10 + v]);
        put(&(-300 * i16::from(v)).to_le_bytes());
        put(&[20 + v]);
    }
    for corners in [vec![0u16, 1, 2], vec![0, 1, 2, 3]] {
        put(&9i32.to_le_bytes());
        put(&(corners.len() as i32).to_le_bytes());
        corners.iter().for_each(|v| put(&v.to_le_bytes()));
        put(&[2]);
        put(&1f32.to_le_bytes());
        put(&2f32.to_le_bytes());
    }
    bytes
}

#[test]
fn any_order_any_type_and_either_byte_order() {
    for (order, big_endian) in [("binary_little_endian", false), ("binary_big_endian", true)] {
        let parsed = outcome(&square(order, big_endian)).unwrap();
        let expected = [0.0, 1.0, 2.0, 3.0].map(|v| [3.0 * v, -300.0 * v, v + 0.1]);
        assert_eq!(parsed.positions, expected);
        assert_eq!(parsed.fields.scalar("quality"), Some(&[0.0, 0.5, 1.0, 1.5][..]));
        let colors = parsed.fields.colors.unwrap();
        assert_eq!(colors, [[0, 10, 20], [1, 11, 21], [2, 12, 22], [3, 13, 23]]);
        assert_eq!(parsed.polygons.face(0), [0, 1, 2]);
        assert_eq!(parsed.polygons.face(1), [0, 1, 2, 3]);
        assert_eq!(
            parsed.notes,
            ["element camera is ignored", "face properties are ignored: texcoord"]
        );
        // Texture coordinates are two for each corner.
        assert_eq!(parsed.fields.faces.scalars, [("flag".to_owned(), vec![9.0, 9.0])]);
        assert_eq!(parsed.fields.faces.texture, None);
    }
}

#[test]
fn every_cut_of_a_binary_file_is_an_error() {
    let bytes = square("binary_little_endian", false);
    for length in 0..bytes.len() {
        assert!(outcome(&bytes[..length]).is_err(), "{length} of {}", bytes.len());
    }
}

#[test]
fn text_keeps_double_precision_and_rows_may_go_on() {
    let header = format!("element vertex 3\n{XYZ}\nelement face 1\n{LIST}");
    let file = ascii(&header, "0.1 4649776.161\n0\n1 0 0\n0 1 0\t\r\n\n3 0 1 2 7 8\n\n");
    let parsed = outcome(&file).unwrap();
    assert_eq!(parsed.positions[0], [0.1, 4649776.161, 0.0]);
    // The face has two values that belong to no property.
    assert_eq!(parsed.doubts, ["1 lines have more values than properties"]);
    assert_eq!(parsed.polygons, Polygons::Triangles(vec![[0, 1, 2]]));
}

/// Blank lines end a file as well as none do; others are ignored by meshio, MeshLab and trimesh,
/// and refused by strict reading.
#[test]
fn lines_after_the_last_element_are_named() {
    let header = format!("element vertex 3\n{XYZ}\nelement face 1\n{LIST}");
    let doubts = |end: &str| {
        let parsed = outcome(&ascii(&header, &format!("{THREE}3 0 1 2\n{end}"))).unwrap();
        assert_eq!(parsed.polygons, Polygons::Triangles(vec![[0, 1, 2]]));
        parsed.doubts
    };
    for blank in ["", "\n", " \t\r\n\n  "] {
        assert!(doubts(blank).is_empty(), "{blank:?}");
    }
    let line = header.lines().count() + 3 + 4 + 1;
    let expected = |count: usize, line: usize| {
        [format!("{count} lines after the last element, from line {line} on, are ignored")]
    };
    assert_eq!(doubts("3 0 2 1\n"), expected(1, line));
    assert_eq!(doubts("\n3 0 2 1\n\nx\n"), expected(2, line + 1));
}

#[test]
fn carriage_returns_may_end_lines() {
    let header = format!("element vertex 3\n{XYZ}\nelement face 1\n{LIST}");
    let file = String::from_utf8(ascii(&header, &format!("{THREE}3 0 1 2\n"))).unwrap();
    for end in ["\r\n", "\r"] {
        let parsed = outcome(file.replace('\n', end).as_bytes()).unwrap();
        assert_eq!(parsed.polygons, Polygons::Triangles(vec![[0, 1, 2]]), "{end:?}");
    }
}

#[test]
fn faces_may_come_before_vertices() {
    let header = format!("element face 1\n{LIST}\nelement vertex 3\n{XYZ}");
    let parsed = outcome(&ascii(&header, &format!("3 2 1 0\n{THREE}"))).unwrap();
    assert_eq!(parsed.polygons, Polygons::Triangles(vec![[2, 1, 0]]));
}

/// In the bulk path of either byte order as elsewhere: no vertex has the number
/// of vertices, nor −1.
#[test]
fn an_index_just_out_of_range_is_refused() {
    for (order, big_endian) in [("binary_little_endian", false), ("binary_big_endian", true)] {
        let file = |last: i32| {
            let mut bytes =
                format!("ply\nformat {order} 1.0\nelement vertex 3\n{XYZ}\nelement face 1\n{LIST}\nend_header\n")
                    .into_bytes();
            bytes.extend([0; 36]);
            bytes.push(3);
            for index in [0, 1, last] {
                bytes.extend(if big_endian { index.to_be_bytes() } else { index.to_le_bytes() });
            }
            outcome(&bytes).map(|parsed| parsed.polygons)
        };
        assert_eq!(file(2), Ok(Polygons::Triangles(vec![[0, 1, 2]])));
        for last in [3, -1] {
            let error = file(last).unwrap_err();
            assert!(error.contains(&format!("{last}")) && error.contains("face 0"), "{error}");
        }
    }
}

#[test]
fn strips_restart_and_turn_one_way() {
    let header = format!(
        "element vertex 5\n{XYZ}\nelement tristrips 2\nproperty list int int vertex_indices"
    );
    let vertices = "0 0 0\n1 0 0\n0 1 0\n1 1 0\n2 2 0\n";
    let body = format!("{vertices}11 0 1 2 3 -1 4 3 2 -1 0 1\n5 0 1 2 2 3\n");
    let parsed = outcome(&ascii(&header, &body)).unwrap();
    let expected = vec![[0, 1, 2], [2, 1, 3], [4, 3, 2], [0, 1, 2]];
    assert_eq!(parsed.polygons, Polygons::Triangles(expected));
    assert_eq!(
        parsed.notes,
        ["the faces are 4 triangle strips, 2 of their triangles without area"]
    );
    assert!(outcome(&ascii(&header, &format!("{vertices}3 0 1 -2\n0\n"))).is_err());
}

#[test]
fn vectors_and_normals_are_fields() {
    let header = "element vertex 1\nproperty double nx\nproperty double ny\nproperty double \
                  nz\nproperty float x\nproperty float y\nproperty float z\nproperty float \
                  d_x\nproperty float d_y\nproperty float d_z\nproperty uchar alpha";
    let parsed = outcome(&ascii(header, "0 0 1 1 2 3 4 5 6 255\n")).unwrap();
    assert_eq!(parsed.fields.vector("normal"), Some(&[[0.0, 0.0, 1.0]][..]));
    assert_eq!(parsed.fields.vector("d"), Some(&[[4.0, 5.0, 6.0]][..]));
    assert_eq!(parsed.fields.scalar("alpha"), Some(&[255.0][..]));
}

#[test]
fn errors_name_the_line_or_the_byte() {
    let vertices = format!("element vertex 3\n{XYZ}");
    let both = format!("{vertices}\nelement face 1\n{LIST}");
    let cases: [(Vec<u8>, &str); 18] = [
        (b"ply\nformat ascii 2.0\n".to_vec(), "line 2: expected version 1.0"),
        (b"ply\nformat utf8 1.0\n".to_vec(), "line 2: expected ascii, binary_little"),
        (b"ply\nformat ascii 1.0\n".to_vec(), "line 3: expected end_header"),
        (b"ply\nend_header\n".to_vec(), "line 2: expected a format"),
        (b"plyx\n".to_vec(), "line 1: expected \"ply\""),
        (ascii("element vertex -1", ""), "line 3: expected the number of vertex elements"),
        (ascii("property float x", ""), "line 3: expected an element before a property"),
        (ascii("element vertex 0\nproperty quad x", ""), "line 4: expected property TYPE"),
        (ascii("element vertex 0\nproperty list float int x", ""), "line 4: expected property"),
        (ascii("element vertex 0\nproperty int x\nproperty int x", ""), "a second x"),
        (ascii("element face 0", ""), "expected an element vertex"),
        (ascii("element vertex 1\nproperty float x", "1"), "expected vertex properties x, y and z"),
        (ascii(&vertices, "0 0 0\n1 0 0\n0 nan 0"), "line 10: vertex 2 has the coordinate NaN"),
        (ascii(&vertices, "0 0 0\n1 0 0\n0 1"), "line 10: expected z, found the end of the file"),
        (ascii(&both, &format!("{THREE}3 0 1 3")), "line 13: face 0 names vertex 3"),
        (
            ascii(&both, &format!("{THREE}3 0 1 2.5")),
            "line 13: expected the index of a vertex, found \"2.5\"",
        ),
        (
            ascii(&both, &format!("{THREE}300 0 1 2")),
            "line 13: expected the length of a list of type U8, found 300",
        ),
        (
            ascii(&both, &format!("{THREE}0")),
            "line 13: expected three corners or more in face 0, found 0",
        ),
    ];
    for (file, expected) in cases {
        let text = String::from_utf8_lossy(&file).into_owned();
        let message = outcome(&file).err().unwrap_or_else(|| panic!("{text} was read"));
        assert!(message.contains(expected), "{text}: {message}");
    }
}

#[test]
fn forged_counts_end_with_the_bytes() {
    for format in ["binary_little_endian", "binary_big_endian", "ascii"] {
        for header in [
            format!("element vertex 18446744073709551615\n{XYZ}"),
            format!("element vertex 4294967295\n{XYZ}"),
            format!("element vertex 18446744073709551615\n{XYZ}\nproperty list int int l"),
            format!("element vertex 0\n{XYZ}\nelement face 18446744073709551615\n{LIST}"),
            format!("element x 18446744073709551615\nproperty int a\nelement vertex 0\n{XYZ}"),
            format!("element x 99999999999\nproperty list int int a\nelement vertex 0\n{XYZ}"),
        ] {
            let file = format!("ply\nformat {format} 1.0\n{header}\nend_header\n");
            for body in [&b""[..], &[0xff; 40], b"1 1 1 1 1 1 1 1 1 1 1 1 1 1"] {
                let bytes = [file.as_bytes(), body].concat();
                assert!(outcome(&bytes).is_err(), "{file}");
            }
        }
    }
}

#[test]
fn headers_without_end_are_refused_soon() {
    let properties: String = (0..200_000).map(|k| format!("property int p{k}\n")).collect();
    let message = outcome(&ascii(&format!("element vertex 1\n{properties}"), "")).err().unwrap();
    assert!(message.contains("at most 4096 properties"), "{message}");
    let elements: String = (0..200_000).map(|k| format!("element e{k} 0\n")).collect();
    let message = outcome(&ascii(&elements, "")).err().unwrap();
    assert!(message.contains("at most 4096 elements"), "{message}");
}
