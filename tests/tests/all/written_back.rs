//! Content of files that verbs do not change, and that is written back.

use std::path::Path;

use fairing_mesh::io::{self, Format, VertexFields, WriteOptions};
use fairing_mesh::{PolygonMesh, TriMesh};
use serde_json::Value;

use crate::command_line::{fairing, run};

/// A torus of quads around one pentagon and a triangle.
fn quads() -> TriMesh {
    let (around, across) = (24_u32, 12_u32);
    let position = |k: u32| {
        let [u, v] = [(k / across, around), (k % across, across)]
            .map(|(k, n)| f64::from(k) / f64::from(n) * std::f64::consts::TAU);
        let r = 3.0 + v.cos();
        [r * u.cos(), r * u.sin(), v.sin()]
    };
    let at = |i: u32, j: u32| (i % around) * across + j % across;
    let corners = |k: u32| {
        let (i, j) = (k / across, k % across);
        vec![at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]
    };
    let mut faces: Vec<Vec<u32>> = (0..around * across).map(corners).collect();
    let [a, b, c, d] = faces[30][..] else { panic!("a quad") };
    // The neighbour across the side cd begins with d and c.
    let [_, _, e, f] = faces[31][..] else { panic!("a quad") };
    faces[30] = vec![a, b, c, e, d];
    faces[31] = vec![d, e, f];
    let positions = (0..around * across).map(position).collect();
    PolygonMesh::new(positions, faces).unwrap().triangulate()
}

/// The number of the polygon of each triangle.
fn numbers(mesh: &TriMesh) -> Vec<f64> {
    let polygons = mesh.polygons().unwrap();
    (0..polygons.count()).flat_map(|f| vec![f as f64; polygons.triangles_of(f).len()]).collect()
}

fn written(folder: &Path, line: &str) -> String {
    let output = fairing(folder, line);
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{line}: {said}");
    said
}

const MOVING: [&str; 4] = ["smooth", "denoise", "noise --sigma 0.1", "reconstruct -k 10"];

#[test]
fn verbs_that_keep_the_faces_keep_polygons() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = quads();
    let mut fields = VertexFields::default();
    fields.faces.scalars.push(("number".to_owned(), numbers(&mesh)));
    for format in Format::ALL.into_iter().filter(|format| format.holds().polygons) {
        let input = format!("a.{}", format.extensions()[0]);
        let options = WriteOptions::default().dropping_fields();
        io::write_with_fields(folder.path().join(&input), &mesh, &fields, &options).unwrap();
        let mut verbs = MOVING.to_vec();
        if format.holds().fields {
            verbs.extend(["curvature", "geodesic --from 0"]);
        }
        for verb in verbs {
            let output = format!("out.{}", format.extensions()[0]);
            let said = written(folder.path(), &format!("{verb} {input} -o {output} --force"));
            assert!(!said.contains("split"), "{verb}: {said}");
            let file = io::read(folder.path().join(output)).unwrap();
            assert_eq!(file.mesh.polygons(), mesh.polygons(), "{verb} {format}");
            if format.holds().face_fields {
                assert_eq!(file.fields.faces.scalars, fields.faces.scalars, "{verb} {format}");
            }
        }
    }
}

#[test]
fn formats_of_triangles_say_how_many_polygons_were_split() {
    let folder = tempfile::tempdir().unwrap();
    io::write(folder.path().join("a.ply"), &quads()).unwrap();
    for (verb, output) in [("smooth", "a.stl"), ("denoise", "a.glb"), ("convert", "b.stl")] {
        let said = written(folder.path(), &format!("{verb} a.ply -o {output}"));
        let note = format!("{output}: 287 polygons are split into triangles");
        assert!(said.contains(&note), "{verb}: {said}");
    }
    for (output, split) in [("c.stl", 287), ("c.ply", 0)] {
        for verb in ["smooth", "denoise"] {
            let line = format!("{verb} a.ply -o {output} --force --json");
            let json: Value = serde_json::from_str(&run(folder.path(), &line)).unwrap();
            assert_eq!(json["split_polygons"], split, "{line}");
        }
    }
}

/// Materials of a scan come out as they were, and so do objects and groups.
#[test]
fn materials_stay_with_their_faces() {
    let folder = tempfile::tempdir().unwrap();
    io::write(folder.path().join("plain.obj"), &quads()).unwrap();
    let plain = std::fs::read_to_string(folder.path().join("plain.obj")).unwrap();
    let (mut text, mut count) = ("mtllib scan.mtl\no scan\n".to_owned(), 0);
    for line in plain.lines() {
        if line.starts_with("f ") {
            match count {
                0 => text += "g front\nusemtl skin\n",
                100 => text += "usemtl cloth\ns 1\n",
                200 => text += "g back\nusemtl skin\n",
                _ => {}
            }
            count += 1;
        }
        text += line;
        text += "\n";
    }
    std::fs::write(folder.path().join("scan.obj"), text).unwrap();
    std::fs::write(folder.path().join("scan.mtl"), "newmtl skin\nnewmtl cloth\n").unwrap();
    std::fs::create_dir(folder.path().join("elsewhere")).unwrap();
    let read = |name: &str| io::read(folder.path().join(name)).unwrap().fields.faces.statements;
    let before = read("scan.obj");
    let per_face = |keyword: &'static str| [0, 150, 250].map(|f| before.name(keyword, 2 * f));
    assert_eq!(per_face("usemtl"), [Some(&b"skin"[..]), Some(b"cloth"), Some(b"skin")]);
    for verb in MOVING {
        let said = written(folder.path(), &format!("{verb} scan.obj -o out.obj --force"));
        assert!(!said.contains("materials"), "{verb}: {said}");
        assert_eq!(read("out.obj"), before, "{verb}");
        let said = written(folder.path(), &format!("{verb} scan.obj -o elsewhere/a.obj --force"));
        assert!(said.contains("its materials are looked for in scan.mtl"), "{verb}: {said}");
        let said = written(folder.path(), &format!("{verb} scan.obj -o out.ply --force"));
        assert!(said.contains("holds no groups, materials, smoothing groups"), "{verb}: {said}");
    }
}
