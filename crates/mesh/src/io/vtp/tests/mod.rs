//! Files of VTK, written by `vtkXMLPolyDataWriter` of VTK 9.7.2, and damaged ones.

use super::*;
use crate::io::parsed::{Broken, Parsed};
use crate::io::{Format, NumberType, Reader, WriteOptions, to_bytes};
use crate::polygon::Polygons;

const FILES: [&str; 3] =
    [include_str!("base64.vtp"), include_str!("packed.vtp"), include_str!("appended.vtp")];

fn outcome(bytes: &[u8]) -> Result<Parsed, String> {
    (FORMAT.parse)(bytes, Broken::Refused).map_err(|fault| format!("{}{}", fault.at, fault.problem))
}

#[test]
fn base64_and_zlib_are_decoded() {
    for file in FILES {
        assert!(looks_like(file.as_bytes()));
        let parsed = outcome(file.as_bytes()).unwrap();
        assert_eq!(parsed.positions[2..], [[1.0, 1.0, 0.0], [0.0, 1.0, 0.5]]);
        assert_eq!(parsed.polygons, Polygons::Triangles(vec![[0, 1, 2], [0, 2, 3]]));
        assert_eq!(parsed.fields.scalar("ids"), Some(&[0.0, 1.0, 4.0, 9.0][..]));
        assert_eq!(parsed.fields.types["ids"], NumberType::I32);
        assert_eq!(parsed.fields.faces.colors, Some(vec![[1, 2, 3], [255, 0, 9]]));
        assert_eq!(parsed.notes, [""; 0]);
    }
}

#[test]
fn headers_by_themselves_and_other_bytes_first() {
    let (whole, alone) = ("BgAAAAECA/8ACQ==", "BgAAAA==AQID/wAJ");
    let file = FILES[0].replace(whole, alone);
    assert!(file.contains(alone));
    assert_eq!(outcome(file.as_bytes()).unwrap().fields.faces.colors.unwrap()[1], [255, 0, 9]);
    let big = FILES[0].replace("LittleEndian", "BigEndian");
    assert!(outcome(big.as_bytes()).err().unwrap().contains("a header and its number of bytes"));
}

/// Two pieces with cells of every kind, in text.
const PIECES: &str = r#"<?xml version="1.0"?>
<!-- cells of every kind -->
<VTKFile type="PolyData"><PolyData>
<Piece NumberOfPoints="4" NumberOfVerts="1" NumberOfLines="1" NumberOfStrips="1" NumberOfPolys="2">
<PointData Normals="N &amp; M">
<DataArray type="Float32" Name="N &amp; M" NumberOfComponents="3">0 0 1 0 0 1 0 0 1 0 0 1</DataArray>
<DataArray type="Float32" Name="T" NumberOfComponents="2">0 1 2 3 4 5 6 7</DataArray>
</PointData>
<CellData><DataArray type="Int16" Name="of cell">0 1 2 3 4</DataArray></CellData>
<Points><DataArray type="Float64" NumberOfComponents="3">
0 0 0
1 0 0
1 1 0
0 1 0.1
</DataArray></Points>
<Verts><DataArray type="Int32" Name="connectivity">0</DataArray></Verts>
<Strips><DataArray type="Int32" Name="connectivity">0 1 2 3</DataArray>
<DataArray type="Int32" Name="offsets">4</DataArray></Strips>
<Polys><DataArray type="Int32" Name="connectivity">0 1 2 3
1 0 2</DataArray>
<DataArray type="Int32" Name="offsets">4 7</DataArray></Polys>
</Piece>
<Piece NumberOfPoints="3" NumberOfPolys="1">
<PointData>
<DataArray type="Float32" Name="T" NumberOfComponents="2">0 1 2 3 4 5</DataArray>
</PointData>
<CellData><DataArray type="Int16" Name="of cell">7</DataArray></CellData>
<Points><DataArray type="Float64" NumberOfComponents="3">5 0 0 6 0 0 5 1 0</DataArray></Points>
<Polys><DataArray type="Int32" Name="connectivity">0 1 2</DataArray>
<DataArray type="Int32" Name="offsets">3</DataArray></Polys>
</Piece>
</PolyData></VTKFile>
"#;

