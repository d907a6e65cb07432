//! Conjugate gradients against known solutions and against Cholesky.

use fairing_sparse::{
    CgOptions, Cholesky, ConjugateGradient, Mass, SparseError, SparseMatrix, combine, multiply,
    multiply_points,
};
use proptest::prelude::*;

use crate::matrices::{distance, grid, random_definite, random_vector};

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn solutions_are_found_again(n in 1usize..200, density in 0usize..4, seed: u64) {
        let a = random_definite(n, density * n, seed);
        let x = random_vector(n, seed);
        let options = CgOptions { tolerance: 1e-12, ..Default::default() };
        let cg = ConjugateGradient::new(&a).unwrap();
        let solution = cg.solve(&multiply(&a, &x), None, &options).unwrap();
        prop_assert!(solution.residuals[0] < 1e-11);
        // The condition number is below 10³.
        prop_assert!(distance(&solution.x, &x) < 1e-8);
    }
}

/// Three columns of very different size and one of zeros, each to its own relative residual.
#[test]
fn columns_converge_on_their_own() {
    let n = 90 * 70;
    let a = combine(1.0, Mass::Lumped(&vec![1.0; n]), 30.0, &grid(90, 70));
    let u = random_vector(n, 1);
    let x: Vec<[f64; 3]> = (0..n).map(|i| [1e9 * u[i], 0.0, 1e-9 * (i % 7) as f64]).collect();
    let b = multiply_points(&a, &x);
    let cg = ConjugateGradient::new(&a).unwrap();
    let solution = cg.solve_points(&b, None, &CgOptions::default()).unwrap();
    assert!(solution.residuals.iter().all(|r| *r < 1.1e-10), "{:?}", solution.residuals);
    assert!(solution.x.iter().all(|x| x[1] == 0.0));
    let direct = Cholesky::new(&a).unwrap().solve_points(&b);
    for lane in [0, 2] {
        let worst =
            (0..n).map(|i| (solution.x[i][lane] - direct[i][lane]).abs()).fold(0.0, f64::max);
        let size = (0..n).map(|i| direct[i][lane].abs()).fold(0.0, f64::max);
        assert!(worst < 1e-8 * size, "column {lane}: {worst:e} of {size:e}");
    }
    let again = cg.solve_points(
        &b,
        Some(&solution.x),
        &CgOptions { tolerance: 1e-9, ..Default::default() },
    );
    assert_eq!(again.unwrap().iterations, 0, "the solution is its own best guess");
}

#[test]
fn failures_are_errors() {
    let options = CgOptions::default();
    let singular = grid(5, 5);
    let negative = combine(-0.5, Mass::Lumped(&[1.0; 25]), 1.0, &singular);
    let b = random_vector(25, 1);
    let cg = ConjugateGradient::new(&negative).unwrap();
    assert!(matches!(cg.solve(&b, None, &options), Err(SparseError::NegativeCurvature { .. })));
    let definite = combine(0.5, Mass::Lumped(&[1.0; 25]), 1.0, &singular);
    let cg = ConjugateGradient::new(&definite).unwrap();
    assert!(matches!(
        cg.solve(&b, None, &CgOptions { max_iterations: 2, ..options }),
        Err(SparseError::NotConverged { iterations: 2, residual, .. }) if residual > 1e-10
    ));
    assert_eq!(
        cg.solve(&b[..7], None, &options).unwrap_err(),
        SparseError::Size { rows: 25, columns: 25, length: 7 }
    );
    let mut infinite = b.clone();
    infinite[3] = f64::INFINITY;
    assert_eq!(
        cg.solve(&infinite, None, &options).unwrap_err(),
        SparseError::VectorNotFinite { row: 3 }
    );
    let zero = SparseMatrix::zero((2, 2));
    assert_eq!(
        ConjugateGradient::new(&zero).unwrap_err(),
        SparseError::Diagonal { row: 0, value: 0.0 }
    );
}

/// Same bits on one thread and on four.
#[test]
fn threads_do_not_change_bits() {
    let n = 120 * 130;
    let a = combine(1.0, Mass::Lumped(&vec![1.0; n]), 20.0, &grid(120, 130));
    let b: Vec<[f64; 3]> = random_vector(n, 2).into_iter().map(|v| [v, v * v, 1.0 - v]).collect();
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let cg = ConjugateGradient::new(&a).unwrap();
            cg.solve_points(&b, None, &CgOptions::default()).unwrap()
        })
    };
    assert_eq!(run(1), run(4));
}

