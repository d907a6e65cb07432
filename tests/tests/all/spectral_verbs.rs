//! `fairing spectrum` and `fairing reconstruct` on difficult meshes.

use std::path::Path;

use fairing_mesh::{TriMesh, io};
use fairing_shapes as shapes;
use fairing_spectral::{MassMatrix, Spectrum};
use ndarray::{Array1, Array2};
use serde_json::Value;

use crate::command_line::{fairing, refuse, run};

fn save(folder: &Path, name: &str, mesh: &TriMesh) {
    io::write(folder.join(name), mesh).unwrap();
}

fn scaled(mesh: &TriMesh, s: f64) -> TriMesh {
    mesh.with_positions(mesh.positions().iter().map(|p| p.map(|x| s * x)).collect()).unwrap()
}

/// A mesh and its shifted copy, as two components.
fn twice(mesh: &TriMesh) -> TriMesh {
    let n = mesh.vertex_count() as u32;
    let mut points = mesh.positions().to_vec();
    points.extend(mesh.positions().iter().map(|p| [p[0] + 5.0, p[1], p[2]]));
    let mut faces = mesh.faces().to_vec();
    faces.extend(mesh.faces().iter().map(|f| f.map(|v| v + n)));
    TriMesh::new(points, faces).unwrap()
}

/// A sphere with a collinear face glued to one of its edges.
fn with_a_needle() -> TriMesh {
    let sphere = shapes::icosphere(2);
    let mut points = sphere.positions().to_vec();
    let [a, b, _] = sphere.faces()[0];
    let (p, q) = (points[a as usize], points[b as usize]);
    points.push(std::array::from_fn(|i| 0.5 * (p[i] + q[i])));
    let mut faces = sphere.faces().to_vec();
    faces.push([b, a, points.len() as u32 - 1]);
    TriMesh::new(points, faces).unwrap()
}

fn spectrum(folder: &Path, line: &str) -> Value {
    serde_json::from_str(&run(folder, line)).unwrap()
}

fn values(found: &Value, key: &str) -> Vec<f64> {
    found[key].as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect()
}

/// The arrays that numpy reads: `modes` (n × k), orthonormal in `mass`, with `values` and
/// `residuals`.
#[test]
fn npz_holds_the_documented_arrays() {
    let folder = tempfile::tempdir().unwrap();
    save(folder.path(), "sphere.ply", &shapes::icosphere(3));
    let found = spectrum(folder.path(), "spectrum sphere.ply -k 9 -o modes.npz --json");
    let Spectrum { values: stored, residuals, modes, mass, .. } =
        Spectrum::load(folder.path().join("modes.npz")).unwrap();
    let MassMatrix::Lumped(mass) = mass else { panic!("the mass is lumped") };
    let mass = Array1::from(mass);
    assert_eq!(modes.dim(), (642, 9));
    assert_eq!(stored, values(&found, "eigenvalues"));
    assert_eq!(residuals, values(&found, "residuals"));
    let weighted = &modes * &mass.insert_axis(ndarray::Axis(1));
    let gram = modes.t().dot(&weighted);
    assert!((&gram - &Array2::<f64>::eye(9)).iter().all(|d| d.abs() < 1e-9));
    assert_eq!(found["certified"], true);
    assert_eq!(found["operator"], "cotangent");
    // Nothing is overwritten without --force.
    refuse(folder.path(), "spectrum sphere.ply -k 9 -o modes.npz", 4);
}

#[test]
fn too_many_modes_are_refused_with_both_numbers() {
    let folder = tempfile::tempdir().unwrap();
    save(folder.path(), "small.ply", &shapes::icosphere(1));
    for line in ["spectrum small.ply -k 43", "reconstruct small.ply -k 43 -o out.obj"] {
        let error = refuse(folder.path(), line, 1);
        assert!(error.contains("43") && error.contains("42"), "{error}");
    }
    assert!(!folder.path().join("out.obj").exists());
    let all = spectrum(folder.path(), "spectrum small.ply -k 42 --json");
    assert_eq!(values(&all, "eigenvalues").len(), 42);
}

