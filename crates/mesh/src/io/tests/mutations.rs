//! Damaged files are refused or read as a valid mesh, without a panic.

use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::Index;

use crate::io::{Format, NumberType, Reader, VertexFields, WriteOptions, WriteProblem, to_bytes};
use crate::trimesh::TriMesh;

/// One change of a file.
#[derive(Debug, Clone)]
enum Mutation {
    Set(Index, u8),
    Insert(Index, Vec<u8>),
    Remove(Index, Index),
    Repeat(Index, Index),
    Cut(Index),
}

fn mutation() -> impl Strategy<Value = Mutation> {
    let pieces = prop_oneof![
        Just(b"-1 ".to_vec()),
        Just(b"4294967296 ".to_vec()),
        Just(b"99999999999999999999 ".to_vec()),
        Just(b" nan ".to_vec()),
        Just(b" 1e999 ".to_vec()),
        Just(b"\\\n".to_vec()),
        Just(b"#".to_vec()),
        Just(b"\n".to_vec()),
        Just(b"\r".to_vec()),
        Just(vec![0xff; 4]),
        Just(vec![0; 4]),
        vec(any::<u8>(), 1..9),
    ];
    prop_oneof![
        (any::<Index>(), any::<u8>()).prop_map(|(at, byte)| Mutation::Set(at, byte)),
        (any::<Index>(), pieces).prop_map(|(at, piece)| Mutation::Insert(at, piece)),
        (any::<Index>(), any::<Index>()).prop_map(|(at, n)| Mutation::Remove(at, n)),
        (any::<Index>(), any::<Index>()).prop_map(|(at, n)| Mutation::Repeat(at, n)),
        any::<Index>().prop_map(Mutation::Cut),
    ]
}

fn mutate(bytes: &mut Vec<u8>, mutation: &Mutation) {
    if bytes.is_empty() {
        return;
    }
    let range = |at: &Index, length: &Index| {
        let at = at.index(bytes.len());
        at..bytes.len().min(at + length.index(40))
    };
    match mutation {
        Mutation::Set(at, byte) => {
            let at = at.index(bytes.len());
            bytes[at] = *byte;
        }
        Mutation::Insert(at, piece) => {
            let at = at.index(bytes.len());
            bytes.splice(at..at, piece.iter().copied());
        }
        Mutation::Remove(at, length) => drop(bytes.drain(range(at, length))),
        Mutation::Repeat(at, length) => {
            let range = range(at, length);
            let piece = bytes[range.clone()].to_vec();
            bytes.splice(range.start..range.start, piece);
        }
        Mutation::Cut(at) => bytes.truncate(at.index(bytes.len())),
    }
}

fn check(name: &str, bytes: &[u8]) {
    for reader in [Reader::default(), Reader::strict(), Reader::dropping_broken()] {
        if let Ok(file) = reader.read_bytes(name, bytes) {
            let (positions, faces) = (file.mesh.positions().to_vec(), file.mesh.faces().to_vec());
            TriMesh::new(positions, faces).unwrap();
            assert!(file.fields.scalars.iter().all(|(_, s)| s.len() == file.mesh.vertex_count()));
            // Names of PLY may clash once vectors are written after scalars.
            let written = to_bytes(Format::Ply, &file.mesh, &file.fields, &WriteOptions::default());
            match written.map_err(|error| error.problem) {
                Err(WriteProblem::FieldName { .. }) if file.report.format == Format::Ply => {}
                written => drop(written.unwrap()),
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn mutated_files_are_read_or_refused(
        format in proptest::sample::select(Format::ALL.to_vec()),
        ascii: bool,
        named: bool,
        textured: bool,
        mutations in vec(mutation(), 1..6),
    ) {
        let options = if ascii { WriteOptions::ascii() } else { WriteOptions::default() };
        let mesh = crate::io::tests::tetrahedron();
        let mut fields = VertexFields::default()
            .with_scalar("q", vec![0.5; 4])
            .with_vector("normal", vec![[0.0, 0.0, 1.0]; 4])
            .with_colors(vec![[1, 2, 3]; 4]);
        fields.faces.scalars.push(("part".to_owned(), vec![1.0; 4]));
        fields.faces.types.insert("part".to_owned(), NumberType::U8);
        fields.faces.texture = textured.then(|| vec![[0.5, 1.0]; 12]);
        let mut bytes = to_bytes(format, &mesh, &fields, &options.dropping_fields()).unwrap();
        mutations.iter().for_each(|mutation| mutate(&mut bytes, mutation));
        let name = if named { format!("a.{format}") } else { String::new() };
        check(&name, &bytes);
    }

    #[test]
    fn any_bytes_are_read_or_refused(
        head in proptest::sample::select(vec![
            &b""[..],
            &b"OFF\n"[..],
            &b"solid\n"[..],
            &b"v 0 0 0\n"[..],
            &b"\x1f\x8b"[..],
            &b"ply\nformat binary_big_endian 1.0\nelement vertex 2\n"[..],
            &b"glTF\x02\0\0\0\x40\0\0\0\x10\0\0\0JSON"[..],
            &b"VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 2\nDATA binary\n"[..],
            &b"0 0 .5\n"[..],
            &b"<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"1\">"[..],
        ]),
        tail in vec(any::<u8>(), 0..200),
    ) {
        let bytes = [head, &tail].concat();
        for name in ["", "a.obj.gz"] {
            check(name, &bytes);
        }
        for format in Format::ALL {
            check(&format!("a.{format}"), &bytes);
        }
    }
}

/// A prefix of a file is an error, never a smaller mesh: counts reveal it. (OBJ has
/// no counts, and of points in text the last number may be cut.)
#[test]
fn truncated_files_are_errors() {
    let mesh = crate::io::tests::tetrahedron();
    for format in Format::ALL.into_iter().filter(|&f| f != Format::Obj) {
        for options in [WriteOptions::default(), WriteOptions::ascii()] {
            let bytes = to_bytes(format, &mesh, &VertexFields::default(), &options).unwrap();
            let sound = bytes.trim_ascii_end().len();
            for length in 0..sound {
                let read = Reader::default().read_bytes("", &bytes[..length]);
                assert!(read.is_err(), "{format}: {length} of {sound}");
            }
        }
    }
}
