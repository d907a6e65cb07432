//! Tests of all kinds of noise.

use fairing_parameters::ParameterError;
use fairing_shapes as shapes;

use super::*;

const KINDS: [NoiseKind; 10] = NoiseKind::ALL;

#[test]
fn names_read_back() {
    for kind in KINDS {
        assert_eq!(kind.to_string().parse(), Ok(kind));
    }
    assert!("white".parse::<NoiseKind>().unwrap_err().to_string().contains("axes, direction"));
}

fn displacements(kind: NoiseKind, level: NoiseLevel, seed: u64) -> Vec<DVec3> {
    let sphere = shapes::icosphere(5);
    let noisy = add_noise(&sphere, kind, level, seed).unwrap();
    noisy
        .positions()
        .iter()
        .zip(sphere.positions())
        .map(|(&p, &q)| DVec3::from(p) - DVec3::from(q))
        .collect()
}

/// 10242 vertices: the variance of a Gaussian is known to √(2/n) = 1.4 %,
/// of an impulse of share ¼ to 2.4 times that, of correlated noise, which has
/// a tenth as many independent values, to 4 %; four standard errors. Noise of depth cameras and of
/// fused views is scaled. The mean
/// square level of varying noise is 1 + 9/32 where t is spread evenly; on a
/// sphere it is near ½ more often, where the level is near one.
#[test]
fn each_kind_has_its_variance() {
    let sigma = 0.01;
    let squares = [1.0, 3.0, 1.0, 1.0, 0.25, 1.0, 1.21, 1.0, 1.0, 1.0];
    for (kind, expected) in KINDS.into_iter().zip(squares) {
        let d = displacements(kind, NoiseLevel::Model(sigma), 1);
        let square = d.iter().map(|&x| x.dot(x)).sum::<f64>() / d.len() as f64;
        let ratio = square / (sigma * sigma) / expected;
        assert!((ratio - 1.0).abs() < 0.16, "{kind:?}: {ratio}");
        let independent = match kind {
            NoiseKind::Correlated { .. } => 0.08 * d.len() as f64,
            // A few dozen patches of the surface, and a few.
            NoiseKind::DepthCamera { .. } => 50.0,
            NoiseKind::Fused { .. } => 5.0,
            _ => d.len() as f64,
        };
        for k in 0..3 {
            let mean = d.iter().map(|x| x[k]).sum::<f64>() / d.len() as f64;
            assert!(mean.abs() < 4.0 * sigma / independent.sqrt(), "{kind:?}: {mean}");
        }
    }
}

#[test]
fn noise_along_normals_is_radial_on_a_sphere() {
    let sphere = shapes::icosphere(4);
    let level = NoiseLevel::EdgeLengths(0.1);
    let noisy = add_noise(&sphere, NoiseKind::GaussianAlongNormals, level, 3).unwrap();
    for (&p, &q) in noisy.positions().iter().zip(sphere.positions()) {
        let q = DVec3::from(q);
        let d = DVec3::from(p) - q;
        // Area-weighted normals of an icosphere are off by O(h²).
        assert!(d.dot(q).abs() >= 0.999 * d.length(), "{d:?} at {q:?}");
    }
}

/// Heights at vertices d edges apart on a regular mesh: the sum of products
/// of the weights over their squares. exp(−d²/4) is the limit of a wide and
/// fine kernel in the plane; rings count more vertices than their share.
#[test]
fn correlation_falls_with_edges() {
    let plane = shapes::plane(100, 100, shapes::Diagonals::Regular);
    let kind = NoiseKind::Correlated { length: 2.0 };
    let noisy = add_noise(&plane, kind, NoiseLevel::Model(1.0), 4).unwrap();
    let height = |i: usize, j: usize| noisy.positions()[j * 101 + i][2];
    let correlation = |d: usize| {
        let products = (5..85).flat_map(|i| (5..95).map(move |j| (i, j)));
        let sum: f64 = products.map(|(i, j)| height(i, j) * height(i + d, j)).sum();
        sum / 7200.0
    };
    for (d, expected) in [(1, 0.78), (2, 0.37), (4, 0.02), (7, 0.0)] {
        let found = correlation(d);
        // About 600 independent patches.
        assert!((found - expected).abs() < 0.13, "{d} edges: {found}");
    }
}

