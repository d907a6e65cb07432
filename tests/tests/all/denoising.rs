//! Denoisers on generated meshes with seeded noise.

use std::f64::consts::PI;

use fairing_denoising::{
    Approach, AutomaticOptions, Denoiser, FaceKind, GuidedNormalOptions, SurfaceKind, automatic,
    update_vertices,
};
use fairing_evaluation::{
    NoiseKind, NoiseLevel, ScanOptions, SurfaceTree, add_noise, drift, flipped_faces, normal_error,
    scan,
};
use fairing_mesh::TriMesh;
use fairing_shapes as shapes;
use glam::DVec3;

fn noisy(mesh: &TriMesh, share: f64) -> TriMesh {
    add_noise(mesh, NoiseKind::GaussianAlongNormals, NoiseLevel::EdgeLengths(share), 5).unwrap()
}

fn error(mesh: &TriMesh, truth: &TriMesh) -> f64 {
    normal_error(mesh, truth).unwrap().mean
}

/// A shape with creases: closer than guided filtering, the best published method on it, within a
/// sixth of the noise, and within all limits.
#[test]
fn automatic_restores_a_block_with_creases() {
    let block = shapes::cad_block(0.1);
    for share in [0.1, 0.3, 0.5] {
        let input = noisy(&block, share);
        let result = automatic(&input, &AutomaticOptions::default()).unwrap();
        assert_eq!(result.kind, SurfaceKind::Creased, "{share}");
        let (before, after) = (error(&input, &block), error(&result.mesh, &block));
        assert!(after < 0.15 * before, "{share}: {before} to {after}");
        let guided = error(
            &Denoiser::GuidedNormal(GuidedNormalOptions::DEFAULT).denoise(&input).unwrap(),
            &block,
        );
        assert!(after < guided, "{share}: guided {guided}, automatic {after}");
        let flipped = |m: &TriMesh| flipped_faces(m, &block).unwrap();
        assert!(flipped(&result.mesh) <= flipped(&input).max(5), "{share}");
        assert!(drift(&result.mesh, &block).volume.unwrap().abs() < 0.005, "{share}");
        assert!(result.limit <= 5.5 * result.noise.unwrap().sigma);
        for (p, q) in result.mesh.positions().iter().zip(input.positions()) {
            assert!(DVec3::from(*p).distance((*q).into()) <= result.limit * (1.0 + 1e-12));
        }
    }
}

/// Noise within the surface folds faces over each other. The folds open, and less noise remains
/// than with any published method.
#[test]
fn automatic_opens_folds() {
    let block = shapes::cad_block(0.1);
    for (kind, level) in [
        (NoiseKind::GaussianPerAxis, 0.22),
        (NoiseKind::GaussianAlongDirections, 0.4),
        (NoiseKind::Impulsive { fraction: 0.3 }, 0.6),
    ] {
        let input = add_noise(&block, kind, NoiseLevel::EdgeLengths(level), 5).unwrap();
        let result = automatic(&input, &AutomaticOptions::default()).unwrap();
        assert_eq!(result.kind, SurfaceKind::Creased);
        let (before, after) = (error(&input, &block), error(&result.mesh, &block));
        assert!(after < 0.15 * before, "{kind}: {before} to {after}");
        let flipped = |m: &TriMesh| flipped_faces(m, &block).unwrap();
        let (before, after) = (flipped(&input), flipped(&result.mesh));
        assert!(before > 20 && 10 * after <= before, "{kind}: {before} to {after} flipped");
    }
}

