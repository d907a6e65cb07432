//! Coordinates of very different size, far from the origin, sheets without volume, pairs that
//! amplify, wide regions.

use super::*;
use fairing_operators::{LaplacianKind, LumpedArea};
use fairing_smoothing::{FairRegion, FlowError, Smoothed, Taubin, fair_region, taubin};

/// A patch with bumps of this height.
fn bumps(height: f64) -> TriMesh {
    let plane = shapes::plane(24, 24, shapes::Diagonals::Alternating);
    let bumpy = plane.positions().iter().map(|p| {
        let wave = |x: f64| (2.0 * std::f64::consts::PI * x).sin();
        [p[0], p[1], height * (wave(p[0]) * wave(p[1]) + 0.3 * wave(7.0 * p[0] + 3.0 * p[1]))]
    });
    plane.with_positions(bumpy.collect()).unwrap()
}

/// Steps with uniform weights are linear in each coordinate: bumps of a ten-billionth of the width
/// are smoothed as bumps of a tenth are, by conjugate gradients and by a factorisation.
#[test]
fn low_bumps_are_smoothed_as_high_ones() {
    for lambda in [10.0, 1e5] {
        let constraints = Constraints::boundary(Boundary::Pinned);
        let options =
            Implicit { iterations: 2, constraints, ..Implicit::new(Diffusion::uniform(lambda)) };
        let heights = |height: f64| -> Vec<f64> {
            let mut go_on = |_: &fairing_smoothing::Step<'_>| ControlFlow::Continue(());
            let smoothed = implicit(&bumps(height), &options, Some(&mut go_on)).unwrap();
            smoothed.mesh.positions().iter().map(|p| p[2] / height).collect()
        };
        let high = heights(0.1);
        assert!(high.iter().any(|z| z.abs() > 1e-6));
        for height in [1e-5, 1e-10, 1e-60] {
            for (a, b) in high.iter().zip(heights(height)) {
                // The tolerance of 1e-8 in each of two steps, relative to heights of one.
                assert!((a - b).abs() < 1e-6, "λ = {lambda}, height {height:e}: {a} and {b}");
            }
        }
    }
}

/// A small component beside one a million times as large is solved as if alone.
#[test]
fn small_components_are_solved_as_well_as_large_ones() {
    let large = shapes::bumpy_sphere(2, 0.2, 5.0);
    let n = large.vertex_count();
    let size = 1e-6;
    let mut positions = large.positions().to_vec();
    positions
        .extend(large.positions().iter().map(|p| [size * p[0] + 3.0, size * p[1], size * p[2]]));
    let mut faces = large.faces().to_vec();
    faces.extend(large.faces().iter().map(|f| f.map(|v| v + n as u32)));
    let both = TriMesh::new(positions, faces).unwrap();
    let small = both.positions()[n..].to_vec();
    let alone = TriMesh::new(small, large.faces().to_vec()).unwrap();
    // Times suitable for the small component leave the large one unchanged.
    for t in [1e-14, 1e-11] {
        let options = Implicit {
            iterations: 2,
            ..Implicit::new(Diffusion::Cotangent {
                time: Time::SquaredUnits(t),
                kind: LaplacianKind::Auto,
                area: LumpedArea::Barycentric,
            })
        };
        let run = |mesh: &TriMesh| {
            let mut go_on = |_: &fairing_smoothing::Step<'_>| ControlFlow::Continue(());
            implicit(mesh, &options, Some(&mut go_on)).unwrap().mesh
        };
        let (a, b) = (run(&both), run(&alone));
        for (p, q) in a.positions()[n..].iter().zip(b.positions()) {
            // Rounding of a coordinate near three, and the tolerance.
            assert!(distance(*p, *q) < 1e-14 + 1e-6 * size, "t = {t:e}: {p:?}, {q:?}");
        }
        assert!(largest_distance(&alone, &b) > 1e-3 * size);
    }
}

/// A billion from the origin, flows give the same result as at the origin, up to the rounding of
/// coordinates there.
#[test]
fn flows_far_from_the_origin() {
    let mesh = shapes::bumpy_sphere(2, 0.2, 5.0);
    let by = [1e9, -1e9, 5e8];
    // Coordinates on the grid of floats near a billion, so both meshes have the same shape.
    let x = mesh.positions().iter().map(|p| [0, 1, 2].map(|k| (p[k] + by[k]) - by[k])).collect();
    let here = mesh.with_positions(x).unwrap();
    let moved = |m: &TriMesh| {
        let x = m.positions().iter().map(|p| [0, 1, 2].map(|k| p[k] + by[k])).collect();
        m.with_positions(x).unwrap()
    };
    let there = moved(&here);
    let soft = |c: [f64; 3]| SoftConstraint {
        vertex: 7,
        target: Some([0, 1, 2].map(|k| here.positions()[7][k] + c[k])),
        weight: 3.0,
    };
    let implicit_by = |c, volume, lambda| Implicit {
        constraints: Constraints { soft: vec![soft(c)], ..Constraints::default() },
        volume,
        iterations: 3,
        ..Implicit::new(Diffusion::uniform(lambda))
    };
    for volume in [Volume::Drifts, Volume::Rescaled, Volume::Offset] {
        for lambda in [3.0, 1e4] {
            // Long steps leave nearly a point, whose volume cannot be restored.
            if lambda > 10.0 && volume != Volume::Drifts {
                continue;
            }
            let a = implicit(&here, &implicit_by([0.0; 3], volume, lambda), None).unwrap().mesh;
            let b = implicit(&there, &implicit_by(by, volume, lambda), None).unwrap().mesh;
            // Each of three steps rounds to 1.2e-7.
            let off = largest_distance(&moved(&a), &b);
            assert!(off < 2e-5, "{volume:?}, λ = {lambda}: {off:e}");
        }
    }
}

