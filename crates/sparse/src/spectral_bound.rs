//! Bounds and estimates of the largest eigenvalue of a Laplacian.
//!
//! Lanczos' three-term recurrence from a single vector, without storing the basis: the extreme
//! eigenvalue does not need it, and a step costs one product with `L`. Eigenpairs are computed by
//! `eigen::lanczos`, whose orthogonalised blocks in a factored system take about a hundred times as
//! long.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::graph_laplacian::GraphLaplacian;
use crate::order::larger;
use crate::parallel;

/// Lanczos steps, after which the largest eigenvalue is known to about one percent.
const STEPS: usize = 20;

impl GraphLaplacian {
    /// An upper bound on the eigenvalues of `−L = M⁻¹S`, tight to a few percent.
    ///
    /// 1.01 times the largest Ritz value plus its residual norm, after twenty Lanczos steps from a
    /// fixed random vector in the inner product of `M` (an upper bound in practice, not in theory:
    /// [zhou2006]); never more than [Gershgorin's bound](Self::gershgorin). Exactly 2 for unit
    /// weights.
    ///
    /// [zhou2006]: https://doi.org/10.1016/j.jcp.2006.03.017
    pub fn spectral_bound(&self) -> f64 {
        let gershgorin = self.gershgorin();
        if self.is_uniform() || gershgorin == 0.0 {
            return gershgorin;
        }
        let (alpha, beta) = tridiagonal(self, STEPS);
        let residual = beta.last().copied().unwrap_or(0.0);
        let theta = largest_ritz_value(&alpha, &beta);
        (1.01 * theta + residual * last_component(&alpha, &beta, theta)).min(gershgorin)
    }

    /// A lower estimate of the largest eigenvalue of `−L = M⁻¹S`: the largest Ritz value after
    /// `steps` Lanczos steps from a fixed random vector. Two hundred steps give many digits unless
    /// neighbouring eigenvalues crowd it. Zero without edges.
    pub fn largest_eigenvalue(&self, steps: usize) -> f64 {
        let (alpha, beta) = tridiagonal(self, steps);
        largest_ritz_value(&alpha, &beta)
    }
}

/// Coefficients α and β of the three-term recurrence of `−L`, equally many; the last β is the norm
/// of the residual.
fn tridiagonal(laplacian: &GraphLaplacian, steps: usize) -> (Vec<f64>, Vec<f64>) {
    let mut random = ChaCha8Rng::seed_from_u64(0);
    let (mass, inverse) = (laplacian.mass(), laplacian.inverse_mass());
    let mut v: Vec<[f64; 1]> =
        (0..laplacian.len()).map(|_| [random.random::<f64>() - 0.5]).collect();
    let mut before = vec![[0.0; 1]; v.len()];
    let square: f64 = parallel::sum(v.len(), |i| mass[i] * v[i][0] * v[i][0]);
    let (mut alpha, mut beta) = (Vec::new(), Vec::new());
    let mut norm = square.sqrt();
    for _ in 0..steps {
        fairing_watch::check();
        if norm <= f64::EPSILON * alpha.iter().fold(0.0, |a, b: &f64| larger(a, *b)) {
            break;
        }
        // v = β q and w = −L q − β q₋₁ − α q.
        let scale = 1.0 / norm;
        let last = if alpha.is_empty() { 0.0 } else { norm };
        let diagonal: f64 = laplacian.sweep_summing(&v, &mut before, |i, s, p, old| {
            let w = -s[0] * inverse[i] * scale - last * old[0];
            ([w], mass[i] * w * p[0] * scale)
        });
        let q = &v;
        let square: f64 = parallel::update(&mut before, |i, [w]| {
            let w = w - diagonal * q[i][0] * scale;
            ([w], mass[i] * w * w)
        });
        parallel::update(&mut v, |_, [p]| ([p * scale], ()));
        std::mem::swap(&mut v, &mut before);
        alpha.push(diagonal);
        norm = square.sqrt();
        beta.push(norm);
    }
    (alpha, beta)
}

/// The largest eigenvalue of the symmetric tridiagonal matrix, by bisection on Sturm counts.
fn largest_ritz_value(alpha: &[f64], beta: &[f64]) -> f64 {
    let reach =
        (0..alpha.len()).map(|k| alpha[k].abs() + beta[k] + if k == 0 { 0.0 } else { beta[k - 1] });
    let (mut low, mut high) = (0.0, reach.fold(0.0, larger));
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        // All eigenvalues lie below `middle` iff every pivot of T − middle is negative.
        let mut pivot = -1.0;
        let below = (0..alpha.len()).all(|k| {
            let coupling = if k == 0 { 0.0 } else { beta[k - 1] * beta[k - 1] / pivot };
            pivot = alpha[k] - middle - coupling;
            pivot < 0.0
        });
        if below { high = middle } else { low = middle }
    }
    high
}

/// The absolute value of the last component of the unit eigenvector for `theta`, by forward
/// recurrence.
fn last_component(alpha: &[f64], beta: &[f64], theta: f64) -> f64 {
    let (mut before, mut here, mut square) = (0.0, 1.0, 1.0f64);
    for k in 0..alpha.len().saturating_sub(1) {
        let coupling = if k == 0 { 0.0 } else { beta[k - 1] };
        let next = ((theta - alpha[k]) * here - coupling * before) / beta[k];
        (before, here) = (here, next);
        square += here * here;
    }
    here.abs() / square.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SparseMatrix;

    /// On a ring of n vertices with weights w and masses m the largest eigenvalue is 4 w/m: many
    /// steps find its last digits, and the bound is within a few percent.
    #[test]
    fn the_bound_is_tight() {
        for (n, w, m) in [(3 * 1000, 1.0, 1.0), (50, 1e-3, 2e5), (2, 1.0, 3.0)] {
            let mut t = sprs::TriMatI::<f64, u32>::new((n, n));
            for i in 0..n {
                let j = (i + 1) % n;
                for (a, b, x) in [(i, j, -w), (j, i, -w), (i, i, w), (j, j, w)] {
                    t.add_triplet(a, b, x);
                }
            }
            let ring: SparseMatrix = t.to_csr();
            let laplacian = GraphLaplacian::weighted(&ring, vec![m; n], &vec![false; n]);
            let largest = if n == 2 {
                4.0 * w / m
            } else {
                (2.0 - 2.0 * ((n / 2) as f64 * std::f64::consts::TAU / n as f64).cos()) * w / m
            };
            let bound = laplacian.spectral_bound();
            assert!(
                bound >= largest * (1.0 - 1e-12) && bound < 1.05 * largest,
                "{bound} {largest}"
            );
            let found = laplacian.largest_eigenvalue(200);
            assert!(
                found <= largest * (1.0 + 1e-12) && found > 0.999 * largest,
                "{found} {largest}"
            );
        }
    }

    #[test]
    fn the_bound_of_a_zero_laplacian_is_zero() {
        let points =
            GraphLaplacian::weighted(&SparseMatrix::zero((2, 2)), vec![1.0; 2], &[false; 2]);
        assert_eq!((points.spectral_bound(), points.largest_eigenvalue(5)), (0.0, 0.0));
    }
}
