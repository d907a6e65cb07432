//! Eigenpairs of meshes with tiny masses, huge weights and many components.

use fairing_mesh::TriMesh;
use fairing_operators::Laplacian;
use fairing_shapes as shapes;
use fairing_spectral::{EigenOptions, Spectrum, SpectrumOptions, spectrum};

use crate::meshes::{capsule, scaled, sheet, union};

fn modes(mesh: &TriMesh, k: usize) -> Spectrum {
    spectrum(&Laplacian::cotangent(mesh).unwrap(), k, &SpectrumOptions::default()).unwrap()
}

fn robust(mesh: &TriMesh, k: usize) -> Spectrum {
    spectrum(&Laplacian::robust(mesh).unwrap(), k, &SpectrumOptions::default()).unwrap()
}

/// Certified, ascending, and Φᵀ M Φ = I.
fn check(found: &Spectrum) {
    assert!(found.certified && found.values.is_sorted(), "{:?}", found.values);
    let gram = found.transform(found.modes.view()).unwrap();
    let worst = gram
        .indexed_iter()
        .fold(0.0, |m: f64, ((i, j), g)| m.max((g - if i == j { 1.0 } else { 0.0 }).abs()));
    assert!(worst < 1e-9, "orthonormal to {worst:e}");
}

fn close(found: &[f64], expected: &[f64], share: f64) {
    let largest = expected[expected.len() - 1];
    for (a, b) in found.iter().zip(expected) {
        assert!((a - b).abs() <= share * largest, "{found:?} instead of {expected:?}");
    }
}

/// Poles of faces without area are as good as poles without them, in any unit, dense and sparse.
/// Mollification adds 10⁻⁵ of an edge length to every edge at most a few hundred times over: 0.5 %
/// of the area.
#[test]
fn capsules_with_fans_at_the_poles() {
    for (around, half) in [(12, 4), (40, 9)] {
        let clean = robust(&capsule(around, half, false), 12);
        let mesh = capsule(around, half, true);
        let fans = robust(&mesh, 12);
        check(&fans);
        close(&fans.values, &clean.values, 5e-3);
        for s in [1e-9, 1e9] {
            let other = robust(&scaled(&mesh, s), 12);
            check(&other);
            let back: Vec<f64> = other.values.iter().map(|l| l * s * s).collect();
            // Lengths of 10⁻⁵ edges come from differences of coordinates: ε / 10⁻⁵, magnified by
            // cotangents.
            close(&back, &fans.values, 1e-7);
        }
    }
}

/// Rings inside of the poles of a capsule with fans, at the given radii: masses become as small as
/// one likes.
fn with_inner_rings(around: usize, half: usize, radii: &[f64]) -> TriMesh {
    let mesh = capsule(around, half, true);
    let (mut points, mut faces) = (mesh.positions().to_vec(), mesh.faces().to_vec());
    let n = points.len();
    for (first, z, turned) in [(0, -2.0, true), (n - around, 2.0, false)] {
        let mut outer = first;
        for (k, radius) in radii.iter().enumerate() {
            let inner = if k == 0 { outer } else { points.len() };
            for i in 0..around {
                let (s, c) = (std::f64::consts::TAU * i as f64 / around as f64).sin_cos();
                let p = [radius * c, radius * s, z];
                if k == 0 { points[first + i] = p } else { points.push(p) }
            }
            for i in 0..if k == 0 { 0 } else { around } {
                let j = (i + 1) % around;
                let [a, b, c, d] = [outer + i, outer + j, inner + j, inner + i].map(|v| v as u32);
                let quad = [[a, b, c], [a, c, d]];
                faces.extend(quad.map(|[p, q, r]| if turned { [p, r, q] } else { [p, q, r] }));
            }
            outer = inner;
        }
    }
    TriMesh::new(points, faces).unwrap()
}

/// Masses that differ by 10¹² and more do not prevent the other modes from being found: poles of
/// many vertices in one place, for which the robust operator is, and tiny discs at the poles, whose
/// cotangents are sound.
#[test]
fn masses_of_any_ratio() {
    let spread = |found: &Spectrum| {
        let mass = found.mass.lumped();
        let (low, high) =
            mass.iter().fold((f64::MAX, 0.0), |(l, h): (f64, f64), &m| (l.min(m), h.max(m)));
        high / low
    };
    for (around, half) in [(24, 8), (60, 12)] {
        let clean = robust(&capsule(around, half, false), 12);
        let points = robust(&with_inner_rings(around, half, &[0.0; 4]), 12);
        let discs = [1e-5, 1e-6, 1e-7].map(|r| {
            let radii = [r, 0.6 * r, 0.4 * r, 0.3 * r];
            (modes(&with_inner_rings(around, half, &radii), 12), 0.1 / (r * r))
        });
        for (found, ratio) in discs.iter().chain([&(points, 1e11)]) {
            assert!(spread(found) > *ratio, "{:e}", spread(found));
            check(found);
            close(&found.values, &clean.values, 5e-3);
        }
    }
}

