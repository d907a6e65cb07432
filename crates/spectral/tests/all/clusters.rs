//! Clusters of eigenvalues, and the properties that the documentation states.

use fairing_mesh::TriMesh;
use fairing_operators::Laplacian;
use fairing_shapes as shapes;
use fairing_spectral::{
    Beyond, EigenOptions, Rest, Spectrum, SpectrumOptions, Split, compress, graph_spectrum,
    heat_kernel_times, reconstruct, spectrum,
};
use ndarray::ArrayView2;

use crate::meshes::{relabelled, scaled, union};

fn ends(split: Option<Split>) -> Option<(usize, Option<usize>)> {
    split.map(|split| (split.below, split.above))
}

fn modes(mesh: &TriMesh, k: usize) -> Spectrum {
    spectrum(&Laplacian::cotangent(mesh).unwrap(), k, &SpectrumOptions::default()).unwrap()
}

/// The symmetry of the icosahedron keeps 1, 3 and 5 modes together and parts the seven of ℓ = 3
/// into 4 and 3 or 3 and 4; dense (162 vertices) and sparse.
#[test]
fn a_sphere_has_the_clusters_of_its_symmetry() {
    for level in [2, 3] {
        let sphere = shapes::icosphere(level);
        let found = modes(&sphere, 16);
        let clusters = found.clusters();
        assert_eq!(clusters[..3], [0..1, 1..4, 4..9], "{:?}", found.values);
        assert_eq!(clusters.len(), 5);
        let cut = clusters[3].end;
        assert!(cut == 12 || cut == 13);
        assert_eq!(found.split(16), None);
        for (k, below, above) in [(2, 1, 4), (3, 1, 4), (5, 4, 9), (8, 4, 9), (cut - 1, 9, cut)] {
            // The same from all modes and from k modes: the eigenvalues after them are known.
            for spectrum in [&found, &modes(&sphere, k), &found.truncated(k).unwrap()] {
                assert_eq!(ends(spectrum.split(k)), Some((below, Some(above))), "{k}");
                assert_eq!((spectrum.gap_below(k), spectrum.gap_above(k)), (below, Some(above)));
            }
        }
        for k in [0, 1, 4, 9, cut, 16] {
            let few = modes(&sphere, k);
            assert_eq!((few.split(k), few.gap_below(k), few.gap_above(k)), (None, k, Some(k)));
        }
    }
}

/// Results that split no cluster are properties of the mesh: the same from other starting vectors
/// and with another numbering. Results that split one are not, and report it.
#[test]
fn only_splits_depend_on_the_basis() {
    let mesh = shapes::icosphere(3);
    // Noise, so that every mode matters.
    let noise = |v: usize, i: usize| ((v * 37 + i * 11) % 23) as f64 / 23.0 - 0.5;
    let points = mesh.positions().iter().enumerate();
    let noisy = mesh
        .with_positions(points.map(|(v, p)| std::array::from_fn(|i| p[i] + noise(v, i))).collect())
        .unwrap();
    let (other, place) = relabelled(&mesh);
    let mut shuffled = vec![[0.0; 3]; place.len()];
    for (v, p) in noisy.positions().iter().enumerate() {
        shuffled[place[v]] = *p;
    }
    let shuffled = other.with_positions(shuffled).unwrap();
    let walk = |mesh: &TriMesh, seed| {
        let options = EigenOptions { seed, ..Default::default() };
        graph_spectrum(mesh, 40, fairing_operators::MassKind::Degree, &options).unwrap()
    };
    let (a, b, c) = (walk(&mesh, 0), walk(&mesh, 1), walk(&other, 0));
    assert_eq!(a.clusters(), b.clusters());
    assert_eq!(a.clusters(), c.clusters());
    let mut split = 0;
    for k in 1..=40 {
        let [x, y] = [&a, &b].map(|modes| reconstruct(&noisy, modes, k).unwrap());
        let z = reconstruct(&shuffled, &c, k).unwrap();
        assert_eq!((x.split, y.split, z.split), (a.split(k), a.split(k), a.split(k)));
        assert_eq!(compress(&noisy, &a, k, 1e-3).unwrap().split, x.split);
        let apart = |v: usize| {
            let (p, q, r) =
                (x.mesh.positions()[v], y.mesh.positions()[v], z.mesh.positions()[place[v]]);
            (0..3).fold(0.0, |m: f64, i| m.max((p[i] - q[i]).abs()).max((p[i] - r[i]).abs()))
        };
        let worst = (0..place.len()).map(apart).fold(0.0, f64::max);
        if x.split.is_none() {
            // Angles of this at most, times coefficients below one.
            assert!(worst < Spectrum::GAP_ANGLE, "{k}: {worst:e}");
        } else {
            split += 1;
            assert!(worst > 1e-3, "{k} is said to split a cluster: {worst:e}");
        }
    }
    assert!((15..35).contains(&split), "{split}");
}

