#![no_main]
//! Every algorithm on tiny meshes of any bytes: a finite result or an error, and no panic.

use fairing_denoising::{Denoiser, noise_level};
use fairing_evaluation::{
    NoiseKind, NoiseLevel, ScanOptions, ScoreOptions, Scores, SurfaceTree, add_noise, hausdorff,
    scan, self_intersections,
};
use fairing_mesh::{Diagnosis, RepairOptions, Tolerance, TriMesh, repair, subdivide_loop};
use fairing_operators::curvature::Estimator;
use fairing_operators::{
    Laplacian, LaplacianKind, MassKind, NormalWeight, gradient, weighted_vertex_normals,
};
use fairing_smoothing::Method;
use fairing_spectral::{
    HeatGeodesics, SpectrumOptions, SurfacePoint, geodesic_path, isolines, reconstruct, spectrum,
};

/// Flows and options that take paths of their own.
const FLOWS: [(&str, &[(&str, &str)]); 20] = [
    ("explicit", &[]),
    ("explicit", &[("weights", "cotangent"), ("boundary", "pinned")]),
    ("explicit", &[("lambda", "2"), ("unstable", "allow"), ("iterations", "300")]),
    ("implicit", &[]),
    ("implicit", &[("weights", "cotangent"), ("lambda", "1e9")]),
    ("implicit", &[("weights", "cotangent"), ("operator", "robust"), ("volume", "offset")]),
    ("implicit", &[("weights", "cotangent"), ("update", "mass"), ("volume", "rescale")]),
    ("implicit", &[("pin", "0,1"), ("soft", "2:3"), ("boundary", "sliding")]),
    ("mean-curvature", &[]),
    ("mean-curvature", &[("operator", "robust"), ("boundary", "pinned")]),
    ("conformal", &[("iterations", "10")]),
    ("conformal", &[("iterations", "10"), ("operator", "robust")]),
    ("taubin", &[]),
    ("windowed-sinc", &[]),
    ("hc", &[("alpha", "0.3"), ("soft", "1:2")]),
    ("scale-dependent", &[("pin", "2")]),
    ("low-pass", &[("modes", "3")]),
    ("low-pass", &[("cutoff", "1.5"), ("operator", "robust")]),
    ("region", &[("vertices", "0,2,3"), ("order", "3")]),
    ("region", &[("vertices", "1"), ("operator", "robust"), ("order", "1")]),
];

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let [verb, choice, rest @ ..] = bytes else { return };
    let Some(mesh) = soup(rest) else { return };
    let choice = usize::from(*choice);
    match verb % 8 {
        0 => mend(&mesh, choice),
        1 => smooth(&mesh, choice),
        2 => denoise(&mesh, choice),
        3 => curve(&mesh, choice),
        4 => assemble(&mesh, choice),
        5 => find_modes(&mesh, choice),
        6 => walk(&mesh, choice),
        _ => judge(&mesh, choice),
    }
});

/// A mesh of at most 24 vertices on a small grid, some of them moved off it by tiny steps, and
/// faces between any of them; at one of several sizes.
fn soup(bytes: &[u8]) -> Option<TriMesh> {
    let [n, unit, rest @ ..] = bytes else { return None };
    let n = usize::from(n % 22) + 3;
    let unit = 2f64.powi([0, 0, 0, -97, 90, 20][usize::from(unit % 6)]);
    let (positions, faces) = rest.split_at_checked(3 * n)?;
    let coordinate = |&byte: &u8| {
        let tiny = 2f64.powi([0, -50, -30, -8][usize::from(byte >> 6)]);
        let on_grid = f64::from(byte % 8) - 3.0;
        unit * (on_grid + if tiny < 1.0 { tiny * f64::from(byte >> 3 & 7) } else { 0.0 })
    };
    let (positions, _) = positions.as_chunks::<3>();
    let positions = positions.iter().map(|p| p.each_ref().map(coordinate)).collect();
    let (faces, _) = faces.as_chunks::<3>();
    let faces = faces.iter().take(60).map(|face| face.map(|v| u32::from(v) % n as u32));
    let faces = faces.filter(|[a, b, c]| a != b && b != c && c != a).collect();
    TriMesh::new(positions, faces).ok()
}

fn mend(mesh: &TriMesh, choice: usize) {
    let bit = |k: usize| choice >> k & 1 == 1;
    let options = RepairOptions {
        merge: !bit(0),
        tolerance: if bit(1) { Tolerance::EdgeLengths(0.1) } else { Tolerance::Rounding },
        orient: !bit(2),
        split: !bit(3),
        smallest_component: if bit(4) { 3 } else { 0 },
        thin: if bit(5) { 0.05 } else { 0.0 },
        isolated: !bit(6),
        holes: if bit(7) { 12 } else { 0 },
        ..RepairOptions::DEFAULT
    };
    let Ok(first) = repair(mesh, &options) else { return };
    check(&first.mesh);
    assert_eq!(first.vertex_sources.len(), first.mesh.vertex_count());
    assert_eq!(first.face_sources.len(), first.mesh.face_count());
    // Merging within the same distance again.
    let tolerance = match options.tolerance {
        Tolerance::EdgeLengths(ratio) => Tolerance::Model(ratio * mesh.mean_edge_length()),
        other => other,
    };
    let options = RepairOptions { tolerance, ..options };
    let again = repair(&first.mesh, &options).expect("options in their ranges");
    assert!(again.is_unchanged(), "not idempotent: {:?}", again.changes);
}