/// A fan of 20000 faces: all pairs of rim vertices would be 200 million.
#[test]
fn correlation_does_not_pass_through_a_hub() {
    let n = 20_000u32;
    let rim = (0..n).map(|i| {
        let (y, x) = libm::sincos(std::f64::consts::TAU * f64::from(i) / f64::from(n));
        [x, y, 0.0]
    });
    let positions = std::iter::once([0.0; 3]).chain(rim).collect();
    let faces = (0..n).map(|i| [0, i + 1, (i + 1) % n + 1]).collect();
    let fan = TriMesh::new(positions, faces).unwrap();
    let kind = NoiseKind::Correlated { length: 2.0 };
    let noisy = add_noise(&fan, kind, NoiseLevel::Model(1.0), 4).unwrap();
    let height = |i: u32| noisy.positions()[(i % n) as usize + 1][2];
    let mean = |f: &dyn Fn(u32) -> f64| (0..n).map(f).sum::<f64>() / f64::from(n);
    // The hub's own part is in all of them; of the rest, there are about 5000
    // independent stretches.
    let common = mean(&height);
    let product = |apart: u32| mean(&|i| (height(i) - common) * (height(i + apart) - common));
    let (near, far) = (product(1) / product(0), product(9) / product(0));
    assert!(near > 0.6 && far.abs() < 0.1, "{near} {far}");
}

#[test]
fn the_level_varies() {
    let sphere = shapes::icosphere(5);
    let noisy = add_noise(&sphere, NoiseKind::Varying, NoiseLevel::Model(1e-3), 2).unwrap();
    // Where the coordinates add up to the sine's peak, and to its valley.
    let spread = |near: f64| {
        let at = sphere.positions().iter().zip(noisy.positions()).filter_map(|(&p, &q)| {
            let sum = p[0] + p[1] + p[2];
            ((sum - near).abs() < 0.2).then(|| DVec3::from(q).distance(p.into()).powi(2))
        });
        let (sum, count) = at.fold((0.0, 0), |(s, n), x| (s + x, n + 1));
        (sum / f64::from(count)).sqrt()
    };
    assert!((spread(-1.5) / 1.75e-3 - 1.0).abs() < 0.1, "{}", spread(-1.5));
    assert!((spread(1.5) / 0.25e-3 - 1.0).abs() < 0.15, "{}", spread(1.5));
}

#[test]
fn impulses_move_their_share() {
    let d = displacements(NoiseKind::Impulsive { fraction: 0.25 }, NoiseLevel::Model(1.0), 9);
    let moved = d.iter().filter(|&&x| x != DVec3::ZERO).count() as f64 / d.len() as f64;
    // Four standard errors of a share of ¼ among 10242.
    assert!((moved - 0.25).abs() < 0.018, "{moved}");
}

#[test]
fn the_seed_decides_and_the_level_scales() {
    for kind in KINDS {
        // At a distance of ten, a camera has no larger level.
        let a = displacements(kind, NoiseLevel::Model(0.5), 5);
        assert_eq!(a, displacements(kind, NoiseLevel::Model(0.5), 5));
        assert_ne!(a, displacements(kind, NoiseLevel::Model(0.5), 6));
        if let NoiseKind::DepthCamera { .. } = kind {
            continue;
        }
        let b = displacements(kind, NoiseLevel::Model(1.0), 5);
        for (x, y) in a.iter().zip(&b) {
            // Differences of numbers up to 5, rounded.
            assert!((2.0 * *x - *y).length() < 1e-14);
        }
    }
}

#[test]
fn units() {
    let sphere = shapes::icosphere(2);
    let h = sphere.mean_edge_length();
    assert_eq!(NoiseLevel::EdgeLengths(0.5).in_mesh_units(&sphere), 0.5 * h);
    assert_eq!(NoiseLevel::Diagonals(2.0).in_mesh_units(&sphere), 2.0 * sphere.diagonal());
}

#[test]
fn bad_parameters_are_named() {
    let sphere = shapes::icosphere(1);
    for level in [-1.0, f64::NAN, f64::INFINITY] {
        let e = add_noise(&sphere, NoiseKind::UniformPerAxis, NoiseLevel::Model(level), 0);
        let Err(EvaluationError::Option(ParameterError::Range { option, .. })) = e else {
            panic!("{e:?}")
        };
        assert_eq!(option, "noise level in mesh units");
    }
    let kind = NoiseKind::Impulsive { fraction: 1.5 };
    let e = add_noise(&sphere, kind, NoiseLevel::Model(1.0), 0).unwrap_err();
    assert_eq!(e.to_string(), "fraction of impulses is 1.5, but must be between 0 and 1");
    let kind = NoiseKind::Correlated { length: 0.0 };
    let e = add_noise(&sphere, kind, NoiseLevel::Model(1.0), 0).unwrap_err();
    assert_eq!(e.to_string(), "correlation length in edges is 0, but must be between 0.1 and 10");
    let e = add_noise(&sphere, NoiseKind::GaussianPerAxis, NoiseLevel::Model(1e308), 0);
    assert!(matches!(e, Err(EvaluationError::Positions(_))));
}

