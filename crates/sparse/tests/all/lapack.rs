//! An independent oracle: eigenpairs against those of LAPACK, and against LOBPCG.

use fairing_sparse::{Cholesky, EigenOptions, Mass, combine, smallest_eigenpairs};
use ndarray::{Array1, Array2, ArrayView1, ArrayView2, Axis, Slice};
use ndarray_linalg::lobpcg::{LobpcgResult, TruncatedOrder, lobpcg};
use ndarray_linalg::{Eigh, UPLO};

use crate::matrices::{grid, random_vector};

fn lanczos() -> EigenOptions {
    EigenOptions { dense_rows: 20, ..Default::default() }
}

fn dense() -> EigenOptions {
    EigenOptions { dense_rows: 2000, ..Default::default() }
}

fn dense_mass(mass: Mass<'_>) -> Array2<f64> {
    match mass {
        Mass::Lumped(m) => Array2::from_diag(&ArrayView1::from(m)),
        Mass::Consistent(m) => m.to_dense(),
    }
}

/// Sine of the largest angle between the spans of M-orthonormal columns: ‖B − A Aᵀ M B‖ in the M
/// norm.
fn angle(a: ArrayView2<'_, f64>, b: ArrayView2<'_, f64>, m: &Array2<f64>) -> f64 {
    let rest = &b - &a.dot(&a.t().dot(&m.dot(&b)));
    rest.t().dot(&m.dot(&rest)).diag().iter().fold(0.0, |worst: f64, d| worst.max(d.abs())).sqrt()
}

/// Both paths against `dsygv` called here, values and invariant subspaces, for lumped and
/// consistent masses in units far from one.
#[test]
fn every_path_agrees_with_lapack() {
    let s = grid(21, 19);
    let n = s.rows();
    let k = 40;
    let lumped: Vec<f64> = random_vector(n, 5).iter().map(|v| 1e-8 * (1.5 + v)).collect();
    let consistent = combine(1.0, Mass::Lumped(&lumped), -0.05e-8, &s);
    for mass in [Mass::Lumped(&lumped), Mass::Consistent(&consistent)] {
        let m = dense_mass(mass);
        let (values, (vectors, _)) = (s.to_dense(), m.clone()).eigh(UPLO::Lower).unwrap();
        let scale = values[k];
        // Where the spectrum has a gap of a hundredth, spans are determined to the residual over
        // the gap.
        let cut = (k / 2..k).find(|&i| values[i] - values[i - 1] > 0.01 * values[i]).unwrap();
        for (options, rounding) in [(dense(), 1e-12), (lanczos(), 1e-10)] {
            let pairs = smallest_eigenpairs(&s, mass, k, &options)
                .unwrap_or_else(|e| panic!("{} rows, {mass:?}: {e}", options.dense_rows));
            assert_eq!(pairs.values[0], 0.0);
            for i in 0..k {
                let error = (pairs.values[i] - values[i]).abs() / scale;
                assert!(error < rounding, "{} rows, {i}: {error:e}", options.dense_rows);
            }
            let first = Slice::from(..cut);
            let sine = angle(
                vectors.slice_axis(Axis(1), first),
                pairs.vectors.slice_axis(Axis(1), first),
                &m,
            );
            assert!(sine < 1e-6, "{} rows: {sine:e}", options.dense_rows);
        }
    }
}

/// LOBPCG on M^(−1/2) S M^(−1/2), with a Cholesky factor as preconditioner and the constant as
/// constraint.
#[test]
fn lobpcg_finds_the_same_pairs() {
    let s = grid(40, 31);
    let n = s.rows();
    let k = 6;
    let mass: Vec<f64> = random_vector(n, 8).iter().map(|v| 1.5 + v).collect();
    let root = Array1::from_iter(mass.iter().map(|m| m.sqrt())).insert_axis(Axis(1));
    let factor = Cholesky::new(&combine(1e-3, Mass::Lumped(&mass), 1.0, &s)).unwrap();
    let multiply = |x: ArrayView2<'_, f64>| -> Array2<f64> {
        fairing_sparse::multiply_block(&s, (&x / &root).view()) / &root
    };
    let precondition = |mut x: ndarray::ArrayViewMut2<'_, f64>| {
        let solved = factor.solve_block((&x * &root).view()) * &root;
        x.assign(&solved);
    };
    let start = Array2::from_shape_fn((n, k), |(i, j)| random_vector(n, 100 + j as u64)[i]);
    // LOBPCG compares plain residual norms with its tolerance.
    let found = lobpcg(
        multiply,
        start,
        precondition,
        Some(root.clone()),
        1e-8,
        400,
        TruncatedOrder::Smallest,
    );
    let (values, norms) = match found {
        LobpcgResult::Ok(values, _, norms) => (values, norms),
        LobpcgResult::Err(values, _, norms, _) => (values, norms),
        LobpcgResult::NoResult(error) => panic!("{error}"),
    };
    assert!(norms.iter().all(|r| *r < 1e-6), "{norms:?}");
    let ours = smallest_eigenpairs(&s, Mass::Lumped(&mass), k + 1, &lanczos()).unwrap();
    for i in 0..k {
        // An eigenvalue errs by its residual at most.
        let error = (values[i] - ours.values[i + 1]).abs();
        assert!(error < norms[i] + 1e-9 * ours.values[k], "{i}: {error:e}");
    }
}
