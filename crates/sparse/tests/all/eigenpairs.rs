//! Eigenpairs against known spectra; pairs are always checked with S φ = λ M φ itself.

use fairing_sparse::{
    EigenOptions, EigenPairs, Mass, SparseError, SparseMatrix, combine, multiply_block,
    smallest_eigenpairs, smallest_symmetric_eigenpairs,
};
use ndarray::Array2;

use crate::matrices::{cycle, graph_laplacian, grid, grid_eigenvalues, path, random_vector};

/// Residuals and M-orthonormality, both recomputed; eigenvalues ascend.
fn check(s: &SparseMatrix, mass: Mass<'_>, pairs: &EigenPairs, tolerance: f64) {
    let k = pairs.values.len();
    assert_eq!((pairs.vectors.nrows(), pairs.vectors.ncols()), (s.rows(), k));
    assert!(pairs.values.is_sorted(), "{:?}", pairs.values);
    let mut m_vectors = Array2::zeros((s.rows(), k));
    for j in 0..k {
        let column = mass.times(&pairs.vectors.column(j).to_vec());
        m_vectors.column_mut(j).assign(&ndarray::Array1::from(column));
    }
    let gram = pairs.vectors.t().dot(&m_vectors);
    let worst = (&gram - &Array2::<f64>::eye(k)).iter().fold(0.0, |m: f64, d| m.max(d.abs()));
    assert!(worst < 1e-9, "orthonormal to {worst:e}");
    // With constants only there is nothing to compare rounding with but S itself, of size 1.
    let largest = pairs.values[k - 1].max(1e-6);
    let r = multiply_block(s, pairs.vectors.view())
        - m_vectors * ndarray::ArrayView1::from(&pairs.values);
    if let Mass::Lumped(m) = mass {
        for j in 0..k {
            let norm: f64 = (0..s.rows()).map(|i| r[[i, j]] * r[[i, j]] / m[i]).sum::<f64>().sqrt();
            assert!(norm <= tolerance * largest, "pair {j}: residual {norm:e} of {largest:e}");
            // The reported residual is the recomputed one, up to the rounding of either.
            assert!(
                (norm - pairs.residuals[j]).abs() <= 1e-10 * largest + 1e-14,
                "{norm:e} {}",
                pairs.residuals[j]
            );
        }
    }
}

fn compare(values: &[f64], expected: &[f64]) {
    let largest = expected[values.len() - 1];
    for (i, (found, expected)) in values.iter().zip(expected).enumerate() {
        assert!((found - expected).abs() <= 1e-9 * largest, "{i}: {found} instead of {expected}");
    }
}

fn lanczos() -> EigenOptions {
    EigenOptions { dense_rows: 20, ..Default::default() }
}

#[test]
fn lanczos_finds_the_spectrum_of_a_grid() {
    let (nx, ny) = (61, 47);
    let s = grid(nx, ny);
    let ones = vec![1.0; nx * ny];
    for k in [1, 2, 15, 60, 200] {
        let pairs = smallest_eigenpairs(&s, Mass::Lumped(&ones), k, &lanczos()).unwrap();
        assert!(pairs.certified);
        assert_eq!(pairs.values[0], 0.0);
        check(&s, Mass::Lumped(&ones), &pairs, 1e-8);
        compare(&pairs.values, &grid_eigenvalues(nx, ny));
    }
}

/// A square grid: nearly all eigenvalues are double, some of higher multiplicity; k cuts through
/// pairs.
#[test]
fn multiple_eigenvalues_are_complete() {
    let n = 40;
    let s = grid(n, n);
    let ones = vec![1.0; n * n];
    for k in [2, 3, 50, 51, 52, 53] {
        let pairs = smallest_eigenpairs(&s, Mass::Lumped(&ones), k, &lanczos()).unwrap();
        check(&s, Mass::Lumped(&ones), &pairs, 1e-8);
        compare(&pairs.values, &grid_eigenvalues(n, n));
    }
}

