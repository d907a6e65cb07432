//! Flows at every extent that a mesh may have.

use std::ops::ControlFlow;

use fairing_mesh::BuildError;
use fairing_mesh::TriMesh;
use fairing_operators::{LaplacianKind, LumpedArea};
use fairing_shapes as shapes;
use fairing_smoothing::{
    Boundary, ConformalizedMcf, Constraints, Diffusion, Explicit, FairRegion, FlowError,
    FlowFailure, Hc, Implicit, LowPass, Method, ScaleDependent, SoftConstraint, Stability, Taubin,
    Time, Transfer, Update, Volume, WindowedSinc, explicit, largest_eigenvalue, stable_limit,
};
use glam::DVec3;

/// Powers of two over the range of extents, reduced by the shrinkage of flows. Even, so that roots
/// of areas scale exactly.
const EXPONENTS: [i32; 4] = [-90, -40, 40, 98];

fn power(exponent: i32) -> f64 {
    2f64.powi(exponent)
}

fn scaled(mesh: &TriMesh, factor: f64) -> TriMesh {
    mesh.with_positions(mesh.positions().iter().map(|p| p.map(|x| factor * x)).collect()).unwrap()
}

fn body() -> TriMesh {
    shapes::bumpy_sphere(2, 0.15, 4.0)
}

/// A square with some relief; its boundary has corners.
fn patch() -> TriMesh {
    let flat = shapes::irregular_plane(0.15, 3);
    let relief = |[x, y, _]: [f64; 3]| [x, y, 0.05 * (7.0 * x).sin() * (5.0 * y).cos()];
    flat.with_positions(flat.positions().iter().map(|&p| relief(p)).collect()).unwrap()
}

fn constraints(boundary: Boundary, soft: f64, unit: f64) -> Constraints {
    let soft = (soft > 0.0).then(|| SoftConstraint {
        vertex: 7,
        target: Some([0.1, 0.2, 1.3].map(|x| unit * x)),
        weight: soft,
    });
    Constraints { boundary, pinned: vec![3, 12], soft: soft.into_iter().collect() }
}

/// Flows with every option that has a unit, for a mesh of this unit.
fn flows(unit: f64) -> Vec<(bool, Method)> {
    let cotangent = |time: f64| Diffusion::Cotangent {
        time: Time::SquaredUnits(time * unit * unit),
        kind: LaplacianKind::Cotangent,
        area: LumpedArea::Mixed,
    };
    let soft = |boundary| constraints(boundary, 0.7, unit);
    let pinned = |boundary| constraints(boundary, 0.0, unit);
    let butterworth = |cutoff: f64, order| {
        let transfer = Transfer::Butterworth { cutoff: cutoff / unit / unit, order };
        Method::LowPass(LowPass { constraints: pinned(Boundary::Free), ..LowPass::new(transfer) })
    };
    let heat = |time: f64| Transfer::Heat(Time::SquaredUnits(time * unit * unit));
    let explicit = |diffusion, constraints, volume| {
        Method::Explicit(Explicit { constraints, volume, ..Explicit::new(diffusion) })
    };
    let implicit = |diffusion, constraints, update, volume| {
        let options = Implicit { constraints, update, volume, ..Implicit::new(diffusion) };
        Method::Implicit(Implicit { iterations: 3, ..options })
    };
    let free = Constraints::default;
    let robust = Diffusion::cotangent(2.0).with_kind(LaplacianKind::Robust);
    let region = |order, kind| {
        Method::FairRegion(FairRegion { order, kind, ..FairRegion::new((20..40).collect()) })
    };
    let closed = vec![
        explicit(Diffusion::uniform(0.5), free(), Volume::Rescaled),
        explicit(cotangent(1e-4), pinned(Boundary::Free), Volume::Drifts),
        implicit(Diffusion::uniform(5.0), pinned(Boundary::Free), Update::Never, Volume::Offset),
        implicit(Diffusion::uniform(50.0), free(), Update::Never, Volume::Drifts),
        implicit(cotangent(0.01), soft(Boundary::Free), Update::Never, Volume::Drifts),
        implicit(cotangent(0.01), pinned(Boundary::Free), Update::Both, Volume::Drifts),
        implicit(robust, free(), Update::Both, Volume::Drifts),
        implicit(cotangent(0.01), free(), Update::Mass, Volume::Rescaled),
        Method::ConformalizedMcf(ConformalizedMcf { iterations: 3, ..Default::default() }),
        Method::Taubin(Taubin::default()),
        Method::LowPass(LowPass::new(heat(0.02))),
        Method::LowPass(LowPass::new(Transfer::Modes(9))),
        butterworth(40.0, 2),
        butterworth(0.5, 3),
        region(2, LaplacianKind::Auto),
        region(3, LaplacianKind::Uniform),
    ];
    let open = vec![
        explicit(Diffusion::uniform(0.5), soft(Boundary::Sliding), Volume::Drifts),
        implicit(cotangent(1e-3), soft(Boundary::Sliding), Update::Never, Volume::Drifts),
        implicit(cotangent(1e-3), soft(Boundary::Pinned), Update::Both, Volume::Drifts),
        Method::Taubin(Taubin { constraints: soft(Boundary::Pinned), ..Taubin::default() }),
        Method::WindowedSinc(WindowedSinc {
            constraints: pinned(Boundary::Pinned),
            ..WindowedSinc::default()
        }),
        Method::Hc(Hc { constraints: soft(Boundary::Pinned), ..Hc::default() }),
        Method::ScaleDependent(ScaleDependent {
            constraints: soft(Boundary::Sliding),
            ..ScaleDependent::default()
        }),
        Method::LowPass(LowPass::new(heat(0.01))),
    ];
    let of = |closed: bool| move |method| (closed, method);
    closed.into_iter().map(of(true)).chain(open.into_iter().map(of(false))).collect()
}

