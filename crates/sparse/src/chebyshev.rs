//! Functions of a Laplacian by Chebyshev series.

use fairing_watch::parallel::map;

use crate::clenshaw::Clenshaw;
use crate::graph_laplacian::GraphLaplacian;
use crate::parallel::CHUNK;

/// `g(μ) = Σ cₖ Tₖ(1 + 2μ/b)` on the interval `[−b, 0]`.
///
/// With b no less than the [spectral bound](GraphLaplacian::spectral_bound), `g(L) x` takes one
/// product with `L` per term and no inner products, hence no synchronisation. `L` is symmetric in
/// the inner product of its mass, so an error ε of g on the interval changes the result by at most
/// ε ‖x‖.
///
/// # Examples
///
/// ```
/// use fairing_sparse::{ChebyshevSeries, GraphLaplacian};
/// let path = GraphLaplacian::uniform(vec![0, 1, 3, 4], vec![1, 0, 2, 1]);
/// // One step of heat: exp(L) x, which keeps the mean over the degrees.
/// let heat = ChebyshevSeries::interpolate(2.0, 32, 1e-14, libm::exp).unwrap();
/// let x = heat.apply(&path, &[[0.0; 3], [1.0, 2.0, 0.0], [0.0; 3]]);
/// assert!(((x[0][0] + 2.0 * x[1][0] + x[2][0]) / 4.0 - 0.5).abs() < 1e-14);
/// ```
///
/// Source: \[druskin1989\], [trefethen2013].
///
/// [trefethen2013]: https://doi.org/10.1137/1.9781611975949
#[derive(Debug, Clone, PartialEq)]
pub struct ChebyshevSeries {
    coefficients: Vec<f64>,
    bound: f64,
}

impl ChebyshevSeries {
    /// The series with these coefficients.
    ///
    /// # Panics
    ///
    /// Panics without a coefficient.
    pub fn new(bound: f64, coefficients: Vec<f64>) -> Self {
        assert!(!coefficients.is_empty(), "a series has a constant term");
        Self { coefficients, bound }
    }

    /// The polynomial interpolating `g` at `samples` Chebyshev points, truncated: trailing
    /// coefficients are dropped while their absolute sum stays below `tolerance`, and the constant
    /// term absorbs the change at μ = 0. `None` if g is not finite at one of the points.
    ///
    /// The number of samples follows from a bound of g: if |g| ≤ B on the Bernstein ellipse of
    /// parameter ρ, the polynomial through n points is within `4 B ρ^(1 − n)/(ρ − 1)` of g
    /// ([trefethen2013], theorem 8.2); polynomials of degree below n are reproduced exactly.
    ///
    /// [trefethen2013]: https://doi.org/10.1137/1.9781611975949
    pub fn interpolate(
        bound: f64,
        samples: usize,
        tolerance: f64,
        g: impl Fn(f64) -> f64,
    ) -> Option<Self> {
        let values = sample(bound, samples.max(1), &g);
        if values.iter().any(|v| !v.is_finite()) {
            return None;
        }
        let mut coefficients = truncated(transform(&values), tolerance);
        let lost = g(0.0) - coefficients.iter().sum::<f64>();
        coefficients[0] += lost;
        Some(Self { coefficients, bound })
    }

    /// The coefficients, constant term first.
    pub fn coefficients(&self) -> &[f64] {
        &self.coefficients
    }

    /// The number of products with `L` in one evaluation.
    pub fn degree(&self) -> usize {
        self.coefficients.len() - 1
    }

    /// `g(L) x` by Clenshaw's recurrence `bₖ = cₖ x + 2 T bₖ₊₁ − bₖ₊₂`, in place.
    ///
    /// Requires `g(0) = 1`: the mean of the points (the first point if their sum overflows) is
    /// subtracted before and added after, so that constants are reproduced to rounding and
    /// coordinates far from the origin lose no digits. Points of zero rows are returned unchanged
    /// and do not enter the mean.
    ///
    /// # Panics
    ///
    /// Panics unless there is one point for each row.
    pub fn apply(&self, laplacian: &GraphLaplacian, given: &[[f64; 3]]) -> Vec<[f64; 3]> {
        assert_eq!(given.len(), laplacian.len(), "one point for each row");
        let Some(&origin) = given.first() else { return Vec::new() };
        let centre = mean(laplacian, given).unwrap_or(origin);
        let x = map(given.len(), CHUNK, |i| {
            let p = given[i];
            [p[0] - centre[0], p[1] - centre[1], p[2] - centre[2], 0.0]
        });
        let (coefficients, scale) = (&self.coefficients[..], 2.0 / self.bound);
        let last = Clenshaw { laplacian, x: &x, coefficients, scale }.evaluate();
        map(given.len(), CHUNK, |i| {
            if laplacian.is_fixed(i) {
                return given[i];
            }
            let p = last[i];
            [p[0] + centre[0], p[1] + centre[1], p[2] + centre[2]]
        })
    }
}

