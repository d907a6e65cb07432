//! Meshes without a plain operator, and flows that end in a point.

use super::*;
use fairing_operators::{LaplacianKind, LumpedArea};
use fairing_smoothing::{FairRegion, LowPass, Transfer, Update, fair_region, low_pass};

/// A sphere with a fin on one of its edges, a face without area and an isolated vertex.
fn broken() -> TriMesh {
    let sphere = shapes::icosphere(3);
    let mut positions = sphere.positions().to_vec();
    let mut faces = sphere.faces().to_vec();
    let [a, b, _] = faces[0];
    let n = positions.len() as u32;
    let (p, q) = (positions[a as usize], positions[b as usize]);
    positions.push([0, 1, 2].map(|k| 0.6 * (p[k] + q[k])));
    positions.push([0, 1, 2].map(|k| 0.5 * (p[k] + q[k])));
    positions.push([5.0, 5.0, 5.0]);
    faces.extend([[a, b, n], [b, a, n + 1]]);
    TriMesh::new(positions, faces).unwrap()
}

/// Auto is the robust operator on a mesh with a thin face, which the report names, and the plain
/// operator on others.
#[test]
fn auto_takes_the_robust_operator_where_a_face_is_too_thin() {
    let sphere = fairing_shapes::icosphere(2);
    let n = sphere.face_count() as u32;
    for (mesh, other, too_thin) in
        [(broken(), LaplacianKind::Robust, true), (sphere, LaplacianKind::Cotangent, false)]
    {
        let named = fairing_operators::check_faces(&mesh).err().map(|error| match error {
            fairing_operators::OperatorError::DegenerateFace { face, .. } => face,
            error => panic!("{error}"),
        });
        assert!(named.is_some() == too_thin && named.is_none_or(|face| face >= n), "{named:?}");
        let implicit_with = |kind, update| {
            let step = Diffusion::cotangent(0.05).with_kind(kind);
            implicit(&mesh, &Implicit { update, ..Implicit::new(step) }, None)
        };
        let low_pass_with =
            |kind| low_pass(&mesh, &LowPass { kind, ..LowPass::new(Transfer::Modes(12)) });
        let region_with =
            |kind| fair_region(&mesh, &FairRegion { kind, ..FairRegion::new(vec![3, 40]) });
        let pairs = [
            (
                implicit_with(LaplacianKind::Auto, Update::Never),
                implicit_with(other, Update::Never),
            ),
            (implicit_with(LaplacianKind::Auto, Update::Mass), implicit_with(other, Update::Mass)),
            (implicit_with(LaplacianKind::Auto, Update::Both), implicit_with(other, Update::Both)),
            (low_pass_with(LaplacianKind::Auto), low_pass_with(other)),
            (region_with(LaplacianKind::Auto), region_with(other)),
        ];
        for (found, expected) in pairs {
            let (found, expected) = (found.unwrap(), expected.unwrap());
            assert_eq!(found.mesh, expected.mesh);
            assert_eq!((found.report.too_thin, expected.report.too_thin), (named, None));
        }
    }
}

/// The plain operator is refused with a message that names the alternatives; the robust operator
/// and uniform weights smooth.
#[test]
fn broken_meshes_smooth_through_the_robust_operator() {
    let mesh = broken();
    let step = Diffusion::cotangent(1.0).with_kind(LaplacianKind::Cotangent);
    let error = implicit(&mesh, &Implicit::new(step), None).unwrap_err();
    assert!(matches!(error.failure, FlowFailure::Operator(_)));
    assert!(error.to_string().contains("robust") && error.to_string().contains("uniform"));
    let robust = |lambda| Diffusion::cotangent(lambda).with_kind(LaplacianKind::Robust);
    let limit = stable_limit(&mesh, robust(1.0)).unwrap();
    assert!(limit > 0.0 && limit.is_finite());
    let time = Time::SquaredUnits(0.5 * limit);
    let (kind, area) = (LaplacianKind::Robust, LumpedArea::Barycentric);
    let step = Diffusion::Cotangent { time, kind, area };
    let heat = LowPass { kind, ..LowPass::new(Transfer::Heat(Time::SquaredUnits(0.01))) };
    let results = [
        implicit(&mesh, &Implicit::new(robust(5.0)), None),
        implicit(&mesh, &Implicit { update: Update::Mass, ..Implicit::new(robust(0.2)) }, None),
        implicit(&mesh, &Implicit { update: Update::Both, ..Implicit::new(robust(0.2)) }, None),
        implicit(&mesh, &Implicit::new(Diffusion::uniform(5.0)), None),
        explicit(&mesh, &Explicit::new(step), None),
        low_pass(&mesh, &heat),
        low_pass(&mesh, &LowPass { kind, ..LowPass::new(Transfer::Modes(30)) }),
        fair_region(&mesh, &FairRegion { kind, ..FairRegion::new(vec![0, 642, 643]) }),
    ];
    for (i, result) in results.into_iter().enumerate() {
        let smoothed = result.unwrap_or_else(|error| panic!("{i}: {error}")).mesh;
        assert_eq!(smoothed.positions()[644], [5.0; 3], "{i}: the isolated vertex moved");
        let moved = largest_distance(&smoothed, &mesh);
        assert!(moved > 1e-3 && moved < 2.0, "{i}: {moved}");
    }
}

