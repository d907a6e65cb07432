//! Mean curvature flow of spheres, and limits of implicit steps.

use super::*;
use fairing_evaluation::observed_orders;
use fairing_smoothing::Update;

/// Under mean curvature flow `∂x/∂t = Δx = −2Hn` a sphere stays a sphere and `r(t) = √(r₀² − 4t)`.
/// Halving the edge length quarters the error in space; quartering the step as well quarters the
/// error in time.
#[test]
fn a_sphere_shrinks_as_theory_has_it_with_second_order_in_space() {
    let end = 0.1;
    let (mut h, mut error) = (vec![], vec![]);
    for level in 2..=4 {
        let sphere = shapes::icosphere(level);
        let steps = 10 << (2 * (level - 2));
        let options = Implicit {
            iterations: steps,
            update: Update::Both,
            tolerance: 1e-11,
            ..Implicit::new(Diffusion::Cotangent {
                time: Time::SquaredUnits(end / steps as f64),
                kind: fairing_operators::LaplacianKind::Auto,
                area: fairing_operators::LumpedArea::Barycentric,
            })
        };
        let shrunk = implicit(&sphere, &options, None).unwrap().mesh;
        let exact = (1.0f64 - 4.0 * end).sqrt();
        h.push(sphere.mean_edge_length());
        error.push((mean_radius(&shrunk) - exact).abs());
    }
    for order in observed_orders(&h, &error) {
        // The theoretical order is two; the coarsest level has only ten time steps.
        assert!((1.8..2.2).contains(&order), "{order}, {error:?}");
    }
}

/// The same sphere at one resolution: backward Euler is of first order in time. Comparison with a
/// run of much shorter steps removes the error in space.
#[test]
fn backward_euler_is_of_first_order_in_time() {
    let sphere = shapes::icosphere(3);
    let radius = |steps: usize| {
        let options = Implicit {
            iterations: steps,
            update: Update::Both,
            tolerance: 1e-12,
            ..Implicit::new(Diffusion::Cotangent {
                time: Time::SquaredUnits(0.1 / steps as f64),
                kind: fairing_operators::LaplacianKind::Auto,
                area: fairing_operators::LumpedArea::Barycentric,
            })
        };
        mean_radius(&implicit(&sphere, &options, None).unwrap().mesh)
    };
    let limit = radius(640);
    let steps = [5usize, 10, 20, 40];
    let h: Vec<f64> = steps.iter().map(|&s| 1.0 / s as f64).collect();
    let error: Vec<f64> = steps.iter().map(|&s| (radius(s) - limit).abs()).collect();
    for order in observed_orders(&h, &error) {
        // The theoretical order is one; the reference itself has 1/64 of the error of ten steps.
        assert!((0.9..1.1).contains(&order), "{order}, {error:?}");
    }
}

/// λ → ∞ collapses a mesh to its centroid weighted by degree: only the constant mode remains.
#[test]
fn an_endless_uniform_step_collapses_to_the_centroid_by_degree() {
    let mesh = shapes::bumpy_sphere(2, 0.3, 4.0);
    let options = Implicit { iterations: 1, ..Implicit::new(Diffusion::uniform(1e8)) };
    let collapsed = implicit(&mesh, &options, None).unwrap().mesh;
    let topology = mesh.topology();
    let mut centre = [0.0; 3];
    let mut total = 0.0;
    for (v, p) in mesh.positions().iter().enumerate() {
        let degree = topology.neighbors(v as u32).len() as f64;
        total += degree;
        for k in 0..3 {
            centre[k] += degree * p[k];
        }
    }
    for &p in collapsed.positions() {
        let off = distance(p, centre.map(|c| c / total));
        // The smoothest mode has μ ≈ −0.02, so 5e-7 of it remains; rounding is 1e-16 times 1e8.
        assert!(off < 2e-6 * mesh.diagonal(), "{off:e}");
    }
}

/// A noisy open patch where some faces degenerate after a few steps while the surface stays sound:
/// the flow continues and counts them. If none degenerates, the count is zero.
#[test]
fn faces_that_degenerate_do_not_end_the_flow() {
    let plane = shapes::plane(24, 24, shapes::Diagonals::Alternating);
    let noisy = plane.positions().iter().enumerate().map(|(v, p)| {
        // Irregular numbers in [−1, 1].
        let noise = |k: usize| (((3 * v + k) as f64 * 12.9898).sin() * 43_758.545_3).fract();
        [0, 1, 2].map(|k| 24.0 * p[k] + 0.7 * noise(k))
    });
    let mesh = plane.with_positions(noisy.collect()).unwrap();
    for lambda in [0.5, 1.0] {
        let options = Implicit { iterations: 9, ..Implicit::mean_curvature_flow(lambda) };
        let smoothed = implicit(&mesh, &options, None).unwrap();
        let count = smoothed.report.degenerate_faces;
        assert!(count > 0 && count < mesh.face_count() / 10, "λ = {lambda}: {count}");
        assert!(smoothed.mesh.area() > 1e-3 * mesh.area(), "{}", smoothed.mesh.area());
        assert!(smoothed.report.worst_residual.unwrap() <= 1e-8);
    }
    let short = Implicit { iterations: 2, ..Implicit::mean_curvature_flow(0.5) };
    assert_eq!(implicit(&mesh, &short, None).unwrap().report.degenerate_faces, 0);
}

/// A vertex drawn onto the line through two fixed neighbours keeps faces flat in every step: each
/// face counts once for any number of steps.
#[test]
fn a_face_that_stays_degenerate_counts_once() {
    let mesh = shapes::plane(6, 6, shapes::Diagonals::Alternating);
    let middle = (0..mesh.face_count())
        .find(|&f| {
            let boundary = mesh.topology().boundary_vertices();
            mesh.faces()[f].iter().all(|&v| !boundary[v as usize])
        })
        .unwrap();
    let [v, a, b] = mesh.faces()[middle];
    let p = mesh.positions();
    let target = [0, 1, 2].map(|k| 0.5 * (p[a as usize][k] + p[b as usize][k]));
    // Within 10⁻¹³ of the line; a face is too thin below 10⁻¹⁰.
    let soft = vec![SoftConstraint { vertex: v, target: Some(target), weight: 1e13 }];
    let pinned = vec![a, b];
    let constraints = Constraints { boundary: Boundary::Pinned, pinned, soft };
    let mut drawn = p.to_vec();
    drawn[v as usize] = target;
    let drawn = mesh.with_positions(drawn).unwrap();
    let flat = (0..mesh.face_count()).filter(|&f| drawn.face_area(f) < 1e-12).count();
    assert!((1..4).contains(&flat), "{flat}");
    for iterations in [2, 3, 6] {
        let options = Implicit {
            iterations,
            constraints: constraints.clone(),
            ..Implicit::mean_curvature_flow(0.1)
        };
        let report = implicit(&mesh, &options, None).unwrap().report;
        assert_eq!((report.iterations, report.degenerate_faces), (iterations, flat));
    }
}