/// Every component has its own zero eigenvalue, and each eigenvalue of one occurs twice.
#[test]
fn components_have_a_zero_each() {
    let folder = tempfile::tempdir().unwrap();
    let ellipsoid = shapes::ellipsoid([1.0, 1.3, 1.7], 3);
    save(folder.path(), "one.ply", &ellipsoid);
    save(folder.path(), "two.ply", &twice(&ellipsoid));
    let one = values(&spectrum(folder.path(), "spectrum one.ply -k 6 --json"), "eigenvalues");
    let two = values(&spectrum(folder.path(), "spectrum two.ply -k 12 --json"), "eigenvalues");
    assert_eq!(two[..2], [0.0, 0.0]);
    for i in 0..12 {
        assert!((two[i] - one[i / 2]).abs() < 1e-7 * one[5], "{two:?} {one:?}");
    }
}

/// A free disc has a constant mode; with a fixed boundary its least eigenvalue is that of the
/// membrane.
#[test]
fn boundaries_are_free_or_pinned() {
    let folder = tempfile::tempdir().unwrap();
    let side = 31;
    let mut points = vec![];
    let mut faces = vec![];
    for j in 0..side {
        for i in 0..side {
            points.push([f64::from(i) / 30.0, f64::from(j) / 30.0, 0.0]);
            if i + 1 < side && j + 1 < side {
                let a = (j * side + i) as u32;
                let up = a + side as u32;
                faces.extend([[a, a + 1, up + 1], [a, up + 1, up]]);
            }
        }
    }
    save(folder.path(), "square.ply", &TriMesh::new(points, faces).unwrap());
    let free = spectrum(folder.path(), "spectrum square.ply -k 3 --json");
    assert_eq!(values(&free, "eigenvalues")[0], 0.0);
    let pinned = spectrum(folder.path(), "spectrum square.ply -k 3 --boundary dirichlet --json");
    let least = values(&pinned, "eigenvalues")[0];
    let exact = 2.0 * std::f64::consts::PI.powi(2);
    // Second order: h² λ / 12 with h = 1/30 is 0.2 %.
    assert!((least / exact - 1.0).abs() < 0.005, "{least}");
}

/// Micrometres and kilometres, dense (162 vertices) and sparse (642): eigenvalues scale with the
/// inverse square.
#[test]
fn units_of_the_file_do_not_matter() {
    let folder = tempfile::tempdir().unwrap();
    for level in [2, 3] {
        let mesh = shapes::bumpy_sphere(level, 0.15, 4.0);
        save(folder.path(), "one.ply", &mesh);
        let one = values(&spectrum(folder.path(), "spectrum one.ply -k 8 --json"), "eigenvalues");
        for s in [1e-6, 1e6] {
            save(folder.path(), "other.ply", &scaled(&mesh, s));
            let found = spectrum(folder.path(), "spectrum other.ply -k 8 --json");
            assert_eq!(found["certified"], true);
            for (a, b) in values(&found, "eigenvalues").iter().zip(&one) {
                assert!((a * s * s - b).abs() < 1e-8 * one[7], "{s:e}: {a} {b}");
            }
            run(folder.path(), "reconstruct other.ply -k 20 -o back.ply --force");
        }
        let back = io::read(folder.path().join("back.ply")).unwrap().mesh;
        let size =
            |m: &TriMesh| m.positions().iter().flatten().fold(0.0, |m: f64, x| m.max(x.abs()));
        assert!((size(&back) / size(&mesh) / 1e6 - 1.0).abs() < 0.3);
    }
}

/// A face without area: the robust operator replaces cotangents with a note; an explicit request
/// for cotangents is refused.
#[test]
fn faces_without_area_get_the_robust_operator() {
    let folder = tempfile::tempdir().unwrap();
    save(folder.path(), "needle.ply", &with_a_needle());
    let output = fairing(folder.path(), "spectrum needle.ply -k 5 --json");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success() && said.contains("robust operator"), "{said}");
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((&found["operator"], &found["certified"]), (&"robust".into(), &true.into()));
    // The needle is attached to a sphere: three eigenvalues near 2.
    let sphere = values(&found, "eigenvalues");
    assert!(sphere[1..4].iter().all(|l| (l - 2.0).abs() < 0.2), "{sphere:?}");
    let error = refuse(folder.path(), "spectrum needle.ply -k 5 --operator cotangent", 1);
    assert!(error.contains("degenerate"), "{error}");
    run(folder.path(), "reconstruct needle.ply -k 30 -o back.obj");
    let back = io::read(folder.path().join("back.obj")).unwrap().mesh;
    assert_eq!(back.vertex_count(), 163);
    assert!(back.positions().iter().flatten().all(|x| x.is_finite()));
}

