use super::*;
use crate::io::tests::read;
use crate::io::{Format, NumberType, VertexFields, WriteOptions, to_bytes};

fn message(bytes: &[u8]) -> String {
    match parse(bytes, Broken::Refused) {
        Ok(_) => panic!("{} was read", String::from_utf8_lossy(bytes)),
        Err(fault) => format!("{}{}", fault.at, fault.problem),
    }
}

/// Two points with a colour, padding and a list that is too long to be a field.
const HEADER: &str = "# .PCD v.7\nVERSION .7\nFIELDS y x z rgb _ fpfh id\nSIZE 4 4 4 4 1 1 8\n\
                      TYPE F F F F U U U\nCOUNT 1 1 1 1 2 17 1\nWIDTH 2\nHEIGHT 1\nPOINTS 2\n";

/// The rows of the points as bytes.
fn row(position: [f32; 3], color: u32, id: u64) -> Vec<u8> {
    let floats = position.map(f32::to_le_bytes).concat();
    [&floats[..], &color.to_le_bytes(), &[0; 2], &[9; 17], &id.to_le_bytes()].concat()
}

#[test]
fn text_bytes_and_compressed_bytes_hold_the_same() {
    let rows = [row([2.0, 1.0, 3.0], 0x0001_0203, 7), row([0.5, -1.0, 0.0], 0xff00_fe00, 1 << 60)];
    let list = " 9".repeat(17);
    let text = format!(
        "{HEADER}DATA ascii\n2 1 3 {} 0 0{list} 7\n0.5 -1 0 {} 0 0{list} {}\n",
        f32::from_bits(0x0001_0203),
        f32::from_bits(0xff00_fe00),
        1_u64 << 60
    );
    let binary = [format!("{HEADER}DATA binary\n").as_bytes(), &rows.concat()].concat();
    // One field after the other, in runs of bytes as they are and a copy of seventeen nines.
    let mut packed: Vec<u8> = Vec::new();
    let literal = |packed: &mut Vec<u8>, bytes: &[u8]| {
        for run in bytes.chunks(32) {
            packed.push(run.len() as u8 - 1);
            packed.extend(run);
        }
    };
    for range in [0..4, 4..8, 8..12, 12..16, 16..18] {
        rows.iter().for_each(|row| literal(&mut packed, &row[range.clone()]));
    }
    literal(&mut packed, &[9]);
    packed.extend([7 << 5, 33 - 9, 0]);
    rows.iter().for_each(|row| literal(&mut packed, &row[35..]));
    let sizes = [packed.len() as u32, 2 * 43].map(u32::to_le_bytes).concat();
    let head = format!("{HEADER}DATA binary_compressed\n");
    let compressed = [head.as_bytes(), &sizes, &packed].concat();
    for bytes in [text.as_bytes(), &binary, &compressed] {
        let file = read("", bytes);
        assert_eq!(file.mesh.positions(), [[1.0, 2.0, 3.0], [-1.0, 0.5, 0.0]]);
        assert_eq!(file.fields.colors, Some(vec![[1, 2, 3], [0, 254, 0]]));
        assert_eq!(file.fields.scalar("id"), Some(&[7.0, (1_u64 << 60) as f64][..]));
        let notes = [
            "the field \"fpfh\" of 17 numbers is ignored",
            "integers of \"id\" are rounded to 53 bits",
        ];
        assert_eq!(file.report.notes, notes);
        // The last number of a text may be cut.
        let whole = if bytes == text.as_bytes() { text.len() - 20 } else { bytes.len() };
        for length in 0..whole {
            assert!(parse(&bytes[..length], Broken::Refused).is_err(), "{length}");
        }
    }
    let mut long = binary.clone();
    long.push(0);
    assert_eq!(read("", &long).report.notes[1], "1 bytes after the points are ignored");
    let mut damaged = compressed.clone();
    *damaged.last_mut().unwrap() = 0;
    damaged.truncate(compressed.len() - 9);
    assert!(parse(&damaged, Broken::Refused).is_err());
}

#[test]
fn fields_keep_names_and_types() {
    let mut fields = VertexFields::default()
        .with_scalar("label", vec![1.0, 2.0, 3.0, 255.0])
        .with_vector("normal", vec![[0.0, 0.6, 0.8]; 4])
        .with_colors(vec![[1, 2, 3], [0; 3], [255; 3], [254, 0, 9]]);
    fields.types.insert("label".to_owned(), NumberType::U8);
    let mesh = crate::io::tests::tetrahedron();
    for options in [WriteOptions::default(), WriteOptions::ascii()] {
        let bytes = to_bytes(Format::Pcd, &mesh, &fields, &options.dropping_fields()).unwrap();
        let text = String::from_utf8_lossy(&bytes);
        assert!(text.contains("FIELDS x y z label normal_x normal_y normal_z rgb\n"), "{text}");
        assert!(text.contains("SIZE 8 8 8 1 8 8 8 4\n"), "{text}");
        let file = read("", &bytes);
        assert_eq!((file.mesh.positions(), &file.fields), (mesh.positions(), &fields));
        assert_eq!(file.fields.types["label"], NumberType::U8);
    }
    for name in ["rgb", "_", "normal_x"] {
        let clash = fields.clone().with_scalar(name, vec![0.0; 4]);
        let options = WriteOptions::default().dropping_fields();
        let error = to_bytes(Format::Pcd, &mesh, &clash, &options).unwrap_err();
        assert!(error.to_string().contains(&format!("field name {name:?}")), "{error}");
    }
}

#[test]
fn errors_name_the_line_and_forged_counts_cost_no_memory() {
    let ascii = |points: &str, lines: &str| {
        format!("VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n{points}\n{lines}")
    };
    let most = u64::from(u32::MAX) << 20;
    for (text, expected) in [
        (ascii("POINTS 2", "DATA ascii\n0 0 0\n0 x 0\n"), "line 9: expected a number, found \"x\""),
        (ascii("POINTS 1", "DATA ascii\n0 0 0\n1\n"), "line 9: expected the end of the file"),
        (ascii("POINTS 1", "DATA ascii\n0 nan 0\n"), "vertex 0 has the coordinate NaN"),
        (ascii("POINTS 2", "WIDTH 3\nHEIGHT 1\nDATA ascii\n"), "found WIDTH × HEIGHT of 3"),
        (ascii("", "DATA ascii\n"), "expected POINTS in the header"),
        (ascii("POINTS 1", "DATA zip\n"), "line 7: expected ascii, binary or binary_compressed"),
        (ascii("POINTS 1", "hello\n"), "line 7: expected a line of the header of PCD"),
        (ascii(&format!("POINTS {most}"), "DATA ascii\n"), "line 8: expected a number"),
        (ascii(&format!("POINTS {most}"), "DATA binary\n"), "points of 12 bytes, found 0 bytes"),
        (ascii("POINTS 1", "DATA binary_compressed\n"), "the sizes of the data, found the end"),
        ("FIELDS x y\nSIZE 4\nPOINTS 0\nDATA ascii\n".to_owned(), "2 words of SIZE"),
        ("FIELDS x\nSIZE 3\nTYPE F\nPOINTS 0\nDATA ascii\n".to_owned(), "found F of 3"),
        (
            "FIELDS x\nSIZE 4\nTYPE F\nPOINTS 1\nDATA ascii\n0\n".to_owned(),
            "the columns x, y and z",
        ),
    ] {
        let message = message(text.as_bytes());
        assert!(message.contains(expected), "{text}: {message}");
    }
}
