//! Every verb of the program at both ends of the extents that a mesh may have.

use std::path::Path;

use fairing_denoising::Denoiser;
use fairing_evaluation::{NoiseKind, NoiseLevel, add_noise};
use fairing_mesh::{BuildError, EXTENTS, TriMesh, io};
use fairing_operators::curvature::Estimator;
use fairing_shapes as shapes;
use fairing_smoothing::Method;
use serde_json::Value;

use crate::command_line::{refuse, run};
use crate::extremes::scaled;

/// Powers of two that bring a mesh of extent 2 to either end, less what flows shrink.
const EXPONENTS: [i32; 2] = [-97, 98];

/// Writes a body as `one.ply`, and with noise as `noisy.ply`, at this size.
fn write(folder: &Path, unit: f64) {
    let body = shapes::bumpy_sphere(2, 0.15, 4.0);
    let level = NoiseLevel::EdgeLengths(0.15);
    let noisy = add_noise(&body, NoiseKind::GaussianAlongNormals, level, 7).unwrap();
    for (name, mesh) in [("one.ply", &body), ("noisy.ply", &noisy)] {
        let mesh = scaled(mesh, unit);
        let [low, high] = mesh.bounding_box().unwrap();
        assert!(EXTENTS.contains(&(high[0] - low[0])));
        io::write(folder.join(name), &mesh).unwrap();
    }
}

/// The lines that make a mesh `out.ply`.
fn lines() -> Vec<String> {
    let flows = Method::all();
    let smooth = flows.iter().map(|flow| match flow.name() {
        "region" => "smooth noisy.ply -o out.ply --method region --vertices 5,6,7".to_owned(),
        "mean-curvature" => {
            "smooth noisy.ply -o out.ply --method mean-curvature --iterations 2".to_owned()
        }
        name => format!("smooth noisy.ply -o out.ply --method {name}"),
    });
    let denoise =
        Denoiser::all().into_iter().map(|d| format!("denoise noisy.ply -o out.ply --method {d}"));
    let others = [
        "noise one.ply -o out.ply --sigma 0.2 --kind axes",
        "noise one.ply -o out.ply --sigma 0.2 --kind depth-camera",
        "noise one.ply -o out.ply --sigma 0.2 --kind fused",
        "scan one.ply -o out.ply --size 64x48 --sigma 0.3",
        "reconstruct noisy.ply -k 9 -o out.ply",
        "repair noisy.ply -o out.ply --thin 0.002 --holes 40 --tolerance 0.1",
    ];
    smooth.chain(denoise).chain(others.map(str::to_owned)).collect()
}

/// A number found in two places is the same up to a power of the unit and rounding.
fn alike(one: &Value, other: &Value, unit: f64, what: &str) {
    match (one, other) {
        (Value::Number(a), Value::Number(b)) => {
            let (a, b) = (a.as_f64().unwrap(), b.as_f64().unwrap());
            let same = |power: i32| {
                let back = b * unit.powi(-power);
                (a - back).abs() <= 1e-6 * a.abs() + 1e-9
            };
            assert!((-2..=3).any(same), "{what}: {a} and {b}");
        }
        (Value::Array(a), Value::Array(b)) => {
            assert_eq!(a.len(), b.len(), "{what}");
            a.iter().zip(b).for_each(|(a, b)| alike(a, b, unit, what));
        }
        (Value::Object(a), Value::Object(b)) => {
            for ((key, a), (_, b)) in a.iter().zip(b) {
                alike(a, b, unit, &format!("{what} {key}"));
            }
        }
        (a, b) => assert_eq!(a, b, "{what}"),
    }
}

