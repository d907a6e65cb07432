//! Reports of lost content, and atomic writing.

use crate::io::tests::{read, refusal, tetrahedron};
use crate::io::{Format, Reader, UnsupportedFields, VertexFields, WriteOptions};
use crate::io::{WriteProblem, write, write_to, write_with_fields};

/// An open box whose quads name a corner twice, in a row and not, as files of
/// the formats that have polygons, and the same faces triangle by triangle.
#[test]
fn repeated_corners_are_reduced_alike_in_all_formats() {
    let corners = ["0 0 0", "1 0 0", "0 1 0", "1 1 0", "0 0 1"];
    let faces: [&[u32]; 6] = [
        &[0, 1, 2, 2],
        &[1, 1, 3, 2],
        &[0, 2, 4, 0],
        &[3, 1, 4, 1],
        &[0, 1, 1, 0],
        &[2, 4, 3, 2, 1],
    ];
    let lines = |begin: &str, list: &dyn Fn(&[u32]) -> String| {
        let vertices: String = corners.iter().map(|c| format!("{begin}{c}\n")).collect();
        vertices + &faces.iter().map(|f| list(f) + "\n").collect::<String>()
    };
    let named =
        |f: &[u32], from: u32| f.iter().map(|v| format!(" {}", v + from)).collect::<String>();
    let counted = |f: &[u32]| format!("{}{}", f.len(), named(f, 0));
    let obj = lines("v ", &|f| format!("f{}", named(f, 1)));
    let relative = lines("v ", &|f| {
        "f".to_owned() + &f.iter().map(|&v| format!(" {}", i64::from(v) - 5)).collect::<String>()
    });
    let off = format!("OFF\n5 6 0\n{}", lines("", &counted));
    let header = "property double x\nproperty double y\nproperty double z\nelement face 6\n\
                  property list uchar int vertex_indices\nend_header\n";
    let ply = format!("ply\nformat ascii 1.0\nelement vertex 5\n{header}{}", lines("", &counted));
    let binary = binary_ply(header, &corners, &faces);
    let expected: [&[u32]; 5] = [&[0, 1, 2], &[1, 3, 2], &[0, 2, 4], &[3, 1, 4], &[2, 4, 3, 1]];
    let files = [
        ("a.obj", obj.as_bytes()),
        ("b.obj", relative.as_bytes()),
        ("a.off", off.as_bytes()),
        ("a.ply", ply.as_bytes()),
        ("b.ply", &binary[..]),
    ];
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in files {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        let file = crate::io::read(&path).unwrap();
        let polygons = file.mesh.polygons().unwrap();
        assert_eq!(polygons.iter().collect::<Vec<_>>(), expected, "{name}");
        let report = &file.report;
        assert_eq!((report.file_faces, report.faces(), report.polygons), (6, 5, 1), "{name}");
        assert_eq!((report.reduced, &report.first_reduced[..]), (5, &[0, 1, 2, 3, 5][..]));
        assert_eq!((report.left_out, &report.first_left_out[..]), (1, &[4][..]));
        let said = report.to_string();
        assert!(said.contains("5 vertices, 5 faces\n"), "{said}");
        let reduced =
            "5 faces repeat a corner and are reduced to their distinct corners: 0, 1, 2, 3, 5";
        assert!(said.contains(reduced), "{said}");
        let triangles = read(name, bytes);
        assert_eq!(triangles.mesh.face_count(), 6, "{name}");
        assert_eq!(triangles.report, file.report);
        let message = refusal(name, bytes, &Reader::strict());
        assert!(message.contains("face 0 repeats a corner (6 such faces)"), "{message}");
    }
}

/// The binary form of a PLY file with this header.
fn binary_ply(header: &str, corners: &[&str], faces: &[&[u32]]) -> Vec<u8> {
    let mut binary =
        format!("ply\nformat binary_little_endian 1.0\nelement vertex 5\n{header}").into_bytes();
    for c in corners {
        c.split(' ').for_each(|x| binary.extend(x.parse::<f64>().unwrap().to_le_bytes()));
    }
    for f in faces {
        binary.push(f.len() as u8);
        f.iter().for_each(|v| binary.extend(v.to_le_bytes()));
    }
    binary
}

/// A triangle that repeats a corner is a segment or a point.
#[test]
fn welded_triangles_that_repeat_a_corner_are_left_out() {
    let facet = |t: [&str; 3]| {
        let [a, b, c] = t;
        format!(
            "facet normal 0 0 0\nouter loop\nvertex {a}\nvertex {b}\nvertex {c}\nendloop\nendfacet\n"
        )
    };
    let [a, b, c] = ["0 0 0", "1 0 0", "0 1 0"];
    let stl = format!("solid\n{}{}{}endsolid\n", facet([a, b, c]), facet([a, b, b]), facet([c; 3]));
    let file = read("a.stl", stl.as_bytes());
    assert_eq!(file.mesh.faces(), [[0, 1, 2]]);
    assert_eq!((file.report.reduced, &file.report.first_left_out[..]), (0, &[1, 2][..]));
}

