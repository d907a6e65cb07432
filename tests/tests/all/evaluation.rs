//! Distances, drift and scores with known answers.

use fairing_evaluation::{
    EvaluationError, NoiseKind, NoiseLevel, ScoreOptions, Scores, add_noise, curvature_error,
    drift, feature_edges, flipped_faces, hausdorff, normal_error, observed_orders,
    self_intersections, surface_distance, vertex_displacement, vertex_distance,
};
use fairing_mesh::{TriMesh, subdivide_midpoint};
use fairing_parameters::ParameterError;
use fairing_shapes::{self as shapes, Diagonals};
use proptest::prelude::*;

fn mapped(mesh: &TriMesh, f: impl Fn([f64; 3]) -> [f64; 3]) -> TriMesh {
    mesh.with_positions(mesh.positions().iter().map(|&p| f(p)).collect()).unwrap()
}

/// Spheres of radius 1 and 1.1 around one centre. A vertex of the inner sphere is closest to a face
/// above it, at 0.1 minus the sagitta of a chord; a vertex of the outer sphere is closest to a
/// vertex or face below it, at slightly more than 0.1. Both tend to 0.1 with the square of the edge
/// length.
#[test]
fn concentric_spheres() {
    let (mut h, mut error) = (vec![], vec![]);
    for level in 2..=5 {
        let inner = shapes::icosphere(level);
        let outer = mapped(&inner, |p| p.map(|x| 1.1 * x));
        let d = surface_distance(&inner, &outer).unwrap();
        assert!(d.forward.max <= 0.1 + 1e-12 && d.forward.mean <= d.forward.rms);
        assert!((d.backward.max - 0.1).abs() < 1e-12, "a vertex over the same vertex");
        h.push(inner.mean_edge_length());
        error.push(0.1 - d.forward.mean);
        // Drift is exact: scaling by 1.1.
        let change = drift(&outer, &inner);
        assert!((change.volume.unwrap() - 0.331).abs() < 1e-12);
        assert!((change.area.unwrap() - 0.21).abs() < 1e-12);
        assert!((change.edge_length.unwrap() - 0.1).abs() < 1e-12);
        assert!(normal_error(&outer, &inner).unwrap().max < 1e-6);
    }
    for order in observed_orders(&h, &error) {
        assert!((1.9..2.1).contains(&order), "{order}, {error:?}");
    }
}

/// A cube moved along x by t < ½: every point of the far side, corners included, is at distance t,
/// and no point is farther.
#[test]
fn translated_cubes() {
    let cube = shapes::cube(4, Diagonals::Alternating);
    let fine = subdivide_midpoint(&cube).unwrap();
    for t in [0.01, 0.125, 0.4] {
        for mesh in [&cube, &fine] {
            let moved = mapped(mesh, |p| [p[0] + t, p[1], p[2]]);
            let d = surface_distance(&moved, &cube).unwrap();
            assert!((d.max() - t).abs() < 1e-15, "{d:?}");
            let bounds = hausdorff(&moved, &cube, 1e-6).unwrap();
            assert!(bounds.lower <= t + 1e-15 && t <= bounds.upper + 1e-15, "{bounds:?}");
            assert!(bounds.upper - bounds.lower <= 1e-6);
        }
        let moved = mapped(&cube, |p| [p[0] + t, p[1], p[2]]);
        let displacement = vertex_displacement(&moved, &cube).unwrap();
        assert!((displacement.rms - t).abs() < 1e-15 && (displacement.max - t).abs() < 1e-15);
    }
}

/// Vertices alone are not enough: an equilateral triangle against three small ones that touch its
/// corners from outside. All of its corners are at distance zero; its centre is farthest, a
/// circumradius from the corners.
#[test]
fn hausdorff_finds_the_inside_of_faces() {
    let corners = [0.0f64, 1.0, 2.0].map(|k| {
        let (s, c) = (std::f64::consts::TAU * k / 3.0).sin_cos();
        [c, s, 0.0]
    });
    let large = TriMesh::new(corners.to_vec(), vec![[0, 1, 2]]).unwrap();
    let mut positions = vec![];
    for [x, y, z] in corners {
        positions.extend([[x, y, z], [1.1 * x, 1.1 * y, 0.05], [1.1 * x, 1.1 * y, -0.05]]);
    }
    let small = TriMesh::new(positions, vec![[0, 1, 2], [3, 4, 5], [6, 7, 8]]).unwrap();
    assert_eq!(vertex_distance(&large, &small).unwrap().max, 0.0);
    assert!(vertex_distance(&small, &large).unwrap().max < 0.12);
    for tolerance in [0.1, 1e-3, 1e-6] {
        for bounds in [hausdorff(&large, &small, tolerance), hausdorff(&small, &large, tolerance)] {
            let bounds = bounds.unwrap();
            assert!(bounds.lower <= 1.0 + 1e-15 && 1.0 <= bounds.upper + 1e-15, "{bounds:?}");
            assert!(bounds.upper - bounds.lower <= tolerance + 1e-15);
        }
    }
}