/// Never worse than the noisy mesh, in normals or in positions; no faces flipped unless some were;
/// the volume stays within half a per cent. Closed, open and thin shapes, under every kind of noise
/// at a low and a high level, but those of depth cameras: positions of waves many edges long cannot
/// be recovered. Takes many seconds: harm shows on one shape under one noise, so all pairs run.
#[test]
fn automatic_never_does_harm() {
    let surfaces = [
        shapes::cad_block(0.2),
        shapes::icosphere(3),
        shapes::jittered_plane(24, 16, 0.2, 3),
        shapes::cylinder(1.0, 2.0, 24, 12, shapes::Ends::Open),
    ];
    for (i, truth) in surfaces.iter().enumerate() {
        let waves = |kind: &NoiseKind| {
            matches!(kind, NoiseKind::DepthCamera { .. } | NoiseKind::Fused { .. })
        };
        for (k, kind) in NoiseKind::ALL.into_iter().filter(|kind| !waves(kind)).enumerate() {
            let level = [0.05, 0.3][(i + k) % 2];
            let input = add_noise(truth, kind, NoiseLevel::EdgeLengths(level), 7).unwrap();
            let result = automatic(&input, &AutomaticOptions::default()).unwrap();
            let case = format!("surface {i}, {kind} {level}");
            let (before, after) = (error(&input, truth), error(&result.mesh, truth));
            assert!(after <= before, "{case}: {before}° to {after}°");
            let tree = SurfaceTree::new(truth).unwrap();
            let away = |mesh: &TriMesh| {
                tree.distances(mesh.positions()).iter().map(|d| d * d).sum::<f64>().sqrt()
            };
            let (before, after) = (away(&input), away(&result.mesh));
            assert!(after <= before, "{case}: {before} to {after} away");
            let flipped = |m: &TriMesh| flipped_faces(m, truth).unwrap();
            let (before, after) = (flipped(&input), flipped(&result.mesh));
            assert!(10 * after <= before, "{case}: {before} to {after} flipped");
            if let Some(volume) = drift(&result.mesh, &input).volume {
                assert!(volume.abs() < 0.005, "{case}: volume {volume}");
            }
            let shares: f64 = FaceKind::ALL.iter().map(|&k| result.fraction(k)).sum();
            assert!((shares - 1.0).abs() < 1e-12, "{case}: {shares}");
        }
    }
}

/// The scan of a block by a depth camera: the noise is seen to be correlated, a third of the error
/// is left at most, less than by six published methods at their defaults, and no vertex passes the
/// limit. Half the strength leaves more of the noise, and halves the limit. Independent noise on
/// the same scan is not correlated.
#[test]
fn noise_of_a_depth_camera_is_found_and_removed() {
    let camera = Some([3.0, 2.5, 5.0]);
    let seen = scan(
        &shapes::cad_block(0.1),
        &ScanOptions { camera, size: [110, 82], ..Default::default() },
    )
    .unwrap();
    let level = NoiseLevel::EdgeLengths(0.4);
    let kind = NoiseKind::DepthCamera { camera, length: 5.0 };
    let input = add_noise(&seen.mesh, kind, level, 4).unwrap();
    let result = automatic(&input, &AutomaticOptions::default()).unwrap();
    let noise = result.noise.unwrap();
    assert!(noise.correlation_length >= 4.0 && noise.wide_sigma > 1.5 * noise.sigma, "{noise:?}");
    assert_eq!(result.approach, Some(Approach::TotalGeneralisedVariation));
    let (before, after) = (error(&input, &seen.mesh), error(&result.mesh, &seen.mesh));
    assert!(after < before / 3.0, "{before}° to {after}°");
    for name in [
        "bilateral-normal",
        "guided-normal",
        "l0",
        "total-variation",
        "total-generalised-variation",
        "fast-effective",
    ] {
        let other = Denoiser::by_name(name).unwrap().denoise(&input).unwrap();
        let other = error(&other, &seen.mesh);
        assert!(after < other, "{name}: {other}°, automatic {after}°");
    }
    for (p, q) in result.mesh.positions().iter().zip(input.positions()) {
        assert!(DVec3::from(*p).distance((*q).into()) <= result.limit * (1.0 + 1e-12));
    }
    let half = automatic(&input, &AutomaticOptions { strength: 0.5 }).unwrap();
    assert_eq!((half.approach, half.noise), (result.approach, result.noise));
    assert!((half.limit / result.limit - 0.5).abs() < 1e-12, "{} {}", half.limit, result.limit);
    let rough = error(&half.mesh, &seen.mesh);
    assert!(rough > 1.2 * after, "{rough}°, at full strength {after}°");
    let independent = noisy(&seen.mesh, 0.3);
    let result = automatic(&independent, &AutomaticOptions::default()).unwrap();
    let noise = result.noise.unwrap();
    assert_eq!((noise.correlation_length, noise.wide_sigma), (0.0, noise.sigma));
    assert_eq!(result.approach, Some(Approach::Networks));
}

