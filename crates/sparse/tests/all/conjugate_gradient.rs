//! Conjugate gradients against known solutions and against Cholesky.

use std::sync::atomic::{AtomicUsize, Ordering};

use fairing_sparse::{
    CgOptions, CgSolution, Cholesky, FieldOperator, Mass, SparseMatrix, combine,
    conjugate_gradients, multiply_points, product_by_rows,
};
use proptest::prelude::*;

use crate::matrices::{grid, random_definite, random_vector};

/// The solution from a guess, and the number of products.
fn solve(
    a: &SparseMatrix,
    b: &[[f64; 3]],
    guess: &[[f64; 3]],
    options: &CgOptions,
) -> (CgSolution, usize) {
    let rows: Vec<_> = a.outer_iterator().collect();
    let products = AtomicUsize::new(0);
    let operator = FieldOperator::new(&a.diag().to_dense().to_vec(), |p, q| {
        products.fetch_add(1, Ordering::Relaxed);
        product_by_rows(p, q, |i| {
            let row = rows[i].iter();
            row.fold([0.0; 3], |sum, (j, a)| std::array::from_fn(|k| sum[k] + a * p[j][k]))
        })
    });
    let found = conjugate_gradients(&operator, b, guess.to_vec(), options);
    (found, products.load(Ordering::Relaxed))
}

/// ‖b − A x‖ / ‖b‖ over all coordinates.
fn residual(a: &SparseMatrix, b: &[[f64; 3]], x: &[[f64; 3]]) -> f64 {
    let norm = |v: &[f64]| v.iter().map(|v| v * v).sum::<f64>().sqrt();
    let (image, b) = (multiply_points(a, x), b.as_flattened());
    let rest: Vec<f64> = b.iter().zip(image.as_flattened()).map(|(b, p)| b - p).collect();
    norm(&rest) / norm(b)
}

/// Three columns, one of them zero.
fn columns(n: usize, seed: u64) -> Vec<[f64; 3]> {
    random_vector(n, seed).into_iter().map(|v| [v, 0.0, 1e-3 * v * v]).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn solutions_are_found_again(n in 1usize..200, density in 0usize..4, seed: u64) {
        let a = random_definite(n, density * n, seed);
        let x = columns(n, seed);
        let options = CgOptions { tolerance: 1e-12, ..Default::default() };
        let (solution, _) = solve(&a, &multiply_points(&a, &x), &vec![[0.0; 3]; n], &options);
        prop_assert!(solution.residual <= 1e-12);
        // The condition number is below 10³.
        let pairs = solution.x.as_flattened().iter().zip(x.as_flattened());
        prop_assert!(pairs.map(|(x, y)| (x - y).powi(2)).sum::<f64>().sqrt() < 1e-8);
    }
}

#[test]
fn solutions_agree_with_cholesky() {
    let n = 90 * 70;
    let a = combine(1.0, Mass::Lumped(&vec![1.0; n]), 30.0, &grid(90, 70));
    let b = multiply_points(&a, &columns(n, 1));
    let options = CgOptions::default();
    let (found, _) = solve(&a, &b, &b, &options);
    assert!(found.residual <= options.tolerance && found.x.iter().all(|x| x[1].abs() < 1e-12));
    let direct = Cholesky::new(&a).unwrap().solve_points(&b);
    for (x, y) in found.x.as_flattened().iter().zip(direct.as_flattened()) {
        assert!((x - y).abs() < 1e-8, "{x} {y}");
    }
    let looser = CgOptions { tolerance: 1e-9, ..options };
    assert_eq!(solve(&a, &b, &found.x, &looser).0.iterations, 0, "its own best guess");
    let (nothing, _) = solve(&a, &vec![[0.0; 3]; n], &b, &options);
    assert_eq!((nothing.residual, nothing.x), (0.0, vec![[0.0; 3]; n]));
}

/// An indefinite matrix and too few iterations leave a residual above the tolerance.
#[test]
fn residuals_show_failures() {
    let options = CgOptions::default();
    let (singular, b) = (grid(5, 5), columns(25, 1));
    let negative = combine(-0.5, Mass::Lumped(&[1.0; 25]), 1.0, &singular);
    let (found, _) = solve(&negative, &b, &[[0.0; 3]; 25], &options);
    assert!(found.residual > options.tolerance, "{found:?}");
    let definite = combine(0.5, Mass::Lumped(&[1.0; 25]), 1.0, &singular);
    let few = CgOptions { max_iterations: 2, ..options };
    let (found, _) = solve(&definite, &b, &[[0.0; 3]; 25], &few);
    assert!(found.iterations == 2 && found.residual > options.tolerance, "{found:?}");
    let infinite = vec![[f64::INFINITY; 3]; 25];
    assert!(solve(&definite, &infinite, &[[0.0; 3]; 25], &options).0.residual.is_nan());
}

/// Same bits on one thread and on four.
#[test]
fn threads_do_not_change_bits() {
    let n = 120 * 130;
    let a = combine(1.0, Mass::Lumped(&vec![1.0; n]), 20.0, &grid(120, 130));
    let b: Vec<[f64; 3]> = random_vector(n, 2).into_iter().map(|v| [v, v * v, 1.0 - v]).collect();
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| solve(&a, &b, &vec![[0.0; 3]; n], &CgOptions::default()))
    };
    assert_eq!(run(1), run(4));
}

/// The residual of the iteration is that of the solution up to rounding, which costs no further
/// product; below rounding, the iteration still ends.
#[test]
fn residuals_are_those_of_the_solution() {
    let s = grid(30, 30);
    let a = combine(1e-3, Mass::Lumped(&vec![1.0; s.rows()]), 1.0, &s);
    let (b, zero) = (columns(s.rows(), 8), vec![[0.0; 3]; s.rows()]);
    for (tolerance, reached) in [(1e-4, 1e-4), (1e-10, 1e-10), (1e-20, 1e-12)] {
        let options = CgOptions { tolerance, ..Default::default() };
        let (found, products) = solve(&a, &b, &zero, &options);
        let residual = residual(&a, &b, &found.x);
        // Rounding of A x, whose terms are up to a thousand times b.
        let rounding = 1000.0 * f64::EPSILON;
        let difference = (found.residual - residual).abs();
        assert!(difference <= 1e-3 * residual + rounding, "{difference:e} of {residual:e}");
        assert!(found.residual <= tolerance && residual <= 1.001 * reached);
        assert_eq!(products, found.iterations);
    }
}