#[test]
fn faces_with_fewer_than_three_distinct_corners_are_left_out_by_name() {
    let text =
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 1 2 1\nf 1 2 4 3\nf 4 4 4 4\nf 2 4 3\n";
    let file = read("a.obj", text.as_bytes());
    assert_eq!(file.mesh.faces(), [[0, 1, 2], [0, 1, 3], [0, 3, 2], [1, 3, 2]]);
    assert_eq!((file.report.file_faces, file.report.polygons), (5, 1));
    assert_eq!((file.report.left_out, &file.report.first_left_out[..]), (2, &[1, 3][..]));
    let said = file.report.to_string();
    assert!(
        said.contains(
            "2 faces repeat a corner and are left out, with fewer than three distinct ones: 1, 3"
        ),
        "{said}"
    );
    let message = refusal("a.obj", text.as_bytes(), &Reader::strict());
    assert!(message.contains("face 1 repeats a corner (2 such faces)"), "{message}");
}

#[test]
fn at_most_a_few_of_the_faces_left_out_are_named() {
    let text = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n{}f 1 2 3\n", "f 1 1 2\n".repeat(100));
    let report = read("a.obj", text.as_bytes()).report;
    assert_eq!(report.first_left_out, [0, 1, 2, 3, 4, 5, 6, 7]);
    assert!(report.to_string().ends_with("6, 7, …"), "{report}");
}

#[test]
fn fields_that_are_not_finite_are_left_out_by_name() {
    let text = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty \
                float z\nproperty float q\nproperty float r\nend_header\n0 0 0 1 nan\n0 0 1 2 3\n";
    let file = read("a.ply", text.as_bytes());
    assert_eq!(file.fields, VertexFields::default().with_scalar("q", vec![1.0, 2.0]));
    assert_eq!(file.report.notes, ["field r is NaN at vertex 0: left out"]);
    assert!(Reader::strict().read_bytes("a.ply", text.as_bytes()).is_err());
}

#[test]
fn fields_are_never_lost_in_silence() {
    let folder = tempfile::tempdir().unwrap();
    let fields = VertexFields::default()
        .with_scalar("mean", vec![1.0; 4])
        .with_vector("normal", vec![[0.0, 0.0, 1.0]; 4])
        .with_colors(vec![[1, 2, 3]; 4]);
    for (name, unsupported) in [
        ("a.obj", vec!["mean"]),
        ("a.off", vec!["mean"]),
        ("a.glb", vec![]),
        ("a.stl", vec!["mean", "normal", "colours"]),
        ("a.ply.gz", vec![]),
    ] {
        let path = folder.path().join(name);
        let refuse = WriteOptions::default();
        match write_with_fields(&path, &tetrahedron(), &fields, &refuse) {
            Ok(report) => assert!(unsupported.is_empty() && report.dropped.is_empty()),
            Err(error) => {
                let WriteProblem::UnsupportedFields { fields, .. } = error.problem else {
                    panic!("{error}")
                };
                assert_eq!(fields, unsupported);
                assert!(!path.exists());
            }
        }
        let dropping = refuse.dropping_fields();
        assert_eq!(dropping.unsupported_fields, UnsupportedFields::Drop);
        let report = write_with_fields(&path, &tetrahedron(), &fields, &dropping).unwrap();
        assert_eq!(report.dropped, unsupported);
    }
}

#[test]
fn unsound_fields_are_refused_by_name() {
    let path = std::path::Path::new("/nowhere/a.ply");
    let problem = |fields: VertexFields| {
        let written = write_with_fields(path, &tetrahedron(), &fields, &WriteOptions::default());
        written.unwrap_err().problem.to_string()
    };
    let scalar = |name: &str, value| VertexFields::default().with_scalar(name, vec![value; 4]);
    let long = VertexFields::default().with_scalar("q", vec![0.0; 5]);
    assert_eq!(problem(long), "field q has 5 values for 4 vertices");
    let none = VertexFields::default().with_colors(vec![]);
    assert_eq!(problem(none), "field of colours has 0 values for 4 vertices");
    let nan = problem(scalar("q", f64::NAN));
    assert_eq!(nan, "field q is NaN at vertex 0, which is not finite");
    for name in ["", "a\n", "nx\0"] {
        assert!(problem(scalar(name, 0.0)).starts_with("field name"), "{name:?}");
    }
    let twice = scalar("q", 0.0).with_scalar("q", vec![0.0; 4]);
    assert!(problem(twice).contains("two fields of this name"));
}