/// The smooth waves of fused views on the scan of a block, without and with weak independent noise:
/// half of the error is left at most. Bumps of a clean scan hardly change.
#[test]
fn waves_of_fused_views_are_removed() {
    let options =
        ScanOptions { camera: Some([3.0, 2.5, 5.0]), size: [110, 82], ..Default::default() };
    let seen = scan(&shapes::cad_block(0.1), &options).unwrap().mesh;
    let waves = NoiseKind::Fused { length: 8.0 };
    let input = add_noise(&seen, waves, NoiseLevel::EdgeLengths(0.5), 4).unwrap();
    for fine in [0.0, 0.003] {
        let result = automatic(&noisy(&input, fine), &AutomaticOptions::default()).unwrap();
        assert_eq!(result.approach, Some(Approach::Networks));
        let (before, after) = (error(&input, &seen), error(&result.mesh, &seen));
        assert!(after < 0.5 * before, "{fine}: {before}° to {after}°");
    }
    let bumpy = scan(&shapes::bumpy_sphere(5, 0.05, 12.0), &options).unwrap().mesh;
    let result = automatic(&bumpy, &AutomaticOptions::default()).unwrap();
    let change = error(&result.mesh, &bumpy);
    assert!(change < 1.5, "{change}°");
}

/// The same waves on a closed block are taken for relief, and most of them stay; a ball with fine
/// bumps, closed as well, hardly changes.
#[test]
fn waves_of_fused_views_do_no_harm_on_closed_models() {
    let block = shapes::cad_block(0.07);
    let waves = NoiseKind::Fused { length: 8.0 };
    let input = add_noise(&block, waves, NoiseLevel::EdgeLengths(0.5), 4).unwrap();
    let result = automatic(&input, &AutomaticOptions::default()).unwrap();
    let (before, after) = (error(&input, &block), error(&result.mesh, &block));
    assert!(after < before, "{before}° to {after}°");
    let bumpy = shapes::bumpy_sphere(5, 0.05, 12.0);
    let result = automatic(&noisy(&bumpy, 0.003), &AutomaticOptions::default()).unwrap();
    let change = error(&result.mesh, &bumpy);
    assert!(change < 0.8, "{change}°");
}

/// Waves of a sheet without noise, or with little, are its shape, and stay.
#[test]
fn waves_of_a_sheet_stay() {
    let waves = |[x, y, _]: [f64; 3]| [x, y, 0.05 * (6.0 * PI * x).sin() * (4.0 * PI * y).cos()];
    let flat = shapes::plane(29, 29, shapes::Diagonals::Alternating);
    let sheet = flat.with_positions(flat.positions().iter().map(|&p| waves(p)).collect()).unwrap();
    for share in [0.0, 0.003, 0.03] {
        let input = noisy(&sheet, share);
        let result = automatic(&input, &AutomaticOptions::default()).unwrap();
        let change = error(&result.mesh, &sheet);
        assert!(change < 4.0, "{share}: {change}°");
    }
}

/// A few vertices that fly away are put back and counted, whether the others are noisy or not, also
/// where they are fewer than one in a hundred.
#[test]
fn spikes_are_put_back_and_counted() {
    let truth = shapes::icosphere(4);
    let h = truth.mean_edge_length();
    for (level, most) in [(0.0, 0.5), (0.2, 1.5)] {
        let input = noisy(&truth, level);
        let alone = automatic(&input, &AutomaticOptions::default()).unwrap();
        let mut positions = input.positions().to_vec();
        let far: Vec<usize> = (0..truth.vertex_count()).step_by(211).collect();
        for (k, &v) in far.iter().enumerate() {
            positions[v][k % 3] += 8.0 * h;
        }
        let spiky = input.with_positions(positions).unwrap();
        let result = automatic(&spiky, &AutomaticOptions::default()).unwrap();
        assert_eq!((alone.spikes, result.spikes), (0, far.len()), "{level}");
        let (without, with) = (error(&alone.mesh, &truth), error(&result.mesh, &truth));
        assert!(with < without + most, "{level}: {without}°, {with}°");
        assert!(result.limit > 7.0 * h, "{level}: {}", result.limit / h);
    }
}