/// A power of two changes no bit of a flow, of the observed meshes and of the report; fixed
/// vertices stay to the last bit.
#[test]
fn flows_do_not_depend_on_the_size() {
    let meshes = [patch(), body()];
    let record = |mesh: &TriMesh, method: &Method, unit: f64, watched: bool| {
        let mut seen: Vec<f64> = vec![];
        let mut observe = |step: &fairing_smoothing::Step<'_>| {
            seen.push(step.largest_displacement() / unit);
            seen.extend(step.positions()[5].map(|x| x / unit));
            ControlFlow::Continue(())
        };
        let smoothed =
            if watched { method.run(mesh, Some(&mut observe)) } else { method.run(mesh, None) };
        let smoothed = smoothed.unwrap_or_else(|e| panic!("{} at {unit:e}: {e}", method.name()));
        (scaled(&smoothed.mesh, 1.0 / unit), smoothed.mesh, smoothed.report, seen)
    };
    let one = flows(1.0);
    let expected: Vec<_> = one
        .iter()
        .map(|(closed, method)| {
            [false, true].map(|watched| record(&meshes[usize::from(*closed)], method, 1.0, watched))
        })
        .collect();
    for exponent in EXPONENTS {
        let unit = power(exponent);
        let large = meshes.clone().map(|mesh| scaled(&mesh, unit));
        for ((closed, method), expected) in flows(unit).iter().zip(&expected) {
            let given = &large[usize::from(*closed)];
            for (watched, (mesh, _, report, seen)) in [false, true].into_iter().zip(expected) {
                let what = format!("{} 2^{exponent} {watched} {method:?}", method.name());
                let found = record(given, method, unit, watched);
                assert_eq!(found.0.positions(), mesh.positions(), "{what}");
                assert_eq!(&found.3, seen, "{what}");
                let cotangent = report.stable_limit.map(|limit| limit * unit * unit);
                let limit = found.2.stable_limit;
                assert!(limit == report.stable_limit || limit == cotangent, "{what}");
                let mut still = found.2;
                still.stable_limit = report.stable_limit;
                assert_eq!(&still, report, "{what}");
                if format!("{method:?}").contains("pinned: [3, 12]") {
                    for v in [3, 12] {
                        assert_eq!(found.1.positions()[v], given.positions()[v], "{what}");
                    }
                }
            }
        }
    }
}