/// On a closed Delaunay mesh the robust operator is the plain one.
#[test]
fn the_robust_operator_changes_nothing_on_good_meshes() {
    let mesh = shapes::icosphere(3);
    // Ten steps before the sphere vanishes.
    let plain = Diffusion::cotangent(0.5);
    for update in [Update::Never, Update::Mass, Update::Both] {
        let run = |diffusion| {
            let options = Implicit { update, tolerance: 1e-12, ..Implicit::new(diffusion) };
            implicit(&mesh, &options, None).unwrap().mesh
        };
        let apart = largest_distance(&run(plain), &run(plain.with_kind(LaplacianKind::Robust)));
        assert!(apart < 1e-9, "{update:?}: {apart:e}");
    }
}

/// A unit sphere vanishes at t = ¼, and slightly later with steps of a hundredth. The result is the
/// last mesh before.
#[test]
fn mean_curvature_flow_says_when_a_surface_is_gone() {
    let sphere = shapes::icosphere(3);
    let time = Time::SquaredUnits(0.01);
    let options = Implicit {
        iterations: 100,
        update: Update::Both,
        ..Implicit::new(Diffusion::Cotangent {
            time,
            kind: LaplacianKind::Auto,
            area: LumpedArea::Barycentric,
        })
    };
    let error = implicit(&sphere, &options, None).unwrap_err();
    let FlowFailure::Collapsed { vertex, area, before } = error.failure else {
        panic!("{:?}", error.failure)
    };
    assert!((25..40).contains(&error.iteration), "{}", error.iteration);
    assert!((vertex as usize) < sphere.vertex_count() && area < 0.01 * before);
    let left = error.last_good.area() / sphere.area();
    assert!(left > 1e-4 && left < 0.1, "{left}");
    // Until shortly before, the flow succeeds.
    assert!(implicit(&sphere, &Implicit { iterations: 20, ..options }, None).is_ok());
}

/// A dumbbell pinches at its neck long before its bells vanish, and the flow continues.
#[test]
fn a_neck_that_pinches_off_does_not_end_the_flow() {
    // A cylinder with a waist, closed by two points.
    let (around, along) = (24u32, 60u32);
    let mut positions = Vec::new();
    for i in 0..along {
        let s = f64::from(i) / f64::from(along - 1);
        let z = 6.0 * s - 3.0;
        let bell = ((3.2 - z.abs()) * 0.9).min(1.0) * (1.0 - 0.93 * (-z * z * 1.5).exp());
        for j in 0..around {
            let angle = f64::from(j) * std::f64::consts::TAU / f64::from(around);
            positions.push([bell * angle.cos(), bell * angle.sin(), z]);
        }
    }
    let mut faces = Vec::new();
    let at = |i: u32, j: u32| i * around + j % around;
    for i in 0..along - 1 {
        for j in 0..around {
            faces.push([at(i, j), at(i, j + 1), at(i + 1, j)]);
            faces.push([at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)]);
        }
    }
    let (low, high) = (positions.len() as u32, positions.len() as u32 + 1);
    positions.extend([[0.0, 0.0, -3.05], [0.0, 0.0, 3.05]]);
    for j in 0..around {
        faces.push([low, at(0, j + 1), at(0, j)]);
        faces.push([high, at(along - 1, j), at(along - 1, j + 1)]);
    }
    let dumbbell = TriMesh::new(positions, faces).unwrap();
    let options = Implicit {
        iterations: 2000,
        update: Update::Both,
        ..Implicit::new(Diffusion::Cotangent {
            time: Time::SquaredUnits(5e-4),
            kind: LaplacianKind::Auto,
            area: LumpedArea::Barycentric,
        })
    };
    // After the pinch: the neck has become faces without area, the bells are as round as before.
    let flow = |iterations| implicit(&dumbbell, &Implicit { iterations, ..options.clone() }, None);
    let early = flow(3).unwrap();
    assert_eq!(early.report.degenerate_faces, 0);
    let late = flow(250).unwrap();
    assert!(late.report.degenerate_faces > 0);
    assert!(late.mesh.area() > 0.1 * dumbbell.area());
    // Up to the time at which the bells vanish as well.
    let error = flow(2000).unwrap_err();
    assert!(matches!(error.failure, FlowFailure::Collapsed { .. }), "{:?}", error.failure);
    assert!(error.last_good.area() < 0.1 * dumbbell.area(), "step {}", error.iteration);
}

