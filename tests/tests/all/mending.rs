//! Repairs through the program: vertices merged, parts turned, holes filled and left.

use fairing_mesh::io::{self, NumberType};
use fairing_mesh::{RepairOptions, RepairStep, Tolerance, TriMesh, repair};
use fairing_shapes as shapes;
use serde_json::Value;
use tempfile::TempDir;

use crate::advice::row_of;
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

/// A rotation by a unit quaternion that depends on a number.
fn rotation(of: u64) -> [[f64; 3]; 3] {
    let q = [1.0, 2.0, 3.0, 5.0].map(|k| (k * of as f64).sin());
    let length = q.iter().map(|x| x * x).sum::<f64>().sqrt();
    let [w, x, y, z] = q.map(|x| x / length);
    [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)],
        [2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)],
        [2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)],
    ]
}

/// A mesh as a soup in single precision, each face rotated into place this number of times.
fn rotated_into_place(mesh: &TriMesh, times: u64) -> TriMesh {
    let corners = mesh.faces().iter().enumerate().flat_map(|(f, face)| {
        let turns: Vec<_> = (0..times).map(|t| rotation(1 + 7 * f as u64 + t)).collect();
        face.map(|v| {
            let back = |p: [f64; 3], r: &[[f64; 3]; 3]| {
                [0, 1, 2].map(|i| r[0][i] * p[0] + r[1][i] * p[1] + r[2][i] * p[2])
            };
            let p = turns.iter().rev().fold(mesh.positions()[v as usize], back);
            let there = |p: [f32; 3], r: &[[f64; 3]; 3]| {
                r.map(|row| row[0] as f32 * p[0] + row[1] as f32 * p[1] + row[2] as f32 * p[2])
            };
            turns.iter().fold(p.map(|x| x as f32), there).map(f64::from)
        })
    });
    let faces = (0..mesh.face_count() as u32).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect();
    TriMesh::new(corners.collect(), faces).unwrap()
}

/// The table from which the tolerance was chosen.
#[test]
fn the_default_tolerance_is_that_of_the_table() {
    let torus = shapes::torus(3.0, 1.0, 48, 24);
    for times in 0..4 {
        let soup = rotated_into_place(&torus, times);
        let surplus = |count: usize| count as f64 - torus.vertex_count() as f64;
        let largest = soup.positions().as_flattened().iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        let left = |tolerance| {
            let options = RepairOptions { tolerance, ..RepairOptions::default() };
            let mended = repair(&soup, &options).unwrap().mesh;
            1e2 * surplus(mended.vertex_count()) / surplus(soup.vertex_count())
        };
        let units = [0.0, 1.0, 2.0, 4.0, 8.0].map(|k| k * f64::from(f32::EPSILON) * largest);
        let found = units.map(|unit| (10.0 * left(Tolerance::Model(unit))).ceil() / 10.0);
        let row = row_of("docs/guide/src/defaults.md", &times.to_string());
        assert_eq!(row[1..], found.map(|x| x.to_string()));
        assert_eq!(left(Tolerance::Rounding), 0.0);
    }
}
