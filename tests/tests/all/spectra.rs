//! Spectra compared with analytic ones, and round trips of the transform.

use fairing_evaluation::observed_orders;
use fairing_mesh::TriMesh;
use fairing_mesh::io::{ReadError, ReadProblem};
use fairing_operators::{Laplacian, LaplacianKind, MassKind};
use fairing_shapes as shapes;
use fairing_spectral::{
    HeatDiffusion, HeatGeodesics, Rest, SpectralError, Spectrum, SpectrumOptions, compress,
    global_point_signature, graph_spectrum, heat_kernel_signature, heat_kernel_times, reconstruct,
    shape_dna, spectrum, wave_kernel_energies, wave_kernel_signature,
};
use ndarray::{Array2, ArrayView2};

fn positions(mesh: &TriMesh) -> ArrayView2<'_, f64> {
    ArrayView2::from(mesh.positions())
}

fn modes(mesh: &TriMesh, k: usize) -> Spectrum {
    spectrum(&Laplacian::cotangent(mesh).unwrap(), k, &SpectrumOptions::default()).unwrap()
}

fn scaled(mesh: &TriMesh, s: f64) -> TriMesh {
    mesh.with_positions(mesh.positions().iter().map(|p| p.map(|x| s * x)).collect()).unwrap()
}

/// The unit sphere has the eigenvalues ℓ(ℓ + 1), 2ℓ + 1 times. Means over ℓ = 2 and 3 (symmetry
/// favours ℓ = 1).
#[test]
fn sphere_eigenvalues_converge_quadratically() {
    for mass in [MassKind::Barycentric, MassKind::Mixed, MassKind::Consistent] {
        let (mut h, mut error) = (vec![], vec![]);
        for level in 2..=5 {
            let sphere = shapes::icosphere(level);
            let laplacian = Laplacian::new(&sphere, LaplacianKind::Cotangent, mass).unwrap();
            let found = spectrum(&laplacian, 16, &SpectrumOptions::default()).unwrap();
            assert!(found.certified);
            let mean = |r: std::ops::Range<usize>| {
                let n = r.len() as f64;
                found.values[r].iter().sum::<f64>() / n
            };
            h.push(sphere.mean_edge_length());
            error.push((mean(4..9) - 6.0).abs() / 6.0 + (mean(9..16) - 12.0).abs() / 12.0);
        }
        // Theory gives 2; the margin covers the coarsest level.
        for order in observed_orders(&h, &error) {
            assert!((1.9..2.1).contains(&order), "{mass:?}: {order}, {error:?}");
        }
    }
}

#[test]
fn all_modes_give_the_mesh_back() {
    let mesh = shapes::icosphere(2);
    let n = mesh.vertex_count();
    let all = modes(&mesh, n);
    let back = reconstruct(&mesh, &all, n).unwrap().mesh;
    for (a, b) in mesh.positions().iter().zip(back.positions()) {
        assert!((0..3).all(|i| (a[i] - b[i]).abs() < 1e-12));
    }
    // Parseval, in the inner product of the mass.
    let coefficients = all.transform(positions(&mesh)).unwrap();
    let energy: f64 = Spectrum::energies(coefficients.view()).iter().sum();
    // On the unit sphere ‖x‖² is the area.
    assert!((energy - all.area()).abs() < 1e-12 * energy);
}

/// Random-walk modes are orthonormal in D: with D all modes reconstruct exactly, with a plain
/// transpose they do not.
#[test]
fn the_mass_cannot_be_left_out() {
    let mesh = shapes::torus(2.0, 0.7, 13, 9);
    let n = mesh.vertex_count();
    let options = SpectrumOptions::default();
    let ellipsoid = shapes::icosphere(1)
        .with_positions(
            shapes::icosphere(1)
                .positions()
                .iter()
                .map(|p| [p[0], 1.5 * p[1], 2.0 * p[2]])
                .collect(),
        )
        .unwrap();
    let walk =
        graph_spectrum(&ellipsoid, ellipsoid.vertex_count(), MassKind::Degree, &options.eigen)
            .unwrap();
    for found in [spectrum(&Laplacian::cotangent(&mesh).unwrap(), n, &options).unwrap(), walk] {
        let field = Array2::from_shape_fn((found.vertex_count(), 1), |(i, _)| (i % 5) as f64);
        let exact = found.inverse(found.transform(field.view()).unwrap().view()).unwrap();
        assert!((&exact - &field).iter().all(|d| d.abs() < 1e-10));
        let plain = found.modes.dot(&found.modes.t().dot(&field));
        assert!((&plain - &field).iter().any(|d| d.abs() > 0.1));
    }
}

