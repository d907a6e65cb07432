//! Conjugate gradients for fields of vectors, without a matrix.

use fairing_mesh::vec3::{add, dot, scale, sub};
use rayon::prelude::*;

use super::DenoiseError;

/// Vectors that a thread takes at least: fewer are not worth handing over.
const VECTORS: usize = 4096;

/// Solves `A x = b` for a field of vectors, one scalar operator acting on each
/// coordinate alike, by conjugate gradients with the diagonal as the
/// preconditioner, from `x`, to a relative residual of `tolerance`.
///
/// `apply` is a symmetric positive definite operator, `diagonal` its positive
/// diagonal. Sums are taken in a fixed order: the result does not depend on
/// the number of threads. Returns the solution and the relative residual that
/// is left after at most `max_iterations`.
pub(crate) fn conjugate_gradients(
    apply: impl Fn(&[[f64; 3]]) -> Vec<[f64; 3]>,
    diagonal: &[f64],
    b: &[[f64; 3]],
    mut x: Vec<[f64; 3]>,
    tolerance: f64,
    max_iterations: usize,
) -> (Vec<[f64; 3]>, f64) {
    let b_norm = inner(b, b).sqrt();
    if b_norm == 0.0 {
        return (vec![[0.0; 3]; b.len()], 0.0);
    }
    let mut r = apply(&x);
    r.par_iter_mut().with_min_len(VECTORS).zip(b).for_each(|(r, b)| *r = sub(*b, *r));
    let mut p: Vec<[f64; 3]> =
        r.par_iter().with_min_len(VECTORS).zip(diagonal).map(|(r, d)| scale(*r, 1.0 / d)).collect();
    let mut rz = inner(&r, &p);
    for _ in 0..max_iterations {
        fairing_watch::check();
        if inner(&r, &r).sqrt() <= tolerance * b_norm {
            break;
        }
        let ap = apply(&p);
        let curvature = inner(&p, &ap);
        if curvature.is_nan() || curvature <= 0.0 {
            break;
        }
        let alpha = rz / curvature;
        x.par_iter_mut()
            .with_min_len(VECTORS)
            .zip(&p)
            .for_each(|(x, p)| *x = add(*x, scale(*p, alpha)));
        r.par_iter_mut()
            .with_min_len(VECTORS)
            .zip(&ap)
            .for_each(|(r, ap)| *r = sub(*r, scale(*ap, alpha)));
        // The preconditioned residual, in the place of what is no longer needed.
        let mut z = ap;
        z.par_iter_mut()
            .with_min_len(VECTORS)
            .zip(&r)
            .zip(diagonal)
            .for_each(|((z, r), d)| *z = scale(*r, 1.0 / d));
        let next = inner(&r, &z);
        p.par_iter_mut()
            .with_min_len(VECTORS)
            .zip(&z)
            .for_each(|(p, z)| *p = add(*z, scale(*p, next / rz)));
        rz = next;
    }
    let residual = inner(&r, &r).sqrt() / b_norm;
    (x, residual)
}

/// Like [`conjugate_gradients`], but a residual above ten times the tolerance
/// is an error of outer step `step`.
pub(crate) fn solve(
    apply: impl Fn(&[[f64; 3]]) -> Vec<[f64; 3]>,
    diagonal: &[f64],
    b: &[[f64; 3]],
    x: Vec<[f64; 3]>,
    tolerance: f64,
    max_iterations: usize,
    step: usize,
) -> Result<Vec<[f64; 3]>, DenoiseError> {
    let (x, residual) = conjugate_gradients(apply, diagonal, b, x, tolerance, max_iterations);
    if residual <= 10.0 * tolerance {
        return Ok(x);
    }
    Err(DenoiseError::NotSolved { step, iterations: max_iterations, residual })
}

/// The inner product over all vectors, in blocks of fixed size.
fn inner(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    let partial: Vec<f64> = a
        .par_chunks(8192)
        .zip(b.par_chunks(8192))
        .map(|(a, b)| a.iter().zip(b).map(|(&a, &b)| dot(a, b)).sum())
        .collect();
    partial.iter().sum()
}
