//! Linear systems: their equations, and agreement of all solvers.

use super::*;
use fairing_operators::{LumpedArea, cotan_stiffness, lumped_mass};
use fairing_smoothing::{LowPass, Smoothed, Transfer, low_pass};

fn watched(mesh: &TriMesh, options: &Implicit) -> Smoothed {
    implicit(mesh, options, Some(&mut |_| ControlFlow::Continue(()))).unwrap()
}

/// One step with soft and fixed vertices satisfies `M(1 + w) x' + t S x' = M (x + w c)` in every
/// free row, assembled here from the operators alone; by conjugate gradients for small λ, by a
/// factorisation for large λ.
#[test]
fn a_constrained_step_solves_its_system() {
    let mesh = shapes::bumpy_sphere(3, 0.2, 5.0);
    let n = mesh.vertex_count();
    let stiffness = cotan_stiffness(&mesh).unwrap();
    let mass = lumped_mass(&mesh, LumpedArea::Barycentric).unwrap();
    let pinned = vec![5, 99, 300];
    let (target, weight) = ([0.3, -0.2, 1.7], 2.5);
    let soft = vec![SoftConstraint { vertex: 17, target: Some(target), weight }];
    let constraints = Constraints { pinned: pinned.clone(), soft, ..Constraints::default() };
    for (lambda, factored) in [(1.0, false), (1000.0, true)] {
        let options = Implicit {
            iterations: 1,
            tolerance: 1e-12,
            constraints: constraints.clone(),
            ..Implicit::new(Diffusion::cotangent(lambda))
        };
        let smoothed = implicit(&mesh, &options, None).unwrap();
        let by_factor = matches!(smoothed.report.approach, Approach::Cholesky { .. });
        assert_eq!(by_factor, factored, "λ = {lambda}: {:?}", smoothed.report.approach);
        let t = lambda * mesh.mean_edge_length().powi(2);
        let (x, y) = (mesh.positions(), smoothed.mesh.positions());
        let size = mass.iter().sum::<f64>();
        for i in 0..n {
            if pinned.contains(&(i as u32)) {
                assert_eq!(x[i], y[i]);
                continue;
            }
            for k in 0..3 {
                let w = if i == 17 { weight } else { 0.0 };
                let s: f64 =
                    stiffness.outer_view(i).unwrap().iter().map(|(j, s)| s * y[j][k]).sum();
                let left = mass[i] * (1.0 + w) * y[i][k] + t * s;
                let right = mass[i] * (x[i][k] + w * target[k]);
                // The tolerance, relative to a norm of M x below the total mass.
                assert!((left - right).abs() < 1e-11 * size, "λ = {lambda}, row {i}");
            }
        }
    }
}

/// Series, conjugate gradients and factorisations of a frozen operator, and of a reassembled one,
/// agree.
#[test]
fn factors_and_iterations_agree() {
    let mesh = shapes::bumpy_sphere(4, 0.2, 5.0);
    let scale = mesh.diagonal();
    for lambda in [5.0, 300.0] {
        let options = Implicit { tolerance: 1e-11, ..Implicit::new(Diffusion::cotangent(lambda)) };
        let at_once = implicit(&mesh, &options, None).unwrap();
        let steps = watched(&mesh, &options);
        let apart = largest_distance(&at_once.mesh, &steps.mesh);
        assert!(apart < 1e-8 * scale, "λ = {lambda}: {apart:e}");
        if lambda == 300.0 {
            assert_eq!(steps.report.approach, Approach::Cholesky { factorisations: 1 });
            assert!(steps.report.worst_residual.unwrap() <= 1e-11);
        }
    }
}