/// A strength below one leaves more of the noise; zero is no strength.
#[test]
fn strength_scales_the_estimate() {
    let sphere = shapes::icosphere(3);
    let input = noisy(&sphere, 0.3);
    let moved = |strength| automatic(&input, &AutomaticOptions { strength });
    let rough = |strength| error(&moved(strength).unwrap().mesh, &sphere);
    assert!(rough(0.2) > 1.5 * rough(1.0), "{} {}", rough(0.2), rough(1.0));
    assert_eq!(moved(2.0).unwrap().noise, moved(1.0).unwrap().noise);
    let refused = moved(0.0).unwrap_err().to_string();
    assert!(refused.contains("strength is 0"), "{refused}");
}

/// Without noise nothing moves, to the last bit; a noisy sheet becomes flat.
#[test]
fn automatic_keeps_planes_and_clean_meshes() {
    for clean in [
        shapes::plane(20, 20, shapes::Diagonals::Alternating),
        shapes::jittered_plane(20, 20, 0.2, 1),
        shapes::cube(20, shapes::Diagonals::Regular),
    ] {
        let result = automatic(&clean, &AutomaticOptions::default()).unwrap();
        assert_eq!((result.kind, result.approach), (SurfaceKind::Clean, None));
        assert_eq!(result.mesh.positions(), clean.positions());
    }
    let sheet = shapes::jittered_plane(30, 30, 0.2, 2);
    let result = automatic(&noisy(&sheet, 0.3), &AutomaticOptions::default()).unwrap();
    assert_eq!(result.kind, SurfaceKind::Smooth);
    // A fiftieth of the noise, which is 21°.
    let after = error(&result.mesh, &sheet);
    assert!(after < 0.6, "{after}");
}

#[test]
fn automatic_smooths_a_sphere_and_a_torus() {
    for truth in [shapes::icosphere(4), shapes::torus(1.0, 0.4, 96, 40)] {
        let input = noisy(&truth, 0.3);
        let result = automatic(&input, &AutomaticOptions::default()).unwrap();
        let (before, after) = (error(&input, &truth), error(&result.mesh, &truth));
        assert!(after < 0.2 * before, "{before} to {after}");
        // A flow that smooths this much shrinks both by several per cent.
        assert!(drift(&result.mesh, &truth).volume.unwrap().abs() < 0.005);
    }
}

/// Every method removes noise of 0.3 h from the block. Published tables at this level leave half
/// for vertex filters, and far less for normal filters.
#[test]
fn every_denoiser_helps() {
    let block = shapes::cad_block(0.15);
    let input = noisy(&block, 0.3);
    let before = error(&input, &block);
    for denoiser in Denoiser::all() {
        let after = error(&denoiser.denoise(&input).unwrap(), &block);
        assert!(after < 0.75 * before, "{denoiser}: {before} to {after}");
    }
}

/// Scaling and moving the input scales and moves the output. Thresholds on noisy normals amplify
/// rounding, so a few faces may be decided differently: the bound is on the mean distance. (A power
/// of two scales without rounding.)
#[test]
fn denoisers_move_with_the_mesh() {
    let input = noisy(&shapes::cad_block(0.2), 0.3);
    let h = input.mean_edge_length();
    let motions: [fn([f64; 3]) -> [f64; 3]; 2] = [
        |[x, y, z]| [8.0 * y + 3.0, -8.0 * x, 8.0 * z - 1.0],
        |[x, y, z]| [1000.0 * z, 1000.0 * x + 1e6, 1000.0 * y],
    ];
    for (motion, size) in motions.into_iter().zip([8.0, 1000.0]) {
        let moved = input.positions().iter().map(|&p| motion(p)).collect();
        let moved = input.with_positions(moved).unwrap();
        for denoiser in Denoiser::all() {
            let plain = denoiser.denoise(&input).unwrap();
            let other = denoiser.denoise(&moved).unwrap();
            let total: f64 = (plain.positions().iter().zip(other.positions()))
                .map(|(&p, &q)| DVec3::from(motion(p)).distance(q.into()) / (size * h))
                .sum();
            let mean = total / input.vertex_count() as f64;
            assert!(mean < 2e-3, "{denoiser}: {mean}");
        }
    }
}

