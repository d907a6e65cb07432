use super::*;
use crate::io::{Format, Place, Reader, to_bytes, write_to};

fn parsed(text: &str) -> Parsed {
    parse(text.as_bytes(), Broken::Refused).unwrap_or_else(|fault| panic!("{text:?}: {fault:?}"))
}

fn message(text: &str) -> String {
    match parse(text.as_bytes(), Broken::Refused) {
        Ok(_) => panic!("{text:?} was read"),
        Err(fault) => format!("{}{}", fault.at, fault.problem),
    }
}

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

fn faces(statements: &str) -> Vec<Vec<u32>> {
    let parsed = parsed(&format!("{SQUARE}{statements}"));
    (0..parsed.polygons.len()).map(|f| parsed.polygons.face(f).to_vec()).collect()
}

#[test]
fn faces_of_every_spelling_are_read() {
    for statement in [
        "f 1 2 3",
        "f 1/1 2/2 3/3",
        "f 1//1 2//2 3//3",
        "f 1/1/1 2/2/2 3/3/3",
        "f -4 -3 -2",
        "f -4/-1/-1 2//-1 -2/",
        "\tf  1\t2   3  ",
        "f 1 2 3 # the last",
        "f 1 2 3#",
        "f 1 \\\n 2 3",
        "f 1 2\\\n 3",
        "f\\\n1 2 3",
        "f 1 2 \\\r\n3\r",
        "f +1 2 3",
        "fo 1 2 3",
        "f 1 2 3\\\n",
    ] {
        assert_eq!(faces(statement), [[0, 1, 2]], "{statement:?}");
    }
    assert_eq!(faces("f 1 2 3 4\nf 1 2 3"), vec![vec![0, 1, 2, 3], vec![0, 1, 2]]);
}

#[test]
fn relative_indices_count_from_the_statement() {
    let text = format!("{SQUARE}f -4 -3 -2\nv 5 5 5\nf -1 -2 1\n");
    let expected = Polygons::Triangles(vec![[0, 1, 2], [4, 3, 0]]);
    assert_eq!(parsed(&text).polygons, expected);
    // Whatever the pieces are.
    for size in 1..text.len() {
        let parsed = parse_in_chunks(text.as_bytes(), size, Broken::Refused).unwrap();
        assert_eq!(parsed.polygons, expected, "{size}");
        assert_eq!(parsed.positions.len(), 5);
    }
}

#[test]
fn vertices_keep_their_order_and_isolated_ones() {
    let text = "o a\nv 9 9 9\nv 0 0 0\no b\nv 1 0 0\nv 0 1 0\nf 4 3 2\ng c\nv 7 7 7\n";
    let parsed = parsed(text);
    assert_eq!(parsed.positions.len(), 5);
    assert_eq!(parsed.positions[4], [7.0; 3]);
    assert_eq!(parsed.polygons, Polygons::Triangles(vec![[3, 2, 1]]));
    assert!(parsed.notes.is_empty());
}

#[test]
fn what_follows_a_position_is_told_by_its_length() {
    let weights = parsed("v 1 2 3 1\nv 1 2 3 1.0\nv 4 5 6 0.5\n");
    assert_eq!(weights.positions[2], [4.0, 5.0, 6.0]);
    assert_eq!(weights.doubts.len(), 1);
    assert!(weights.fields.is_empty());

    let colors = parsed("v 1 2 3 0 0.2 1\nv 1 2 3 1 0.752941 0 0.5\n");
    assert_eq!(colors.fields.colors, Some(vec![[0, 51, 255], [255, 192, 0]]));
    assert_eq!(colors.notes, ["the alpha values of 1 vertices are ignored"]);

    let bytes = parsed("v 1 2 3 0 128 255\n");
    assert_eq!(bytes.fields.colors, Some(vec![[0, 128, 255]]));

    let some = parsed("v 1 2 3 0 0 0\nv 1 2 3\n");
    assert_eq!(some.fields.colors, None);
    assert_eq!(some.doubts, ["only 1 vertices have colours: left out"]);
}

#[test]
fn coordinates_keep_double_precision() {
    let parsed = parsed("v 500001.956350000 4649790.161000000 100.000000000\nv 1e-3 -.5 +2.E2\n");
    assert_eq!(parsed.positions[0], [500001.95635, 4649790.161, 100.0]);
    assert_eq!(parsed.positions[1], [1e-3, -0.5, 200.0]);
}

#[test]
fn other_statements_are_counted() {
    let text = "# c\\\nmtllib a\nv 0 0 0\nvt 0 0\nvn 0 0 1\nvn 0 0 1\np 1\nl 1 \\\n1\nusemtl x\ns off\nvp 1\n";
    let notes = parsed(text).notes;
    assert_eq!(
        notes,
        [
            "1 line elements are ignored",
            "1 point elements are ignored",
            "1 statements about curves and free-form surfaces are ignored",
            "1 texture coordinates are ignored",
            "2 vertex normals are ignored",
        ]
    );
}