#[test]
fn truncation_errors_are_known_beforehand() {
    let mesh = shapes::torus(1.0, 0.4, 40, 20);
    let found = modes(&mesh, 60);
    let errors = found.truncation_errors(positions(&mesh)).unwrap();
    assert_eq!(errors.len(), 61);
    assert!(errors.is_sorted_by(|a, b| a >= b));
    let mass = found.mass.as_mass().diagonal();
    for k in [0, 1, 5, 33, 60] {
        let moved = reconstruct(&mesh, &found, k).unwrap().mesh;
        let square: f64 = (0..mesh.vertex_count())
            .map(|v| {
                let (a, b) = (mesh.positions()[v], moved.positions()[v]);
                mass[v] * (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>()
            })
            .sum();
        let measured = (square / found.area()).sqrt();
        assert!((measured - errors[k]).abs() < 1e-9, "{k}: {measured} {}", errors[k]);
    }
    // The low pass up to λ₂₀ keeps exactly the first 20 modes.
    let cutoff = 0.5 * (found.values[19] + found.values[20]);
    let low_pass = |lambda: f64| f64::from(u8::from(lambda <= cutoff));
    let filtered = found.filter(positions(&mesh), low_pass, Rest::Dropped).unwrap().field;
    let kept = reconstruct(&mesh, &found, 20).unwrap().mesh;
    assert!((&filtered - &positions(&kept)).iter().all(|d| d.abs() < 1e-12));
    let identity = found.filter(positions(&mesh), |_| 1.0, Rest::Scaled(1.0)).unwrap().field;
    assert!((&identity - &positions(&mesh)).iter().all(|d| d.abs() < 1e-12));
}

/// Tiny and huge meshes: eigenvalues scale with the inverse square, ShapeDNA is invariant.
#[test]
fn scaling_is_as_documented() {
    let mesh = shapes::icosphere(3);
    let reference = modes(&mesh, 12);
    for s in [1e-6, 1e6] {
        let other = modes(&scaled(&mesh, s), 12);
        for i in 0..12 {
            let back = other.values[i] * s * s;
            assert!((back - reference.values[i]).abs() < 1e-8 * reference.values[11]);
        }
        let (a, b) = (shape_dna(&reference), shape_dna(&other));
        assert!((&a - &b).iter().all(|d| d.abs() < 1e-8 * a[11]));
    }
}

#[test]
fn isolated_vertices_take_no_part() {
    let sphere = shapes::icosphere(2);
    let mut points = sphere.positions().to_vec();
    points.insert(0, [5.0, 6.0, 7.0]);
    let faces = sphere.faces().iter().map(|f| f.map(|v| v + 1)).collect();
    let mesh = TriMesh::new(points, faces).unwrap();
    let found = modes(&mesh, 9);
    let alone = modes(&sphere, 9);
    for i in 0..9 {
        assert!((found.values[i] - alone.values[i]).abs() < 1e-9 * alone.values[8]);
        assert_eq!(found.modes[[0, i]], 0.0);
    }
    let smooth = reconstruct(&mesh, &found, 4).unwrap().mesh;
    assert_eq!(smooth.positions()[0], [5.0, 6.0, 7.0]);
    assert!(matches!(
        spectrum(
            &Laplacian::cotangent(&mesh).unwrap(),
            mesh.vertex_count(),
            &SpectrumOptions::default()
        ),
        Err(SpectralError::TooManyModes { .. })
    ));
    let distance = HeatGeodesics::new(&mesh).unwrap().distance(&[1]).unwrap();
    assert_eq!(distance[0], None);
    assert!(distance[1..].iter().all(|d| d.is_some_and(|d| d >= 0.0)));
}

#[test]
fn signatures_integrate_to_their_traces() {
    let mesh = shapes::torus(1.0, 0.4, 30, 16);
    let found = modes(&mesh, 40);
    let mass = found.mass.as_mass().diagonal();
    let integral = |column: ndarray::ArrayView1<'_, f64>| -> f64 {
        column.iter().zip(&mass).map(|(x, m)| x * m).sum()
    };
    let times = heat_kernel_times(&found, 5);
    let heat = heat_kernel_signature(&found, &times).unwrap();
    for (t, column) in times.iter().zip(heat.columns()) {
        let trace: f64 = found.values.iter().map(|l| (-l * t).exp()).sum();
        assert!((integral(column) - trace).abs() < 1e-9 * trace);
    }
    let (energies, sigma) = wave_kernel_energies(&found, 10).unwrap();
    let wave = wave_kernel_signature(&found, &energies, sigma).unwrap();
    assert!(wave.columns().into_iter().all(|c| (integral(c) - 1.0).abs() < 1e-9));
    // Ten energies at distance d, σ = 7 d, the first and the last 2 σ inside ln λ₁ and ln λ_last.
    let (low, high) = (found.values[1].ln(), found.values[39].ln());
    let d = (high - low) / (9.0 + 28.0);
    for (j, column) in wave.columns().into_iter().enumerate() {
        let energy = low + (14.0 + j as f64) * d;
        let weight = |l: &f64| (-0.5 * ((energy - l.ln()) / (7.0 * d)).powi(2)).exp();
        let weights: Vec<f64> = found.values[1..].iter().map(weight).collect();
        let total: f64 = weights.iter().sum();
        for v in [0, 77, 300] {
            let modes = found.modes.row(v);
            let terms = weights.iter().enumerate().map(|(i, w)| w * modes[i + 1].powi(2));
            assert!((column[v] - terms.sum::<f64>() / total).abs() < 1e-12, "{j} {v}");
        }
    }
    let global = global_point_signature(&found);
    assert_eq!(global.ncols(), 39);
    assert!(
        (integral(global.column(3).mapv(|x| x * x).view()) - 1.0 / found.values[4]).abs() < 1e-9
    );
}