/// A sheet glued to its mirror image has no volume to preserve, whatever the rounding.
#[test]
fn a_doubled_sheet_has_no_volume() {
    let plane = shapes::plane(9, 9, shapes::Diagonals::Alternating);
    let turned = plane
        .positions()
        .iter()
        .map(|p| [0.6 * p[0] - 0.64 * p[1], 0.8 * p[0] + 0.48 * p[1], 0.6 * p[1] + 0.1]);
    let n = plane.vertex_count() as u32;
    let boundary = plane.topology().boundary_vertices();
    let other = |v: u32| if boundary[v as usize] { v } else { v + n };
    let mut positions: Vec<[f64; 3]> = turned.collect();
    positions.extend(positions.clone());
    let mut faces = plane.faces().to_vec();
    faces.extend(plane.faces().iter().map(|&[a, b, c]| [other(a), other(c), other(b)]));
    let pillow = TriMesh::new(positions, faces).unwrap();
    assert!(pillow.topology().is_closed());
    for volume in [Volume::Rescaled, Volume::Offset] {
        let options = Implicit { volume, ..Implicit::new(Diffusion::uniform(1.0)) };
        let error = implicit(&pillow, &options, None).unwrap_err();
        assert!(matches!(error.failure, FlowFailure::Volume { .. }), "{:?}", error.failure);
    }
}

/// A pass band of 1.9 amplifies modes by 5.5 in each pair: refused by default, reported if allowed.
#[test]
fn pairs_that_amplify_are_refused() {
    let sphere = shapes::icosphere(3);
    let run = |options: Taubin| -> Result<Smoothed, FlowError> { taubin(&sphere, &options, None) };
    for (pass_band, pairs) in [(1.9, 10), (1.0, 50), (1.9, 1), (0.1, 1100)] {
        let options = Taubin { pairs, ..Taubin::new(0.5, pass_band) };
        let FlowFailure::Amplified { gain, .. } = run(options.clone()).unwrap_err().failure else {
            panic!("{pass_band}, {pairs}")
        };
        let product = 0.5 * pass_band;
        assert!((gain - (1.0 + product * product / (4.0 * (1.0 - product)))).abs() < 1e-12);
        let allowed = run(Taubin { stability: Stability::Allow, ..options });
        assert!(allowed.unwrap().report.unstable);
    }
    for (pass_band, pairs) in [(0.1, 10), (0.1, 1000), (1.0, 5)] {
        assert!(!run(Taubin { pairs, ..Taubin::new(0.5, pass_band) }).unwrap().report.unstable);
    }
}

/// A flat grid solves its own equations exactly, for every order and any width of the region:
/// condition numbers of 1e4 to 1e16 here.
#[test]
fn wide_regions_of_a_flat_grid_stay() {
    let cells = 60u32;
    let plane = shapes::plane(cells, cells, shapes::Diagonals::Alternating);
    let grid = plane.positions().iter().map(|p| p.map(|x| (x * f64::from(cells)).round()));
    let grid = plane.with_positions(grid.collect()).unwrap();
    let inside = |p: &[f64; 3]| p[..2].iter().all(|&x| x > 4.5 && x < f64::from(cells) - 4.5);
    let region: Vec<u32> = (0..grid.vertex_count() as u32)
        .filter(|&v| inside(&grid.positions()[v as usize]))
        .collect();
    for order in 1..=4 {
        let kind = LaplacianKind::Uniform;
        let options = FairRegion { order, kind, ..FairRegion::new(region.clone()) };
        let fair = fair_region(&grid, &options).unwrap().mesh;
        let off = largest_distance(&fair, &grid);
        // Rounding of coordinates near sixty.
        assert!(off < 1e-12, "order {order}: {off:e}");
    }
}

/// Renumbering, rotation and scaling commute with every flow.
#[test]
fn flows_commute_with_order_turn_and_scale() {
    let mesh = shapes::bumpy_sphere(2, 0.2, 5.0);
    let n = mesh.vertex_count() as u32;
    let place = |v: u32| (v * 5 + 3) % n;
    assert_eq!(n % 5, 2, "so that every place is taken once");
    let (c, s) = (0.6, 0.8);
    for scale in [1.0, 1e-8, 1e8] {
        let map = |p: [f64; 3]| [c * p[0] - s * p[1], s * p[0] + c * p[1], p[2]].map(|x| scale * x);
        let image = |m: &TriMesh| {
            let mut x = vec![[0.0; 3]; n as usize];
            for (v, p) in m.positions().iter().enumerate() {
                x[place(v as u32) as usize] = map(*p);
            }
            TriMesh::new(x, m.faces().iter().map(|f| f.map(place)).collect()).unwrap()
        };
        for method in fairing_smoothing::Method::all() {
            if method.name() == "region" {
                continue;
            }
            let (a, b) = (method.run(&mesh, None), method.run(&image(&mesh), None));
            // A coarse sphere does not survive ten steps of mean curvature flow.
            let (Ok(a), Ok(b)) = (a, b) else {
                assert_eq!(method.name(), "mean-curvature");
                continue;
            };
            let (a, b) = (image(&a.mesh), b.mesh);
            let off = largest_distance(&a, &b) / scale;
            // Ten solves to 1e-8.
            assert!(off < 1e-6, "{}, scale {scale:e}: {off:e}", method.name());
        }
    }
}
