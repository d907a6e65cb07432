//! The `fairing` program as users and scripts run it.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;

use fairing_evaluation::vertex_distance;
use fairing_mesh::TriMesh;
use fairing_mesh::io::{self, VertexFields, WriteOptions};
use fairing_operators::curvature::laplacian_curvature;
use fairing_operators::{Laplacian, LaplacianKind, MassKind};
use fairing_shapes as shapes;
use fairing_smoothing::{Diffusion, Implicit, implicit};
use fairing_spectral::{SpectrumOptions, spectrum};
use serde_json::{Value, json};

/// The program, built once for all tests.
pub(crate) fn program() -> &'static Path {
    static PROGRAM: OnceLock<PathBuf> = OnceLock::new();
    PROGRAM.get_or_init(fairing_tests::program)
}

pub(crate) fn fairing(folder: &Path, line: &str) -> Output {
    let output = Command::new(program()).args(line.split_whitespace()).current_dir(folder).output();
    output.expect("the program runs")
}

/// Runs a command that must succeed; returns its standard output.
pub(crate) fn run(folder: &Path, line: &str) -> String {
    let output = fairing(folder, line);
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{line}: {error}");
    String::from_utf8(output.stdout).unwrap()
}

/// Runs a command that must fail with an exit code; returns its message.
pub(crate) fn refuse(folder: &Path, line: &str, code: i32) -> String {
    let output = fairing(folder, line);
    let error = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(code), "{line}: {error}");
    assert!(!error.contains("panicked"), "{line}: {error}");
    error
}

fn folder_with_torus() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let torus = shapes::torus(3.0, 1.0, 24, 12);
    io::write(folder.path().join("torus.ply"), &torus).unwrap();
    folder
}

