//! How far the spectrum of a Laplacian reaches.

use fairing_mesh::TriMesh;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::engine::assemble::assemble;
use crate::engine::diffusion::Diffusion;
use crate::engine::error::FlowFailure;
use crate::engine::laplacian::{Laplacian, by_chunk};
use crate::engine::unit_scale::{InMeshUnits, times};

/// Lanczos steps; the largest eigenvalue is then known to about one percent.
const STEPS: usize = 20;

/// Steps for the eigenvalue itself; it is then known to many digits unless crowded by its neighbours.
const MANY_STEPS: usize = 200;

/// An upper bound of the eigenvalues of `−L = M⁻¹S`, tight to a few percent.
///
/// Twenty Lanczos steps from a fixed random vector in the inner product of `M`, the largest Ritz value plus its
/// residual norm (an upper bound in practice, not in theory: \[zhou2006\]), never more than Gershgorin's bound. It is
/// 2 for uniform weights, exactly.
pub(crate) fn upper_bound(laplacian: &Laplacian) -> f64 {
    let gershgorin = laplacian.gershgorin();
    if laplacian.is_uniform() || gershgorin == 0.0 {
        return gershgorin;
    }
    let (alpha, beta) = tridiagonal(laplacian, STEPS);
    let residual = beta.last().copied().unwrap_or(0.0);
    let theta = largest_ritz_value(&alpha, &beta);
    (1.01 * theta + residual * last_component(&alpha, &beta, theta)).min(gershgorin)
}

/// The largest eigenvalue of `−L = M⁻¹S`, from below: the largest Ritz value of two hundred Lanczos steps from a
/// fixed random vector. Dimensionless for uniform weights, in one over squared mesh units for cotangents; the step of
/// `diffusion` does not matter. Zero without edges.
///
/// A step of the explicit flow multiplies the roughest mode by one minus the step times this.
///
/// # Errors
///
/// [`FlowFailure::Operator`] and [`FlowFailure::NonPositiveMass`] where the cotangent operator does not exist.
///
/// # Examples
///
/// ```
/// use fairing_shapes as shapes;
/// use fairing_smoothing::{Diffusion, largest_eigenvalue};
///
/// // At most 3/2 on every closed triangle mesh.
/// let reach = largest_eigenvalue(&shapes::icosphere(3), Diffusion::uniform(1.0))?;
/// assert!(reach > 1.0 && reach <= 1.5 + 1e-12);
/// # Ok::<(), fairing_smoothing::FlowFailure>(())
/// ```
pub fn largest_eigenvalue(mesh: &TriMesh, diffusion: Diffusion) -> Result<f64, FlowFailure> {
    let (scaled, unit) = mesh.at_unit_scale();
    let laplacian = assemble(&scaled, diffusion, &vec![false; mesh.vertex_count()])
        .map_err(|failure| times(failure, unit, mesh))?;
    let (alpha, beta) = tridiagonal(&laplacian, MANY_STEPS);
    let largest = largest_ritz_value(&alpha, &beta);
    Ok(if diffusion.is_timed() { largest / unit / unit } else { largest })
}

/// The coefficients of the three-term recurrence of `−L`; one β for each α, the last leads out.
fn tridiagonal(laplacian: &Laplacian, steps: usize) -> (Vec<f64>, Vec<f64>) {
    let mut random = ChaCha8Rng::seed_from_u64(0);
    let (mass, inverse) = (laplacian.mass(), laplacian.inverse_mass());
    let mut v: Vec<[f64; 1]> =
        (0..laplacian.len()).map(|_| [random.random::<f64>() - 0.5]).collect();
    let mut before = vec![[0.0; 1]; v.len()];
    let [square] = by_chunk(&mut v, |i, p| (p, [mass[i] * p[0] * p[0]]));
    let (mut alpha, mut beta) = (Vec::new(), Vec::new());
    let mut norm = square.sqrt();
    for _ in 0..steps {
        fairing_watch::check();
        if norm <= f64::EPSILON * alpha.iter().fold(0.0, |a: f64, b: &f64| a.max(*b)) {
            break;
        }
        // v holds β q; w = −L q − β q₋₁ − α q.
        let scale = 1.0 / norm;
        let [diagonal] = {
            let last = if alpha.is_empty() { 0.0 } else { norm };
            laplacian.sweep_summing(&v, &mut before, |i, s, p, old| {
                let w = -s[0] * inverse[i] * scale - last * old[0];
                ([w], [mass[i] * w * p[0] * scale])
            })
        };
        let q = &v;
        let [square] = by_chunk(&mut before, |i, w| {
            let w = w[0] - diagonal * q[i][0] * scale;
            ([w], [mass[i] * w * w])
        });
        by_chunk(&mut v, |_, p| ([p[0] * scale], []));
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
    let (mut low, mut high) = (0.0, reach.fold(0.0, f64::max));
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        // All eigenvalues lie below iff every pivot of T − middle is negative.
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

/// The size of the last component of the unit eigenvector for `theta`, by forward recurrence.
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