/// Twelve equal cycles: every eigenvalue twelve- or twenty-fourfold, more than a block of eight can
/// see; twelve components with a constant each.
#[test]
fn multiplicities_beyond_the_block_are_found_by_counting() {
    let (copies, n) = (12, 60);
    let s = graph_laplacian(copies * n, (0..copies * n).map(|i| (i, i / n * n + (i % n + 1) % n)));
    let ones = vec![1.0; copies * n];
    let pairs = smallest_eigenpairs(&s, Mass::Lumped(&ones), 50, &lanczos()).unwrap();
    check(&s, Mass::Lumped(&ones), &pairs, 1e-8);
    let at = |k: usize| 2.0 - 2.0 * (2.0 * std::f64::consts::PI * k as f64 / n as f64).cos();
    let expected: Vec<f64> =
        [(0, 12), (1, 24), (2, 24)].iter().flat_map(|&(k, c)| vec![at(k); c]).collect();
    assert!(pairs.values[..12].iter().all(|l| *l == 0.0), "{:?}", &pairs.values[..12]);
    compare(&pairs.values, &expected);
}

/// Slices meet in double eigenvalues; nothing is lost or found twice.
#[test]
fn slices_join_without_a_seam() {
    let n = 45;
    let s = grid(n, n);
    let ones = vec![1.0; n * n];
    let options = EigenOptions { slice: 40, ..lanczos() };
    let pairs = smallest_eigenpairs(&s, Mass::Lumped(&ones), 170, &options).unwrap();
    assert!(pairs.certified);
    check(&s, Mass::Lumped(&ones), &pairs, 1e-8);
    compare(&pairs.values, &grid_eigenvalues(n, n));
}

/// Dense and Lanczos agree on random masses, lumped and consistent.
#[test]
fn dense_and_lanczos_agree() {
    let s = grid(19, 23);
    let n = s.rows();
    let lumped: Vec<f64> = random_vector(n, 3).iter().map(|v| 1.5 + v).collect();
    // Lumped part plus a third of a graph Laplacian's complement: symmetric, diagonally dominant.
    let consistent = fairing_sparse::combine(1.0, Mass::Lumped(&lumped), -0.05, &s);
    for mass in [Mass::Lumped(&lumped), Mass::Consistent(&consistent)] {
        let dense = EigenOptions { dense_rows: 1000, ..Default::default() };
        let all = smallest_eigenpairs(&s, mass, n, &dense).unwrap();
        check(&s, mass, &all, 1e-11);
        let some = smallest_eigenpairs(&s, mass, 40, &lanczos()).unwrap();
        check(&s, mass, &some, 1e-8);
        compare(&some.values, &all.values);
        assert!(some.residuals.iter().all(|r| *r < 1e-8 * some.values[39]));
    }
}

/// Units of 10⁻⁶ and 10⁶ (masses of 10⁻¹² and 10¹²), and stiffness in any unit.
#[test]
fn units_do_not_matter() {
    let s = grid(33, 31);
    let m: Vec<f64> = random_vector(s.rows(), 9).iter().map(|v| 1.5 + v).collect();
    let reference = smallest_eigenpairs(&s, Mass::Lumped(&m), 12, &lanczos()).unwrap();
    for (mass_unit, stiffness_unit) in [(1e-12, 1.0), (1e12, 1.0), (1e-3, 1e9)] {
        let scaled: Vec<f64> = m.iter().map(|m| m * mass_unit).collect();
        let stiff = s.map(|v| v * stiffness_unit);
        let pairs = smallest_eigenpairs(&stiff, Mass::Lumped(&scaled), 12, &lanczos()).unwrap();
        let back: Vec<f64> = pairs.values.iter().map(|l| l * mass_unit / stiffness_unit).collect();
        compare(&back, &reference.values);
        check(&stiff, Mass::Lumped(&scaled), &pairs, 1e-8);
    }
}

#[test]
fn small_problems_give_all_modes() {
    for n in 1..12 {
        let s = path(n);
        let ones = vec![1.0; n];
        let pairs =
            smallest_eigenpairs(&s, Mass::Lumped(&ones), n, &EigenOptions::default()).unwrap();
        let expected: Vec<f64> = (0..n)
            .map(|k| 2.0 - 2.0 * (std::f64::consts::PI * k as f64 / n as f64).cos())
            .collect();
        assert_eq!(pairs.values[0], 0.0);
        if n > 1 {
            check(&s, Mass::Lumped(&ones), &pairs, 1e-12);
            compare(&pairs.values, &expected);
        }
    }
    // Only constants: no edge at all.
    let bare = graph_laplacian(30, []);
    let pairs = smallest_eigenpairs(&bare, Mass::Lumped(&[2.0; 30]), 7, &lanczos()).unwrap();
    assert_eq!(pairs.values, [0.0; 7]);
}