/// The distance from a pole of the unit sphere is the angle; the heat method is of first order.
#[test]
fn heat_distance_approaches_the_angle() {
    let mut errors = vec![];
    for level in [3, 4, 5] {
        let sphere = shapes::icosphere(level);
        let source = sphere.positions()[0];
        let distance = HeatGeodesics::new(&sphere).unwrap().distance(&[0]).unwrap();
        let worst = sphere
            .positions()
            .iter()
            .zip(distance)
            .map(|(p, d)| {
                let cosine = (0..3).map(|i| p[i] * source[i]).sum::<f64>().clamp(-1.0, 1.0);
                (d.unwrap() - cosine.acos()).abs()
            })
            .fold(0.0, f64::max);
        errors.push(worst);
    }
    assert!(errors[2] < 0.04 && errors[2] < 0.6 * errors[0], "{errors:?}");
}

#[test]
fn heat_is_conserved_and_spreads() {
    let mesh = shapes::icosphere(3);
    let found = modes(&mesh, 1);
    let mass = found.mass.as_mass().diagonal();
    let start: Vec<f64> = (0..mesh.vertex_count()).map(|v| f64::from(u8::from(v == 7))).collect();
    let heat = |u: &[f64]| u.iter().zip(&mass).map(|(u, m)| u * m).sum::<f64>();
    let later =
        HeatDiffusion::new(&Laplacian::auto(&mesh).unwrap(), 1e4).unwrap().step(&start).unwrap();
    assert!((heat(&later) - heat(&start)).abs() < 1e-10 * heat(&start));
    let mean = heat(&start) / found.area();
    assert!(later.iter().all(|u| (u - mean).abs() < 1e-3 * mean));
    // At time zero nothing moves, up to the rounding of √m · √m.
    let still =
        HeatDiffusion::new(&Laplacian::auto(&mesh).unwrap(), 0.0).unwrap().step(&start).unwrap();
    assert!(still.iter().zip(&start).all(|(a, b)| (a - b).abs() < 1e-15));
}

#[test]
fn compression_knows_its_error() {
    let mesh = shapes::torus(1.0, 0.4, 40, 20);
    let found = modes(&mesh, 50);
    let small = compress(&mesh, &found, 30, 1e-3).unwrap();
    let back = small.positions(&found).unwrap();
    let rest = &positions(&mesh) - &back;
    let mass = found.mass.as_mass().diagonal();
    let square: f64 =
        rest.rows().into_iter().zip(mass).map(|(r, m)| m * r.dot(&r)).sum::<f64>() / found.area();
    assert!((square.sqrt() - small.error).abs() < 1e-9);
    assert!(small.bits() < 64.0 * 90.0);
}