#[test]
fn pieces_are_joined_and_cells_keep_their_values() {
    let parsed = outcome(PIECES.as_bytes()).unwrap();
    assert_eq!(parsed.positions.len(), 7);
    let faces: Vec<&[u32]> = (0..5).map(|f| parsed.polygons.face(f)).collect();
    assert_eq!(faces, [&[0u32, 1, 2, 3][..], &[1, 0, 2], &[0, 1, 2], &[2, 1, 3], &[4, 5, 6]]);
    let of_cell = ("of cell".to_owned(), vec![2.0, 3.0, 4.0, 4.0, 7.0]);
    assert_eq!(parsed.fields.faces.scalars, [of_cell]);
    assert_eq!(parsed.fields.faces.types["of cell"], NumberType::I16);
    assert_eq!(parsed.fields.scalar("T_1").unwrap()[3..], [7.0, 1.0, 3.0, 5.0]);
    assert_eq!(parsed.fields.vectors, []);
    assert_eq!(
        parsed.notes,
        [
            "1 cells that are vertices are ignored",
            "1 cells that are lines are ignored",
            "1 triangle strips are split into triangles",
        ]
    );
    assert_eq!(parsed.doubts, ["the array \"N & M\" is not in every piece once: left out"]);
    let one = PIECES.replace("NumberOfPoints=\"3\" NumberOfPolys=\"1\"", "");
    let last = one.rfind("<Piece").unwrap();
    let one = format!("{}</PolyData></VTKFile>", &one[..last]);
    let parsed = outcome(one.as_bytes()).unwrap();
    assert_eq!(parsed.fields.vector("normal").unwrap().len(), 4);
}

#[test]
fn errors_name_the_line_and_the_array() {
    for (from, to, expected) in [
        ("1 1 0\n", "1 x 0\n", "line 13: expected a number, found \"x\""),
        ("1 1 0\n", "1 nan 0\n", "line 13: vertex 2 has the coordinate NaN"),
        ("1 1 0\n", "1 1\n", "line 10: expected 12 numbers in array \"\", found 11"),
        ("0 1 2 3\n1 0 2", "0 1 2 3\n1 0 4", "line 20: face 1 names vertex 4"),
        ("0 1 2 3\n1 0 2", "0 1 2 3\n1 0", "line 21: expected ascending offsets up to 6"),
        ("0 1 2 3\n1 0 2", "0 1 2 3\n1 0 2 2", "line 19: expected 7 numbers in array connect"),
        (">4 7<", ">7 4<", "line 21: expected ascending offsets up to 7"),
        (">4 7<", ">4 4 7<", "line 21: expected 2 numbers in array \"offsets\", found 3"),
        (">0 1 2 3 4<", ">0 1 2 3<", "line 9: expected 5 numbers in array \"of cell\", found 4"),
        ("</VTKFile>", "", "line 33: expected </VTKFile>"),
        ("</PolyData>", "", "line 32: expected XML, found"),
        ("NumberOfPoints=\"4\"", "NumberOfPoints=\"-4\"", "line 4: expected a count as Num"),
        ("type=\"Float64\"", "type=\"Float64\" format=\"hex\"", "line 10: expected the format"),
        (
            "\"PolyData\"",
            "\"PolyData\" compressor=\"vtkLZ4DataCompressor\"",
            "line 3: expected data",
        ),
        (
            "\"PolyData\"",
            "\"ImageData\"",
            "line 3: expected the type PolyData, found \"ImageData\"",
        ),
    ] {
        let file = PIECES.replacen(from, to, 1);
        assert_ne!(file, PIECES, "{from}");
        let message = outcome(file.as_bytes()).err().unwrap_or_else(|| panic!("{file} was read"));
        assert!(message.contains(expected), "{message}, and not {expected}");
    }
}

/// Counts, sizes and offsets that the file does not have.
#[test]
fn forged_numbers_end_with_the_bytes() {
    let max = u64::MAX.to_string();
    for count in ["4294967296", "1000000000000", &max] {
        for attribute in ["NumberOfPoints", "NumberOfPolys", "NumberOfStrips", "NumberOfVerts"] {
            let file =
                PIECES.replacen(&format!("{attribute}=\""), &format!("{attribute}=\"{count}"), 1);
            assert!(outcome(file.as_bytes()).is_err(), "{file}");
        }
        for file in FILES {
            let file = file.replace("=\"3\"", &format!("=\"{count}\""));
            assert!(outcome(file.as_bytes()).is_err(), "{file}");
        }
        let file = FILES[2].replace("offset=\"72\"", &format!("offset=\"{count}\""));
        assert!(outcome(file.as_bytes()).err().unwrap().contains("line 10: expected appended"));
    }
    let mesh = crate::io::tests::tetrahedron();
    let sound =
        to_bytes(Format::Vtp, &mesh, &Default::default(), &WriteOptions::default()).unwrap();
    let start = sound.iter().position(|&b| b == b'_').unwrap() + 1;
    for length in [97u64, 1 << 40, u64::MAX] {
        let mut file = sound.clone();
        file[start..start + 8].copy_from_slice(&length.to_le_bytes());
        assert!(outcome(&file).is_err());
    }
}