pub(crate) fn files(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

#[test]
fn info_gives_the_documented_keys() {
    let folder = folder_with_torus();
    let info: Value = serde_json::from_str(&run(folder.path(), "info torus.ply --json")).unwrap();
    for (key, value) in [
        ("vertices", 288),
        ("faces", 576),
        ("edges", 864),
        ("components", 1),
        ("boundary_loops", 0),
        ("genus", 1),
        ("isolated_vertices", 0),
        ("degenerate_faces", 0),
        ("duplicate_faces", 0),
        ("nonmanifold_edges", 0),
        ("nonmanifold_vertices", 0),
    ] {
        assert_eq!(info[key], value, "{key}");
    }
    for key in ["manifold", "closed", "orientable"] {
        assert_eq!(info[key], true, "{key}");
    }
    assert!(run(folder.path(), "info torus.ply").contains("genus"));
}

#[test]
fn convert_goes_round_all_formats_without_loss() {
    let folder = folder_with_torus();
    let original = io::read(folder.path().join("torus.ply")).unwrap().mesh;
    for (from, to) in [
        ("torus.ply", "a.obj"),
        ("a.obj", "b.off.gz"),
        ("b.off.gz", "c.ply.gz"),
        ("c.ply.gz", "d.ply"),
    ] {
        run(folder.path(), &format!("convert {from} {to}"));
    }
    assert_eq!(io::read(folder.path().join("d.ply")).unwrap().mesh, original);
}

/// The numbers of faces of the file, triangles and edges in the output of `info`.
#[test]
fn polygons_stay_polygons_until_triangles_are_asked_for() {
    let folder = folder_with_torus();
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nf 1 2 3 4\nf 2 5 3\n";
    std::fs::write(folder.path().join("a.obj"), square).unwrap();
    for (line, counts) in [
        ("convert a.obj b.ply", [2, 3, 6]),
        ("convert b.ply c.off.gz", [2, 3, 6]),
        ("convert c.off.gz d.obj --triangulate", [3, 3, 7]),
        ("convert c.off.gz e.stl", [3, 3, 7]),
    ] {
        run(folder.path(), line);
        let output = line.split(' ').nth(2).unwrap();
        let info = run(folder.path(), &format!("info {output} --json"));
        let info: Value = serde_json::from_str(&info).unwrap();
        let found = ["faces", "triangles", "edges"].map(|key| info[key].as_u64().unwrap());
        assert_eq!(found, counts, "{line}");
    }
}

#[test]
fn nothing_is_overwritten_unasked() {
    let folder = folder_with_torus();
    run(folder.path(), "convert torus.ply a.off");
    let before = std::fs::read(folder.path().join("a.off")).unwrap();
    std::fs::write(folder.path().join("a.png"), "a picture").unwrap();
    for line in [
        "convert torus.ply a.off",
        "noise torus.ply -o a.off --sigma 0.1",
        "render torus.ply -o a.png",
    ] {
        assert!(refuse(folder.path(), line, 4).contains("--force"));
    }
    assert_eq!(std::fs::read(folder.path().join("a.off")).unwrap(), before);
    run(folder.path(), "noise torus.ply -o a.off --sigma 0.1 --force");
    assert_ne!(std::fs::read(folder.path().join("a.off")).unwrap(), before);
}

#[test]
fn bad_input_is_named_and_leaves_nothing_behind() {
    let folder = folder_with_torus();
    std::fs::write(folder.path().join("bad.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n").unwrap();
    for line in ["info bad.obj", "convert bad.obj out.ply", "render bad.obj -o out.png"] {
        let error = refuse(folder.path(), line, 3);
        assert!(error.contains("bad.obj") && error.contains("line 4"), "{error}");
    }
    assert!(refuse(folder.path(), "info absent.ply", 3).contains("absent.ply"));
    refuse(folder.path(), "convert torus.ply out.abc", 4);
    refuse(folder.path(), "frobnicate", 2);
    assert_eq!(files(folder.path()), ["bad.obj", "torus.ply"]);
}

#[test]
fn noise_is_seeded_and_in_the_unit_asked_for() {
    let folder = folder_with_torus();
    run(folder.path(), "noise torus.ply -o a.ply --sigma 0.1 --seed 5");
    run(folder.path(), "noise torus.ply -o b.ply --sigma 0.1 --seed 5 --threads 1");
    run(folder.path(), "noise torus.ply -o c.ply --sigma 0.1 --seed 6");
    let bytes = |name| std::fs::read(folder.path().join(name)).unwrap();
    assert_eq!(bytes("a.ply"), bytes("b.ply"));
    assert_ne!(bytes("a.ply"), bytes("c.ply"));
    let clean = io::read(folder.path().join("torus.ply")).unwrap().mesh;
    let noisy = io::read(folder.path().join("a.ply")).unwrap().mesh;
    let square: f64 = (clean.positions().as_flattened().iter())
        .zip(noisy.positions().as_flattened())
        .map(|(a, b)| (a - b).powi(2))
        .sum();
    let sigma = (square / clean.vertex_count() as f64).sqrt() / clean.mean_edge_length();
    // 288 normal samples: the standard error is 4 %.
    assert!((0.085..0.115).contains(&sigma), "{sigma}");
    refuse(folder.path(), "noise torus.ply -o d.ply --sigma -1", 1);
}

#[test]
fn render_draws_the_field_that_is_asked_for() {
    let folder = folder_with_torus();
    let torus = io::read(folder.path().join("torus.ply")).unwrap().mesh;
    let height: Vec<f64> = torus.positions().iter().map(|p| p[2]).collect();
    let fields = VertexFields::default().with_scalar("height", height);
    let path = folder.path().join("field.ply");
    io::write_with_fields(path, &torus, &fields, &WriteOptions::default()).unwrap();
    let said = run(folder.path(), "render field.ply -o a.png --field height --size 80x60");
    assert!(said.contains("coolwarm from -1 to 1"), "{said}");
    run(folder.path(), "render field.ply -o b.png --size 80x60");
    let bytes = |name| std::fs::read(folder.path().join(name)).unwrap();
    assert!(bytes("a.png").starts_with(b"\x89PNG"));
    assert_ne!(bytes("a.png"), bytes("b.png"));
    let error = refuse(folder.path(), "render field.ply -o c.png --field heigth", 2);
    assert!(error.contains("the file has height"), "{error}");
}

#[test]
fn curvature_of_a_sphere_is_written_as_vertex_properties() {
    let folder = tempfile::tempdir().unwrap();
    io::write(folder.path().join("sphere.ply"), &shapes::icosphere(3)).unwrap();
    // The error of each estimator is the square of its reach: one ring of h = 0.15, or three.
    let estimators = [("cotangent", 0.03), ("corrected", 0.03), ("jet3", 0.2), ("adaptive", 0.001)];
    for (name, tolerance) in estimators {
        let line = format!("curvature sphere.ply -o {name}.ply --estimator {name} --json");
        let summary: Value = serde_json::from_str(&run(folder.path(), &line)).unwrap();
        assert_eq!((&summary["vertices"], &summary["undefined"]), (&642.into(), &0.into()));
        let fields = io::read(folder.path().join(format!("{name}.ply"))).unwrap().fields;
        for property in ["mean", "gaussian", "kappa1", "kappa2"] {
            let values = fields.scalar(property).unwrap();
            assert!(values.iter().all(|x| (x - 1.0).abs() < tolerance), "{name} {property}");
        }
        let directions = fields.vector("direction1").is_some();
        assert_eq!(directions, name != "cotangent", "{name}");
        // Only `adaptive` has standard errors.
        let trust = &summary["accuracy"]["mean_error"]["greatest"];
        assert_eq!(trust.as_f64().is_some_and(|e| e < tolerance), name == "adaptive", "{name}");
        assert_eq!(fields.scalar("mean_error").is_some(), name == "adaptive", "{name}");
    }
    let list = run(folder.path(), "curvature --list");
    assert!(list.lines().count() >= 10 && list.contains("normal-cycle"));
    assert!(refuse(folder.path(), "curvature sphere.ply --estimator mean", 2).contains("jet3"));
    refuse(folder.path(), "curvature sphere.ply --estimator steiner --rings 2", 2);
}

#[test]
fn compare_scores_a_mesh_against_a_reference() {
    let folder = folder_with_torus();
    run(folder.path(), "noise torus.ply -o noisy.ply --sigma 0.1");
    let scores = |line| -> Value { serde_json::from_str(&run(folder.path(), line)).unwrap() };
    let own = scores("compare torus.ply torus.ply --json");
    let noisy = scores("compare noisy.ply torus.ply --json");
    for name in ["normal_mean", "distance_mean", "hausdorff_lower", "displacement_rms"] {
        // The distance from a corner to its own face is rounded.
        assert!(own[name]["value"].as_f64().unwrap() < 1e-15, "{name}");
        assert!(noisy[name]["value"].as_f64().unwrap() > 1e-3, "{name}");
    }
    // Different faces: element-wise scores are absent, with the reason.
    io::write(folder.path().join("sphere.ply"), &shapes::icosphere(2)).unwrap();
    let other = scores("compare sphere.ply torus.ply --json");
    assert_eq!(other["normal_mean"]["value"], Value::Null);
    assert!(other["normal_mean"]["reason"].as_str().unwrap().contains("triangles"));
    assert!(other["distance_mean"]["value"].as_f64().unwrap() > 0.0);
}

#[test]
fn denoise_says_what_it_found() {
    let folder = tempfile::tempdir().unwrap();
    // With fewer sides the tube is a prism, which the estimators see.
    io::write(folder.path().join("torus.ply"), &shapes::torus(3.0, 1.0, 72, 30)).unwrap();
    run(folder.path(), "noise torus.ply -o noisy.ply --sigma 0.05");
    let line = "denoise noisy.ply -o clean.ply --json";
    let found: Value = serde_json::from_str(&run(folder.path(), line)).unwrap();
    assert_eq!((&found["kind"], &found["border_vertices"]), (&json!("smooth"), &json!(0)));
    let sigma = found["noise"]["sigma"].as_f64().unwrap();
    assert!(found["displacement_limit"].as_f64().unwrap() >= 5.0 * sigma);
    let shares = found["area_fraction"].as_object().unwrap();
    let sum: f64 = shares.values().map(|x| x.as_f64().unwrap()).sum();
    assert!(shares.contains_key("creased") && (sum - 1.0).abs() < 1e-12, "{found}");
    let line = "denoise noisy.ply -o other.ply --method l0 --json";
    assert!(refuse(folder.path(), line, 2).contains("automatic"));
    assert_eq!(files(folder.path()), ["clean.ply", "noisy.ply", "torus.ply"]);
}

#[test]
fn smooth_moves_vertices_and_says_how() {
    let folder = folder_with_torus();
    let line = "smooth torus.ply -o smooth.ply --method implicit --lambda 5 --iterations 3 --json";
    let summary: Value = serde_json::from_str(&run(folder.path(), line)).unwrap();
    assert_eq!(summary["method"], "implicit");
    assert_eq!(summary["iterations"], 3);
    assert!(summary["volume_change_percent"].as_f64().unwrap() < -1.0);
    let smooth = io::read(folder.path().join("smooth.ply")).unwrap().mesh;
    assert_eq!(smooth.vertex_count(), 24 * 12);
    let line = "smooth torus.ply -o kept.ply --method implicit --volume rescale --json";
    let summary: Value = serde_json::from_str(&run(folder.path(), line)).unwrap();
    assert!(summary["volume_change_percent"].as_f64().unwrap().abs() < 1e-9);
    assert!(run(folder.path(), "smooth --list").lines().count() >= 10);
}

#[test]
fn smooth_refuses_what_does_not_fit_and_writes_nothing() {
    let folder = folder_with_torus();
    let limit = refuse(folder.path(), "smooth torus.ply -o x.ply --method explicit --lambda 2", 1);
    assert!(limit.contains("stable limit 1.333"), "{limit}");
    let foreign = refuse(folder.path(), "smooth torus.ply -o x.ply --method hc --lambda 2", 2);
    assert!(foreign.contains("hc has no --lambda"), "{foreign}");
    refuse(folder.path(), "smooth torus.ply -o x.ply --method implicit --lambda=-1", 2);
    assert_eq!(files(folder.path()), ["torus.ply"]);
    run(folder.path(), "smooth torus.ply -o x.ply --method explicit --lambda 2 --unstable allow");
}

/// Options that exclude each other are refused with both names, before anything is read or written.
#[test]
fn options_that_would_be_ignored_are_errors() {
    let folder = folder_with_torus();
    for (line, names) in [
        ("smooth torus.ply -o x.ply --method explicit --area mixed", ["area", "uniform"]),
        ("smooth torus.ply -o x.ply --method implicit --operator robust", ["operator", "uniform"]),
        (
            "smooth torus.ply -o x.ply --method implicit --weights uniform --time 1",
            ["time", "uniform"],
        ),
        (
            "smooth torus.ply -o x.ply --method region --vertices 3 --weights uniform --area mixed",
            ["area", "uniform"],
        ),
        (
            "smooth torus.ply -o x.ply --method low-pass --operator robust --area mixed",
            ["area", "robust"],
        ),
        ("smooth torus.ply -o x.ply --method low-pass --order 4", ["order", "cutoff"]),
        ("smooth torus.ply -o x.ply --method low-pass --last-good", ["low-pass", "--last-good"]),
        ("smooth torus.ply -o x.ply --method region --vertices 3 --until 1", ["region", "--until"]),
        ("smooth torus.ply -o x.ply --method implicit --update both", ["uniform", "update"]),
        ("denoise torus.ply -o x.ply --iterations 3", ["automatic", "--iterations"]),
        ("denoise torus.ply -o x.ply --method l0 --range 3", ["l0", "--range"]),
        ("curvature torus.ply --estimator steiner --radius 3", ["steiner", "--radius"]),
        ("curvature torus.ply --estimator jet3 --operator robust", ["jet3", "--operator"]),
        (
            "curvature torus.ply --estimator cotangent --operator robust --area mixed",
            ["--operator robust", "--area"],
        ),
        ("curvature torus.ply --estimator jet3 --rings 2 --radius 1", ["--rings", "--radius"]),
        ("curvature torus.ply --force", ["--force", "--output"]),
        ("spectrum torus.ply --force", ["--force", "--output"]),
        ("noise torus.ply -o x.ply --sigma 0.1 --fraction 0.5", ["--fraction", "normal"]),
        ("noise torus.ply -o x.ply --sigma 0.1 --kind rays --length 2", ["--length", "rays"]),
        ("noise torus.ply -o x.ply --sigma 0.1 --camera 0,0,9", ["--camera", "normal"]),
        ("scan torus.ply -o x.ply --length 3", ["--length", "--sigma"]),
        ("convert torus.ply x.obj --ascii", ["--ascii", "OBJ"]),
        ("convert torus.ply x.stl --single", ["--single", "STL"]),
        ("render torus.ply -o x.png --map hue", ["--map", "--field"]),
    ] {
        let said = refuse(folder.path(), line, 2);
        assert!(names.iter().all(|name| said.contains(name)), "{line}: {said}");
    }
    assert_eq!(files(folder.path()), ["torus.ply"]);
}

/// A scan and its truth have the same faces; the truth lies on the model, and the noise on rays.
#[test]
fn scan_writes_a_noisy_mesh_and_its_truth() {
    let folder = folder_with_torus();
    let line = "scan torus.ply --camera 0,-9,6 --size 80x60 --sigma 0.67 --seed 3";
    run(folder.path(), &format!("{line} -o noisy.ply --truth truth.ply"));
    let read = |name: &str| io::read(folder.path().join(name)).unwrap().mesh;
    let (noisy, truth) = (read("noisy.ply"), read("truth.ply"));
    assert_eq!(noisy.faces(), truth.faces());
    assert!(vertex_distance(&truth, &read("torus.ply")).unwrap().max < 1e-12);
    let mut squares = 0.0;
    for (p, q) in noisy.positions().iter().zip(truth.positions()) {
        let [x, y, z] = [q[0], q[1] + 9.0, q[2] - 6.0];
        let [u, v, w] = [0, 1, 2].map(|k| p[k] - q[k]);
        let across = [v * z - w * y, w * x - u * z, u * y - v * x];
        assert!(across.iter().all(|c| c.abs() < 1e-10), "{across:?}");
        squares += u * u + v * v + w * w;
    }
    let rms = (squares / truth.vertex_count() as f64).sqrt();
    assert!((rms / (0.67 * truth.mean_edge_length()) - 1.0).abs() < 0.02);
    run(folder.path(), &format!("{line} -o again.ply --threads 1"));
    assert_eq!(read("again.ply"), noisy);
    let said = refuse(folder.path(), "scan torus.ply -o x.ply --camera 3,0,0 --fov 60", 1);
    assert!(said.contains("the camera at [3.0, 0.0, 0.0] is inside of the mesh"), "{said}");
}

/// Denoisers and estimators have the flags of their tables, and each flag has an effect.
#[test]
fn parameters_of_denoisers_and_estimators_are_flags() {
    let folder = folder_with_torus();
    run(folder.path(), "noise torus.ply -o noisy.ply --sigma 0.2");
    let denoise = |name: &str, flags: &str| {
        run(folder.path(), &format!("denoise noisy.ply -o {name} --method guided-normal {flags}"));
        std::fs::read(folder.path().join(name)).unwrap()
    };
    let usual = denoise("a.ply", "");
    assert_eq!(denoise("b.ply", "--iterations 20 --radius 2"), usual);
    assert_ne!(denoise("c.ply", "--iterations 3"), usual);
    let list = run(folder.path(), "denoise --list");
    assert!(list.contains("guided-normal: ") && list.contains("--iterations 20"), "{list}");
    let said = refuse(folder.path(), "denoise noisy.ply -o d.ply --method l0 --growth 0.5", 2);
    assert!(said.contains("growth is 0.5"), "{said}");

    // A neighbourhood of five rings has to be a height field.
    io::write(folder.path().join("fine.ply"), &shapes::torus(3.0, 1.0, 120, 60)).unwrap();
    run(folder.path(), "noise fine.ply -o fine-noisy.ply --sigma 0.1");
    let mean =
        |flags: &str| run(folder.path(), &format!("curvature fine-noisy.ply --json {flags}"));
    assert_eq!(mean("--noise independent"), mean(""));
    assert_ne!(mean("--noise correlated"), mean(""));
    let jet = |flags: &str| mean(&format!("--estimator jet3 {flags}"));
    assert_eq!(jet("--rings 3"), jet(""));
    assert_ne!(jet("--rings 5"), jet(""));
    assert_ne!(jet("--gaussian 1"), jet(""));
    let cotangent = |flags: &str| mean(&format!("--estimator cotangent {flags}"));
    assert_ne!(cotangent("--area barycentric"), cotangent(""));
    let list = run(folder.path(), "curvature --list");
    assert!(list.contains("jet3: ") && list.contains("--rings 3"), "{list}");
    let said = refuse(folder.path(), "curvature noisy.ply --estimator jet3 --rings 17", 2);
    assert!(said.contains("rings is 17, but must be between 1 and 16"), "{said}");
}

/// A pyramid whose sides are quads that name a corner twice, beside a face with two corners. All
/// outputs give the same number of faces, and no hole.
#[test]
fn faces_are_counted_alike_and_reduced_ones_are_kept() {
    let folder = tempfile::tempdir().unwrap();
    let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0.5 0.5 1\nf 4 3 2 1\nf 1 2 5 5\nf 2 3 5 5\n\
                f 3 3 4 5\nf 4 1 5 4\nf 1 2 2 1\n";
    std::fs::write(folder.path().join("pyramid.obj"), text).unwrap();
    let info: Value = serde_json::from_str(&run(folder.path(), "info pyramid.obj --json")).unwrap();
    assert_eq!((&info["faces"], &info["triangles"]), (&5.into(), &6.into()));
    assert_eq!((&info["closed"], &info["boundary_loops"]), (&true.into(), &0.into()));
    let file = &info["file"];
    assert_eq!((&file["reduced_faces"], &file["left_out_faces"]), (&4.into(), &1.into()));
    let table = run(folder.path(), "info pyramid.obj");
    assert!(table.starts_with("OBJ: 5 vertices, 5 faces\n"), "{table}");
    for name in ["a.obj", "a.ply", "a.off"] {
        let output = fairing(folder.path(), &format!("convert pyramid.obj {name}"));
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.success(), "{said}");
        let reduced =
            "4 faces repeat a corner and are reduced to their distinct corners: 1, 2, 3, 4";
        assert!(said.contains(reduced), "{said}");
        let file = io::read(folder.path().join(name)).unwrap();
        let polygons = file.mesh.polygons().unwrap();
        assert_eq!((polygons.count(), file.report.file_faces), (5, 5), "{name}");
        assert_eq!(polygons.face(0), [3, 2, 1, 0]);
        assert_eq!(polygons.face(3), [2, 3, 4]);
    }
    let said = fairing(folder.path(), "smooth pyramid.obj -o s.obj --method explicit").stderr;
    assert!(String::from_utf8(said).unwrap().contains("pyramid.obj: 4 faces repeat a corner"));
    let refused = refuse(folder.path(), "convert pyramid.obj b.obj --strict", 3);
    assert!(refused.contains("face 1 repeats a corner (5 such faces)"), "{refused}");
    // Scores that require the same faces give the number of triangles.
    io::write(folder.path().join("ico.ply"), &shapes::icosphere(1)).unwrap();
    let scores = run(folder.path(), "compare pyramid.obj ico.ply --json");
    assert!(scores.contains("6 and 80 triangles"), "{scores}");
}

/// The robust operator replaces cotangents with a note that names the face.
#[test]
fn curvature_says_that_it_uses_the_robust_operator() {
    let folder = tempfile::tempdir().unwrap();
    let sphere = shapes::icosphere(2);
    let (mut positions, mut faces) = (sphere.positions().to_vec(), sphere.faces().to_vec());
    let n = positions.len() as u32;
    positions.extend([[3.0, 0.0, 0.0], [4.0, 0.0, 0.0], [5.0, 0.0, 0.0]]);
    faces.push([n, n + 1, n + 2]);
    let mesh = TriMesh::new(positions, faces).unwrap();
    io::write(folder.path().join("bad.ply"), &mesh).unwrap();
    io::write(folder.path().join("good.ply"), &sphere).unwrap();
    let line = |name: &str| format!("curvature {name} --estimator cotangent --json");
    let output = fairing(folder.path(), &line("bad.ply"));
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(
        said.contains("face 320 is too thin for cotangents; using the robust operator"),
        "{said}"
    );
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(json["too_thin_face"], 320);
    let good: Value = serde_json::from_str(&run(folder.path(), &line("good.ply"))).unwrap();
    assert_eq!(good["too_thin_face"], Value::Null);
}

/// Eigenvalues, curvature and flows with auto are bitwise those of `Laplacian::auto`, on meshes
/// with non-Delaunay edges and on one with a face too thin for cotangents.
#[test]
fn auto_is_the_same_in_the_program_and_in_the_library() {
    let folder = tempfile::tempdir().unwrap();
    let bumpy = shapes::bumpy_sphere(3, 0.3, 5.0);
    let stretched = bumpy.positions().iter().map(|[x, y, z]| [x + 2.0 * y, 2.0 * y, *z]).collect();
    let stretched = bumpy.with_positions(stretched).unwrap();
    let (mut positions, mut faces) = (bumpy.positions().to_vec(), bumpy.faces().to_vec());
    let [a, b, _] = faces[0].map(|v| positions[v as usize]);
    positions.push([0, 1, 2].map(|k| 0.5 * (a[k] + b[k])));
    faces.push([faces[0][1], faces[0][0], positions.len() as u32 - 1]);
    let finned = TriMesh::new(positions, faces).unwrap();
    let cotangent = (LaplacianKind::Cotangent, "cotangent");
    let robust = (LaplacianKind::Robust, "robust");
    for (mesh, (kind, name)) in [(bumpy, cotangent), (stretched, cotangent), (finned, robust)] {
        let laplacian = Laplacian::auto(&mesh).unwrap();
        assert_eq!(laplacian.kind(), kind);
        let other = Laplacian::new(&mesh, LaplacianKind::NonNegative, MassKind::Barycentric);
        assert_eq!(other.unwrap().kind(), LaplacianKind::Robust);
        io::write(folder.path().join("mesh.ply"), &mesh).unwrap();
        let found: Value =
            serde_json::from_str(&run(folder.path(), "spectrum mesh.ply -k 7 --json")).unwrap();
        assert_eq!(found["operator"], name);
        let modes = spectrum(&laplacian, 7, &SpectrumOptions::default()).unwrap();
        assert_eq!(found["eigenvalues"], json!(modes.values));
        let line = "curvature mesh.ply --estimator cotangent --operator auto --json";
        let found: Value = serde_json::from_str(&run(folder.path(), line)).unwrap();
        let thin = (kind == LaplacianKind::Robust).then(|| mesh.face_count() - 1);
        assert_eq!(found["too_thin_face"], json!(thin));
        let mean = laplacian_curvature(&mesh, &laplacian).unwrap().mean;
        let greatest = mean.iter().copied().fold(f64::MIN, f64::max);
        assert!(found.to_string().contains(&greatest.to_string()), "{greatest} in {found}");
        let flow = implicit(&mesh, &Implicit::new(Diffusion::cotangent(0.05)), None).unwrap();
        assert_eq!(json!(flow.report.too_thin), json!(thin));
        let line = "smooth mesh.ply -o x.ply --force --method implicit --weights cotangent --lambda 0.05 --json";
        let found: Value = serde_json::from_str(&run(folder.path(), line)).unwrap();
        assert_eq!(found["too_thin_face"], json!(thin));
    }
}

/// The commands under the methods of the report run as printed and write the files they name.
#[test]
fn commands_of_the_report_run() {
    let truth = shapes::bumpy_sphere(2, 0.1, 3.0);
    let step = 0.1 * truth.mean_edge_length();
    let moved = |(v, p): (usize, &[f64; 3])| {
        let sign = if v % 2 == 0 { step } else { -step };
        p.map(|x| x * (1.0 + sign))
    };
    let noisy = truth.positions().iter().enumerate().map(moved).collect();
    let noisy = truth.with_positions(noisy).unwrap();
    for experiment in fairing_report::experiments::ALL {
        let folder = tempfile::tempdir().unwrap();
        let card = experiment.card();
        let commands = &card.section.commands;
        assert!(!commands.is_empty(), "{}", card.id);
        let mut made: Vec<&str> = vec![];
        for command in commands {
            let line = command.split('#').next().unwrap_or_default().trim();
            let line = line.strip_prefix("fairing ").expect("a command of the program");
            let words: Vec<&str> = line.split_whitespace().collect();
            let output = words.windows(2).find(|pair| pair[0] == "-o").map(|pair| pair[1]);
            for word in words.iter().filter(|w| w.ends_with(".ply") && Some(**w) != output) {
                let mesh = if *word == "noisy.ply" { &noisy } else { &truth };
                if !made.contains(word) && !folder.path().join(word).is_file() {
                    io::write(folder.path().join(word), mesh).unwrap();
                }
            }
            let said = run(folder.path(), line);
            match output {
                Some(output) => {
                    assert!(folder.path().join(output).is_file(), "{command}");
                    made.push(output);
                }
                None => assert!(!said.trim().is_empty(), "{command} says nothing"),
            }
        }
    }
}
