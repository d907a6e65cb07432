//! Several files at a time, standard streams, and repair through the program.

use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

use fairing_mesh::TriMesh;
use fairing_mesh::io;
use fairing_shapes as shapes;
use serde_json::Value;

use crate::command_line::{fairing, files, program, refuse, run};

/// A folder with a sphere, a torus, a file that is cut off and one without content.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    io::write(path("sphere.ply"), &shapes::icosphere(2)).unwrap();
    io::write(path("torus.obj"), &shapes::torus(3.0, 1.0, 24, 12)).unwrap();
    let bytes = std::fs::read(path("sphere.ply")).unwrap();
    std::fs::write(path("cut.ply"), &bytes[..bytes.len() / 2]).unwrap();
    std::fs::write(path("empty.off"), "").unwrap();
    std::fs::create_dir(path("out")).unwrap();
    folder
}

const ALL: &str = "cut.ply empty.off sphere.ply torus.obj";

#[test]
fn bad_files_are_reported_and_the_others_done() {
    let folder = folder();
    for jobs in [1, 3] {
        let line = format!("denoise {ALL} -o out/{{stem}}.ply --force --table=csv --jobs {jobs}");
        let output = fairing(folder.path(), &line);
        assert_eq!(output.status.code(), Some(3));
        let error = String::from_utf8(output.stderr).unwrap();
        assert!(error.contains("error: cut.ply") && error.contains("error: empty.off"), "{error}");
        assert!(error.ends_with("error: 2 of 4 files failed\n"), "{error}");
        assert_eq!(files(&folder.path().join("out")), ["sphere.ply", "torus.ply"]);
        let table = String::from_utf8(output.stdout).unwrap();
        let lines: Vec<&str> = table.lines().collect();
        assert!(lines[0].starts_with("path,noise") && lines[0].ends_with(",error"), "{table}");
        for (line, name) in lines[1..].iter().zip(ALL.split(' ')) {
            assert!(line.starts_with(&format!("{name},")), "{table}");
        }
    }
}

#[test]
fn two_inputs_never_write_the_same_file() {
    let folder = folder();
    let said = refuse(folder.path(), "smooth sphere.ply torus.obj -o out/a.ply", 2);
    assert!(said.contains("out/a.ply") && said.contains("{stem}"), "{said}");
    assert_eq!(files(&folder.path().join("out")), [""; 0]);
    let said = refuse(folder.path(), "convert sphere.ply torus.obj a.obj", 2);
    assert!(said.contains("--output"), "{said}");
    run(folder.path(), "convert sphere.ply torus.obj -o out/{stem}.off");
    assert_eq!(files(&folder.path().join("out")), ["sphere.off", "torus.off"]);
}

/// Each verb gives one row for each file, and the same as for the file alone.
#[test]
fn tables_have_a_row_for_each_file() {
    let folder = folder();
    run(folder.path(), "noise sphere.ply torus.obj -o out/{stem}.ply --sigma 0.1");
    for verb in ["info", "curvature", "spectrum -k 4", "repair --dry-run"] {
        let rows = run(folder.path(), &format!("{verb} sphere.ply torus.obj --json"));
        let rows: Vec<Value> = rows.lines().map(|row| serde_json::from_str(row).unwrap()).collect();
        for (mut row, name) in rows.into_iter().zip(["sphere.ply", "torus.obj"]) {
            assert_eq!(row["path"], name);
            row.as_object_mut().unwrap().remove("path");
            let alone = run(folder.path(), &format!("{verb} {name} --json"));
            assert_eq!(row, serde_json::from_str::<Value>(&alone).unwrap(), "{verb}");
        }
        let table = run(folder.path(), &format!("{verb} sphere.ply torus.obj --table"));
        assert_eq!(table.lines().count(), 3, "{table}");
    }
    // The reference has the name of each mesh.
    io::write(folder.path().join("torus.ply"), &shapes::torus(3.0, 1.0, 24, 12)).unwrap();
    let table = run(folder.path(), "compare out/sphere.ply out/torus.ply {stem}.ply --table");
    let lines: Vec<Vec<&str>> = table.lines().map(|l| l.split_whitespace().collect()).collect();
    let column = lines[0].iter().position(|name| *name == "normal_mean.value").unwrap();
    for line in &lines[1..] {
        let angle: f64 = line[column].parse().unwrap();
        assert!(angle > 1.0 && angle < 30.0, "{table}");
    }
}