/// Arrays that share bytes, and blocks that claim to be large, stop at the limit.
#[test]
fn small_files_do_not_grow_without_limit() {
    let block = |name: usize| {
        format!("<DataArray type=\"Int8\" Name=\"a{name}\" format=\"appended\" offset=\"0\"/>\n")
    };
    let arrays: String = (0..4000).map(block).collect();
    let n = 40_000usize;
    let xml = format!(
        "<VTKFile type=\"PolyData\" header_type=\"UInt64\"><PolyData><Piece NumberOfPoints=\"{n}\">\
         <PointData>{arrays}</PointData><Points><DataArray type=\"Int8\" NumberOfComponents=\"3\" \
         format=\"appended\" offset=\"{}\"/></Points></Piece></PolyData>\
         <AppendedData encoding=\"raw\">_",
        n + 8
    );
    let mut file = xml.into_bytes();
    for length in [n, 3 * n] {
        file.extend((length as u64).to_le_bytes());
        file.extend(vec![1; length]);
    }
    file.extend(b"</AppendedData></VTKFile>");
    let message = outcome(&file).err().unwrap();
    assert!(message.contains("unpack to more than"), "{message}");
    let sizes = |length: u64| {
        use base64::Engine;
        let words = [1, length, 0, 14].map(u64::to_le_bytes).concat();
        base64::engine::general_purpose::STANDARD.encode(words)
    };
    let packed = FILES[1].replace("AQAAAAAAAAAgAAAAAAAAABAAAAAAAAAADgAAAAAAAAA=", &sizes(1 << 50));
    assert!(outcome(packed.as_bytes()).err().unwrap().contains("unpack to more than"));
    let packed = FILES[1].replace("AQAAAAAAAAAgAAAAAAAAABAAAAAAAAAADgAAAAAAAAA=", &sizes(15));
    let message = outcome(packed.as_bytes()).err().unwrap();
    assert!(message.contains("cannot be decompressed: a block holds 16"), "{message}");
}

#[test]
fn names_that_would_clash_are_changed() {
    let values = |name: &str, components: usize| {
        let numbers = "1 ".repeat(3 * components);
        format!(
            "<DataArray type=\"Int8\" Name=\"{name}\" NumberOfComponents=\"{components}\">{numbers}\
             </DataArray>"
        )
    };
    let names = ["x", "a_x", "a_y", "a_z", "red", "green", "blue", "", "b", "b", "v_y"];
    let arrays: String = names.iter().map(|name| values(name, 1)).collect();
    let arrays = arrays + &values("v", 3) + &values("two words", 3);
    let file = format!(
        "<VTKFile type='PolyData'><PolyData><Piece NumberOfPoints=\"3\"><PointData>{arrays}\
         </PointData><Points>{}</Points></Piece></PolyData></VTKFile>",
        values("", 3)
    );
    let read = |bytes: &[u8]| Reader::default().read_bytes("", bytes).unwrap();
    let file = read(file.as_bytes());
    let scalars: Vec<&str> = file.fields.scalars.iter().map(|(name, _)| &name[..]).collect();
    let expected = ["x", "a_x", "a_y", "a_z", "red", "green", "blue", "field", "b", "v_y"];
    assert_eq!(scalars, expected);
    let vectors: Vec<&str> = file.fields.vectors.iter().map(|(name, _)| &name[..]).collect();
    assert_eq!(vectors, ["v", "two words"]);
    let vtp = to_bytes(Format::Vtp, &file.mesh, &file.fields, &WriteOptions::default()).unwrap();
    let again = read(&vtp);
    assert_eq!((&again.fields, &again.fields.types), (&file.fields, &file.fields.types));
}

/// Programs show no points without cells.
#[test]
fn points_are_cells() {
    let points = crate::TriMesh::new(vec![[0.0; 3], [1.0, 0.0, 0.5]], vec![]).unwrap();
    for options in [WriteOptions::default(), WriteOptions::ascii()] {
        let bytes = to_bytes(Format::Vtp, &points, &Default::default(), &options).unwrap();
        let text = String::from_utf8_lossy(&bytes);
        assert!(text.contains("NumberOfVerts=\"2\"") && text.contains("<Verts>"), "{text}");
        let file = Reader::strict().read_bytes("", &bytes).unwrap();
        assert_eq!((file.mesh, file.report.notes.len()), (points.clone(), 0));
    }
}