/// The correlation of signed displacements at the two ends of an edge, and the fraction of their
/// variance left after 5, 20 and 50 rounds of averaging with the neighbours.
fn persistence(mesh: &TriMesh, heights: &[f64]) -> [f64; 4] {
    let topology = mesh.topology();
    let square = |h: &[f64]| h.iter().map(|x| x * x).sum::<f64>() / h.len() as f64;
    let product = |e: &[u32; 2]| heights[e[0] as usize] * heights[e[1] as usize];
    let correlation = topology.edges().iter().map(product).sum::<f64>()
        / topology.edges().len() as f64
        / square(heights);
    let mut current = heights.to_vec();
    let mut left = [correlation, 0.0, 0.0, 0.0];
    for round in 1..=50 {
        let mean = |v: u32| {
            let ring = topology.neighbors(v);
            ring.iter().map(|&w| current[w as usize]).sum::<f64>() / ring.len() as f64
        };
        current = (0..mesh.vertex_count() as u32).map(mean).collect();
        if let Some(k) = [5, 20, 50].iter().position(|&k| k == round) {
            left[k + 1] = square(&current) / square(heights);
        }
    }
    left
}

/// A tilted wavy sheet below the camera, with edges of about one.
fn sheet() -> TriMesh {
    let plane = shapes::plane(80, 80, shapes::Diagonals::Alternating);
    let lifted = plane.positions().iter().map(|&[x, y, _]| {
        let [x, y] = [80.0 * x, 80.0 * y];
        [x, y, 0.2 * x + 4.0 * libm::sin(0.08 * y)]
    });
    plane.with_positions(lifted.collect()).unwrap()
}

/// Persistence of noise of 0.67 mean edges on the sheet, along `z` of the displacement.
fn persistence_of(kind: NoiseKind) -> [f64; 4] {
    let sheet = sheet();
    let noisy = add_noise(&sheet, kind, NoiseLevel::EdgeLengths(0.67), 3).unwrap();
    let heights: Vec<f64> =
        noisy.positions().iter().zip(sheet.positions()).map(|(p, q)| p[2] - q[2]).collect();
    persistence(&sheet, &heights)
}

/// Independent noise is gone after a few rounds: 0.6 % of its variance is left after 50 on a
/// regular mesh, and somewhat more along edges of valence four. Measured on a view of a depth
/// camera: 0.70, 0.50, 0.32, 0.24; on fused views: 0.97, 0.93, 0.84, 0.75.
#[test]
fn noise_of_sensors_persists() {
    for kind in [NoiseKind::GaussianAlongNormals, NoiseKind::Rays { camera: None }] {
        let [edge, five, twenty, fifty] = persistence_of(kind);
        assert!(edge.abs() < 0.03 && five < 0.06 && twenty < 0.015 && fifty < 0.006, "{kind}");
    }
    let near = |kind: NoiseKind, expected: [f64; 4]| {
        let found = persistence_of(kind);
        for (x, y) in found.iter().zip(expected) {
            assert!((x - y).abs() < 0.12, "{kind}: {found:?}");
        }
    };
    near(NoiseKind::DepthCamera { camera: None, length: 8.0 }, [0.70, 0.50, 0.32, 0.24]);
    near(NoiseKind::Fused { length: 25.0 }, [0.97, 0.93, 0.84, 0.75]);
    let kinds = [
        NoiseKind::Correlated { length: 1.0 },
        NoiseKind::DepthCamera { camera: None, length: 1.0 },
        NoiseKind::Fused { length: 1.0 },
    ];
    for kind in kinds {
        let at = |length: f64| persistence_of(kind.with_length(length).unwrap());
        let found = [at(2.0), at(5.0), at(10.0)];
        for k in [0, 3] {
            let rises = found[0][k] < found[1][k] && found[1][k] < 1.02 * found[2][k];
            assert!(rises, "{kind}: {found:?}");
        }
    }
}

