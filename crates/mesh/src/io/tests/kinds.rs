//! Recognition of formats, and of files that are no mesh.

use std::io::Write;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use flate2::Compression;
use flate2::write::GzEncoder;

use crate::io::tests::{read, refusal, tetrahedron};
use crate::io::{Format, Reader, VertexFields, WriteOptions, read as read_file, to_bytes};

/// A file name with the usual file extension.
fn name_of(format: Format) -> String {
    format!("a.{}", format.extensions()[0])
}

fn bytes(format: Format, options: &WriteOptions) -> Vec<u8> {
    let options = options.clone().dropping_fields();
    to_bytes(format, &tetrahedron(), &VertexFields::default(), &options).unwrap()
}

fn packed(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

#[test]
fn content_decides_where_the_name_is_silent() {
    for format in Format::ALL {
        for options in [WriteOptions::default(), WriteOptions::ascii()] {
            let bytes = bytes(format, &options);
            for (bytes, compressed) in [(packed(&bytes), true), (bytes, false)] {
                for name in ["", "mesh", "mesh.dat"] {
                    let report = read(name, &bytes).report;
                    assert_eq!((report.format, report.compressed), (format, compressed));
                }
            }
        }
    }
}

/// The mark is skipped in text and before the header of a binary PLY; places in
/// errors still count from the start of the file.
#[test]
fn a_byte_order_mark_is_no_content() {
    const MARK: &[u8] = b"\xef\xbb\xbf";
    for format in Format::ALL {
        let marked = [MARK, &bytes(format, &WriteOptions::ascii())].concat();
        for name in ["", &name_of(format)] {
            for bytes in [marked.clone(), packed(&marked)] {
                // A packed file has another file extension.
                let name = if bytes == marked { name } else { "" };
                let file = read(name, &bytes);
                assert_eq!(file.report.format, format);
                assert!(file.report.notes.iter().any(|note| note.contains("byte-order mark")));
                assert_eq!(file.mesh.vertex_count(), tetrahedron().vertex_count());
            }
        }
    }
    let reader = Reader::default();
    assert!(refusal("a.obj", b"\xef\xbb\xbfv 0 0 0\nv 1 x 0\n", &reader).contains("line 2"));
    let ply = [MARK, &bytes(Format::Ply, &WriteOptions::default())].concat();
    assert_eq!(read("a.ply", &ply).mesh, tetrahedron());
    let cut = ply.len() - 30;
    let plain = refusal("a.ply", &ply[3..cut], &reader);
    let moved = refusal("a.ply", &ply[..cut], &reader);
    let byte = |message: &str| -> u64 {
        let digits = message.split("byte ").nth(1).unwrap();
        digits[..digits.find(|c: char| !c.is_ascii_digit()).unwrap()].parse().unwrap()
    };
    assert_eq!(byte(&moved), byte(&plain) + 3);
    // Nothing but the mark, and a mark before what is no mesh.
    assert!(!refusal("a.obj", MARK, &reader).is_empty());
    assert!(refusal("", b"\xef\xbb\xbfhello", &reader).contains("expected one of the formats OBJ"));
}

#[test]
fn another_kind_than_the_ending_is_named() {
    for content in Format::ALL {
        for options in [WriteOptions::default(), WriteOptions::ascii()] {
            let bytes = bytes(content, &options);
            for named in Format::ALL.into_iter().filter(|&named| named != content) {
                let message = refusal(&name_of(named), &bytes, &Reader::default());
                let expected = format!("the name says {named}, but the content is {content}");
                assert!(message.contains(&expected), "{message}");
            }
        }
    }
    let message = refusal("a.obj.gz", b"v 0 0 0\n", &Reader::default());
    assert!(message.contains("the name says gzip-compressed, but the content is not"), "{message}");
    for format in Format::ALL {
        let message = refusal(&name_of(format), b"\x89PNG\r\n\x1a\n and so on", &Reader::default());
        assert!(message.contains("but the content is a PNG image"), "{message}");
    }
    let message = refusal("a.png", b"\x89PNG\r\n\x1a\n", &Reader::default());
    assert!(message.contains("expected one of the formats OBJ, PLY, OFF, STL"), "{message}");
}

#[test]
fn gzip_under_a_plain_name_is_read() {
    let file = read("a.obj", &packed(&bytes(Format::Obj, &WriteOptions::default())));
    assert!(file.report.compressed);
    assert_eq!(file.mesh, tetrahedron());
}

#[test]
fn empty_files_and_meshes_are_errors() {
    for format in Format::ALL {
        for bytes in [&b""[..], b" \n\t\r\n", &packed(b"")] {
            let message = refusal(&name_of(format), bytes, &Reader::default());
            assert!(message.contains("the file is empty"), "{message}");
        }
    }
    for (name, bytes) in [
        ("a.obj", &b"# nothing\n"[..]),
        ("a.off", b"OFF\n0 0 0\n"),
        ("a.stl", b"solid\nendsolid\n"),
        ("b.stl", &[0; 84]),
        (
            "a.ply",
            b"ply\nformat ascii 1.0\nelement vertex 0\nproperty int x\nproperty int y\n\
                   property int z\nend_header\n",
        ),
    ] {
        let message = refusal(name, bytes, &Reader::default());
        assert!(message.contains("the file holds no vertices"), "{name}: {message}");
    }
}

/// SolidWorks writes binary files whose header begins with `solid`; cut short, one is still binary.
#[test]
fn a_binary_stl_with_a_header_like_text_is_binary_at_any_size() {
    let mut bytes = b"solid part".to_vec();
    bytes.resize(80, b' ');
    bytes.extend(1u32.to_le_bytes());
    for x in [0.0f32, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0] {
        bytes.extend(x.to_le_bytes());
    }
    bytes.extend([0; 2]);
    let reader = Reader::default();
    assert_eq!(read("a.stl", &bytes).mesh.face_count(), 1);
    for wrong in [&bytes[..bytes.len() - 7], &[&bytes[..], b"junk"].concat()] {
        let message = refusal("a.stl", wrong, &reader);
        assert!(message.contains("1 triangles of 50 bytes, as the header says"), "{message}");
    }
}

#[test]
fn several_gzip_members_are_one_file() {
    let text = bytes(Format::Obj, &WriteOptions::default());
    let (a, b) = text.split_at(40);
    assert_eq!(read("a.obj.gz", &[packed(a), packed(b)].concat()).mesh, tetrahedron());
}

#[test]
fn damaged_gzip_is_an_error() {
    let packed = packed(&bytes(Format::Off, &WriteOptions::default()));
    for length in 2..packed.len() {
        let message = refusal("a.off.gz", &packed[..length], &Reader::default());
        assert!(message.contains("cannot be decompressed"), "{length}: {message}");
    }
    let mut flipped = packed.clone();
    let last = flipped.len() - 6;
    flipped[last] ^= 1;
    let message = refusal("a.off.gz", &flipped, &Reader::default());
    assert!(message.contains("cannot be decompressed"), "{message}");
}

/// A thousandfold growth stops at the limit, long before memory does.
#[test]
fn bombs_stop_at_the_limit() {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    let block = vec![b'\n'; 1 << 20];
    for _ in 0..64 {
        encoder.write_all(&block).unwrap();
    }
    let bomb = encoder.finish().unwrap();
    assert!(bomb.len() < 70_000);
    let message = refusal("a.obj.gz", &bomb, &Reader::default());
    assert!(message.contains("unpack to more than"), "{message}");

    let small = packed(&bytes(Format::Obj, &WriteOptions::default()));
    let reader = Reader { max_bytes: 50, ..Reader::default() };
    let message = refusal("a.obj.gz", &small, &reader);
    assert!(message.contains("unpack to more than 50 bytes"), "{message}");
}

/// A file is read in one state or not at all.
#[test]
fn a_file_that_changes_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.off");
    let mut content = bytes(Format::Off, &WriteOptions::default());
    content.extend_from_slice(&b"# comment\n".repeat(1 << 17));
    std::fs::write(&path, &content).unwrap();
    let stop = AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            let mut file = std::fs::OpenOptions::new().append(true).open(&path).unwrap();
            while !stop.load(Ordering::Relaxed) {
                file.write_all(b"# more\n").unwrap();
                std::thread::yield_now();
            }
        });
        let start = Instant::now();
        let error = loop {
            match read_file(&path) {
                Ok(_) if start.elapsed() < Duration::from_secs(60) => {}
                outcome => break outcome,
            }
        };
        stop.store(true, Ordering::Relaxed);
        let error = error.unwrap_err().to_string();
        assert!(error.contains("has changed while it was read"), "{error}");
    });
}

#[test]
fn files_and_streams_stop_at_the_limit() {
    let content = bytes(Format::Obj, &WriteOptions::default());
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.obj");
    std::fs::write(&path, &content).unwrap();
    let size = content.len() as u64;
    for (max_bytes, fits) in [(size, true), (size - 1, false)] {
        let reader = Reader { max_bytes, ..Reader::default() };
        for read in [reader.read(&path), reader.read_from(&content[..], Some(Format::Obj))] {
            match read {
                Ok(_) => assert!(fits, "{max_bytes}"),
                Err(error) => {
                    let message = error.to_string();
                    assert!(!fits && message.contains(&format!("more than {max_bytes} bytes")));
                }
            }
        }
    }
    // A stream without end is not read to its end.
    let reader = Reader { max_bytes: 1 << 20, ..Reader::default() };
    let error = reader.read_from(std::io::repeat(b' '), None).unwrap_err();
    assert!(error.to_string().contains("more than 1048576 bytes"), "{error}");
}
