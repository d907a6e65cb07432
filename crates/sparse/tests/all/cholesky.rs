//! Factorisations against products: A x is formed first, so the error of x is known.

use fairing_sparse::{
    Cholesky, Mass, Ordering, SparseError, SparseMatrix, SymbolicCholesky, combine, multiply,
    multiply_block, multiply_points,
};
use ndarray::Array2;
use proptest::prelude::*;

use crate::matrices::{
    cycle, distance, graph_laplacian, grid, grid_eigenvalues, path, random_definite, random_vector,
};

fn shifted(laplacian: &SparseMatrix, sigma: f64) -> SparseMatrix {
    let ones = vec![1.0; laplacian.rows()];
    combine(-sigma, Mass::Lumped(&ones), 1.0, laplacian)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    /// One, three and k right-hand sides, under every ordering.
    /// Condition numbers stay below 10³, so twelve digits are there.
    #[test]
    fn solutions_are_found_again(n in 1usize..120, density in 0usize..4, k in 1usize..20, seed: u64) {
        let a = random_definite(n, density * n, seed);
        let reverse = Ordering::Custom((0..n as u32).rev().collect());
        for ordering in [
            Ordering::MinimumDegree,
            Ordering::NestedDissection,
            Ordering::LeastFill,
            Ordering::Natural,
            reverse,
        ] {
            let factor = SymbolicCholesky::new(&a, ordering).unwrap().factorize(&a).unwrap();
            let x = random_vector(n, seed);
            prop_assert!(distance(&factor.solve(&multiply(&a, &x)), &x) < 1e-12);
            let points: Vec<[f64; 3]> = x.iter().map(|&v| [v, -2.0 * v, 1.0 - v]).collect();
            let solved = factor.solve_points(&multiply_points(&a, &points));
            prop_assert!(distance(solved.as_flattened(), points.as_flattened()) < 1e-12);
            let block = Array2::from_shape_fn((n, k), |(i, j)| x[(i * (j + 1)) % n]);
            let solved = factor.solve_block(multiply_block(&a, block.view()).view());
            prop_assert!((&solved - &block).iter().all(|d| d.abs() < 1e-12));
        }
    }

    /// The inertia of a diagonal congruence is that of the diagonal, which has known signs.
    #[test]
    fn inertia_counts_signs(signs in proptest::collection::vec(any::<bool>(), 1..60), seed: u64) {
        let n = signs.len();
        // L D Lᵀ with L = I + E of a path: tridiagonal, D as drawn.
        let d: Vec<f64> = signs.iter().map(|s| if *s { 1.5 } else { -0.75 }).collect();
        let l = random_vector(n, seed);
        let mut t = sprs::TriMatI::<f64, u32>::new((n, n));
        for i in 0..n {
            t.add_triplet(i, i, d[i]);
            if i > 0 {
                let e = l[i];
                t.add_triplet(i, i, e * e * d[i - 1]);
                t.add_triplet(i, i - 1, e * d[i - 1]);
                t.add_triplet(i - 1, i, e * d[i - 1]);
            }
        }
        let a: SparseMatrix = t.to_csr();
        let ldlt = SymbolicCholesky::new(&a, Ordering::Natural).unwrap().factorize_indefinite(&a).unwrap();
        prop_assert_eq!(ldlt.inertia().negative, signs.iter().filter(|s| !**s).count());
        prop_assert_eq!(ldlt.inertia().positive, signs.iter().filter(|s| **s).count());
    }
}

/// Slicing the spectrum of a cycle: double eigenvalues 2 − 2 cos(2πk/n).
#[test]
fn inertia_counts_eigenvalues_below_a_shift() {
    let n = 101;
    let laplacian = cycle(n);
    let symbolic = SymbolicCholesky::new(&laplacian, Ordering::default()).unwrap();
    for below in [1usize, 3, 21, 99] {
        let at = |k: f64| 2.0 - 2.0 * (2.0 * std::f64::consts::PI * k / n as f64).cos();
        // Halfway would also be an eigenvalue of half the cycle, a leading block: growth is then
        // 10¹².
        let sigma = at((below as f64 - 1.0) / 2.0 + 0.4);
        let ldlt = symbolic.factorize_indefinite(&shifted(&laplacian, sigma)).unwrap();
        assert_eq!(ldlt.inertia().negative, below, "sigma {sigma}, growth {}", ldlt.growth());
        let x = random_vector(n, 3);
        let b = multiply(&shifted(&laplacian, sigma), &x);
        // The nearest eigenvalue is about 10⁻³ away.
        let error = distance(&ldlt.solve(&b), &x);
        assert!(error < 1e-10, "{error:e} at sigma {sigma}, growth {}", ldlt.growth());
    }
}

