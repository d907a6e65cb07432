//! Linear systems for fields of vectors, without a matrix.

use fairing_sparse::passes::update;
use fairing_sparse::{CgOptions, CgSystem};

use super::DenoiseError;

/// A scalar operator that acts on each coordinate of a field of vectors alike, with the inverse of its diagonal as
/// preconditioner. Coordinates share their steps, so that a rotated field has a rotated solution.
struct Field<F> {
    apply: F,
    inverse_diagonal: Vec<f64>,
}

impl<F: Fn(&[[f64; 3]], &mut [[f64; 3]]) -> [f64; 3] + Sync> CgSystem<3> for Field<F> {
    fn multiply(&self, p: &[[f64; 3]], q: &mut Vec<[f64; 3]>) -> [f64; 3] {
        (self.apply)(p, q)
    }

    #[inline]
    fn precondition(&self, i: usize, r: [f64; 3]) -> [f64; 3] {
        r.map(|r| r * self.inverse_diagonal[i])
    }

    fn is_coupled(&self) -> bool {
        true
    }
}

/// `q ← A p` by rows, and Σ p q of each coordinate.
pub(crate) fn by_rows(
    p: &[[f64; 3]],
    q: &mut [[f64; 3]],
    row: impl Fn(usize) -> [f64; 3] + Sync,
) -> [f64; 3] {
    update(q, |i, _| {
        let value = row(i);
        (value, [p[i][0] * value[0], p[i][1] * value[1], p[i][2] * value[2]])
    })
}

/// Solves `A x = b` for a field of vectors, one scalar operator acting on each
/// coordinate alike, by conjugate gradients with the diagonal as the
/// preconditioner, from `x`.
///
/// `apply(p, q)` is a symmetric positive definite operator that writes `A p`
/// into `q` and returns Σ p q of each coordinate ([`by_rows`]), `diagonal` its
/// positive diagonal. Returns the solution and its relative residual: measured,
/// or carried along by the iteration, as the options say.
pub(crate) fn conjugate_gradients(
    apply: impl Fn(&[[f64; 3]], &mut [[f64; 3]]) -> [f64; 3] + Sync,
    diagonal: &[f64],
    b: &[[f64; 3]],
    mut x: Vec<[f64; 3]>,
    options: &CgOptions,
) -> (Vec<[f64; 3]>, f64) {
    if b.iter().all(|b| *b == [0.0; 3]) {
        update(&mut x, |_, _| ([0.0; 3], ()));
        return (x, 0.0);
    }
    let field = Field { apply, inverse_diagonal: diagonal.iter().map(|d| 1.0 / d).collect() };
    let (solution, _) = fairing_sparse::conjugate_gradients(&field, b, x, options);
    // Coordinates are measured together: each of the three residuals is that of all.
    (solution.x, solution.residuals[0])
}

/// The solution, unless its residual is above ten times the tolerance: an error
/// of outer step `step`.
pub(crate) fn solved(
    (x, residual): (Vec<[f64; 3]>, f64),
    options: &CgOptions,
    step: usize,
) -> Result<Vec<[f64; 3]>, DenoiseError> {
    if residual <= 10.0 * options.tolerance {
        return Ok(x);
    }
    Err(DenoiseError::NotSolved { step, iterations: options.max_iterations, residual })
}
