//! Volume, observers, errors, determinism.

use super::*;

#[test]
fn volume_is_kept_when_asked_for() {
    let mesh = shapes::bumpy_sphere(3, 0.2, 5.0);
    let before = volume(&mesh);
    for policy in [Volume::Rescaled, Volume::Offset] {
        for diffusion in [Diffusion::uniform(5.0), Diffusion::cotangent(5.0)] {
            let options = Implicit { volume: policy, ..Implicit::new(diffusion) };
            let kept = volume(&implicit(&mesh, &options, None).unwrap().mesh);
            assert!((kept / before - 1.0).abs() < 1e-12, "{policy:?}: {kept} of {before}");
        }
    }
    let drifted = implicit(&mesh, &Implicit::new(Diffusion::uniform(5.0)), None).unwrap().mesh;
    assert!(volume(&drifted) < 0.9 * before);
}

/// The origin is arbitrary: a translated mesh is smoothed and rescaled alike.
#[test]
fn rescaling_is_about_the_centroid() {
    let mesh = shapes::bumpy_sphere(3, 0.2, 5.0);
    let by = [10.0, -20.0, 5.0];
    let moved = |m: &TriMesh| {
        let x = m.positions().iter().map(|p| [0, 1, 2].map(|k| p[k] + by[k])).collect();
        m.with_positions(x).unwrap()
    };
    let options = Implicit { volume: Volume::Rescaled, ..Implicit::new(Diffusion::uniform(5.0)) };
    let run = |m: &TriMesh| implicit(m, &options, None).unwrap().mesh;
    // The tolerance of the solver, on coordinates near twenty.
    assert!(largest_distance(&run(&moved(&mesh)), &moved(&run(&mesh))) < 1e-6);
}

#[test]
fn an_offset_leaves_pinned_vertices_where_they_are() {
    let mesh = shapes::bumpy_sphere(3, 0.2, 5.0);
    let constraints = Constraints { pinned: vec![0, 17, 300], ..Constraints::default() };
    let options =
        Explicit { volume: Volume::Offset, constraints, ..Explicit::new(Diffusion::uniform(0.5)) };
    let kept = explicit(&mesh, &options, None).unwrap().mesh;
    for v in [0, 17, 300] {
        assert_eq!(kept.positions()[v], mesh.positions()[v]);
    }
    assert!((volume(&kept) / volume(&mesh) - 1.0).abs() < 1e-12);
}

#[test]
fn volume_of_an_open_mesh_cannot_be_kept() {
    let mesh = shapes::plane(4, 4, shapes::Diagonals::Alternating);
    let options = Explicit { volume: Volume::Offset, ..Explicit::new(Diffusion::uniform(0.5)) };
    let error = explicit(&mesh, &options, None).unwrap_err();
    assert!(matches!(error.failure, FlowFailure::Volume { .. }));
}

/// For a sphere of radius r, `V/V₀ ≈ exp(−3nλh²/(2r²))`: one step moves a vertex by λ times a
/// quarter of the squared edge length over r.
#[test]
fn a_sphere_loses_volume_as_predicted() {
    let mesh = shapes::icosphere(4);
    let h = mesh.mean_edge_length();
    let options = Explicit { iterations: 50, ..Explicit::new(Diffusion::uniform(0.5)) };
    let ratio = volume(&explicit(&mesh, &options, None).unwrap().mesh) / volume(&mesh);
    let predicted = (-3.0 * 50.0 * 0.5 * h * h / 2.0f64).exp();
    // Edge lengths of an icosphere vary by a sixth about their mean, and so do their squares about
    // h².
    assert!((ratio.ln() / predicted.ln() - 1.0).abs() < 0.03, "{ratio} against {predicted}");
}

#[test]
fn an_observer_sees_every_step_and_can_stop() {
    let mesh = shapes::icosphere(2);
    let mut seen = Vec::new();
    let options = Explicit { iterations: 40, ..Explicit::new(Diffusion::uniform(0.5)) };
    let smoothed = explicit(
        &mesh,
        &options,
        Some(&mut |step| {
            assert_eq!(step.step_size(), 0.5);
            let (volume, area) = (step.mesh().signed_volume(), step.mesh().area());
            seen.push((step.iteration(), volume, area));
            if volume < 0.8 * 4.0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        }),
    )
    .unwrap();
    assert!(smoothed.report.stopped);
    assert_eq!(smoothed.report.iterations, seen.len());
    assert!(seen.len() < 40 && seen.len() > 1, "{}", seen.len());
    for (k, pair) in seen.windows(2).enumerate() {
        assert_eq!(pair[0].0, k + 1);
        assert!(pair[1].1 < pair[0].1 && pair[1].2 < pair[0].2);
    }
    assert!((seen.last().unwrap().1 - volume(&smoothed.mesh)).abs() < 1e-12);
}

