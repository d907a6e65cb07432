//! Boundaries, fixed vertices, soft constraints.

use super::*;

fn patch() -> TriMesh {
    let plane = shapes::plane(12, 12, shapes::Diagonals::Alternating);
    let bumped = plane.positions().iter().enumerate().map(|(v, p)| {
        let phase = v as f64 * 2.399_963;
        [p[0] + 0.01 * phase.sin(), p[1] + 0.01 * phase.cos(), p[2]]
    });
    plane.with_positions(bumped.collect()).unwrap()
}

fn boundary_of(mesh: &TriMesh) -> Vec<usize> {
    (0..mesh.vertex_count()).filter(|&v| mesh.topology().boundary_vertices()[v]).collect()
}

fn every_flow(mesh: &TriMesh, constraints: &Constraints) -> Vec<(&'static str, TriMesh)> {
    let mut results = Vec::new();
    for (name, diffusion) in
        [("uniform", Diffusion::uniform(0.5)), ("cotangent", Diffusion::cotangent(0.02))]
    {
        let options = Explicit { constraints: constraints.clone(), ..Explicit::new(diffusion) };
        results.push((name, explicit(mesh, &options, None).unwrap().mesh));
    }
    for (name, diffusion) in [
        ("implicit uniform", Diffusion::uniform(5.0)),
        ("implicit cotangent", Diffusion::cotangent(5.0)),
    ] {
        let options = Implicit { constraints: constraints.clone(), ..Implicit::new(diffusion) };
        results.push((name, implicit(mesh, &options, None).unwrap().mesh));
    }
    results
}

#[test]
fn a_plane_stays_a_plane() {
    for boundary in [Boundary::Free, Boundary::Pinned, Boundary::Sliding] {
        for (name, mesh) in every_flow(&patch(), &Constraints::boundary(boundary)) {
            for p in mesh.positions() {
                assert_eq!(p[2], 0.0, "{name}, {boundary:?}");
            }
        }
    }
}

#[test]
fn a_free_border_moves_inward_and_a_pinned_one_not_at_all() {
    let mesh = patch();
    let area = |m: &TriMesh| (0..m.face_count()).map(|f| m.face_area(f)).sum::<f64>();
    for (name, free) in every_flow(&mesh, &Constraints::default()) {
        assert!(area(&free) < 0.99 * area(&mesh), "{name}");
    }
    for (name, pinned) in every_flow(&mesh, &Constraints::boundary(Boundary::Pinned)) {
        for v in boundary_of(&mesh) {
            assert_eq!(pinned.positions()[v], mesh.positions()[v], "{name}, vertex {v}");
        }
        // In a plane the coordinates are harmonic: cotangents move nothing in the interior.
        let moved = largest_distance(&pinned, &mesh);
        if name.contains("uniform") {
            assert!(moved > 1e-3, "{name}: {moved:e}")
        } else {
            assert!(moved < 1e-9, "{name}: {moved:e}")
        }
    }
}

/// The boundary of a square patch with uneven vertices: they slide along the square, and its
/// corners stay.
#[test]
fn a_sliding_border_keeps_its_curve_and_evens_out() {
    let plane = shapes::plane(8, 8, shapes::Diagonals::Alternating);
    let [low, high] = plane.bounding_box().unwrap();
    let side = high[0] - low[0];
    // Squeezes x towards one side, quadratically: the square stays, the spacing does not.
    let squeezed = plane.positions().iter().map(|p| {
        let s = (p[0] - low[0]) / side;
        [low[0] + side * s * (0.5 + 0.5 * s), p[1], p[2]]
    });
    let mesh = plane.with_positions(squeezed.collect()).unwrap();
    let spread = |m: &TriMesh| {
        let mut x: Vec<f64> = boundary_of(m)
            .into_iter()
            .map(|v| m.positions()[v])
            .filter(|p| (p[1] - low[1]).abs() < 1e-12)
            .map(|p| p[0])
            .collect();
        x.sort_by(f64::total_cmp);
        let gaps: Vec<f64> = x.windows(2).map(|w| w[1] - w[0]).collect();
        assert_eq!(gaps.len(), 8);
        gaps.iter().copied().fold(0.0, f64::max) / gaps.iter().copied().fold(1e9, f64::min)
    };
    let before = spread(&mesh);
    for (name, slid) in every_flow(&mesh, &Constraints::boundary(Boundary::Sliding)) {
        for v in boundary_of(&mesh) {
            let p = slid.positions()[v];
            let off = [p[0] - low[0], high[0] - p[0], p[1] - low[1], high[1] - p[1]];
            let nearest = off.into_iter().fold(f64::MAX, |m, d| m.min(d.abs()));
            assert!(nearest < 1e-12, "{name}: vertex {v} left the square by {nearest:e}");
        }
        if name.contains("uniform") {
            let after = spread(&slid);
            assert!(after < 0.8 * before, "{name}: spacing {before} became {after}");
        }
    }
}

#[test]
fn pinned_sets_stay_and_soft_constraints_pull() {
    let mesh = shapes::icosphere(3);
    let lifted = [0.0, 0.0, 2.0];
    let constraints = Constraints { pinned: vec![5, 17], ..Constraints::default() };
    for (name, smoothed) in every_flow(&mesh, &constraints) {
        for v in [5, 17] {
            assert_eq!(smoothed.positions()[v], mesh.positions()[v], "{name}");
        }
    }
    let mut last = f64::MAX;
    for weight in [0.1, 1.0, 1000.0] {
        let soft = vec![SoftConstraint { vertex: 3, target: Some(lifted), weight }];
        let constraints = Constraints { soft, ..Constraints::default() };
        let options = Implicit { constraints, ..Implicit::new(Diffusion::cotangent(1.0)) };
        let smoothed = implicit(&mesh, &options, None).unwrap().mesh;
        let left = distance(smoothed.positions()[3], lifted);
        assert!(left < last, "weight {weight}: {left} left, {last} with a smaller weight");
        last = left;
    }
    // A ratio of a thousand to one in each of ten steps.
    assert!(last < 0.05, "{last}");
}

#[test]
fn constraints_on_vertices_that_are_not_there_are_errors() {
    let mesh = shapes::icosphere(1);
    let constraints = Constraints { pinned: vec![42], ..Constraints::default() };
    let options = Explicit { constraints, ..Explicit::new(Diffusion::uniform(0.5)) };
    let error = explicit(&mesh, &options, None).unwrap_err();
    assert_eq!(error.failure, FlowFailure::NoSuchVertex { vertex: 42, vertex_count: 42 });
}

/// The later of two soft constraints for one vertex counts, as documented.
#[test]
fn the_later_of_two_soft_constraints_counts() {
    let mesh = patch();
    let [first, later] = [[0.2, 0.3, 1.0], [0.5, 0.1, -2.0]].map(|target| SoftConstraint {
        vertex: 30,
        target: Some(target),
        weight: 3.0,
    });
    let run = |soft: Vec<SoftConstraint>| {
        let constraints = Constraints { soft, ..Constraints::default() };
        let options =
            Implicit { iterations: 1, constraints, ..Implicit::new(Diffusion::uniform(1.0)) };
        implicit(&mesh, &options, None).unwrap().mesh
    };
    assert_eq!(run(vec![first, later]), run(vec![later]));
    assert_ne!(run(vec![first, later]), run(vec![first]));
}