/// Distance is symmetric, invariant under motions, and scales.
#[test]
fn hausdorff_is_a_distance() {
    let a = shapes::bumpy_sphere(3, 0.1, 4.0);
    let b = shapes::torus(1.0, 0.4, 24, 12);
    let tolerance = 1e-4;
    let ab = hausdorff(&a, &b, tolerance).unwrap();
    let ba = hausdorff(&b, &a, tolerance).unwrap();
    assert!(ab.lower <= ba.upper && ba.lower <= ab.upper);
    let turned = |m: &TriMesh| mapped(m, |[x, y, z]| [10.0 + 2.0 * z, -2.0 * y, 2.0 * x]);
    let twice = hausdorff(&turned(&a), &turned(&b), 2.0 * tolerance).unwrap();
    assert!((twice.lower - 2.0 * ab.lower).abs() <= 2.0 * tolerance);
    assert!(ab.lower >= surface_distance(&a, &b).unwrap().max());
    // Midpoints of sides are rounded.
    assert!(hausdorff(&a, &a, tolerance).unwrap().lower < 1e-15);
}

/// A roof of slope s over a plane: every normal turns by atan s.
#[test]
fn a_known_angle() {
    let plane = shapes::plane(8, 8, Diagonals::Alternating);
    for slope in [1e-9, 0.1, 1.0, 30.0f64] {
        let roof = mapped(&plane, |[x, y, _]| [x, y, slope * (x - 0.5).abs()]);
        let error = normal_error(&roof, &plane).unwrap();
        let angle = slope.atan().to_degrees();
        for found in [error.mean, error.max, error.area_weighted] {
            assert!((found / angle - 1.0).abs() < 1e-12, "{found} for {angle}");
        }
    }
    let over = mapped(&plane, |[x, y, _]| [-x, y, 0.0]);
    assert_eq!(flipped_faces(&over, &plane).unwrap(), plane.face_count());
    assert_eq!(normal_error(&over, &plane).unwrap().mean, 180.0);
    assert_eq!(curvature_error(&over, &plane).unwrap(), None);
}

/// Gaussian noise along the normals of a sphere of radius 1: the root mean square distance is σ at
/// the vertices, and slightly less over the surface.
#[test]
fn known_noise() {
    let sphere = shapes::icosphere(5);
    let sigma = 0.1 * sphere.mean_edge_length();
    for kind in [NoiseKind::GaussianAlongNormals, NoiseKind::UniformPerAxis] {
        let noisy = add_noise(&sphere, kind, NoiseLevel::EdgeLengths(0.1), 4).unwrap();
        let rms = vertex_displacement(&noisy, &sphere).unwrap().rms;
        // 10242 squares: 1.4 % standard error for Gaussians.
        assert!((rms / sigma - 1.0).abs() < 0.05, "{kind:?}: {rms}");
        let d = vertex_distance(&noisy, &sphere).unwrap();
        assert!(d.rms <= rms * (1.0 + 1e-12));
        let expected = if kind == NoiseKind::UniformPerAxis { 3f64.sqrt().recip() } else { 1.0 };
        assert!((d.rms / sigma / expected - 1.0).abs() < 0.06, "{kind:?}: {}", d.rms / sigma);
    }
}

/// A cube has 12 · n sharp edges. Rounding it to a sphere loses them, folding a plane creates new
/// ones.
#[test]
fn features() {
    let cube = shapes::cube(6, Diagonals::Regular);
    let same = feature_edges(&cube, &cube, 30.0).unwrap();
    assert_eq!((same.shared, same.found, same.expected), (72, 72, 72));
    assert_eq!((same.precision(), same.recall()), (Some(1.0), Some(1.0)));
    // Edges at exactly the threshold angle are sharp.
    assert_eq!(feature_edges(&cube, &cube, 90.0).unwrap(), same);
    // The bound on the rounding of a volume is some thousand roundings of its terms.
    let sphere = shapes::icosphere(3);
    assert!(sphere.volume_rounding() < 1e-11 * sphere.signed_volume());
    let ball = mapped(&cube, shapes::onto_sphere);
    let lost = feature_edges(&ball, &cube, 30.0).unwrap();
    assert_eq!((lost.found, lost.recall(), lost.precision()), (0, Some(0.0), None));
    let error = feature_edges(&cube, &cube, 180.0).unwrap_err();
    assert_eq!(
        error,
        ParameterError::range("feature angle", 180.0, "above 0 and below 180 degrees").into()
    );
}