#[test]
fn a_step_out_of_range_returns_the_last_good_mesh() {
    let mesh = shapes::icosphere(2);
    let mut bent = mesh.positions().to_vec();
    bent[9] = [1.5, 0.3, 0.1];
    let mesh = mesh.with_positions(bent).unwrap();
    let options = Explicit {
        iterations: 100_000,
        stability: Stability::Warn,
        ..Explicit::new(Diffusion::uniform(10.0))
    };
    let error = explicit(&mesh, &options, None).unwrap_err();
    assert!(error.iteration > 10 && error.iteration < 100, "{}", error.iteration);
    let FlowFailure::Mesh(fairing_mesh::BuildError::Extent { extent }) = error.failure else {
        panic!("{:?}", error.failure)
    };
    assert!(extent > 1e30);
    assert!(error.last_good.diagonal() > 1e28);
}

#[test]
fn a_thin_face_is_named_as_in_the_file() {
    let mut positions = shapes::icosphere(2).positions().to_vec();
    let faces = shapes::icosphere(2).faces().to_vec();
    let [a, b, c] = faces[123].map(|v| v as usize);
    positions[c] = [0, 1, 2].map(|k| 0.5 * (positions[a][k] + positions[b][k]));
    let mesh = TriMesh::new(positions, faces).unwrap();
    let step = Diffusion::cotangent(1.0).with_kind(fairing_operators::LaplacianKind::Cotangent);
    let error = implicit(&mesh, &Implicit::new(step), None).unwrap_err();
    let expected = fairing_operators::cotan_stiffness(&mesh).unwrap_err();
    assert_eq!(error.failure, FlowFailure::Operator(expected));
    assert_eq!(*error.last_good, mesh);
    // Uniform weights are not affected.
    assert!(implicit(&mesh, &Implicit::new(Diffusion::uniform(1.0)), None).is_ok());
}

#[test]
fn options_out_of_range_are_errors() {
    let mesh = shapes::icosphere(1);
    for lambda in [-1.0, f64::NAN, f64::INFINITY] {
        let error = explicit(&mesh, &Explicit::new(Diffusion::uniform(lambda)), None).unwrap_err();
        assert!(matches!(error.failure, FlowFailure::Option(_)), "{lambda}");
        let error =
            implicit(&mesh, &Implicit::new(Diffusion::cotangent(lambda)), None).unwrap_err();
        assert!(matches!(error.failure, FlowFailure::Option(_)), "{lambda}");
    }
}

#[test]
fn isolated_vertices_and_empty_meshes_are_no_trouble() {
    let empty = TriMesh::new(vec![], vec![]).unwrap();
    let sphere = shapes::icosphere(1);
    let mut positions = sphere.positions().to_vec();
    positions.insert(0, [9.0, 9.0, 9.0]);
    let faces = sphere.faces().iter().map(|f| f.map(|v| v + 1)).collect();
    let lonely = TriMesh::new(positions, faces).unwrap();
    for mesh in [&empty, &lonely] {
        for diffusion in [Diffusion::uniform(0.5), Diffusion::cotangent(0.01)] {
            let a = explicit(mesh, &Explicit::new(diffusion), None).unwrap().mesh;
            let b = implicit(mesh, &Implicit::new(diffusion), None).unwrap().mesh;
            for m in [a, b] {
                assert_eq!(m.vertex_count(), mesh.vertex_count());
                if m.vertex_count() > 0 {
                    assert!(distance(m.positions()[0], [9.0; 3]) < 1e-12);
                }
            }
        }
    }
}

/// The volume of a closed sheet is rounding only, so nothing can be scaled to it.
#[test]
fn a_volume_of_rounding_cannot_be_kept() {
    let sheet = shapes::jittered_plane(6, 6, 0.2, 1);
    let n = sheet.vertex_count() as u32;
    let border = |v: u32| sheet.topology().is_boundary_vertex(v);
    let back = |f: &[u32; 3]| [f[0], f[2], f[1]].map(|v| if border(v) { v } else { v + n });
    let faces = sheet.faces().iter().copied().chain(sheet.faces().iter().map(back));
    let both = [sheet.positions(), sheet.positions()].concat();
    let pillow = TriMesh::new(both, faces.collect()).unwrap();
    let mut rounded = 0;
    for turn in 0..20 {
        let ((s, c), (t, d)) = (f64::from(turn).sin_cos(), (1.3 * f64::from(turn)).sin_cos());
        let turned = |&[x, y, z]: &[f64; 3]| {
            let [x, y] = [c * x - s * y, s * x + c * y];
            [x + 1.0, d * y - t * z + 7.0, t * y + d * z - 2.0]
        };
        let mesh = pillow.with_positions(pillow.positions().iter().map(turned).collect()).unwrap();
        rounded += usize::from(mesh.signed_volume() != 0.0);
        for volume in [Volume::Rescaled, Volume::Offset] {
            let options = Explicit { volume, ..Explicit::new(Diffusion::uniform(0.5)) };
            let error = explicit(&mesh, &options, None).unwrap_err();
            let reason = "the input encloses no volume";
            assert_eq!((error.iteration, error.failure), (0, FlowFailure::Volume { reason }));
        }
    }
    assert!(rounded > 5, "{rounded}");
}
