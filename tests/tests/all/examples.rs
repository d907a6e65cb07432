//! The examples of the façade, run on small meshes.

use std::path::Path;

use fairing::evaluation::{NoiseKind, NoiseLevel, add_noise};
use fairing::mesh::{TriMesh, io};
use fairing::shapes;
use fairing::spectral::Spectrum;

#[expect(dead_code, reason = "main reads arguments")]
#[path = "../../../crates/fairing/examples/convert_in_memory.rs"]
mod convert_in_memory;
#[expect(dead_code, reason = "main reads arguments")]
#[path = "../../../crates/fairing/examples/denoise_and_compare.rs"]
mod denoise_and_compare;
#[expect(dead_code, reason = "main reads arguments")]
#[path = "../../../crates/fairing/examples/heat_distance.rs"]
mod heat_distance;
#[expect(dead_code, reason = "main reads arguments")]
#[path = "../../../crates/fairing/examples/implicit_smoothing.rs"]
mod implicit_smoothing;
#[expect(dead_code, reason = "main reads arguments")]
#[path = "../../../crates/fairing/examples/mean_curvature.rs"]
mod mean_curvature;
#[expect(dead_code, reason = "main reads arguments")]
#[path = "../../../crates/fairing/examples/mesh_from_arrays.rs"]
mod mesh_from_arrays;
#[expect(dead_code, reason = "main reads arguments")]
#[path = "../../../crates/fairing/examples/picture.rs"]
mod picture;
#[expect(dead_code, reason = "main reads arguments")]
#[path = "../../../crates/fairing/examples/poisson.rs"]
mod poisson;
#[expect(dead_code, reason = "main reads arguments")]
#[path = "../../../crates/fairing/examples/principal_directions.rs"]
mod principal_directions;
#[expect(dead_code, reason = "main prints")]
#[path = "../../../crates/fairing/examples/report.rs"]
mod report;
#[expect(dead_code, reason = "main reads arguments")]
#[path = "../../../crates/fairing/examples/signature.rs"]
mod signature;

/// The name of a file in a folder, with a mesh in it if given.
fn file(folder: &Path, name: &str, mesh: Option<&TriMesh>) -> String {
    let path = folder.join(name);
    if let Some(mesh) = mesh {
        io::write(&path, mesh).unwrap();
    }
    path.to_str().unwrap().to_owned()
}

#[test]
fn examples_do_what_they_say() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str, mesh: Option<&TriMesh>| file(folder.path(), name, mesh);
    let ball = shapes::icosphere(4);
    let sphere = at("sphere.obj", Some(&ball));
    let patch = shapes::plane(8, 8, shapes::Diagonals::Alternating);
    let plane = at("plane.ply", Some(&patch));
    let (modes, out) = (at("modes.npz", None), at("out.ply", None));

    // A sphere of radius 1: cubic jets are accurate to a few per cent at this size.
    let field = mean_curvature::run(&sphere).unwrap();
    assert!(field.mean.iter().all(|h| (h - 1.0).abs() < 0.05), "{:?}", field.mean);

    signature::run(&sphere, &modes, &out).unwrap();
    assert_eq!(Spectrum::load(&modes).unwrap().values.len(), 50);
    assert_eq!(io::read(&out).unwrap().fields.scalars.len(), 8);

    implicit_smoothing::run(&plane, &out).unwrap();
    let smooth = io::read(&out).unwrap().mesh;
    assert_eq!(smooth.faces(), patch.faces());
    for v in 0..patch.vertex_count() {
        let fixed = patch.topology().is_boundary_vertex(v as u32);
        assert!(!fixed || smooth.positions()[v] == patch.positions()[v], "vertex {v}");
    }

    let level = NoiseLevel::EdgeLengths(0.1);
    let noisy = add_noise(&ball, NoiseKind::GaussianAlongNormals, level, 1).unwrap();
    let scores = denoise_and_compare::run(&at("noisy.ply", Some(&noisy)), &sphere).unwrap();
    assert!(scores.displacement.unwrap().rms > 0.0);

    // On the square of side s the largest u is 0.0737 s², up to the error of such a coarse mesh.
    let [low, high] = patch.bounding_box().unwrap();
    let (u, energy) = poisson::run(&plane).unwrap();
    let largest = u.iter().fold(0.0, |m: f64, u| m.max(*u)) / (high[0] - low[0]).powi(2);
    assert!((largest - 0.0737).abs() < 0.004 && energy > 0.0, "{largest}");

    let distance = heat_distance::run(&sphere, 3).unwrap();
    let farthest = distance.iter().map(|d| d.unwrap()).fold(0.0, f64::max);
    // Half of the circumference, up to the error of the heat method on 162 vertices.
    let error = farthest - std::f64::consts::PI;
    assert!(distance[3] == Some(0.0) && error.abs() < 0.3, "{farthest}");

    principal_directions::run(&sphere, &out).unwrap();
    assert_eq!(io::read(&out).unwrap().fields.vectors.len(), 2);

    let flat = (ball.positions().as_flattened(), ball.faces().as_flattened());
    assert_eq!(mesh_from_arrays::run(flat.0, flat.1).unwrap(), ball);
    assert!(mesh_from_arrays::run(&flat.0[1..], flat.1).is_err());

    let mut stl = Vec::new();
    convert_in_memory::run(std::fs::File::open(&sphere).unwrap(), &mut stl).unwrap();
    assert_eq!(stl.len(), 84 + 50 * ball.face_count());

    assert!(picture::run(&sphere, 80, 60).unwrap().starts_with(b"\x89PNG"));
}

/// The code shown in each section of the report runs and returns numbers.
#[test]
fn the_lines_of_the_report_run() {
    let numbers = report::run(&shapes::bumpy_sphere(2, 0.1, 3.0)).unwrap();
    assert_eq!(numbers.len(), 11);
    for (section, number) in numbers {
        // A clean mesh is denoised, which the automatic denoiser leaves as it is.
        let is_used = number != 0.0 || section == "denoisers";
        assert!(number.is_finite() && is_used, "{section}: {number}");
        // κₙ along y is a/b².
        assert!(section != "q2" || (number - 2.0).abs() < 1e-12, "{number}");
    }
}