/// On a grid, with shifts anywhere.
#[test]
fn inertia_matches_the_spectrum_of_a_grid() {
    let laplacian = grid(23, 17);
    let eigenvalues = grid_eigenvalues(23, 17);
    let symbolic = SymbolicCholesky::new(&laplacian, Ordering::default()).unwrap();
    for sigma in [-0.5, 1e-4, 0.0321, 0.4444, 1.9, 4.123, 7.9, 9.0] {
        let inertia = symbolic.factorize_indefinite(&shifted(&laplacian, sigma)).unwrap().inertia();
        assert_eq!(inertia.negative, eigenvalues.iter().filter(|l| **l < sigma).count());
    }
}

#[test]
fn logarithms_of_pivots_sum_to_that_of_the_determinant() {
    let (nx, ny, sigma) = (23, 31, -1e-3);
    let factor = Cholesky::new(&shifted(&grid(nx, ny), sigma)).unwrap();
    let expected: f64 = grid_eigenvalues(nx, ny).iter().map(|l| (l - sigma).ln()).sum();
    assert!((factor.log_determinant() / expected - 1.0).abs() < 1e-11);
}

#[test]
fn symbolic_analysis_serves_changed_values() {
    let laplacian = grid(30, 20);
    let symbolic = SymbolicCholesky::new(&shifted(&laplacian, -1.0), Ordering::default()).unwrap();
    let x = random_vector(600, 1);
    for sigma in [-1.0, -1e-3, -5.0, -1e8] {
        let a = shifted(&laplacian, sigma);
        let factor = symbolic.factorize(&a).unwrap();
        assert!(distance(&factor.solve(&multiply(&a, &x)), &x) < 1e-10);
    }
    let other = shifted(&grid(20, 30), -1.0);
    assert!(matches!(symbolic.factorize(&other), Err(SparseError::PatternChanged { .. })));
    assert!(matches!(
        symbolic.factorize(&shifted(&path(4), -1.0)),
        Err(SparseError::PatternChanged { .. })
    ));
}

#[test]
fn singular_and_indefinite_matrices_name_the_pivot() {
    // A whole Laplacian is singular, whatever rounding says.
    for laplacian in [path(40), cycle(41), grid(15, 17)] {
        let error = Cholesky::new(&laplacian).unwrap_err();
        assert!(matches!(error, SparseError::Singular { .. }), "{error}");
    }
    // Row 7 stands alone with a negative entry.
    let mut t = sprs::TriMatI::<f64, u32>::new((9, 9));
    for i in 0..9 {
        t.add_triplet(i, i, if i == 7 { -2.0 } else { 2.0 });
    }
    assert_eq!(
        Cholesky::new(&t.to_csr()).unwrap_err(),
        SparseError::Indefinite { row: 7, pivot: -2.0, diagonal: -2.0 }
    );
    // An isolated vertex without mass: its row is zero.
    let isolated = graph_laplacian(4, [(0, 1), (1, 3)]);
    let masses = combine(1.0, Mass::Lumped(&[1.0, 1.0, 0.0, 1.0]), 1.0, &isolated);
    assert_eq!(
        Cholesky::new(&masses).unwrap_err(),
        SparseError::Singular { row: 2, pivot: 0.0, diagonal: 0.0 }
    );
    assert!(matches!(
        Cholesky::new(&shifted(&grid(9, 9), 0.5)),
        Err(SparseError::Indefinite { .. })
    ));
}

#[test]
fn bad_input_is_named() {
    let rectangle = SparseMatrix::zero((2, 3));
    assert_eq!(
        Cholesky::new(&rectangle).unwrap_err(),
        SparseError::NotSquare { rows: 2, columns: 3 }
    );
    let laplacian = path(3);
    for order in [vec![0, 1], vec![0, 1, 1], vec![0, 1, 3], vec![0, 1, 2, 3]] {
        assert!(matches!(
            SymbolicCholesky::new(&laplacian, Ordering::Custom(order)),
            Err(SparseError::NotAnOrdering { .. })
        ));
    }
    let empty = Cholesky::new(&SparseMatrix::zero((0, 0))).unwrap();
    assert!(empty.solve(&[]).is_empty());
}

/// At a tiny step the factor decays below the smallest normal number far from the diagonal.
#[test]
fn scales_and_decay_do_not_hurt() {
    let laplacian = grid(60, 60);
    let ones = vec![1.0; 3600];
    let x = random_vector(3600, 5);
    for t in [1e-12, 1e-6, 1e-2, 1.0, 1e3] {
        for scale in [1e-150, 1e-12, 1.0, 1e12, 1e150] {
            let a = combine(scale, Mass::Lumped(&ones), t * scale, &laplacian);
            let b = multiply(&a, &x);
            let solved = Cholesky::new(&a).unwrap().solve(&b);
            // The condition number is 1 + 8t.
            assert!(distance(&solved, &x) < 1e-14 * (1.0 + 8.0 * t) + 1e-14, "{t} {scale}");
        }
    }
}