/// Renumbering vertices and faces, and rotating the corners of a face, renumbers the output. Sums
/// in another order round differently, as above.
#[test]
fn denoisers_do_not_depend_on_the_numbering() {
    let input = noisy(&shapes::cad_block(0.2), 0.3);
    let (n, h) = (input.vertex_count(), input.mean_edge_length());
    let step = (n / 3..).find(|s| gcd(*s, n) == 1).unwrap();
    let new = |v: usize| (v * step + 5) % n;
    let mut positions = vec![[0.0; 3]; n];
    for (v, p) in input.positions().iter().enumerate() {
        positions[new(v)] = *p;
    }
    let renumbered = |[a, b, c]: [u32; 3]| [b, c, a].map(|v| new(v as usize) as u32);
    let faces = input.faces().iter().rev().map(|f| renumbered(*f)).collect();
    let other = TriMesh::new(positions, faces).unwrap();
    for denoiser in Denoiser::all() {
        let (a, b) = (denoiser.denoise(&input).unwrap(), denoiser.denoise(&other).unwrap());
        let total: f64 = (0..n)
            .map(|v| DVec3::from(a.positions()[v]).distance(b.positions()[new(v)].into()) / h)
            .sum();
        assert!(total / (n as f64) < 2e-3, "{denoiser}: {}", total / n as f64);
    }
}

fn gcd(a: usize, b: usize) -> usize {
    if b == 0 { a } else { gcd(b, a % b) }
}

#[test]
fn denoisers_do_not_depend_on_the_threads() {
    let input = noisy(&shapes::cad_block(0.2), 0.4);
    let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let (single, several) = (pool(1), pool(3));
    for denoiser in Denoiser::all() {
        let one = single.install(|| denoiser.denoise(&input).unwrap());
        let three = several.install(|| denoiser.denoise(&input).unwrap());
        assert!(one.positions() == three.positions(), "{denoiser}");
    }
    let sphere = noisy(&shapes::icosphere(3), 0.3);
    let one = single.install(|| automatic(&sphere, &AutomaticOptions::default()).unwrap().mesh);
    let three = several.install(|| automatic(&sphere, &AutomaticOptions::default()).unwrap().mesh);
    assert!(one.positions() == three.positions());
}

/// Bad input gives a mesh with finite positions or a clear error, never a panic. `TriMesh` itself
/// refuses coordinates that are not finite.
#[test]
fn denoisers_survive_bad_input() {
    let open = noisy(&shapes::jittered_plane(20, 15, 0.2, 3), 0.2);
    let lost = noisy(&shapes::icosphere(2), 20.0);
    let fan = TriMesh::new(
        vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.2], [0.0, 0.0, 1.0]],
        vec![[0, 1, 2], [1, 0, 3], [0, 1, 4]],
    );
    let degenerate = TriMesh::new(vec![[0.0; 3]; 4], vec![[0, 1, 2], [0, 2, 3]]);
    let needle = TriMesh::new(
        vec![[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [9.0, 9.0, 9.0]],
        vec![[0, 1, 2], [0, 1, 3]],
    );
    let empty = TriMesh::new(vec![], vec![]);
    let points = TriMesh::new(vec![[1.0, 2.0, 3.0]; 3], vec![]);
    let meshes = [fan, degenerate, needle, empty, points].map(Result::unwrap);
    for (k, mesh) in meshes.iter().chain([&open, &lost]).enumerate() {
        for denoiser in Denoiser::all() {
            match denoiser.denoise(mesh) {
                Ok(out) => assert_eq!(out.vertex_count(), mesh.vertex_count(), "{k} {denoiser}"),
                Err(error) => assert!(!error.to_string().is_empty(), "{k} {denoiser}"),
            }
        }
    }
}