/// Auto is the same in every verb: cotangents if every face has them, otherwise the robust operator
/// with a note that names the face.
#[test]
fn auto_is_the_same_in_every_verb() {
    let folder = tempfile::tempdir().unwrap();
    // Slivers with negative weights: x is sheared by four times y. One of them has no area.
    let sphere = shapes::icosphere(2);
    let mut p: Vec<_> =
        sphere.positions().iter().map(|p| [p[0] + 4.0 * p[1], p[1], p[2]]).collect();
    save(folder.path(), "round.ply", &sphere);
    save(folder.path(), "sheared.ply", &sphere.with_positions(p.clone()).unwrap());
    let [a, b, c] = sphere.faces()[0].map(|v| v as usize);
    p[a] = [0, 1, 2].map(|k| 0.5 * (p[b][k] + p[c][k]));
    save(folder.path(), "flat.ply", &sphere.with_positions(p).unwrap());
    let lines = [
        "spectrum MESH -k 4 --json",
        "reconstruct MESH -k 30 -o out.obj --force",
        "curvature MESH --estimator cotangent --operator auto --json",
        "smooth MESH -o out.ply --force --method explicit --weights cotangent --lambda 0.001",
        "smooth MESH -o out.ply --force --method mean-curvature --lambda 0.1 --iterations 2",
        "smooth MESH -o out.ply --force --method low-pass --modes 20",
        "smooth MESH -o out.ply --force --method region --vertices 7,8,30",
    ];
    let said = |line: &str| {
        let output = fairing(folder.path(), line);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{line}: {said}");
        (said, output.stdout)
    };
    for line in lines {
        for mesh in ["round.ply", "sheared.ply"] {
            let (good, _) = said(&line.replace("MESH", mesh));
            assert!(!good.contains("operator"), "{line}: {good}");
        }
        let (bad, _) = said(&line.replace("MESH", "flat.ply"));
        assert!(bad.contains("face 0") && bad.contains("using the robust operator"), "{bad}");
        let (asked, _) = said(
            &(line.replace("MESH", "sheared.ply").replace(" --operator auto", "")
                + " --operator cotangent"),
        );
        assert!(!asked.contains("robust"), "{line}: {asked}");
    }
    let found = spectrum(folder.path(), "spectrum flat.ply -k 4 --json");
    assert_eq!(found["operator"], "robust");
    let found = spectrum(folder.path(), "spectrum sheared.ply -k 4 --mass mixed --json");
    assert_eq!(found["operator"], "cotangent");
    // The explicit request counts: the values differ.
    let mean = |operator: &str| {
        let line =
            format!("curvature sheared.ply --estimator cotangent --operator {operator} --json");
        let json: Value = serde_json::from_slice(&said(&line).1).unwrap();
        json["interior"]["mean"]["greatest"].as_f64().unwrap()
    };
    assert_eq!(mean("auto"), mean("cotangent"));
    assert!(mean("auto") != mean("robust"));
    // The robust operator has barycentric areas only.
    let line = "smooth flat.ply -o no.ply --method implicit --weights cotangent --area mixed";
    assert!(refuse(folder.path(), line, 1).contains("face 0 is degenerate"));
    let error = refuse(folder.path(), "curvature round.ply --operator robust", 2);
    assert!(error.contains("adaptive has no --operator"), "{error}");
}

/// The mass is stored with the modes; the robust operator has only one.
#[test]
fn masses_are_chosen_or_refused() {
    let folder = tempfile::tempdir().unwrap();
    save(folder.path(), "sphere.ply", &shapes::icosphere(2));
    for mass in ["barycentric", "mixed", "consistent"] {
        let line = format!("spectrum sphere.ply -k 4 --mass {mass} --json");
        let found = values(&spectrum(folder.path(), &line), "eigenvalues");
        assert!((found[1] - 2.0).abs() < 0.1);
    }
    let line = "spectrum sphere.ply -k 4 --mass mixed --operator robust";
    assert!(refuse(folder.path(), line, 1).contains("barycentric"));
}