/// With a tolerance below rounding the solver stops at rounding level and reports the true
/// residual.
#[test]
fn residuals_are_measured() {
    use fairing_sparse::{CgOptions, ConjugateGradient, Mass, combine, multiply};
    let s = crate::matrices::grid(30, 30);
    let a = combine(1e-3, Mass::Lumped(&vec![1.0; s.rows()]), 1.0, &s);
    let b = crate::matrices::random_vector(s.rows(), 8);
    let cg = ConjugateGradient::new(&a).unwrap();
    for tolerance in [1e-10, 1e-20, 0.0] {
        let options = CgOptions { tolerance, max_iterations: 2000, ..Default::default() };
        let Ok(found) = cg.solve(&b, None, &options) else {
            assert_eq!(tolerance, 0.0, "only this cannot be reached");
            continue;
        };
        let product = multiply(&a, &found.x);
        let norm = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        let rest: Vec<f64> = b.iter().zip(&product).map(|(b, p)| b - p).collect();
        let residual = norm(&rest) / norm(&b);
        assert!((found.residuals[0] - residual).abs() <= 1e-3 * residual);
        assert!(residual > 1e-17 && residual < 1e-9);
    }
}

/// Without measuring, a solution takes one product less and is the same; the residual is that of
/// the iteration.
#[test]
fn residuals_need_not_be_measured() {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use fairing_sparse::{CgSystem, conjugate_gradients};

    struct Counted<'a>(ConjugateGradient<'a>, AtomicUsize);
    impl CgSystem<3> for Counted<'_> {
        fn multiply(&self, p: &[[f64; 3]], q: &mut Vec<[f64; 3]>) -> [f64; 3] {
            self.1.fetch_add(1, Ordering::Relaxed);
            self.0.multiply(p, q)
        }

        fn precondition(&self, i: usize, r: [f64; 3]) -> [f64; 3] {
            self.0.precondition(i, r)
        }

        fn is_coupled(&self) -> bool {
            true
        }
    }

    let n = 60 * 50;
    let a = combine(1.0, Mass::Lumped(&vec![1.0; n]), 5.0, &grid(60, 50));
    let b: Vec<[f64; 3]> = random_vector(n, 3).into_iter().map(|v| [v, 1e-3 * v, v * v]).collect();
    let solve = |measure: bool| {
        let system = Counted(ConjugateGradient::new(&a).unwrap(), AtomicUsize::new(0));
        let options = CgOptions { tolerance: 1e-8, measure, ..Default::default() };
        let (found, failure) = conjugate_gradients(&system, &b, vec![[0.0; 3]; n], &options);
        assert_eq!(failure, None);
        (found, system.1.into_inner())
    };
    let ((measured, products), (carried, fewer)) = (solve(true), solve(false));
    assert_eq!((products, fewer), (measured.iterations + 1, carried.iterations));
    assert_eq!(measured.x, carried.x);
    for k in 0..3 {
        // One number for all coordinates; both residuals are the same to rounding of b.
        assert_eq!(measured.residuals[k], measured.residuals[0]);
        assert!((measured.residuals[k] / carried.residuals[k] - 1.0).abs() < 1e-5);
        assert!(measured.residuals[k] <= 1e-8 && measured.residuals[k] > 1e-10);
    }
}

/// From a guess far away the residual that is carried along departs from the true one by the
/// rounding of the guess. The true one counts: it ends at the goal and a few roundings of the terms
/// of A x and b.
#[test]
fn residuals_end_at_the_rounding_of_the_solution() {
    let n = 40 * 30;
    let a = combine(1.0, Mass::Lumped(&vec![1.0; n]), 30.0, &grid(40, 30));
    let size = a.map(|value| value.abs());
    let cg = ConjugateGradient::new(&a).unwrap();
    let norm = |v: Vec<f64>| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    for seed in 0..8 {
        let b = multiply(&a, &random_vector(n, seed));
        let guess: Vec<f64> = random_vector(n, seed + 100).iter().map(|x| 1e5 * x).collect();
        let options = CgOptions { tolerance: 1e-15, ..Default::default() };
        let x = cg.solve(&b, Some(&guess), &options).unwrap().x;
        let terms = multiply(&size, &x.iter().map(|x| x.abs()).collect::<Vec<_>>());
        let residual = norm(multiply(&a, &x).iter().zip(&b).map(|(r, b)| b - r).collect());
        let rounding = norm(terms.iter().zip(&b).map(|(t, b)| t + b.abs()).collect());
        let most = 1e-15 * norm(b.clone()) + 8.0 * f64::EPSILON * rounding;
        assert!(residual <= most, "{residual:e} {most:e}");
    }
}
