//! Linear systems for fields of vectors, without a matrix.

use fairing_sparse::passes::{sum, update};
use fairing_sparse::{CgOptions, CgSystem};

use super::DenoiseError;

/// A scalar operator that acts on each coordinate of a field of vectors alike, with the inverse of its diagonal as
/// preconditioner. Coordinates share their steps, so that a rotated field has a rotated solution.
struct Field<F> {
    apply: F,
    inverse_diagonal: Vec<f64>,
}

impl<F: Fn(&[[f64; 3]]) -> Vec<[f64; 3]> + Sync> CgSystem<3> for Field<F> {
    fn multiply(&self, p: &[[f64; 3]], q: &mut Vec<[f64; 3]>) -> [f64; 3] {
        // Its memory is used again, while it is in the cache.
        *q = Vec::new();
        *q = (self.apply)(p);
        sum(q.len(), |i| [p[i][0] * q[i][0], p[i][1] * q[i][1], p[i][2] * q[i][2]])
    }

    #[inline]
    fn precondition(&self, i: usize, r: [f64; 3]) -> [f64; 3] {
        r.map(|r| r * self.inverse_diagonal[i])
    }

    fn is_coupled(&self) -> bool {
        true
    }
}

/// Solves `A x = b` for a field of vectors, one scalar operator acting on each
/// coordinate alike, by conjugate gradients with the diagonal as the
/// preconditioner, from `x`, to a relative residual of `tolerance`.
///
/// `apply` is a symmetric positive definite operator, `diagonal` its positive
/// diagonal. Returns the solution after at most `max_iterations`, and the
/// relative residual that it has, measured.
pub(crate) fn conjugate_gradients(
    apply: impl Fn(&[[f64; 3]]) -> Vec<[f64; 3]> + Sync,
    diagonal: &[f64],
    b: &[[f64; 3]],
    x: Vec<[f64; 3]>,
    tolerance: f64,
    max_iterations: usize,
) -> (Vec<[f64; 3]>, f64) {
    let options = CgOptions { tolerance, max_iterations, ..CgOptions::default() };
    solve_field(apply, diagonal, b, x, &options)
}

fn solve_field(
    apply: impl Fn(&[[f64; 3]]) -> Vec<[f64; 3]> + Sync,
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

/// [`conjugate_gradients`] within a loop whose next system begins with this
/// solution, and by measuring it: the residual is the one that the iteration
/// carries along.
pub(crate) fn inner(
    apply: impl Fn(&[[f64; 3]]) -> Vec<[f64; 3]> + Sync,
    diagonal: &[f64],
    b: &[[f64; 3]],
    x: Vec<[f64; 3]>,
    tolerance: f64,
    max_iterations: usize,
) -> (Vec<[f64; 3]>, f64) {
    let options = CgOptions { tolerance, max_iterations, measure: false };
    solve_field(apply, diagonal, b, x, &options)
}

/// The solution, unless its residual is above ten times the tolerance: an error
/// of outer step `step`.
pub(crate) fn solved(
    (x, residual): (Vec<[f64; 3]>, f64),
    tolerance: f64,
    iterations: usize,
    step: usize,
) -> Result<Vec<[f64; 3]>, DenoiseError> {
    if residual <= 10.0 * tolerance {
        return Ok(x);
    }
    Err(DenoiseError::NotSolved { step, iterations, residual })
}
