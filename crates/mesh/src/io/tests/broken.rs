//! Broken vertices and faces, refused or left out.

use crate::io::{ReadProblem, Reader};

/// Four corners of a square, a broken vertex with faces, and one without. The first and the last
/// face are sound, the last but one repeats a corner, the others have a broken or missing vertex.
const FILES: [(&str, &str); 3] = [
    (
        "a.obj",
        "v 0 0 0 1 0 0\nv nan 0 0 0 1 0\nv 1 0 0 1 1 1\nv 1 1 0 0 0 0\nv 0 1 0 0 0 1\nv 2 2 -inf 1 1 0\n\
         f 1 3 4\nf 1 2 3\nf 1 4 9\nf 1 -99 3\nf 0 1 3\nf 1 3 3\nf 1 4 5 3\n",
    ),
    (
        "a.off",
        "COFF\n6 7 0\n0 0 0 255 0 0 0\nnan 0 0 0 255 0 0\n1 0 0 255 255 255 0\n1 1 0 0 0 0 0\n0 1 0 0 0 255 0\n\
         2 2 -inf 255 255 0 0\n3 0 2 3\n3 0 1 2\n3 0 3 8\n3 0 -7 2\n3 7 0 2\n3 0 2 2\n4 0 3 4 2\n",
    ),
    (
        "a.ply",
        "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\nproperty float z\n\
         property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 7\n\
         property list uchar int vertex_indices\nend_header\n\
         0 0 0 255 0 0\nnan 0 0 0 255 0\n1 0 0 255 255 255\n1 1 0 0 0 0\n0 1 0 0 0 255\n2 2 -inf 255 255 0\n\
         3 0 2 3\n3 0 1 2\n3 0 3 8\n3 0 -7 2\n3 7 0 2\n3 0 2 2\n4 0 3 4 2\n",
    ),
];

#[test]
fn what_is_broken_is_an_error_or_left_out_with_its_count() {
    for (name, text) in FILES {
        for reader in [Reader::default(), Reader::strict()] {
            let error = reader.read_bytes(name, text.as_bytes()).unwrap_err();
            assert!(matches!(error.problem, ReadProblem::NonFinite { vertex: 1, .. }), "{error}");
        }
        let reader = Reader::dropping_broken();
        let file = reader.read_bytes(name, text.as_bytes()).unwrap();
        let (mesh, report) = (&file.mesh, &file.report);
        assert_eq!(mesh.faces(), [[0, 2, 3], [0, 3, 4], [0, 4, 2]], "{name}");
        assert_eq!(mesh.vertex_count(), 6);
        assert_eq!((mesh.positions()[1], mesh.positions()[5]), ([0.0; 3], [0.0; 3]));
        assert_eq!(mesh.positions()[4], [0.0, 1.0, 0.0]);
        assert_eq!(file.fields.colors.as_ref().unwrap()[4], [0, 0, 255]);
        assert_eq!((report.broken_vertices, report.broken_faces), (2, 4));
        assert_eq!(report.first_broken_vertices, [1, 5]);
        assert_eq!(report.first_broken_faces, [1, 2, 3, 4]);
        assert_eq!(
            (&report.first_left_out[..], report.file_faces, report.faces()),
            (&[5][..], 7, 2)
        );
        let said = report.to_string();
        assert!(said.contains("2 vertices are not finite") && said.contains("4 faces"), "{said}");
        // Where nothing is broken, the option changes nothing.
        let sound: String = text.replace("nan", "0").replace("-inf", "0");
        let sound: String =
            sound.replace("-99", "1").replace("f 0 1 3", "f 1 1 3").replace(" 9\n", " 1\n");
        let sound = sound.replace(" 8\n", " 0\n").replace("-7", "0").replace("3 7 ", "3 0 ");
        let [plain, dropping] = [Reader::default(), reader]
            .map(|reader| reader.read_bytes(name, sound.as_bytes()).unwrap());
        assert_eq!((plain.mesh, plain.report), (dropping.mesh, dropping.report));
    }
}

/// Binary files take other paths than text.
#[test]
fn binary_files_lose_what_is_broken_too() {
    let header = |faces: usize, body: &str| {
        format!(
            "ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\n\
             property float z\nelement face {faces}\nproperty list uchar {body} vertex_indices\nend_header\n"
        )
    };
    let corners = [[0.0f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [f32::NAN, 0.0, 0.0]];
    let mut bytes = header(3, "int").into_bytes();
    corners.as_flattened().iter().for_each(|x| bytes.extend(x.to_le_bytes()));
    for face in [[0i32, 1, 2], [0, 1, 3], [-1, 4, 0]] {
        bytes.push(3);
        face.iter().for_each(|v| bytes.extend(v.to_le_bytes()));
    }
    let mut stl = vec![0; 80];
    stl.extend(2u32.to_le_bytes());
    for corners in [[0, 1, 2], [1, 2, 3]].map(|face| face.map(|v: usize| corners[v])) {
        stl.extend([0; 12]);
        corners.as_flattened().iter().for_each(|x| stl.extend(x.to_le_bytes()));
        stl.extend([0; 2]);
    }
    for (name, bytes, faces) in [("a.ply", bytes, 2), ("a.stl", stl, 1)] {
        assert!(Reader::default().read_bytes(name, &bytes).is_err());
        let file = Reader::dropping_broken().read_bytes(name, &bytes).unwrap();
        assert_eq!(file.mesh.faces(), [[0, 1, 2]], "{name}");
        assert_eq!(file.mesh.positions()[3], [0.0; 3]);
        assert_eq!((file.report.broken_vertices, file.report.broken_faces), (1, faces), "{name}");
    }
    let nothing = "v nan 0 0\nv 0 inf 0\n";
    let error = Reader::dropping_broken().read_bytes("a.obj", nothing.as_bytes());
    assert!(matches!(error.unwrap_err().problem, ReadProblem::NoVertices));
}