/// Impulses far above the noise level: the median ignores them, and the system is solved although
/// its weights then span many orders of magnitude.
#[test]
fn impulses_on_a_smooth_body() {
    let sphere = shapes::icosphere(4);
    let kind = NoiseKind::Impulsive { fraction: 0.1 };
    let fine =
        add_noise(&sphere, NoiseKind::GaussianAlongNormals, NoiseLevel::EdgeLengths(0.02), 3);
    let input = add_noise(&fine.unwrap(), kind, NoiseLevel::EdgeLengths(1.0), 4).unwrap();
    let result = automatic(&input, &AutomaticOptions::default()).unwrap();
    assert!(result.noise.unwrap().is_impulsive());
    let (before, after) = (error(&input, &sphere), error(&result.mesh, &sphere));
    assert!(after < 0.3 * before, "{before} to {after}");
}

/// If every face agrees with its normal, no step makes a face oppose it, even for normals of a
/// crumpled surface.
#[test]
fn vertex_updates_do_not_flip_faces() {
    let plane = shapes::jittered_plane(20, 20, 0.2, 8);
    let input = noisy(&plane, 0.1);
    let truth: Vec<[f64; 3]> = vec![[0.0, 0.0, 1.0]; plane.face_count()];
    let tilted: Vec<[f64; 3]> = (0..plane.face_count())
        .map(|f| {
            let (s, c) = (1.2 * (f as f64).sin()).sin_cos();
            [s, 0.0, c]
        })
        .collect();
    let opposing = |mesh: &TriMesh, normals: &[[f64; 3]]| {
        (0..mesh.face_count())
            .filter(|&f| {
                let a = mesh.area_vector(f);
                (0..3).map(|k| a[k] * normals[f][k]).sum::<f64>() < 0.0
            })
            .count()
    };
    for normals in [&truth, &tilted] {
        let before = opposing(&input, normals);
        let after = opposing(&update_vertices(&input, normals, 50).unwrap(), normals);
        // Two vertices that move at once may still flip a face between them.
        assert!(after <= before + plane.face_count() / 100, "{before} to {after}");
    }
}

/// Under noise far above an edge length, faces are needles by chance, but no longer than the noise.
/// This is not a tessellation, which would be left alone.
#[test]
fn noise_does_not_make_a_mesh_uneven() {
    for mesh in [shapes::icosphere(3), shapes::cad_block(0.25)] {
        for noise in [0.1, 0.5, 1.0, 3.0] {
            let level = NoiseLevel::EdgeLengths(noise);
            let noisy = add_noise(&mesh, NoiseKind::GaussianPerAxis, level, 2).unwrap();
            assert_eq!(
                automatic(&noisy, &AutomaticOptions::default()).unwrap().uneven_vertices,
                0,
                "{noise}"
            );
        }
    }
}

/// On shapes that nothing was trained on, the expected error of normals is within a factor of two
/// of the actual one. None is expected where no network ran.
#[test]
fn the_error_left_is_expected() {
    let shapes = [
        ("ellipsoid", shapes::ellipsoid([1.0, 0.8, 0.6], 4)),
        ("helicoid", shapes::helicoid(&shapes::HelicoidOptions::default())),
        ("flower", shapes::flower(0.03, 1)),
    ];
    for (name, truth) in shapes {
        for level in [0.1, 0.3] {
            let result = automatic(&noisy(&truth, level), &AutomaticOptions::default()).unwrap();
            let (actual, expected) = (error(&result.mesh, &truth), result.expected_error.unwrap());
            let ratio = expected / actual;
            assert!((0.5..2.0).contains(&ratio), "{name} {level}: {actual}°, expected {expected}°");
        }
    }
    let clean = automatic(&shapes::cube(20, shapes::Diagonals::Regular), &Default::default());
    assert_eq!(clean.unwrap().expected_error, None);
}