/// A second component of another size, as in scans: both have their zero, and the larger one its
/// values.
#[test]
fn components_of_different_sizes() {
    let large = shapes::bumpy_sphere(3, 0.15, 4.0);
    let alone = modes(&large, 7);
    for size in [1e-3, 1e-4, 1e-6] {
        for small in [shapes::icosphere(1), shapes::icosphere(3)] {
            let small = scaled(&small, size);
            for mesh in [union(&large, &small), union(&small, &large)] {
                let found = modes(&mesh, 8);
                check(&found);
                assert_eq!(found.values[..2], [0.0, 0.0]);
                close(&found.values[1..], &alone.values, 1e-9);
            }
        }
    }
}

/// Tetrahedra of edge a have 16/(3a²) three times, on top of a zero each; isolated vertices have
/// nothing.
#[test]
fn many_small_components() {
    let (mut points, mut faces, mut expected) = (vec![], vec![], vec![]);
    for i in 0..150 {
        let a = 0.1 * 100f64.powf(f64::from(i) / 149.0);
        let r = a / 8f64.sqrt();
        points.push([7.0; 3]);
        let n = points.len() as u32;
        for p in [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]] {
            points.push(p.map(|x: f64| r * x + 30.0 * f64::from(i)));
        }
        faces.extend([[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]].map(|f| f.map(|v| n + v)));
        expected.extend([16.0 / (3.0 * a * a); 3]);
    }
    let mesh = TriMesh::new(points, faces).unwrap();
    expected.sort_by(f64::total_cmp);
    // Zeros only, and zeros with more: in one run and in slices.
    for (k, slice) in [(20, 320), (150, 320), (160, 320), (190, 16)] {
        let eigen = EigenOptions { slice, ..Default::default() };
        let options = SpectrumOptions { eigen, ..Default::default() };
        let found = spectrum(&Laplacian::cotangent(&mesh).unwrap(), k, &options).unwrap();
        check(&found);
        assert!(found.values.iter().take(150).all(|l| *l == 0.0));
        if k > 150 {
            // Edges of 0.1 far from the origin have 12 digits.
            close(&found.values[150..], &expected[..k - 150], 1e-8);
        }
        assert!(found.modes.rows().into_iter().step_by(5).all(|row| row.iter().all(|x| *x == 0.0)));
    }
}

/// A sphere with one edge much shorter than the others keeps its eigenvalues, with the collapsed
/// one within what leaving out the vertex changes.
#[test]
fn one_short_edge() {
    for level in [2, 3] {
        let sphere = shapes::icosphere(level);
        let whole = modes(&sphere, 9);
        let [a, b, _] = sphere.faces()[0].map(|v| v as usize);
        for length in [1e-3, 1e-6, 1e-9] {
            let mut points = sphere.positions().to_vec();
            points[a] =
                std::array::from_fn(|i| points[b][i] + length * (points[a][i] - points[b][i]));
            let mesh = sphere.with_positions(points).unwrap();
            let found = modes(&mesh, 9);
            check(&found);
            close(&found.values, &whole.values, 0.1);
            assert_eq!(found.values[0], 0.0);
        }
    }
}

/// Two largely independent solvers, on a pinned sheet with two vertices very close together:
/// shift-invert and a dense decomposition, which is off by ε times its largest eigenvalue unless it
/// is refined.
#[test]
fn dense_and_sparse_agree_beside_a_needle() {
    for length in [1e-4, 1e-6] {
        let sheet = sheet(10, 11, [0.1, 0.1], 0.0);
        let mut points = sheet.positions().to_vec();
        points[60] =
            std::array::from_fn(|i| points[61][i] + length * (points[60][i] - points[61][i]));
        let mesh = sheet.with_positions(points).unwrap();
        let solve = |k: usize, dense_rows: usize| {
            let eigen = EigenOptions { dense_rows, ..Default::default() };
            let options = SpectrumOptions { eigen, ..SpectrumOptions::dirichlet(&mesh) };
            spectrum(&Laplacian::cotangent(&mesh).unwrap(), k, &options).unwrap()
        };
        for k in [1, 7] {
            let (dense, sparse) = (solve(k, 400), solve(k, 10));
            check(&dense);
            check(&sparse);
            // ε φᵀ|S|φ with weights of 1 / length on vertices that carry a hundredth of the mass.
            let share = 1e-10 + 1e-16 / length;
            close(&dense.values, &sparse.values, share);
            assert!(dense.residuals.iter().all(|r| *r < 1e-6 * dense.values[0]));
        }
    }
}