/// Limits, errors and the last good mesh are in mesh units.
#[test]
fn limits_and_errors_are_in_mesh_units() {
    let mesh = body();
    let limit = |mesh: &TriMesh| stable_limit(mesh, Diffusion::cotangent(1.0)).unwrap();
    let reach = |mesh: &TriMesh| largest_eigenvalue(mesh, Diffusion::cotangent(1.0)).unwrap();
    let uniform = |mesh: &TriMesh| largest_eigenvalue(mesh, Diffusion::uniform(1.0)).unwrap();
    for exponent in EXPONENTS {
        let unit = power(exponent);
        let other = scaled(&mesh, unit);
        assert_eq!(limit(&other), limit(&mesh) * unit * unit, "2^{exponent}");
        assert_eq!(reach(&other), reach(&mesh) / unit / unit, "2^{exponent}");
        assert_eq!(uniform(&other), uniform(&mesh), "2^{exponent}");
        let far = Explicit::new(Diffusion::cotangent(10.0));
        let refused = |mesh: &TriMesh| -> FlowError { explicit(mesh, &far, None).unwrap_err() };
        let (there, here) = (refused(&other), refused(&mesh));
        let (
            FlowFailure::Unstable { step: a, limit: b },
            FlowFailure::Unstable { step: c, limit: d },
        ) = (&there.failure, &here.failure)
        else {
            panic!("{there} {here}")
        };
        assert_eq!((*a, *b), (c * unit * unit, d * unit * unit));
        assert_eq!(there.last_good.positions(), other.positions());
        let steps = Explicit { stability: Stability::Allow, iterations: 2000, ..far.clone() };
        let error = explicit(&other, &steps, None).unwrap_err();
        assert!(matches!(error.failure, FlowFailure::Mesh(BuildError::Extent { .. })), "{error}");
        assert!(error.iteration >= 1, "{error}");
        // A face without area is named with its size in mesh units.
        let mut flat = other.positions().to_vec();
        let [a, b, c] = other.faces()[11].map(|v| v as usize);
        flat[c] = [0, 1, 2].map(|k| 0.5 * flat[a][k] + 0.5 * flat[b][k]);
        let flat = other.with_positions(flat).unwrap();
        let step = Diffusion::cotangent(0.1).with_kind(LaplacianKind::Cotangent);
        let error = explicit(&flat, &Explicit::new(step), None).unwrap_err();
        let expected = fairing_operators::cotan_stiffness(&flat).unwrap_err();
        assert_eq!(error.failure, FlowFailure::Operator(expected));
    }
}

/// A vertex without faces stays, and its position affects nothing else.
#[test]
fn far_vertices_without_faces_change_nothing() {
    let mesh = body();
    let with = |x: f64| {
        let mut positions = mesh.positions().to_vec();
        positions.push([x, -x, 0.5 * x]);
        TriMesh::new(positions, mesh.faces().to_vec()).unwrap()
    };
    for (closed, method) in flows(1.0) {
        if !closed || matches!(method, Method::ConformalizedMcf(_)) {
            continue;
        }
        let volume = format!("{method:?}").contains("volume: Rescaled");
        let near = method.run(&with(0.0), None).unwrap().mesh;
        for far in [1e10, 1e29] {
            let given = with(far);
            let after = method.run(&given, None).unwrap_or_else(|e| panic!("{method:?}: {e}")).mesh;
            let n = mesh.vertex_count();
            if !volume {
                assert_eq!(after.positions()[n], given.positions()[n], "{method:?}");
            }
            let apart = near.positions()[..n].iter().zip(&after.positions()[..n]);
            let apart = apart.map(|(&p, &q)| DVec3::from(p).distance(q.into())).fold(0.0, f64::max);
            assert!(apart < 1e-9, "{} {far:e}: {apart:e} {method:?}", method.name());
        }
    }
}