/// If no coefficient is small, rounding keeps the requested precision, up to chance among 90
/// coefficients.
#[test]
fn compression_meets_its_precision() {
    let torus = shapes::torus(1.0, 0.4, 40, 20);
    let bent = |&[x, y, z]: &[f64; 3]| {
        [x + 0.1 * y * y, y + 0.2 * (3.0 * x).sin() + 0.1 * z, z + 0.1 * x * y]
    };
    let mesh = torus.with_positions(torus.positions().iter().map(bent).collect()).unwrap();
    let found = modes(&mesh, 30);
    let precision = 1e-7;
    let small = compress(&mesh, &found, 30, precision).unwrap();
    let coefficients = found.transform(positions(&mesh)).unwrap();
    let rest = &coefficients - &small.levels.mapv(|level| level as f64 * small.step);
    let rounding = (rest.iter().map(|x| x * x).sum::<f64>() / found.area()).sqrt();
    assert!((0.8..1.2).contains(&(rounding / precision)), "{rounding}");
}

#[test]
fn files_give_the_same_spectrum_back() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = shapes::icosphere(2);
    for mass in [MassKind::Mixed, MassKind::Consistent] {
        let laplacian = Laplacian::new(&mesh, LaplacianKind::Cotangent, mass).unwrap();
        let found = spectrum(&laplacian, 7, &SpectrumOptions::default()).unwrap();
        let path = folder.path().join(format!("{mass:?}.npz"));
        found.save(&path).unwrap();
        assert_eq!(Spectrum::load(&path).unwrap(), found);
        let refused = |change: fn(&mut Spectrum)| {
            let mut other = found.clone();
            change(&mut other);
            let read = Spectrum::from_bytes(&other.to_bytes().unwrap());
            assert!(
                matches!(read, Err(ReadError { problem: ReadProblem::Unexpected { .. }, .. })),
                "{read:?}"
            );
        };
        refused(|other| other.values[2] = f64::NAN);
        refused(|other| other.modes[[3, 1]] = f64::INFINITY);
        refused(|other| other.residuals[0] = f64::NAN);
        refused(|other| other.residuals.truncate(3));
    }
    let Err(error) = Spectrum::from_bytes(b"PK") else { panic!() };
    assert!(error.to_string().contains("archive cannot be read"), "{error}");
    assert!(matches!(
        Spectrum::load(folder.path().join("nothing.npz")),
        Err(ReadError { problem: ReadProblem::Io(_), .. })
    ));
}

/// With a fixed boundary the unit square has π²(i² + j²) for i, j ≥ 1; with a free one, for i, j ≥
/// 0.
#[test]
fn square_eigenvalues_with_both_boundaries() {
    let n = 40;
    let points = (0..=n)
        .flat_map(|j| {
            (0..=n).map(move |i| [f64::from(i) / f64::from(n), f64::from(j) / f64::from(n), 0.0])
        })
        .collect();
    let at = |i: i32, j: i32| (j * (n + 1) + i) as u32;
    let faces = (0..n)
        .flat_map(|j| {
            (0..n).flat_map(move |i| {
                [
                    [at(i, j), at(i + 1, j), at(i + 1, j + 1)],
                    [at(i, j), at(i + 1, j + 1), at(i, j + 1)],
                ]
            })
        })
        .collect();
    let square = TriMesh::new(points, faces).unwrap();
    let (free, fixed) = (SpectrumOptions::default(), SpectrumOptions::dirichlet(&square));
    for (boundary, options, least) in [("free", free, 0), ("fixed", fixed, 1)] {
        let found = spectrum(&Laplacian::cotangent(&square).unwrap(), 8, &options).unwrap();
        let mut exact: Vec<f64> = (least..9)
            .flat_map(|i: i32| {
                (least..9).map(move |j| f64::from(i * i + j * j) * std::f64::consts::PI.powi(2))
            })
            .collect();
        exact.sort_by(f64::total_cmp);
        for (found, exact) in found.values.iter().zip(&exact) {
            // The error of the five-point stencil is λ h²/12 (i⁴ + j⁴)/(i² + j²): at most 0.5 %
            // here.
            assert!((found - exact).abs() <= 0.006 * exact, "{boundary}: {found} {exact}");
        }
    }
}
