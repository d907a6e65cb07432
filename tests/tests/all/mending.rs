//! Repairs through the program: vertices merged, parts turned, holes filled and left.

use fairing_mesh::io::{self, NumberType};
use fairing_mesh::{RepairStep, TriMesh};
use fairing_shapes as shapes;
use serde_json::Value;
use tempfile::TempDir;

use crate::command_line::{refuse, run};

fn folder_with(mesh: &TriMesh) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    io::write(folder.path().join("a.ply"), mesh).unwrap();
    folder
}

fn json(folder: &TempDir, line: &str) -> Value {
    serde_json::from_str(&run(folder.path(), line)).unwrap()
}

/// A mesh as a soup whose zeros are 1e-16, by turns of both signs.
fn with_rounded_zeros(mesh: &TriMesh) -> TriMesh {
    let corner = |(i, &v): (usize, &u32)| {
        let zero = 1e-16 * ((i % 3) as f64 - 1.0);
        mesh.positions()[v as usize].map(|x| if x.abs() < 1e-12 { zero } else { x })
    };
    let corners = mesh.faces().as_flattened().iter().enumerate().map(corner).collect();
    let faces = (0..mesh.face_count() as u32).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect();
    TriMesh::new(corners, faces).unwrap()
}

#[test]
fn the_property_source_is_an_integer() {
    let folder = folder_with(&shapes::icosphere(1));
    run(folder.path(), "repair a.ply -o b.ply --quiet");
    for options in ["", " --ascii", " --single"] {
        run(folder.path(), &format!("convert b.ply c.ply --force --quiet{options}"));
        let types = io::read(folder.path().join("c.ply")).unwrap().fields.types;
        assert_eq!(types.get("source"), Some(&NumberType::I32), "{options}");
    }
}

/// `info` counts them and names the repair without options; a distance needs its unit.
#[test]
fn corners_that_differ_by_rounding_are_merged() {
    let torus = shapes::torus(3.0, 1.0, 24, 12);
    let folder = folder_with(&with_rounded_zeros(&torus));
    let info = json(&folder, "info a.ply --json");
    assert!(info["rounded_vertices"].as_u64().unwrap() > 0, "{info}");
    let command = info["repair"].as_str().unwrap();
    assert_eq!(command, "fairing repair a.ply -o repaired.ply");
    assert!(run(folder.path(), "repair a.ply --dry-run").contains("moved"));
    run(folder.path(), command.strip_prefix("fairing ").unwrap());
    let mended = json(&folder, "info repaired.ply --json");
    assert_eq!((&mended["vertices"], &mended["genus"]), (&288.into(), &1.into()));
    assert_eq!((&mended["rounded_vertices"], &mended["repair"]), (&0.into(), &Value::Null));

    let vertices = |options: &str| {
        json(&folder, &format!("repair a.ply --dry-run --json {options}"))["vertices"].clone()
    };
    assert_eq!(vertices("--tolerance 1e-12 --unit model"), 288);
    assert_eq!(vertices("--tolerance 1e-12 --unit diagonal"), 288);
    assert_eq!(vertices("--tolerance 1e-12"), 288);
    assert!(vertices("--tolerance 1e-17 --unit model").as_u64() > Some(288));
    assert!(vertices("--tolerance 0").as_u64() > Some(288));
    let error = refuse(folder.path(), "repair a.ply --dry-run --unit model", 2);
    assert!(error.contains("--tolerance"), "{error}");
    let error = refuse(folder.path(), "repair a.ply --dry-run --tolerance=-1 --unit model", 2);
    assert!(error.contains("tolerance is -1"), "{error}");
}

/// Text, JSON and table name what `--holes` leaves, and why.
#[test]
fn holes_that_stay_open_are_named() {
    let sphere = shapes::icosphere(3);
    let low = |f: usize, z: f64| sphere.triangle(f).iter().all(|p| p[2] < z);
    let lone = (0..sphere.face_count()).find(|&f| low(f, -0.5)).unwrap();
    let bowl = sphere.faces().iter().enumerate().filter(|(f, _)| *f != lone && low(*f, 0.5));
    let bowl = TriMesh::new(sphere.positions().to_vec(), bowl.map(|(_, face)| *face).collect());
    let folder = folder_with(&bowl.unwrap());
    let text = run(folder.path(), "repair a.ply --dry-run --holes 9");
    assert!(text.contains("holes filled ") && text.contains("more edges than --holes"), "{text}");
    let summary = json(&folder, "repair a.ply --dry-run --holes 9 --json");
    let [hole] = &summary["open_holes"].as_array().unwrap()[..] else { panic!("{summary}") };
    assert_eq!(hole["reason"], "too-large");
    assert_eq!(summary["changes"][RepairStep::OpenHoles.name()][0], hole["vertex"]);
    let table = run(folder.path(), "repair a.ply --dry-run --holes 9 --table");
    assert!(table.contains("open-holes"), "{table}");
}

#[test]
fn a_solid_within_a_solid_is_turned_by_cavities_alone() {
    let ball = shapes::icosphere(2);
    let scaled = |s: f64| ball.positions().iter().map(move |p| p.map(|x| s * x));
    let n = ball.vertex_count() as u32;
    let faces = ball.faces().iter().copied();
    let faces: Vec<_> = faces.clone().chain(faces.map(|face| face.map(|v| v + n))).collect();
    let both = TriMesh::new(scaled(1.0).chain(scaled(0.3)).collect(), faces).unwrap();
    let folder = folder_with(&both);
    let text = run(folder.path(), "repair a.ply --dry-run");
    assert!(text.contains("within others") && text.contains("no change"), "{text}");
    run(folder.path(), "repair a.ply -o b.ply --cavities --quiet");
    let volume = |file: &str| io::read(folder.path().join(file)).unwrap().mesh.signed_volume();
    let ratio = volume("b.ply") / volume("a.ply");
    assert!((ratio - (1.0 - 0.027) / (1.0 + 0.027)).abs() < 1e-6, "{ratio}");
}