/// Mean curvature flow over a fixed square frame, whose limit is flat: a few long steps, each with
/// a factorisation of its own, agree with the limit of many iterations.
#[test]
fn long_steps_of_mean_curvature_flow_are_factored() {
    let plane = shapes::plane(40, 40, shapes::Diagonals::Alternating);
    let dome = plane.positions().iter().map(|p| {
        let bump = |x: f64| (std::f64::consts::PI * x).sin();
        [p[0], p[1], 0.3 * bump(p[0]) * bump(p[1]) + 0.1 * p[0]]
    });
    let mesh = plane.with_positions(dome.collect()).unwrap();
    let flow = |lambda: f64, iterations| {
        let constraints = Constraints::boundary(Boundary::Pinned);
        let options = Implicit::mean_curvature_flow(lambda);
        watched(&mesh, &Implicit { tolerance: 1e-10, iterations, constraints, ..options })
    };
    let long = flow(2000.0, 6);
    assert_eq!(long.report.approach, Approach::Cholesky { factorisations: 6 });
    let short = flow(0.2, 2);
    assert!(matches!(short.report.approach, Approach::ConjugateGradients { .. }));
    for p in long.mesh.positions() {
        // The tilted plane through the frame; each of six steps of λ = 2000 h² leaves at most 10⁻⁴
        // of the dome.
        assert!((p[2] - 0.1 * p[0]).abs() < 1e-3, "{p:?}");
    }
}

/// With a condition number above one over the tolerance the residual stagnates at rounding, which
/// is no failure: the patch has still become a point.
#[test]
fn endless_steps_end_at_rounding() {
    let plane = shapes::plane(60, 45, shapes::Diagonals::Alternating);
    let rough = plane.positions().iter().enumerate();
    let rough = rough.map(|(v, p)| [p[0] + 7.0, p[1], p[2] + 0.01 * (v as f64 * 2.399_963).sin()]);
    let mesh = plane.with_positions(rough.collect()).unwrap();
    for lambda in [1e6, 1e8, 1e10] {
        let options = Implicit { iterations: 1, ..Implicit::new(Diffusion::uniform(lambda)) };
        let smoothed = implicit(&mesh, &options, None).unwrap();
        assert!(matches!(smoothed.report.approach, Approach::Cholesky { .. }));
        // The smoothest mode of the patch has |μ| ≈ 10⁻³; rounding relative to the distance from
        // the origin is 10⁻¹⁶ λ.
        let left = smoothed.mesh.diagonal() / mesh.diagonal();
        assert!(left < 3e3 / lambda + 1e-14 * lambda, "λ = {lambda}: {left:e}");
    }
}

/// All modes reconstruct the mesh; the first four modes of a sphere, a constant and the
/// coordinates, give nearly a sphere; and the projection is idempotent.
#[test]
fn modes_are_a_projection() {
    let mesh = shapes::bumpy_sphere(2, 0.1, 5.0);
    let modes = |mesh: &TriMesh, k| low_pass(mesh, &LowPass::new(Transfer::Modes(k)));
    let n = mesh.vertex_count();
    let all = modes(&mesh, n).unwrap();
    assert_eq!(all.report.approach, Approach::Modes { count: n });
    assert!(largest_distance(&all.mesh, &mesh) < 1e-9);
    let sphere = modes(&shapes::icosphere(3), 4).unwrap().mesh;
    for p in sphere.positions() {
        // By symmetry the coordinates of an icosphere are modes up to the error of the areas.
        let radius = distance(*p, [0.0; 3]);
        assert!((radius - 1.0).abs() < 0.01, "{radius}");
    }
    let error = modes(&mesh, n + 1).unwrap_err();
    assert!(matches!(error.failure, FlowFailure::Modes(_)), "{:?}", error.failure);
}

/// Rescaling is about the centroid of the volume, so it commutes with translation.
#[test]
fn flows_commute_with_translation() {
    let mesh = shapes::bumpy_sphere(3, 0.2, 5.0);
    let offset = [30.0, -20.0, 7.0];
    let moved = |m: &TriMesh| {
        let shifted = m.positions().iter().map(|p| [0, 1, 2].map(|k| p[k] + offset[k]));
        m.with_positions(shifted.collect()).unwrap()
    };
    for volume in [Volume::Drifts, Volume::Rescaled, Volume::Offset] {
        for diffusion in [Diffusion::uniform(5.0), Diffusion::cotangent(20.0)] {
            let options = Implicit { volume, tolerance: 1e-12, ..Implicit::new(diffusion) };
            let here = moved(&implicit(&mesh, &options, None).unwrap().mesh);
            let there = implicit(&moved(&mesh), &options, None).unwrap().mesh;
            // Rounding of coordinates near 40, and the tolerance of 1e-10 of series.
            let apart = largest_distance(&here, &there);
            assert!(apart < 1e-9, "{volume:?}, {diffusion:?}: {apart:e}");
        }
    }
}