/// The mean of the points of nonzero rows; `None` without such rows or if it is not finite.
fn mean(laplacian: &GraphLaplacian, x: &[[f64; 3]]) -> Option<[f64; 3]> {
    let moving = (0..x.len()).filter(|&i| !laplacian.is_fixed(i));
    let (sum, count) = moving.fold(([0.0; 3], 0.0), |(s, n), i| {
        let p = x[i];
        ([s[0] + p[0], s[1] + p[1], s[2] + p[2]], n + 1.0)
    });
    let mean = sum.map(|s| s / count);
    mean.iter().all(|m| m.is_finite()).then_some(mean)
}

/// Values of `g` at the Chebyshev points of the interval, `μ = −bound (1 − cos θ)/2` with
/// `θⱼ = π (j + ½)/n`.
fn sample(bound: f64, n: usize, g: impl Fn(f64) -> f64) -> Vec<f64> {
    (0..n)
        .map(|j| {
            let half = 0.5 * std::f64::consts::PI * (j as f64 + 0.5) / n as f64;
            // (1 − cos θ)/2 = sin² (θ/2) without cancellation near μ = 0.
            g(-bound * libm::sin(half).powi(2))
        })
        .collect()
}

/// The discrete cosine transform `cₖ = (2/n) Σⱼ gⱼ cos kθⱼ`, `c₀` halved.
fn transform(values: &[f64]) -> Vec<f64> {
    let n = values.len();
    // cos kθⱼ = cos(π k(2j + 1)/(2n)) repeats after 4n quarter steps.
    let cosines: Vec<f64> =
        (0..4 * n).map(|q| libm::cos(std::f64::consts::PI * q as f64 / (2 * n) as f64)).collect();
    map(n, 64, |k| {
        let mut q = k;
        let mut sum = 0.0;
        for v in values {
            sum += v * cosines[q];
            q += 2 * k;
            while q >= 4 * n {
                q -= 4 * n;
            }
        }
        sum * if k == 0 { 1.0 } else { 2.0 } / n as f64
    })
}

/// Drops trailing coefficients while their absolute sum stays below the tolerance.
fn truncated(mut coefficients: Vec<f64>, tolerance: f64) -> Vec<f64> {
    let mut left_out = 0.0;
    while let [_, .., last] = coefficients[..] {
        left_out += last.abs();
        if left_out >= tolerance {
            break;
        }
        coefficients.pop();
    }
    coefficients
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The modes of a path of n vertices are cos(π k j/(n − 1)) with μ = cos(π k/(n − 1)) − 1. A
    /// series multiplies each by g(μ), far from the origin too, and leaves zero rows unchanged.
    #[test]
    fn modes_are_multiplied_by_the_function() {
        let n = 40u32;
        let (mut offsets, mut columns) = (vec![0u32], Vec::new());
        for i in 0..n {
            columns.extend([i.wrapping_sub(1), i + 1].into_iter().filter(|&j| j < n));
            offsets.push(columns.len() as u32);
        }
        // One isolated vertex at the end.
        columns.push(n);
        offsets.push(columns.len() as u32);
        let path = GraphLaplacian::uniform(offsets, columns);
        let g = |mu: f64| libm::exp(7.0 * mu);
        let series = ChebyshevSeries::interpolate(2.0, 64, 1e-13, g).unwrap();
        assert!(series.degree() < 40, "{}", series.degree());
        for k in [0, 1, 5, 20, 39] {
            let angle = std::f64::consts::PI * f64::from(k) / f64::from(n - 1);
            let mode = |j: u32| libm::cos(angle * f64::from(j));
            let mut x: Vec<[f64; 3]> = (0..n).map(|j| [mode(j), 1e6 + mode(j), 5.0]).collect();
            x.push([3.0, 2.0, 1e300]);
            let y = series.apply(&path, &x);
            assert_eq!(y[n as usize], x[n as usize]);
            let factor = g(libm::cos(angle) - 1.0);
            for j in 0..n {
                let [a, b, c] = y[j as usize];
                assert!((a - factor * mode(j)).abs() < 1e-12, "mode {k}: {a}");
                // Coordinates of 10⁶ are known to 10⁻¹⁰.
                assert!((b - 1e6 - factor * mode(j)).abs() < 1e-9, "mode {k}: {b}");
                assert!((c - 5.0).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn functions_that_are_not_finite_have_no_series() {
        assert!(ChebyshevSeries::interpolate(2.0, 8, 1e-10, |mu| 1.0 / (mu + 1.0)).is_some());
        assert!(ChebyshevSeries::interpolate(2.0, 9, 1e-10, |_| f64::NAN).is_none());
        assert!(ChebyshevSeries::interpolate(2.0, 9, 1e-10, |mu| f64::MAX * (4.0 - mu)).is_none());
    }
}