fn piped(folder: &Path, line: &str, input: &[u8]) -> (Vec<u8>, String) {
    let mut child = Command::new(program())
        .args(line.split_whitespace())
        .current_dir(folder)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    child.stdin.take().unwrap().write_all(input).unwrap();
    let output = child.wait_with_output().unwrap();
    (output.stdout, String::from_utf8(output.stderr).unwrap())
}

#[test]
fn standard_streams_hold_a_mesh() {
    let folder = folder();
    run(folder.path(), "smooth sphere.ply -o smooth.ply");
    let bytes = std::fs::read(folder.path().join("sphere.ply")).unwrap();
    let (smooth, _) = piped(folder.path(), "smooth - -o - --to ply", &bytes);
    assert_eq!(smooth, std::fs::read(folder.path().join("smooth.ply")).unwrap());
    let (info, _) = piped(folder.path(), "info - --json", &smooth);
    assert_eq!(serde_json::from_slice::<Value>(&info).unwrap()["vertices"], 162);
    let (_, said) = piped(folder.path(), "smooth - -o -", &bytes);
    assert!(said.contains("--to"), "{said}");
    // The formats of the streams are named apart, and the content of the input decides.
    for from in ["", "--from ply"] {
        let line = format!("convert - - --to stl {from}");
        let (stl, said) = piped(folder.path(), &line, &bytes);
        assert_eq!(stl.len(), 84 + 50 * 320, "{said}");
    }
    let (nothing, said) = piped(folder.path(), "convert - - --from off --to stl", &bytes);
    assert!(nothing.is_empty() && said.contains("OFF") && said.contains("PLY"), "{said}");
    // Sources of distances are named by an option of the same name.
    let line = "geodesic - --from 0 --input-format ply -o - --to ply";
    let (distances, said) = piped(folder.path(), line, &bytes);
    assert!(distances.starts_with(b"ply"), "{said}");
}

/// `info` counts: it does not try repairs, whose time is no longer linear around such a hub.
#[test]
fn info_of_a_disc_with_a_hub_proposes_no_tried_options() {
    let folder = folder();
    let count = 60_000;
    let corner = |i: u32| {
        let angle = std::f64::consts::TAU * f64::from(i) / f64::from(count);
        [angle.cos(), angle.sin(), 0.0]
    };
    let positions = std::iter::once([0.0; 3]).chain((0..count).map(corner)).collect();
    let mut faces: Vec<_> = (0..count).map(|i| [0, 1 + i, 1 + (i + 1) % count]).collect();
    faces[7].swap(1, 2);
    io::write(folder.path().join("disc.ply"), &TriMesh::new(positions, faces).unwrap()).unwrap();
    let info: Value = serde_json::from_str(&run(folder.path(), "info disc.ply --json")).unwrap();
    assert_eq!((&info["sliver_faces"], &info["turned_faces"]), (&count.into(), &1.into()));
    assert_eq!(info["repair"], "fairing repair disc.ply -o repaired.ply");
}

