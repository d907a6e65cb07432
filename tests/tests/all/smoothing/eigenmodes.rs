//! Modes are multiplied by exactly their theoretical factors.

use super::*;

/// x is −1 at one pole of an axis and +1 at the other (μ = −1); two poles against two others have μ
/// = −3/2.
const ODD: [f64; 6] = [1.0, -1.0, 0.0, 0.0, 0.0, 0.0];
const EVEN: [f64; 6] = [1.0, 1.0, -1.0, -1.0, 0.0, 0.0];

/// An octahedron whose coordinates are two modes and a constant: not a geometry, but valid input of
/// a flow.
fn modes() -> TriMesh {
    octahedron((0..6).map(|v| [ODD[v], EVEN[v], 7.0]).collect())
}

fn factors(before: &TriMesh, after: &TriMesh) -> [f64; 2] {
    for (v, (p, q)) in before.positions().iter().zip(after.positions()).enumerate() {
        assert!((q[2] - p[2]).abs() < 1e-12, "the constant moved at vertex {v}");
    }
    [after.positions()[0][0], after.positions()[0][1]]
}

#[test]
fn explicit_steps_multiply_by_one_plus_lambda_mu() {
    let mesh = modes();
    for lambda in [0.01, 0.05, 0.5, 1.0, 4.0 / 3.0] {
        let options = Explicit { iterations: 3, ..Explicit::new(Diffusion::uniform(lambda)) };
        let [odd, even] = factors(&mesh, &explicit(&mesh, &options, None).unwrap().mesh);
        // A few roundings of numbers near one; 1e-10 if the run is a series.
        assert!((odd - (1.0 - lambda).powi(3)).abs() < 2e-10, "λ = {lambda}: {odd}");
        assert!((even - (1.0 - 1.5 * lambda).powi(3)).abs() < 2e-10, "λ = {lambda}: {even}");
    }
}

#[test]
fn implicit_steps_divide_by_one_minus_lambda_mu() {
    let mesh = modes();
    for lambda in [0.01, 0.1, 5.0, 100.0] {
        let options = Implicit { iterations: 2, ..Implicit::new(Diffusion::uniform(lambda)) };
        let [odd, even] = factors(&mesh, &implicit(&mesh, &options, None).unwrap().mesh);
        assert!((odd - (1.0 + lambda).powi(-2)).abs() < 2e-10, "λ = {lambda}: {odd}");
        assert!((even - (1.0 + 1.5 * lambda).powi(-2)).abs() < 2e-10, "λ = {lambda}: {even}");
    }
}

/// The series of an unobserved run and the steps of an observed one give the same mesh.
#[test]
fn a_series_and_its_steps_agree() {
    let mesh = shapes::bumpy_sphere(4, 0.2, 5.0);
    let scale = mesh.diagonal();
    for diffusion in [Diffusion::uniform(0.4), Diffusion::cotangent(0.1)] {
        let options = Explicit { iterations: 60, ..Explicit::new(diffusion) };
        let at_once = explicit(&mesh, &options, None).unwrap();
        assert!(matches!(at_once.report.approach, Approach::Series { .. }));
        let steps = explicit(&mesh, &options, Some(&mut |_| ControlFlow::Continue(()))).unwrap();
        assert_eq!(steps.report.approach, Approach::Stepping);
        let apart = largest_distance(&at_once.mesh, &steps.mesh);
        assert!(apart < 1e-9 * scale, "{diffusion:?}: {apart:e}");
    }
    for diffusion in
        [Diffusion::uniform(5.0), Diffusion::cotangent(5.0), Diffusion::cotangent(100.0)]
    {
        let options = Implicit { tolerance: 1e-11, ..Implicit::new(diffusion) };
        let at_once = implicit(&mesh, &options, None).unwrap();
        let steps = implicit(&mesh, &options, Some(&mut |_| ControlFlow::Continue(()))).unwrap();
        let apart = largest_distance(&at_once.mesh, &steps.mesh);
        // Ten solves to 1e-11 of systems with condition numbers below 1000.
        assert!(apart < 1e-8 * scale, "{diffusion:?}: {apart:e}");
    }
}