/// A pinned end takes the constant away: eigenvalues 2 − 2 cos(π(2k + 1)/(2n + 1)).
#[test]
fn pinned_problems_have_no_zero() {
    let n = 300;
    let mut end = vec![0.0; n];
    end[0] = 1.0;
    let s = fairing_sparse::combine(1.0, Mass::Lumped(&end), 1.0, &path(n));
    let ones = vec![1.0; n];
    let pairs = smallest_eigenpairs(&s, Mass::Lumped(&ones), 9, &lanczos()).unwrap();
    let expected: Vec<f64> = (0..9)
        .map(|k| 2.0 - 2.0 * (std::f64::consts::PI * (2 * k + 1) as f64 / (2 * n + 1) as f64).cos())
        .collect();
    check(&s, Mass::Lumped(&ones), &pairs, 1e-8);
    compare(&pairs.values, &expected);
    assert!((pairs.values[0] / expected[0] - 1.0).abs() < 1e-7);
}

#[test]
fn failures_are_errors() {
    let s = cycle(500);
    let ones = vec![1.0; 500];
    let lumped = Mass::Lumped(&ones);
    assert_eq!(
        smallest_eigenpairs(&s, lumped, 501, &lanczos()).unwrap_err(),
        SparseError::TooManyPairs { wanted: 501, rows: 500 }
    );
    let mut holes = ones.clone();
    holes[77] = 0.0;
    assert_eq!(
        smallest_eigenpairs(&s, Mass::Lumped(&holes), 3, &lanczos()).unwrap_err(),
        SparseError::MassNotPositive { row: 77, value: 0.0 }
    );
    let few = EigenOptions { max_blocks: 3, ..lanczos() };
    assert!(matches!(
        smallest_eigenpairs(&s, lumped, 40, &few),
        Err(SparseError::PairsNotConverged { wanted: 39, converged, .. }) if converged < 39
    ));
    let negative = s.map(|v| -v);
    assert!(matches!(
        smallest_eigenpairs(&negative, lumped, 3, &lanczos()),
        Err(SparseError::Factor { .. })
    ));
}

/// A cancelled watch ends the computation; a finished one has reached all pairs.
#[test]
fn watches_see_and_end_the_computation() {
    let s = grid(60, 50);
    let ones = vec![1.0; s.rows()];
    let find = || smallest_eigenpairs(&s, Mass::Lumped(&ones), 40, &lanczos());
    let watch = fairing_watch::Watch::new();
    assert!(watch.run(find).unwrap().is_ok());
    let progress = watch.progress();
    assert_eq!((progress.stage, progress.of), ("modes", 40));
    assert!(progress.done >= 39, "{progress:?}");
    watch.cancel();
    assert!(watch.run(find).is_err());
}

/// Same bits on one thread and on four, another seed gives other bits and the same spectrum.
#[test]
fn threads_do_not_change_bits() {
    let s = grid(90, 100);
    let ones = vec![1.0; 9000];
    let run = |threads: usize, seed: u64| {
        let options = EigenOptions { seed, ..Default::default() };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| smallest_eigenpairs(&s, Mass::Lumped(&ones), 20, &options).unwrap())
    };
    let once = run(1, 0);
    assert_eq!(once, run(4, 0));
    let other = run(2, 1);
    assert_ne!(once.vectors, other.vectors);
    compare(&once.values, &other.values);
}

/// Dense problems too: in units of 10⁻⁸ and 10⁸ residuals stay at rounding, relative to the norm of
/// M⁻¹S.
#[test]
fn units_do_not_matter_to_dense_problems() {
    let s = grid(21, 19);
    let weights: Vec<f64> = random_vector(s.rows(), 5).iter().map(|v| 1.5 + v).collect();
    for unit in [1e-12, 1e-8, 1.0, 1e8, 1e12] {
        let m: Vec<f64> = weights.iter().map(|w| w * unit).collect();
        let options = EigenOptions { dense_rows: s.rows(), ..Default::default() };
        let pairs = smallest_eigenpairs(&s, Mass::Lumped(&m), 40, &options).unwrap();
        check(&s, Mass::Lumped(&m), &pairs, 1e-8);
        // M⁻¹S is at most 16 / unit here; 40 such roundings are far more than was ever seen.
        assert!(pairs.residuals.iter().all(|r| r * unit < 40.0 * 16.0 * f64::EPSILON * 21.0));
    }
}