#[test]
fn verbs_that_make_a_mesh_do_so_at_both_ends() {
    let folder = tempfile::tempdir().unwrap();
    let results = |unit: f64| -> Vec<TriMesh> {
        write(folder.path(), unit);
        let result = |line: &String| {
            run(folder.path(), &format!("{line} --force"));
            scaled(&io::read(folder.path().join("out.ply")).unwrap().mesh, 1.0 / unit)
        };
        lines().iter().map(result).collect()
    };
    let expected = results(1.0);
    for exponent in EXPONENTS {
        for ((found, expected), line) in
            results(2f64.powi(exponent)).iter().zip(&expected).zip(lines())
        {
            let apart = fairing_evaluation::vertex_displacement(found, expected).unwrap().max;
            assert!(apart < 1e-7, "{line} at 2^{exponent}: {apart:e}");
        }
    }
}

#[test]
fn verbs_that_measure_do_so_at_both_ends() {
    let folder = tempfile::tempdir().unwrap();
    let mut lines: Vec<String> = Estimator::all()
        .iter()
        .map(|e| format!("curvature one.ply --estimator {e} --json"))
        .collect();
    lines.extend(
        [
            "info one.ply --json",
            "compare noisy.ply one.ply --json",
            "spectrum one.ply -k 8 --json",
            "spectrum noisy.ply -k 8 --operator robust --json",
        ]
        .map(str::to_owned),
    );
    let results = |unit: f64| -> Vec<Value> {
        write(folder.path(), unit);
        lines.iter().map(|line| serde_json::from_str(&run(folder.path(), line)).unwrap()).collect()
    };
    let expected = results(1.0);
    for exponent in EXPONENTS {
        let unit = 2f64.powi(exponent);
        for ((found, expected), line) in results(unit).iter().zip(&expected).zip(&lines) {
            alike(expected, found, unit, &format!("{line} at 2^{exponent}"));
        }
    }
}

#[test]
fn pictures_and_files_are_made_at_both_ends() {
    let folder = tempfile::tempdir().unwrap();
    let results = |unit: f64| {
        write(folder.path(), unit);
        for format in ["obj", "off", "stl", "ply"] {
            run(folder.path(), &format!("convert noisy.ply out.{format} --force"));
            let found = io::read(folder.path().join(format!("out.{format}"))).unwrap().mesh;
            let extent = |mesh: &TriMesh| mesh.diagonal() / unit;
            let given = io::read(folder.path().join("noisy.ply")).unwrap().mesh;
            // STL has single precision.
            assert!((extent(&found) / extent(&given) - 1.0).abs() < 1e-6, "{format} {unit:e}");
        }
        run(folder.path(), "render one.ply -o out.png --size 120x120 --force");
        std::fs::read(folder.path().join("out.png")).unwrap()
    };
    let expected = results(1.0);
    for exponent in EXPONENTS {
        assert_eq!(results(2f64.powi(exponent)), expected, "2^{exponent}");
    }
}

/// Beyond the ends a mesh is refused wherever it comes from.
#[test]
fn extents_out_of_range_are_refused() {
    let body = shapes::icosphere(1);
    for size in [1e-31, 1e31, 1e300] {
        let positions: Vec<[f64; 3]> =
            body.positions().iter().map(|p| p.map(|x| x * size)).collect();
        let refused = body.with_positions(positions.clone()).unwrap_err();
        assert!(matches!(refused, BuildError::Extent { .. }), "{refused}");
        assert!(TriMesh::new(positions.clone(), body.faces().to_vec()).is_err());
        assert!(fairing_mesh::PolygonMesh::new(positions.clone(), body.faces()).is_err());
        let folder = tempfile::tempdir().unwrap();
        let lines = positions.iter().map(|[x, y, z]| format!("v {x:e} {y:e} {z:e}\n"));
        let faces =
            body.faces().iter().map(|[a, b, c]| format!("f {} {} {}\n", a + 1, b + 1, c + 1));
        std::fs::write(folder.path().join("far.obj"), lines.chain(faces).collect::<String>())
            .unwrap();
        let message = refuse(folder.path(), "info far.obj", 3);
        assert!(message.contains("far.obj") && message.contains("rescale"), "{message}");
    }
    // A point has no extent, wherever it is.
    let point = vec![[1e40, -3.0, 1e-40]; 3];
    assert!(TriMesh::new(point, vec![[0, 1, 2]]).is_ok());
}