#[test]
fn the_octahedron_attains_the_bound_and_four_thirds_is_stable() {
    let mesh = modes();
    let run = |lambda| {
        let options = Explicit { iterations: 200, ..Explicit::new(Diffusion::uniform(lambda)) };
        explicit(&mesh, &options, None)
    };
    let [_, even] = factors(&mesh, &run(4.0 / 3.0).unwrap().mesh);
    // |1 − (4/3)(3/2)| = 1: after two hundred alternating steps the mode has its first value.
    assert!((even - 1.0).abs() < 1e-12, "{even}");
    let error = run(1.34).unwrap_err();
    assert!(matches!(error.failure, FlowFailure::Unstable { limit, .. } if limit == 4.0 / 3.0));
    assert_eq!(*error.last_good, mesh);
}

/// Two triangles at an edge have μ = −5/3: steps between 8/7, which is safe for open meshes, and
/// 4/3, the bound for closed ones, can make a mesh grow.
#[test]
fn open_meshes_have_a_lower_limit() {
    // The mode is 1 at the outer corners and −2/3 at the inner ones.
    let x = [1.0, -2.0 / 3.0, -2.0 / 3.0, 1.0].map(|z| [z, 0.0, 0.0]);
    let pair = TriMesh::new(x.to_vec(), vec![[0, 1, 2], [3, 2, 1]]).unwrap();
    let run = |lambda, stability| {
        let options =
            Explicit { iterations: 21, stability, ..Explicit::new(Diffusion::uniform(lambda)) };
        explicit(&pair, &options, None)
    };
    let error = run(1.25, Stability::Refuse).unwrap_err();
    assert!(matches!(error.failure, FlowFailure::Unstable { limit, .. } if limit == 8.0 / 7.0));
    let grown = run(1.25, Stability::Warn).unwrap();
    assert!(grown.report.unstable);
    for (lambda, smoothed) in
        [(1.25, grown), (8.0 / 7.0, run(8.0 / 7.0, Stability::Refuse).unwrap())]
    {
        let factor: f64 = 1.0 - lambda * 5.0 / 3.0;
        let found = smoothed.mesh.positions()[0][0];
        // Twenty-one products of numbers near one; 1e-10 if the run is a series.
        assert!((found - factor.powi(21)).abs() < 2e-10, "λ = {lambda}: {found}");
    }
}

#[test]
fn lambda_two_diverges_on_every_mesh_and_can_be_had() {
    let open = shapes::plane(6, 6, shapes::Diagonals::Alternating);
    for mesh in [shapes::icosphere(2), shapes::torus(2.0, 0.7, 12, 8), open] {
        let options = Explicit {
            iterations: 50,
            stability: Stability::Allow,
            ..Explicit::new(Diffusion::uniform(2.0))
        };
        let noisy = shaken(&mesh);
        let smoothed = explicit(&noisy, &options, None).unwrap();
        assert!(smoothed.report.unstable);
        let growth = smoothed.mesh.diagonal() / mesh.diagonal();
        // |1 + 2μ| with |μ| ≥ n/(n − 1): far above one on these meshes.
        assert!(growth > 1e3, "{growth}");
    }
}

/// Positions with a part of every mode: moved by a fixed pattern of a hundredth of the diagonal.
fn shaken(mesh: &TriMesh) -> TriMesh {
    let size = 0.01 * mesh.diagonal();
    let moved = mesh.positions().iter().enumerate().map(|(v, p)| {
        let phase = v as f64 * 2.399_963;
        [p[0] + size * phase.sin(), p[1] + size * phase.cos(), p[2] + size * (1.7 * phase).sin()]
    });
    mesh.with_positions(moved.collect()).unwrap()
}

/// Steps just below the measured limit stay bounded, steps a tenth above it grow.
#[test]
fn the_measured_cotangent_limit_separates_stable_from_unstable() {
    let mesh = shaken(&shapes::icosphere(3));
    let limit = stable_limit(&mesh, Diffusion::cotangent(1.0)).unwrap();
    let h = mesh.mean_edge_length();
    assert!((0.1..0.4).contains(&(limit / (h * h))), "{}", limit / (h * h));
    let run = |factor: f64| {
        let Diffusion::Cotangent { kind, area, .. } = Diffusion::cotangent(1.0) else {
            unreachable!()
        };
        let options = Explicit {
            iterations: 400,
            stability: Stability::Allow,
            ..Explicit::new(Diffusion::Cotangent {
                time: Time::SquaredUnits(factor * limit),
                kind,
                area,
            })
        };
        explicit(&mesh, &options, None).unwrap().mesh.diagonal() / mesh.diagonal()
    };
    assert!(run(0.99) < 1.0);
    assert!(run(1.1) > 1e3);
}