/// Masses must be positive numbers; the first that is not is named.
#[test]
fn masses_that_are_no_positive_numbers_are_named() {
    for value in [0.0, -1.0, f64::INFINITY, f64::NAN] {
        let error = Mass::Lumped(&[1.0, value, value]).check(3).unwrap_err();
        assert!(matches!(error, SparseError::MassNotPositive { row: 1, .. }), "{error}");
    }
    assert_eq!(Mass::Lumped(&[1.0, 2.0]).check(2), Ok(()));
    let error = Mass::Lumped(&[1.0, 2.0]).check(3);
    assert_eq!(error, Err(SparseError::MassSize { mass: 2, stiffness: 3 }));
}

/// A strip of m cells of 1 × h with lumped masses, as cotangents make it: 1/h across, h/2 along,
/// the diagonal rounded as a sum is. Its smallest eigenvalues are those of the path, 4 sin²(kπ/2m),
/// doubled at the ends' half mass.
fn strip(m: usize, h: f64) -> (SparseMatrix, Vec<f64>) {
    let n = 2 * (m + 1);
    let (mut t, mut masses) = (vec![], vec![0.0; n]);
    let mut tie =
        |i: usize, j: usize, w: f64| t.extend([(i as u32, j as u32, -w), (j as u32, i as u32, -w)]);
    for i in 0..=m {
        let share = if i == 0 || i == m { 0.5 } else { 1.0 };
        tie(2 * i, 2 * i + 1, share / h);
        masses[2 * i] = 0.5 * h * share;
        masses[2 * i + 1] = 0.5 * h * share;
        if i < m {
            tie(2 * i, 2 * i + 2, 0.5 * h);
            tie(2 * i + 1, 2 * i + 3, 0.5 * h);
        }
    }
    for i in 0..n {
        let diagonal = -t.iter().filter(|e| e.0 == i as u32).map(|e| e.2).sum::<f64>();
        t.push((i as u32, i as u32, diagonal));
    }
    (fairing_sparse::from_triplets((n, n), &t).unwrap(), masses)
}

/// A certified interval holds the eigenvalue, and the value itself is right to the tolerance of the
/// largest wanted, whatever k and the height; the stored diagonal alone would leave four digits at
/// 10⁻⁵.
#[test]
fn strips_of_any_height_have_the_spectrum_of_a_path() {
    for (m, dense_rows) in [(300, 0), (100, 0), (100, 400)] {
        for h in [1e-1, 1e-3, 1e-4, 1e-5] {
            let (s, masses) = strip(m, h);
            for k in [2, 3, 4, 6, 9, 20] {
                let options = EigenOptions { dense_rows, ..EigenOptions::default() };
                let pairs = smallest_eigenpairs(&s, Mass::Lumped(&masses), k, &options).unwrap();
                for i in 1..k {
                    let angle = std::f64::consts::PI * i as f64 / (2 * m) as f64;
                    let expected = 4.0 * angle.sin().powi(2);
                    let error = (pairs.values[i] - expected).abs();
                    let largest = pairs.values[k - 1];
                    assert!(error < 1e-9 * largest, "{m} {h} {k}: {i} is off by {error:e}");
                    let allowed = pairs.residuals[i] + 1e-12 * expected;
                    assert!(!pairs.certified || error <= allowed, "{m} {h} {k}: {i}, {error:e}");
                }
            }
        }
    }
}