/// Names that are free in VTP and GLB have other meanings in PLY.
#[test]
fn names_are_kept_where_they_can_be() {
    let zeros = || vec![0.0; 4];
    let scalars = ["x", "z", "a b", "a_x", "a_y", "a_z", "v_y", "vertex_index"];
    let fields = scalars
        .iter()
        .fold(VertexFields::default(), |fields, &name| fields.with_scalar(name, zeros()));
    let fields = fields.with_vector("v", vec![[0.0, 1.0, 2.0]; 4]).with_colors(vec![[1, 2, 3]; 4]);
    let again = |format, fields: &VertexFields| {
        let mut bytes = Vec::new();
        let options = WriteOptions::default().dropping_fields();
        let report = write_to(&mut bytes, format, &tetrahedron(), fields, &options).unwrap();
        let file = Reader::strict().read_bytes("", &bytes).unwrap();
        assert!(file.report.notes.is_empty(), "{format}: {:?}", file.report.notes);
        (file.fields, report.notes)
    };
    for format in [Format::Vtp, Format::Glb] {
        let (found, notes) = again(format, &fields);
        assert!(notes.iter().all(|note| !note.contains("field")), "{format}: {notes:?}");
        for name in scalars {
            assert_eq!(found.scalar(name), fields.scalar(name), "{format}: {name}");
        }
        assert_eq!(found.vectors, fields.vectors, "{format}");
    }
    let changed = ["x_2", "z_2", "a_b", "a_x", "a_y", "a_z_2", "v_y", "vertex_index"];
    let format = Format::Ply;
    let (found, notes) = again(format, &fields);
    let names: Vec<&str> = found.scalars.iter().map(|(name, _)| &name[..]).collect();
    assert_eq!(names, changed, "{format}");
    assert_eq!(found.vectors[0].0, "v_2");
    assert_eq!(
        notes,
        [
            "\"x\" is called x_2",
            "\"z\" is called z_2",
            "\"a b\" is called a_b",
            "\"a_z\" is called a_z_2",
            "\"v\" is called v_2"
        ]
        .map(|n| format!("the field {n}"))
    );
    // These names are kept from then on.
    assert_eq!(again(format, &found), (found, vec![]));
    let mut of_faces = VertexFields::default();
    of_faces.faces.scalars = ["x", "vertex_index"].map(|name| (name.to_owned(), zeros())).to_vec();
    assert_eq!(again(Format::Vtp, &of_faces), (of_faces.clone(), vec![]));
    let (found, notes) = again(Format::Ply, &of_faces);
    let names: Vec<&str> = found.faces.scalars.iter().map(|(name, _)| &name[..]).collect();
    assert_eq!((names, notes.len()), (vec!["x", "vertex_index_2"], 1));
}

#[test]
fn a_failed_write_leaves_what_was_there() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.stl");
    write(&path, &tetrahedron()).unwrap();
    let before = std::fs::read(&path).unwrap();
    let fields = VertexFields::default().with_scalar("q", vec![0.0; 4]);
    write_with_fields(&path, &tetrahedron(), &fields, &WriteOptions::default()).unwrap_err();
    assert_eq!(std::fs::read(&path).unwrap(), before);
    // A folder of that name cannot be replaced; nothing temporary stays.
    let taken = folder.path().join("b.obj");
    std::fs::create_dir(&taken).unwrap();
    assert!(matches!(write(&taken, &tetrahedron()).unwrap_err().problem, WriteProblem::Io(_)));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
    let unknown = write(folder.path().join("a.txt"), &tetrahedron()).unwrap_err();
    assert!(matches!(unknown.problem, WriteProblem::UnknownExtension { .. }));
}

#[cfg(unix)]
#[test]
fn written_files_have_the_permissions_of_new_files() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let mode = |path: &std::path::Path| std::fs::metadata(path).unwrap().permissions().mode();
    let (ours, plain) = (folder.path().join("a.ply"), folder.path().join("plain"));
    write(&ours, &tetrahedron()).unwrap();
    std::fs::write(&plain, b"").unwrap();
    assert_eq!(mode(&ours), mode(&plain));
}

#[test]
fn stl_says_what_it_loses() {
    let folder = tempfile::tempdir().unwrap();
    let report = write(folder.path().join("a.stl"), &tetrahedron()).unwrap();
    assert_eq!(
        report.notes,
        [
            "STL numbers vertices by first appearance, not as they were",
            "binary STL rounds coordinates to 32 bits",
        ]
    );
    let isolated = crate::TriMesh::new(vec![[0.0; 3]], vec![]).unwrap();
    let report = write(folder.path().join("b.stl"), &isolated).unwrap();
    assert_eq!(report.notes, ["STL does not hold the 1 isolated vertices"]);
}