#[test]
fn rays_meet_in_the_camera() {
    let sphere = shapes::icosphere(4);
    for camera in [None, Some([2.0, -1.0, 3.0])] {
        let eye = DVec3::from(camera.unwrap_or([0.0, 0.0, 3.0 * sphere.diagonal()]));
        for kind in [NoiseKind::Rays { camera }, NoiseKind::DepthCamera { camera, length: 2.0 }] {
            let noisy = add_noise(&sphere, kind, NoiseLevel::Model(0.02), 8).unwrap();
            let mut squares = 0.0;
            for (&p, &q) in noisy.positions().iter().zip(sphere.positions()) {
                let (d, ray) = (DVec3::from(p) - DVec3::from(q), DVec3::from(q) - eye);
                assert!(d.cross(ray.normalize()).length() < 1e-14 * ray.length(), "{kind}");
                squares += d.length_squared();
            }
            let rms = (squares / sphere.vertex_count() as f64).sqrt();
            // Four standard errors of independent noise at 2562 vertices.
            let within = if matches!(kind, NoiseKind::Rays { .. }) { 0.06 } else { 0.01 };
            assert!((rms / 0.02 - 1.0).abs() < within, "{kind}: {rms}");
        }
    }
}

#[test]
fn levels_of_sensors_are_met() {
    let sheet = sheet();
    for level in [0.05, 0.3, 1.0] {
        for kind in [
            NoiseKind::DepthCamera { camera: None, length: 8.0 },
            NoiseKind::DepthCamera { camera: Some([40.0, 40.0, 90.0]), length: 2.0 },
            NoiseKind::Fused { length: 25.0 },
        ] {
            let noisy = add_noise(&sheet, kind, NoiseLevel::Model(level), 4).unwrap();
            let pairs = noisy.positions().iter().zip(sheet.positions());
            let square = pairs.map(|(&p, &q)| DVec3::from(p).distance_squared(q.into()));
            let rms = (square.sum::<f64>() / sheet.vertex_count() as f64).sqrt();
            assert!((rms / level - 1.0).abs() < 0.01, "{kind}: {rms} for {level}");
        }
    }
}

#[test]
fn threads_change_nothing() {
    let sheet = sheet();
    let noisy = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            KINDS.map(|kind| add_noise(&sheet, kind, NoiseLevel::EdgeLengths(0.3), 4).unwrap())
        })
    };
    assert_eq!(noisy(1), noisy(3));
}

#[test]
fn cameras_that_cannot_be_are_named() {
    let sphere = shapes::icosphere(2);
    let message = |kind, level| {
        add_noise(&sphere, kind, NoiseLevel::Model(level), 1).unwrap_err().to_string()
    };
    let camera = Some(sphere.positions()[7]);
    let found = message(NoiseKind::Rays { camera }, 0.1);
    assert!(found.starts_with("vertex 7 is not in front of the camera at ["), "{found}");
    let camera = Some([0.5, 0.0, 0.0]);
    let found = message(NoiseKind::DepthCamera { camera, length: 2.0 }, 0.1);
    assert!(found.contains("is not in front of the camera at [0.5, 0.0, 0.0]"), "{found}");
    let camera = Some([f64::NAN, 0.0, 0.0]);
    let found = message(NoiseKind::Rays { camera }, 0.1);
    assert!(found.starts_with("coordinate of the camera is NaN, but must be"), "{found}");
    let camera = Some([0.0, 0.0, 4.0]);
    let found = message(NoiseKind::DepthCamera { camera, length: 2.0 }, 1.0);
    assert!(found.contains("for a depth camera at this distance"), "{found}");
    let found = message(NoiseKind::Fused { length: 0.5 }, 1.0);
    let expected = "correlation length in mean edge lengths is 0.5, but must be between 1 and 100";
    assert_eq!(found, expected);
}

/// Truth at the closest points: on the surface, and no farther than the noise.
#[test]
fn truth_of_fused_views_is_on_the_surface() {
    let truth = sheet();
    let kind = NoiseKind::Fused { length: 10.0 };
    let noisy = add_noise(&truth, kind, NoiseLevel::Model(1.0), 4).unwrap();
    let closest = crate::at_closest_points(&noisy, &truth).unwrap();
    assert!(crate::vertex_distance(&closest, &truth).unwrap().max < 1e-12);
    for ((&p, &q), &t) in noisy.positions().iter().zip(closest.positions()).zip(truth.positions()) {
        let p = DVec3::from(p);
        assert!(p.distance(q.into()) <= p.distance(t.into()) + 1e-12);
    }
}