/// Same bits on one thread and on four.
#[test]
fn threads_do_not_change_bits() {
    let laplacian = grid(120, 130);
    let a = shifted(&laplacian, -0.1);
    let block = Array2::from_shape_fn((a.rows(), 19), |(i, j)| ((i * 31 + j * 17) % 101) as f64);
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let factor = Cholesky::new(&a).unwrap();
            let indefinite = SymbolicCholesky::new(&a, Ordering::default())
                .unwrap()
                .factorize_indefinite(&shifted(&laplacian, 0.01))
                .unwrap();
            let mut x = block.clone();
            indefinite.solve_block_in_place(x.view_mut());
            (factor.solve_block(block.view()), x, multiply_block(&a, block.view()))
        })
    };
    assert_eq!(run(1), run(4));
}

/// `LeastFill` takes the sparser factor: on a cube of nodes, whose fill is large enough for both
/// orderings to be tried, and on a plane grid, which is as sparse as most meshes and not dissected
/// at all.
#[test]
fn least_fill_is_the_least() {
    let side = 20;
    let n = side * side * side;
    let cube = graph_laplacian(
        n,
        (0..n).flat_map(|v| {
            let steps = [(1, v % side), (side, v / side % side), (side * side, v / (side * side))];
            steps.into_iter().filter(|s| s.1 + 1 < side).map(move |s| (v, v + s.0))
        }),
    );
    let fill =
        |a: &SparseMatrix, ordering| SymbolicCholesky::new(a, ordering).unwrap().factor_entries();
    for a in [cube, grid(80, 80)] {
        let degree = fill(&a, Ordering::MinimumDegree);
        let dissected = fill(&a, Ordering::NestedDissection);
        assert_eq!(fill(&a, Ordering::LeastFill), degree.min(dissected));
        // Dissection is the sparser one often enough to be tried.
        assert!(dissected < degree + degree / 2, "{dissected} {degree}");
    }
}

/// A tiny pivot in one block shows beside another block of entries 10⁹ times as large; definite
/// matrices have no growth.
#[test]
fn growth_is_measured_row_by_row() {
    use fairing_sparse::{Ordering, SparseMatrix, SymbolicCholesky};
    let grown = |corner: f64| {
        let values = vec![1e9, corner, 1.0, 1.0, 2.0];
        let (starts, columns) = (vec![0, 1, 3, 5], vec![0, 1, 2, 1, 2]);
        let matrix = SparseMatrix::new((3, 3), starts, columns, values);
        let symbolic = SymbolicCholesky::new(&matrix, Ordering::Natural).unwrap();
        symbolic.factorize_indefinite(&matrix).unwrap().growth()
    };
    assert!(grown(1e-10) > 1e9, "{:e}", grown(1e-10));
    assert_eq!(grown(1.0), 1.0);
}

/// The sums of a factor that is cut into parts are those of L |D| Lᵀ: the diagonal, of a definite
/// matrix.
#[test]
fn definite_matrices_have_no_growth() {
    let s = crate::matrices::grid(130, 140);
    let ones = vec![1.0; s.rows()];
    let matrix = fairing_sparse::combine(0.1, fairing_sparse::Mass::Lumped(&ones), 1.0, &s);
    for ordering in
        [fairing_sparse::Ordering::NestedDissection, fairing_sparse::Ordering::LeastFill]
    {
        let symbolic = fairing_sparse::SymbolicCholesky::new(&matrix, ordering).unwrap();
        let growth = symbolic.factorize_indefinite(&matrix).unwrap().growth();
        assert!((growth - 1.0).abs() < 1e-12, "{growth}");
    }
}

/// An entry may differ from its mirror image by rounding, a share of 10⁻¹⁰ of the larger diagonal
/// entry, not by more.
#[test]
fn symmetry_is_asked_for_up_to_rounding() {
    let factor = |difference: f64| {
        let values = vec![4.0, 1.0, 1.0 + difference, 2.0];
        Cholesky::new(&SparseMatrix::new((2, 2), vec![0, 2, 4], vec![0, 1, 0, 1], values))
    };
    assert!(factor(3e-10).is_ok());
    for difference in [1e-9, -1e-9, 1e-3] {
        let error = factor(difference).unwrap_err();
        assert!(matches!(error, SparseError::NotSymmetric { row: 1, column: 0, .. }), "{error}");
    }
}