/// A face has the names stated last before it, whatever the pieces are, and they are written back.
#[test]
fn statements_belong_to_the_faces_after_them() {
    let text = format!(
        "mtllib a b.mtl\n{SQUARE}f 1 2 3\no part\ng left side\nusemtl r\u{f6}t # red\nf 1 2 3\n\
         f 1 3 4\ng\ns off\nusemtl \\\nblue\nf 1 2 3 4\nusemtl r\u{f6}t # red\nf 2 3 4\ng unused\n"
    );
    let red = Some("r\u{f6}t # red".as_bytes());
    let whole = parsed(&text).fields.faces.statements;
    for size in 1..text.len() {
        let parsed = parse_in_chunks(text.as_bytes(), size, Broken::Refused).unwrap();
        assert_eq!(parsed.fields.faces.statements, whole, "{size}");
    }
    let names = |keyword| [0, 1, 2, 3, 4].map(|f| whole.name(keyword, f));
    assert_eq!(whole.libraries, [b"a b.mtl"]);
    let [part, off] = [&b"part"[..], b"off"].map(Some);
    assert_eq!(names("o"), [None, part, part, part, part]);
    let left = Some(&b"left side"[..]);
    assert_eq!(names("g"), [None, left, left, Some(b""), Some(b"")]);
    assert_eq!(names("usemtl"), [None, red, red, Some(b"blue"), red]);
    assert_eq!(names("s"), [None, None, None, off, off]);
    let read = |bytes: &[u8]| Reader::strict().read_bytes("a.obj", bytes).unwrap();
    let file = read(text.as_bytes());
    let written = to_bytes(Format::Obj, &file.mesh, &file.fields, &WriteOptions::default());
    let again = read(&written.unwrap());
    assert_eq!(again.fields.faces.statements, file.fields.faces.statements);
    assert_eq!(again.mesh.polygons(), file.mesh.polygons());
    // Other formats say what they lack.
    let mut bytes = vec![];
    let report = write_to(&mut bytes, Format::Ply, &file.mesh, &file.fields, &Default::default());
    let lost = "PLY holds no objects, groups, materials, smoothing groups: left out";
    assert_eq!(report.unwrap().notes, [lost]);
}

/// Relative indices too, and whatever the pieces are.
#[test]
fn corners_have_texture_coordinates_and_vertices_normals() {
    let text = format!(
        "{SQUARE}vt 0 0.25\nvt .5\nvt 1 1 0\nvn 0 0 1\nvn 0 1 0\nf 1/1/1 2/2/2 3/3/1\n\
         vt 7 7\nvn 0 0 1\nf 1/-1/-1 3/-2/1 4/1/-2\n"
    );
    for size in 1..text.len() {
        let parsed = parse_in_chunks(text.as_bytes(), size, Broken::Refused).unwrap();
        let [a, b, c, d] = [[0.0, 0.25], [0.5, 0.0], [1.0, 1.0], [7.0, 7.0]];
        assert_eq!(parsed.fields.faces.texture, Some(vec![a, b, c, d, c, a]), "{size}");
        let [z, y] = [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0]];
        assert_eq!(parsed.fields.vectors, [("normal".to_owned(), vec![z, y, z, y])]);
        assert_eq!((parsed.notes.len(), parsed.doubts.len()), (0, 0));
    }
    // Normals in the order of the vertices, which no face has to name.
    for faces in ["", "f 1 2 3\n", "f 1//1 2 3\n"] {
        let parsed = parsed(&format!("{SQUARE}{}{faces}", "vn 0 0 1\n".repeat(4)));
        assert_eq!(parsed.fields.vectors[0].1, [[0.0, 0.0, 1.0]; 4], "{faces}");
    }
}