/// The curvature of an inscribed sphere is 1 up to O(h²), and 1/1.01 for a sphere scaled by 1.01.
#[test]
fn curvature_of_a_blown_up_sphere() {
    let sphere = shapes::icosphere(4);
    let blown = mapped(&sphere, |p| p.map(|x| 1.01 * x));
    let error = curvature_error(&blown, &sphere).unwrap().unwrap();
    assert!((error - (1.0 - 1.0 / 1.01)).abs() < 1e-12, "{error}");
}

#[test]
fn scores_of_the_same_mesh() {
    let block = shapes::cad_block(0.2);
    let scores = Scores::new(&block, &block, &ScoreOptions::default()).unwrap();
    for score in scores.entries() {
        match (score.name, score.value) {
            ("psnr", Err(reason)) => assert_eq!(reason, "no vertex moved"),
            ("feature_precision" | "feature_recall", value) => assert_eq!(value, Ok(1.0)),
            // Points inside faces are rounded.
            ("hausdorff_lower", value) => assert!(value.unwrap() < 1e-15),
            ("hausdorff_upper", value) => assert!(value.unwrap() <= 1e-4),
            (name, value) => assert_eq!(value, Ok(0.0), "{name}"),
        }
    }
}

/// Meshes with different faces have distances and drift; scores that need matching elements are
/// absent, with the reason.
#[test]
fn scores_of_different_faces() {
    let (coarse, fine) = (shapes::icosphere(2), shapes::icosphere(3));
    let scores = Scores::new(&coarse, &fine, &ScoreOptions::default()).unwrap();
    let absent: Vec<&str> = scores
        .entries()
        .into_iter()
        .filter_map(|s| {
            let reason = s.value.err()?;
            assert!(reason.contains("162 and 642 vertices"), "{reason}");
            Some(s.name)
        })
        .collect();
    let expected = [
        "normal_mean",
        "normal_area_weighted",
        "normal_max",
        "displacement_rms",
        "displacement_max",
        "psnr",
        "flipped_faces",
        "feature_precision",
        "feature_recall",
        "curvature_error",
    ];
    assert_eq!(absent, expected);
    let table = scores.to_string();
    assert_eq!(table.lines().count(), scores.entries().len());
    assert!(scores.distance.forward.max < 0.02);
}

#[test]
fn nothing_to_compare() {
    let sphere = shapes::icosphere(1);
    let points = TriMesh::new(vec![[0.0; 3]; 4], vec![]).unwrap();
    let none = |which| Err(EvaluationError::NoFaces { which });
    assert_eq!(surface_distance(&points, &sphere), none("mesh"));
    assert_eq!(surface_distance(&sphere, &points), none("reference"));
    assert!(Scores::new(&sphere, &points, &ScoreOptions::default()).is_err());
    for tolerance in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(hausdorff(&sphere, &sphere, tolerance).is_err(), "{tolerance}");
    }
}

/// Heavy noise makes faces cross and flip; without noise none does.
#[test]
fn crossings_come_with_noise() {
    let sphere = shapes::icosphere(4);
    let mut last = 0;
    for level in [0.05, 0.5, 1.0] {
        let noisy =
            add_noise(&sphere, NoiseKind::GaussianPerAxis, NoiseLevel::EdgeLengths(level), 1)
                .unwrap();
        let crossings = self_intersections(&noisy);
        assert!(crossings >= last);
        last = crossings;
    }
    assert!(last > 1000);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Moving both meshes, renumbering them or scaling them changes no score by more than rounding.
    #[test]
    fn scores_do_not_depend_on_the_frame(seed in 0u64..1000, size in -3i32..4, shift in -4.0..4.0) {
        let clean = shapes::cube(4, Diagonals::Alternating);
        let level = NoiseLevel::EdgeLengths(0.2);
        let noisy = add_noise(&clean, NoiseKind::GaussianPerAxis, level, seed).unwrap();
        let size = 2f64.powi(size);
        let moved = |m: &TriMesh| mapped(m, |[x, y, z]| [size * z + shift, size * x, size * y]);
        let options = ScoreOptions::default();
        let here = Scores::new(&noisy, &clean, &options).unwrap().entries();
        let there = Scores::new(&moved(&noisy), &moved(&clean), &options).unwrap().entries();
        for (a, b) in here.iter().zip(&there) {
            let (x, y) = (a.value.clone().unwrap(), b.value.clone().unwrap());
            let slack = if a.name.starts_with("hausdorff") { 1e-4 } else { 1e-9 };
            prop_assert!((x - y).abs() <= slack * (1.0 + x.abs()), "{}: {x} and {y}", a.name);
        }
    }
}