/// Components of different sizes and scales, pinned and free, equal and not: the merge of their
/// spectra, each vector zero outside its own component.
#[test]
fn components_are_solved_apart() {
    let lengths = [3, 40, 500, 7, 500, 90, 7, 7, 12, 700];
    let (mut t, mut masses, mut expected, mut start) = (vec![], vec![], vec![], 0);
    for (c, &n) in lengths.iter().enumerate() {
        let weight = [1.0, 0.25, 4.0][c % 3];
        let pinned = c % 4 == 1;
        for i in 0..n {
            let ends = usize::from(i == 0) + usize::from(i == n - 1);
            let ties = if pinned { 2.0 } else { 2.0 - ends as f64 };
            let row = (start + i) as u32;
            t.push((row, row, weight * ties));
            if i > 0 {
                t.push((row, row - 1, -weight));
                t.push((row - 1, row, -weight));
            }
            let denominator = if pinned { n + 1 } else { n } as f64;
            let k = (i + usize::from(pinned)) as f64;
            let half = (0.5 * std::f64::consts::PI * k / denominator).sin();
            expected.push(4.0 * weight * half * half);
        }
        masses.extend(vec![1.0; n]);
        start += n;
    }
    expected.sort_by(f64::total_cmp);
    let s = fairing_sparse::from_triplets((start, start), &t).unwrap();
    let mass = Mass::Lumped(&masses);
    for k in [1, 5, 8, 9, 12, 40, 200] {
        let pairs = smallest_eigenpairs(&s, mass, k, &EigenOptions::default()).unwrap();
        assert!(pairs.certified);
        check(&s, mass, &pairs, 1e-8);
        compare(&pairs.values, &expected[..k]);
        for column in pairs.vectors.columns() {
            let mut from = 0;
            let inside = lengths.iter().filter(|&&n| {
                from += n;
                column.iter().take(from).skip(from - n).any(|v| *v != 0.0)
            });
            assert_eq!(inside.count(), 1);
        }
        let next = &pairs.beyond.values;
        if !next.is_empty() {
            compare(next, &expected[k..k + next.len()]);
        }
        assert!(expected.get(k + next.len()).is_none_or(|l| *l >= pairs.beyond.clear_below));
    }
}

/// Eighty equal arms joined at a hub: every second eigenvalue is 79-fold, in one component.
#[test]
fn restarts_go_on_while_they_find_more() {
    let (arms, length) = (80, 9);
    let edges = (0..arms * length).map(|i| (i + 1, if i % length == 0 { 0 } else { i }));
    let s = graph_laplacian(arms * length + 1, edges);
    let ones = vec![1.0; arms * length + 1];
    let pairs = smallest_eigenpairs(&s, Mass::Lumped(&ones), 60, &lanczos()).unwrap();
    check(&s, Mass::Lumped(&ones), &pairs, 1e-8);
    // An arm whose hub rests: a path pinned at one end.
    let at = 2.0 - 2.0 * (std::f64::consts::PI / (2 * length + 1) as f64).cos();
    compare(&pairs.values[1..], &vec![at; 59]);
}

/// Eigenvalues of the grid minus 3, with and without Lanczos, up to scale.
#[test]
fn indefinite_matrices_have_negative_eigenvalues() {
    let (nx, ny) = (31, 27);
    let (s, ones) = (grid(nx, ny), vec![1.0; nx * ny]);
    for scale in [1.0, 1e-12, 1e9] {
        let s = combine(-3.0 * scale, Mass::Lumped(&ones), scale, &s);
        for k in [1, 5, 40] {
            let options = lanczos();
            let pairs =
                smallest_symmetric_eigenpairs(&s, Mass::Lumped(&ones), k, &options).unwrap();
            assert!(pairs.certified);
            for (found, expected) in pairs.values.iter().zip(grid_eigenvalues(nx, ny)) {
                assert!((found / scale - (expected - 3.0)).abs() < 1e-9, "{k} {found}");
            }
        }
    }
    // The lowest of a long path are close to each other beside their distance from zero.
    let shifted_path = combine(-4.0, Mass::Lumped(&[1.0; 2000]), 1.0, &path(2000));
    let pairs =
        smallest_symmetric_eigenpairs(&shifted_path, Mass::Lumped(&[1.0; 2000]), 4, &lanczos())
            .unwrap();
    for (j, found) in pairs.values.iter().enumerate() {
        let expected = -2.0 - 2.0 * (std::f64::consts::PI * j as f64 / 2000.0).cos();
        assert!((found - expected).abs() < 1e-10, "{j} {found}");
    }
    // Positive semi-definite: zero stays exactly zero.
    let pairs = smallest_symmetric_eigenpairs(&s, Mass::Lumped(&ones), 9, &lanczos()).unwrap();
    assert_eq!(pairs, smallest_eigenpairs(&s, Mass::Lumped(&ones), 9, &lanczos()).unwrap());
    let lonely = SparseMatrix::new((2, 2), vec![0, 2, 3], vec![0, 1, 1], vec![1.0, 2.0, 1.0]);
    let options = EigenOptions::default();
    let error = smallest_symmetric_eigenpairs(&lonely, Mass::Lumped(&[1.0; 2]), 1, &options);
    assert!(matches!(error, Err(SparseError::NotSymmetric { row: 0, column: 1, .. })));
}