/// A soup of turned faces with a hole, as a file of a scanner might be.
#[test]
fn info_names_the_repair_that_mends() {
    let folder = folder();
    let sphere = shapes::icosphere(3);
    let turn = |(f, &[a, b, c]): (usize, &[u32; 3])| if f % 5 == 0 { [a, c, b] } else { [a, b, c] };
    let faces = sphere.faces().iter().enumerate().map(turn);
    let open = |face: &[u32; 3]| ![12, 40].iter().any(|v| face.contains(v));
    let corners: Vec<[f64; 3]> =
        faces.filter(open).flat_map(|face| face.map(|v| sphere.positions()[v as usize])).collect();
    let soup = (0..corners.len() as u32 / 3).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect();
    let soup = TriMesh::new(corners, soup).unwrap();
    io::write(folder.path().join("scan.ply"), &soup).unwrap();
    let info: Value = serde_json::from_str(&run(folder.path(), "info scan.ply --json")).unwrap();
    let command = info["repair"].as_str().unwrap().strip_prefix("fairing ").unwrap();
    let dry = run(folder.path(), "repair scan.ply --dry-run");
    assert!(
        dry.contains("faces flipped") && !files(folder.path()).contains(&"repaired.ply".into())
    );
    // The two holes stay: only the user knows which loops of a boundary are holes.
    assert_eq!(command, "repair scan.ply -o repaired.ply");
    run(folder.path(), command);
    let info: Value =
        serde_json::from_str(&run(folder.path(), "info repaired.ply --json")).unwrap();
    assert_eq!((&info["turned_faces"], &info["boundary_loops"]), (&0.into(), &2.into()));
    assert_eq!(info["repair"], Value::Null);
    run(folder.path(), "repair repaired.ply -o closed.ply --holes 20");
    let closed = io::read(folder.path().join("closed.ply")).unwrap();
    assert!(closed.mesh.topology().is_closed() && closed.fields.scalar("source").is_some());
    let volume = closed.mesh.signed_volume() / sphere.signed_volume();
    assert!((volume - 1.0).abs() < 2e-3, "{volume}");
    run(folder.path(), "repair closed.ply -o again.ply --holes 20");
    assert_eq!(io::read(folder.path().join("again.ply")).unwrap().mesh, closed.mesh);
}

/// One row for each file, with the same columns; the elements and the map are in the summary.
#[test]
fn repairs_are_counted_in_a_table() {
    let folder = folder();
    let sphere = shapes::icosphere(2);
    let doubled = [sphere.faces(), &[sphere.faces()[3]]].concat();
    let doubled = TriMesh::new(sphere.positions().to_vec(), doubled).unwrap();
    io::write(folder.path().join("doubled.off"), &doubled).unwrap();
    let table = run(folder.path(), "repair doubled.off torus.obj --dry-run --table=csv");
    let rows: Vec<Vec<&str>> = table.lines().map(|row| row.split(',').collect()).collect();
    assert!(rows.len() == 3 && rows.iter().all(|row| row.len() == rows[0].len()), "{table}");
    let column = rows[0].iter().position(|name| *name == "duplicate-faces").unwrap();
    assert_eq!(rows[1][column], "1", "{table}");
    assert_eq!((rows[2][1], rows[2][column]), ("true", "0"), "{table}");
    let alone = run(folder.path(), "repair doubled.off --dry-run --json");
    let alone: Value = serde_json::from_str(&alone).unwrap();
    assert_eq!(alone["vertex_map"].as_array().unwrap().len(), 162);
    assert!(alone["changes"]["duplicate-faces"].as_array().unwrap().contains(&320.into()));
}

#[test]
fn info_lists_fields_of_faces_and_texture() {
    let folder = folder();
    let text = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
        property float z\nproperty float height\nelement face 1\nproperty list uchar int vertex_indices\n\
        property int group\nend_header\n0 0 0 1\n1 0 0 2\n0 1 0 3\n3 0 1 2 7\n";
    std::fs::write(folder.path().join("a.ply"), text).unwrap();
    let info: Value = serde_json::from_str(&run(folder.path(), "info a.ply --json")).unwrap();
    assert_eq!((&info["fields"][0], &info["face_fields"][0]), (&"height".into(), &"group".into()));
    assert_eq!(info["texture_coordinates"], false);
    assert!(run(folder.path(), "info a.ply").contains("fields of faces: group\n"));
}