#[test]
fn filters_say_what_they_split() {
    let mesh = shapes::icosphere(3);
    let field = ArrayView2::from(mesh.positions());
    let (six, nine) = (modes(&mesh, 6), modes(&mesh, 9));
    let split = |modes: &Spectrum, response: &dyn Fn(f64) -> f64, rest| {
        modes.filter(field, response, rest).unwrap().split
    };
    let whole = Some((4, Some(9)));
    assert_eq!(ends(split(&six, &|_| 1.0, Rest::Dropped)), whole);
    assert_eq!(ends(split(&six, &|l| (-l).exp(), Rest::Scaled(0.0))), whole);
    assert_eq!(split(&six, &|_| 1.0, Rest::Scaled(1.0)), None);
    assert_eq!(split(&six, &|l| if l < 3.0 { 1.0 } else { 0.0 }, Rest::Dropped), None);
    assert_eq!(split(&nine, &|_| 1.0, Rest::Dropped), None);
    // A cut at the fifth of six equal eigenvalues, up to rounding.
    let middle = {
        let mut sorted = nine.values[4..9].to_vec();
        sorted.dedup();
        sorted[sorted.len() / 2]
    };
    let cut = |l: f64| if l < middle { 1.0 } else { 0.0 };
    if nine.values[4..9].iter().any(|l| cut(*l) == 1.0) {
        assert_eq!(ends(split(&nine, &cut, Rest::Dropped)), whole);
    }
}

/// Every component has a zero; three of them are one cluster, and exact zeros are apart from all
/// the rest.
#[test]
fn zeros_of_components_belong_together() {
    let one = shapes::bumpy_sphere(3, 0.15, 4.0);
    let mesh = union(&one, &union(&scaled(&one, 1e-4), &scaled(&one, 0.5)));
    for k in [1, 2] {
        assert_eq!(ends(modes(&mesh, k).split(k)), Some((0, Some(3))));
    }
    for k in [3, 4] {
        let found = modes(&mesh, k);
        assert_eq!((found.clusters()[0].clone(), found.split(3)), (0..3, None));
    }
}

/// Eigenvalues known beyond the last mode are stored with the modes; files without them load.
#[test]
fn files_keep_what_lies_beyond() {
    let folder = tempfile::tempdir().unwrap();
    for level in [1, 3] {
        let found = modes(&shapes::icosphere(level), 6);
        let path = folder.path().join("modes.npz");
        found.save(&path).unwrap();
        let back = Spectrum::load(&path).unwrap();
        assert_eq!(back, found);
        assert_eq!(ends(back.split(6)), Some((4, Some(9))));
    }
}

/// Two components whose sizes differ by 10⁻⁶: pairs of eigenvalues as close as 2 · 10⁻⁶ are
/// clusters, and the other one of a pair that is cut is known.
#[test]
fn nearly_equal_eigenvalues_are_a_cluster() {
    let one = shapes::bumpy_sphere(3, 0.15, 4.0);
    let mesh = union(&one, &scaled(&one, 1.0 + 1e-6));
    let alone = modes(&one, 3);
    assert_eq!(alone.split(2), None);
    let found = modes(&mesh, 3);
    assert_eq!(ends(found.split(3)), Some((2, Some(4))));
    assert_eq!(modes(&mesh, 4).split(4), None);
}

/// The residual of either neighbour closes a gap, whichever of them it is.
#[test]
fn a_rough_neighbour_on_either_side_is_no_gap() {
    let mut found = modes(&shapes::bumpy_sphere(3, 0.15, 4.0), 5);
    assert_eq!(found.split(2), None);
    let gap = found.values[2] - found.values[1];
    for rough in [1, 2] {
        let before =
            std::mem::replace(&mut found.residuals[rough], 2.0 * Spectrum::GAP_ANGLE * gap);
        assert!(found.split(2).is_some(), "{rough}");
        found.residuals[rough] = before;
    }
    assert_eq!(found.split(2), None);
}

/// From 4 ln 10 / λ of the last mode to that of the first above zero, evenly in the logarithm.
#[test]
fn times_of_heat_kernels_span_the_spectrum() {
    let found = modes(&shapes::icosphere(3), 9);
    let times = heat_kernel_times(&found, 3);
    let [first, last] = [8, 1].map(|i| 4.0 * 10f64.ln() / found.values[i]);
    for (time, expected) in times.iter().zip([first, (first * last).sqrt(), last]) {
        assert!((time / expected - 1.0).abs() < 1e-12, "{times:?}");
    }
}

/// A bound below which no eigenvalue follows makes a gap only if the bound is farther away than the
/// residual leaves the last mode undetermined.
#[test]
fn a_bound_is_a_gap_beyond_the_residual() {
    let mut found = modes(&shapes::icosphere(2), 4);
    let last = found.values[3];
    found.residuals[3] = 1e-8 * last;
    let gap = 1e-8 * last / Spectrum::GAP_ANGLE;
    for (factor, splits) in [(0.5, true), (2.0, false)] {
        found.beyond = Beyond::new(vec![], last + factor * gap);
        assert_eq!(found.split(4).is_some(), splits, "{factor}");
    }
}