/// On a long strip with free boundaries the condition of Δ⁴ exceeds double precision: an error is
/// better than a result that corrections still change by a fifth of the mesh.
#[test]
fn regions_that_cannot_be_solved_are_refused() {
    let (rows, n) = (6, 500u32);
    let places = (0..n).flat_map(|i| (0..rows).map(move |j| [f64::from(i), f64::from(j)]));
    let positions = places.map(|[x, y]| [x, y, (0.7 * x).sin()]).collect();
    let at = |i, j| i * rows + j;
    let cells = (0..n - 1).flat_map(|i| (0..rows - 1).map(move |j| (i, j)));
    let faces = cells.flat_map(|(i, j)| {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        [[a, b, c], [a, c, d]]
    });
    let mesh = TriMesh::new(positions, faces.collect()).unwrap();
    let region: Vec<u32> = (5 * rows..(n - 5) * rows).collect();
    for kind in [LaplacianKind::Uniform, LaplacianKind::Auto] {
        let options = FairRegion { order: 4, kind, ..FairRegion::new(region.clone()) };
        let error = fair_region(&mesh, &options).unwrap_err();
        let named =
            matches!(error.failure, FlowFailure::NotConverged { .. } | FlowFailure::NotFactored(_));
        assert!(named && error.last_good.positions() == mesh.positions(), "{error}");
    }
}

/// Weights that divide by edge lengths are undefined at coincident neighbours: the error names the
/// edge.
#[test]
fn edges_without_length_are_named() {
    let sphere = fairing_shapes::icosphere(1);
    let [a, b] = sphere.topology().edges()[7];
    let mut positions = sphere.positions().to_vec();
    positions[b as usize] = positions[a as usize];
    let mesh = sphere.with_positions(positions).unwrap();
    let options = fairing_smoothing::ScaleDependent { iterations: 3, ..Default::default() };
    let error = fairing_smoothing::scale_dependent(&mesh, &options, None).unwrap_err();
    assert_eq!(error.failure, FlowFailure::NoLength { vertex: a, neighbor: b });
    assert_eq!((error.iteration, error.last_good.positions()), (1, mesh.positions()));
}

/// A sphere away from the origin shrinks to a point; steps that only move rounding errors are not
/// taken.
#[test]
fn a_flow_that_has_become_a_point_stops() {
    let sphere = shapes::icosphere(1);
    let positions = sphere.positions().iter().map(|p| [p[0] + 3.0, p[1], p[2]]).collect();
    let sphere = sphere.with_positions(positions).unwrap();
    let options = Explicit { iterations: 100_000, ..Explicit::new(Diffusion::uniform(1.0)) };
    let mut watch = |_: &fairing_smoothing::Step<'_>| ControlFlow::Continue(());
    let found = explicit(&sphere, &options, Some(&mut watch)).unwrap();
    assert!(found.report.stopped && found.report.iterations < 2000, "{}", found.report.iterations);
    assert!(found.mesh.diagonal() < 1e-14);
    assert!((found.mesh.positions()[0][0] - 3.0).abs() < 1e-12);
}