fn smooth(mesh: &TriMesh, choice: usize) {
    let (name, values) = FLOWS[choice % FLOWS.len()];
    let method = Method::with(name, values).expect("known options");
    if let Ok(smoothed) = method.run(mesh, None) {
        check(&smoothed.mesh);
        assert_eq!(smoothed.mesh.faces(), mesh.faces());
    }
}

fn denoise(mesh: &TriMesh, choice: usize) {
    if let Some(level) = noise_level(mesh) {
        assert!(level.sigma.is_finite() && level.sigma >= 0.0);
    }
    let denoisers = Denoiser::all();
    if let Ok(clean) = denoisers[choice % denoisers.len()].denoise(mesh) {
        check(&clean);
        assert_eq!(clean.faces(), mesh.faces());
    }
}

fn curve(mesh: &TriMesh, choice: usize) {
    let estimators = Estimator::all();
    if let Ok(field) = estimators[choice % estimators.len()].estimate(mesh) {
        for values in [&field.kappa1, &field.kappa2, &field.mean, &field.gaussian] {
            finite(values);
        }
        for directions in field.directions.iter().flatten() {
            finite(directions.as_flattened());
        }
    }
    for weight in [NormalWeight::Area, NormalWeight::Angle, NormalWeight::Sphere] {
        finite(weighted_vertex_normals(mesh, weight).as_flattened());
    }
}

fn laplacian(mesh: &TriMesh, choice: usize) -> Option<Laplacian> {
    let kinds = [LaplacianKind::Auto, LaplacianKind::Cotangent, LaplacianKind::Robust];
    let masses = [MassKind::Barycentric, MassKind::Mixed, MassKind::Consistent];
    Laplacian::new(mesh, kinds[choice % 3], masses[choice / 3 % 3]).ok()
}

fn assemble(mesh: &TriMesh, choice: usize) {
    if let Some(laplacian) = laplacian(mesh, choice) {
        finite(laplacian.stiffness().data());
        finite(&laplacian.mass().lumped());
        let heights: Vec<f64> = mesh.positions().iter().map(|p| p[2]).collect();
        if let Ok(values) = laplacian.pointwise(&heights) {
            finite(&values);
        }
    }
    if let Ok(gradient) = gradient(mesh) {
        finite(gradient.data());
    }
    let info = Diagnosis::new(mesh);
    assert!(info.area.is_finite() && info.volume.is_none_or(f64::is_finite));
    if let Ok(fine) = subdivide_loop(mesh) {
        check(&fine);
    }
}

fn find_modes(mesh: &TriMesh, choice: usize) {
    let Some(laplacian) = laplacian(mesh, choice) else { return };
    let options = match choice / 9 % 2 {
        0 => SpectrumOptions::default(),
        _ => SpectrumOptions::dirichlet(mesh),
    };
    let Ok(modes) = spectrum(&laplacian, choice / 18 % 6, &options) else { return };
    finite(&modes.values);
    finite(&modes.residuals);
    assert!(modes.modes.iter().all(|x| x.is_finite()));
    if let Ok(rebuilt) = reconstruct(mesh, &modes, modes.values.len()) {
        check(&rebuilt.mesh);
    }
}

fn walk(mesh: &TriMesh, choice: usize) {
    let Some(laplacian) = laplacian(mesh, choice) else { return };
    let time = (choice / 9 % 2 == 1).then_some(0.5);
    let Ok(geodesics) = HeatGeodesics::with(mesh, &laplacian, time) else { return };
    let source = SurfacePoint::vertex(0);
    let Ok(distance) = geodesics.distance_from(std::slice::from_ref(&source)) else { return };
    let known: Vec<f64> = distance.iter().flatten().copied().collect();
    finite(&known);
    assert!(known.iter().all(|d| *d >= 0.0), "{known:?}");
    let farthest = (choice / 18 % mesh.vertex_count()) as u32;
    if let Ok(path) = geodesic_path(mesh, &distance, &[source], farthest) {
        assert!(path.length().is_finite());
    }
    for line in isolines(mesh, &distance, 1.0).expect("a field of this mesh") {
        line.segments().for_each(|segment| finite(segment.as_flattened()));
    }
}

fn judge(mesh: &TriMesh, choice: usize) {
    let kinds = [
        NoiseKind::GaussianPerAxis,
        NoiseKind::GaussianAlongNormals,
        NoiseKind::Impulsive { fraction: 0.5 },
        NoiseKind::Correlated { length: 2.0 },
        NoiseKind::Varying,
    ];
    let kind = kinds[choice % kinds.len()];
    if let Ok(noisy) = add_noise(mesh, kind, NoiseLevel::EdgeLengths(0.3), choice as u64) {
        check(&noisy);
        if let Ok(scores) = Scores::new(&noisy, mesh, &ScoreOptions::default()) {
            let values = scores.entries().into_iter().filter_map(|score| score.value.ok());
            finite(&values.collect::<Vec<_>>());
        }
        if let Ok(bounds) = hausdorff(&noisy, mesh, 0.1 * noisy.mean_edge_length()) {
            assert!(bounds.lower <= bounds.upper);
        }
    }
    self_intersections(mesh);
    if let Ok(tree) = SurfaceTree::new(mesh) {
        finite(&tree.distances(mesh.positions()));
    }
    let options = ScanOptions { size: [12, 9], ..ScanOptions::default() };
    if let Ok(seen) = scan(mesh, &options) {
        check(&seen.mesh);
    }
}

/// A result is a valid mesh.
fn check(mesh: &TriMesh) {
    TriMesh::new(mesh.positions().to_vec(), mesh.faces().to_vec()).expect("the result is valid");
}

fn finite(values: &[f64]) {
    assert!(values.iter().all(|x| x.is_finite()), "{values:?}");
}