/// Zero modes are wrong usage; nothing is read or written.
#[test]
fn no_modes_are_wrong_usage() {
    let folder = tempfile::tempdir().unwrap();
    for line in ["spectrum nothing.ply -k 0", "reconstruct nothing.ply -k 0 -o out.obj"] {
        let error = refuse(folder.path(), line, 2);
        assert!(error.contains("at least one mode"), "{error}");
    }
}

/// A sphere has clusters of 1, 3 and 5 modes: 6 modes split a cluster, 4 and 9 do not.
#[test]
fn a_split_cluster_is_warned_of() {
    let folder = tempfile::tempdir().unwrap();
    save(folder.path(), "sphere.ply", &shapes::icosphere(3));
    for verb in ["spectrum sphere.ply", "reconstruct sphere.ply -o out.obj --force"] {
        for (k, good) in
            [(6, Some("-k 4 and -k 9 do not")), (2, Some("-k 1 and -k 4 do not")), (9, None)]
        {
            let output = fairing(folder.path(), &format!("{verb} -k {k}"));
            let said = String::from_utf8_lossy(&output.stderr).into_owned();
            assert!(output.status.success());
            assert_eq!(said.contains("split a cluster"), good.is_some(), "{said}");
            assert!(good.is_none_or(|good| said.contains(good)), "{said}");
        }
    }
    let found = spectrum(folder.path(), "spectrum sphere.ply -k 6 --json");
    assert_eq!((&found["gap_below"], &found["gap_above"]), (&4.into(), &9.into()));
    // The low-pass flow truncates to modes as well.
    let flow = "smooth sphere.ply -o out.obj --force --method low-pass";
    for (k, below, above) in [(6, 4, 9), (2, 1, 4), (9, 9, 9)] {
        let output = fairing(folder.path(), &format!("{flow} --modes {k} --json"));
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{said}");
        let good = format!("--modes {below} and --modes {above} do not");
        assert_eq!(said.contains(&good), k != 9, "{said}");
        assert_eq!(said.contains("split a cluster"), k != 9, "{said}");
        let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!((&found["gap_below"], &found["gap_above"]), (&below.into(), &above.into()));
    }
    let output = fairing(folder.path(), &format!("{flow} --time 0.01 --json"));
    let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(found["gap_below"].is_null() && found["gap_above"].is_null());
}

/// With a huge eigenvalue, or masses that increase rounding, the output states the bound that the
/// residuals meet.
#[test]
fn residuals_above_the_usual_bound_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let sphere = shapes::icosphere(3);
    save(folder.path(), "good.ply", &sphere);
    let quiet = fairing(folder.path(), "spectrum good.ply -k 9");
    let said = String::from_utf8(quiet.stderr).unwrap();
    assert!(said.contains("inertia count") && !said.contains("residual"), "{said}");

    // Weights of 10⁹ at two vertices very close to each other.
    let sheet = shapes::plane(10, 10, shapes::Diagonals::Regular);
    let mut points = sheet.positions().to_vec();
    points[60] = std::array::from_fn(|i| points[59][i] + 1e-9 * (points[60][i] - points[59][i]));
    save(folder.path(), "close.ply", &sheet.with_positions(points).unwrap());
    let output = fairing(folder.path(), "spectrum close.ply -k 3 --boundary dirichlet");
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("exceed 1e-8 of their eigenvalue"), "{said}");
    assert!(said.contains("rounding dominates"), "{said}");

    // Faces without area: the largest eigenvalue of the robust operator is 10¹⁰ times the others.
    let points = vec![[0.0; 3], [0.0; 3], [1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]];
    let faces = vec![[0, 1, 2], [1, 3, 2], [2, 3, 4]];
    save(folder.path(), "flat.ply", &TriMesh::new(points, faces).unwrap());
    let output = fairing(folder.path(), "spectrum flat.ply -k 5");
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("of the largest eigenvalue"), "{said}");
}