#[test]
fn texture_coordinates_and_normals_that_are_left_out_are_named() {
    let values = "vt 0 0\nvt 1 x\nvt 1 1 2\nvn 0 0 1\nvn 0 1 0\n";
    let said = |faces: &str| {
        let parsed = parsed(&format!("{SQUARE}{values}{faces}"));
        assert!(parsed.fields.is_empty(), "{faces}");
        assert_eq!(parsed.notes[0], "1 third texture coordinates are ignored");
        assert_eq!(parsed.notes.len() + parsed.doubts.len(), 3, "{faces}");
        parsed.notes[1..].iter().chain(&parsed.doubts).cloned().collect::<Vec<_>>()
    };
    let of_3 = "only 2 of 3 corners have texture coordinates: left out";
    let missing = "1 corners name texture coordinates that do not exist: left out";
    for (faces, expected) in [
        ("f 1/1 2/1 3\n", of_3),
        ("f 1/1 2/1 3/4\n", missing),
        ("f 1/1 2/1 3/0\n", missing),
        ("f 1/1 2/1 3/-4\n", missing),
        ("f 1//1 2//1 3//9\n", "1 corners name normals that do not exist: left out"),
        ("f 1//1 2//1 3//2\n", "only 3 vertices have normals: left out"),
    ] {
        assert!(said(faces).iter().any(|note| note == expected), "{faces}: {:?}", said(faces));
    }
    let creased = parsed(&format!("{SQUARE}{values}f 1//1 2//1 3//1\nf 1//2 3//1 4//1\n"));
    assert_eq!(creased.notes[2], "vertex normals are ignored: 1 vertices have several");
    // Faces of two corners take their indices along.
    let small = parsed(&format!("{SQUARE}{values}f 1/2 2/2\nf -4/-3 -2/1\nf 1/1 2/1 3/1\n"));
    assert_eq!(small.fields.faces.texture, Some(vec![[0.0; 2]; 3]));
    let broken = crate::io::tests::read("", format!("{SQUARE}{values}f 1/1 2/2 3/3\n").as_bytes());
    assert_eq!(broken.fields.faces.texture, None);
    let said = "field of texture coordinates is NaN at corner 1: left out";
    assert!(broken.report.notes.iter().any(|note| note == said), "{:?}", broken.report.notes);
}

#[test]
fn every_line_end_is_understood() {
    for text in [
        "v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nf 1 2 3\r\n",
        "v 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3",
        "# ünïcode\no näme\nv 0 0 0\n\n\nv 1 0 0 # é\nv 0 1 0\nf 1 2 3",
    ] {
        assert_eq!(parsed(text).polygons, Polygons::Triangles(vec![[0, 1, 2]]), "{text:?}");
    }
}

#[test]
fn faces_of_two_corners_are_left_out() {
    let parsed = parsed(&format!("{SQUARE}f -1 -2\nf 1 2\nf -4 2 3\n"));
    assert_eq!(parsed.polygons, Polygons::Triangles(vec![[0, 1, 2]]));
    assert_eq!(parsed.doubts, ["2 faces have fewer than three corners: left out"]);
}

#[test]
fn errors_name_the_line() {
    for (text, expected) in [
        ("v 0 0\nv 1 1 1\n", "line 1: expected a coordinate, found the end of the line"),
        ("v\n", "line 1: expected a coordinate, found the end of the line"),
        ("v 0 0 0\nv 0 nan 0\n", "line 2: vertex 1 has the coordinate NaN"),
        ("v 0 0 1e999\n", "line 1: vertex 0 has the coordinate inf"),
        ("v 0 0 0,5\n", "line 1: expected a coordinate, found \"0,5\""),
        ("v 0 0 0 1 2\n", "line 1: expected 3, 4, 6 or 7 numbers for a vertex, found 5"),
        (
            "v 0 0 0 1 2 3 4 5\n",
            "line 1: expected 3, 4, 6 or 7 numbers for a vertex, found more than 7",
        ),
        ("v 0 0 0\nf 1 1 0\n", "line 2: expected an index from 1 to 2^32 - 1, found 0"),
        ("v 0 0 0\nf # 1\n", "line 2: expected the corners of a face, found none"),
        ("v 0 0 0\nf 1 x 1\n", "line 2: expected the index of a vertex, found \"x\""),
        ("v 0 0 0\nf 1.5 1 1\n", "line 2: expected white space after an index, found \".5\""),
        ("v 0 0 0\nf 1/2/3/4 1 1\n", "line 2: expected white space after an index"),
        (
            "v 0 0 0\n\nf 1 1 1\nf 1 1 2\n",
            "line 4: face 1 names vertex 1 (counted from 0), but there are 1 vertices",
        ),
        ("v 0 0 0\nf 1 1 -2\n", "line 2: face 0 names vertex -1"),
        (
            "v 0 0 0\nf 1 1 4294967297\n",
            "line 2: expected an index from 1 to 2^32 - 1, found 4294967297",
        ),
        ("v 0 0 0\nf 1 1 99999999999999999999\n", "line 2: expected the index of a vertex"),
        ("v 0 0 0\nhello 1\n", "line 2: expected an OBJ statement, found \"hello\""),
    ] {
        let message = message(text);
        assert!(message.contains(expected), "{text:?}: {message}");
    }
}

#[test]
fn lines_of_later_pieces_are_counted_from_the_start() {
    let mut text = SQUARE.repeat(50);
    text.push_str("f 1 2 3\n".repeat(100).as_str());
    text.push_str("f 1 2 201\n");
    for size in [10, 100, 1000] {
        let fault = parse_in_chunks(text.as_bytes(), size, Broken::Refused).err().unwrap();
        assert_eq!(fault.at, Place::Line(301), "{size}");
    }
}
