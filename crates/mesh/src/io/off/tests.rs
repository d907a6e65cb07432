use super::*;
use crate::polygon::Polygons;

fn parsed(text: &str) -> Parsed {
    parse(text.as_bytes(), Broken::Refused).unwrap_or_else(|fault| panic!("{text:?}: {fault:?}"))
}

fn message(text: &str) -> String {
    match parse(text.as_bytes(), Broken::Refused) {
        Ok(_) => panic!("{text:?} was read"),
        Err(fault) => format!("{}{}", fault.at, fault.problem),
    }
}

#[test]
fn counts_and_comments_stand_anywhere() {
    for text in [
        "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
        "OFF 3 1 0\r\n0 0 0\r\n1 0 0\r\n0 1 0\r\n3 0 1 2",
        "# c\n OFF # c\n\n3 1\n# c\n0 0 0 # c\n\n1 0 0\n0 1 0\n3 0 1 2 255 0 0\n# end",
        "3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
        "OFF\n3\n1\n0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
        // ModelNet.
        "OFF3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
        "OFF3 1 0 0 0 0 1 0 0 0 1 0 3 0 1 2",
        // Lines that end elsewhere, with and without the colour of a face.
        "OFF\n3\n1\n0\n0\n0\n0\n1\n0\n0\n0\n1\n0\n3 0 1 2 9 9 9\n",
        "OFF\n3 1 0\n0 0\n0 1 0\n0 0 1 0\n3 0 1 2 0.5 0.5 0.5 1\n",
        "OFF\n3 1 0 # c\n0 0 0 1 0 0 # c\n0 1 0\n\n3 0 1\n2\n",
    ] {
        let parsed = parsed(text);
        assert_eq!(parsed.positions, [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], "{text}");
        assert_eq!(parsed.polygons, Polygons::Triangles(vec![[0, 1, 2]]), "{text}");
    }
}

#[test]
fn prefixes_say_what_follows_a_position() {
    let parsed = parsed("STCNOFF 1 0 0\n1 2 3  0 0 1  0.2 0.4 1 0.5  0 1\n");
    assert_eq!(parsed.positions, [[1.0, 2.0, 3.0]]);
    assert_eq!(parsed.fields.vector("normal"), Some(&[[0.0, 0.0, 1.0]][..]));
    assert_eq!(parsed.fields.colors, Some(vec![[51, 102, 255]]));
    assert_eq!(parsed.notes.len(), 1);
    let colors =
        super::parse(b"COFF\n2 0 0\n0 0 0 1 2 255\n0 0 1 0 0 1 255\n", Broken::Refused).unwrap();
    assert_eq!(colors.fields.colors, Some(vec![[1, 2, 255], [0, 0, 1]]));
}

#[test]
fn errors_name_the_line() {
    for (text, expected) in [
        (
            "OFF\n4 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
            "line 7: expected 1 faces, found 0 and then the end",
        ),
        (
            "OFF\n2 1 0\n0 0 0\n1 0 0\n0 1 0\n",
            "line 5: expected three corners or more in face 0, found 0",
        ),
        (
            "OFF\n1 1 0\n0 0 0\n3 0 1 2\n",
            "line 4: face 0 names vertex 1 (counted from 0), but there are 1",
        ),
        ("OFF\n1 1 0\n0 0 0\n3 0 -1 2\n", "line 4: face 0 names vertex -1"),
        ("OFF\n1 0 0\n0 nan 0\n", "line 3: vertex 0 has the coordinate NaN"),
        ("OFF\n1 0 0\n0 1e999 0\n", "line 3: vertex 0 has the coordinate inf"),
        ("OFF\n1 0 0\n0 x 0\n", "line 3: expected a coordinate, found \"x\""),
        ("OFF\n1 0 0\n0 0\n", "line 3: expected a coordinate, found the end of the line"),
        ("OFF\n9999999999 0 0\n0 0 0\n", "expected 9999999999 vertices, found 1 and then the end"),
        ("OFF\n1 0 0\n0 0 0\n0 0 0\n", "line 4: expected the end of the file"),
        ("OFF\n1 99999999999 0\n0 0 0\n", "expected 99999999999 faces, found 0 and then the end"),
        ("OFF\n-1 0 0\n", "line 2: expected the number of vertices, found -1"),
        ("4OFF\n1 0 0\n", "line 1: expected OFF with three coordinates of each position"),
        ("C4OFF\n1 0 0\n", "found \"C4OFF\", four coordinates of each position"),
        ("nOFF\n2\n1 0 0\n", "found \"nOFF\", positions of any dimension"),
        ("4nOFF\n2\n1 0 0\n", "found \"4nOFF\", positions of any dimension"),
        ("OFFSET 1 0 0", "line 1: expected OFF, perhaps with the prefixes"),
        ("OFF BINARY\n\0\0", "byte 11: expected the number of vertices"),
        ("OFF", "expected the number of vertices, found the end of the file"),
    ] {
        let message = message(text);
        assert!(message.contains(expected), "{text:?}: {message}");
    }
}

/// MeshLab writes `N` before `C`, and colours before normals.
#[test]
fn colours_precede_normals_where_meshlab_wrote() {
    let parsed = parsed("NCSTOFF\n1 0 0\n1 2 3 255 0 9 255 0 0.6 0.8 0.5 0.5 \n");
    assert_eq!(parsed.positions, [[1.0, 2.0, 3.0]]);
    assert_eq!(parsed.fields.vector("normal"), Some(&[[0.0, 0.6, 0.8]][..]));
    assert_eq!(parsed.fields.colors, Some(vec![[255, 0, 9]]));
    assert!(parsed.doubts.is_empty());
}

/// Colours of any form after a face end with their line and shift nothing.
#[test]
fn colours_of_faces_end_with_their_line() {
    for color in ["", "7", "255 0 0", "255 0 0 255", "0.5 0.5 0.5", "1.0 0 0 0.25", "0 1 2 # c"] {
        let text = format!("OFF 3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 {color}\n3 2 1 0 {color}\n");
        let parsed = parsed(&text);
        assert_eq!(parsed.polygons, Polygons::Triangles(vec![[0, 1, 2], [2, 1, 0]]), "{text}");
        assert_eq!(parsed.notes.len(), usize::from(!color.is_empty()), "{text}");
    }
}

/// A number that is missing does not become one of the next line.
#[test]
fn missing_numbers_are_found() {
    for (text, line) in [
        ("OFF\n3 1 0\n0 0 0\n1 0\n0 1 0\n3 2 1 0\n", "line 4: "),
        ("OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1\n3 1 2 0\n", "line 6: "),
        ("OFF\n3 1 0\n0 0 0\n1 0\n0 1 0\n3 2 1 0 0\n", "line 4: "),
    ] {
        assert!(message(text).starts_with(line), "{text:?}: {}", message(text));
    }
}

/// A triangle with normals, colours and texture coordinates, and with a colour of the face.
fn binary() -> Vec<u8> {
    let mut bytes = b"STCNOFF BINARY\n".to_vec();
    let words = |bytes: &mut Vec<u8>, all: &[i32]| {
        bytes.extend(all.iter().flat_map(|word| word.to_be_bytes()));
    };
    words(&mut bytes, &[3, 1, 0]);
    for position in [[0.0f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.5, 0.0]] {
        let rest = [0.0, 0.0, 1.0, 0.2, 0.4, 1.0, 1.0, 0.5, 0.5];
        bytes.extend(position.iter().chain(&rest).flat_map(|x| x.to_be_bytes()));
    }
    words(&mut bytes, &[3, 0, 1, 2, 3, 1, 2, 3]);
    bytes
}

#[test]
fn binary_files_are_read() {
    let parsed = super::parse(&binary(), Broken::Refused).unwrap();
    assert_eq!(parsed.positions, [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.5, 0.0]]);
    assert_eq!(parsed.polygons, Polygons::Triangles(vec![[0, 1, 2]]));
    assert_eq!(parsed.fields.vector("normal"), Some(&[[0.0, 0.0, 1.0]; 3][..]));
    assert_eq!(parsed.fields.colors, Some(vec![[51, 102, 255]; 3]));
    assert_eq!(parsed.notes.len(), 2);
}

/// Each prefix ends too soon, and a false count reserves no memory.
#[test]
fn damaged_binary_files_are_refused() {
    let sound = binary();
    for length in 15..sound.len() {
        assert!(super::parse(&sound[..length], Broken::Refused).is_err(), "{length}");
    }
    for (at, expected) in [
        (15, "byte 27: expected 2147483647 vertices, found 176 bytes"),
        (19, "byte 171: expected 2147483647 faces, found 32 bytes"),
        (171, "byte 175: expected 2147483647 corners, found 28 bytes"),
        (175, "byte 175: face 0 names vertex 2147483647"),
        (187, "byte 191: expected 2147483647 values of a colour, found 12 bytes"),
    ] {
        let mut forged = sound.clone();
        forged[at..at + 4].copy_from_slice(&i32::MAX.to_be_bytes());
        let fault = super::parse(&forged, Broken::Refused).err().unwrap();
        let message = format!("{}{}", fault.at, fault.problem);
        assert!(message.starts_with(expected), "{at}: {message}");
    }
    let longer = super::parse(&[&sound[..], &[1]].concat(), Broken::Refused).err().unwrap();
    assert!(longer.problem.to_string().contains("found 1 bytes more"));
}
