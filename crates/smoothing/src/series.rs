//! A whole run of a linear flow at once.
//!
//! With a fixed operator, `k` steps multiply the mode of eigenvalue μ by `g(μ)`: `(1 + λμ)ᵏ` for explicit steps,
//! `(1 − λμ)⁻ᵏ` for implicit ones. When nobody looks at the steps in between, `g(L) x` is computed directly from
//! the Chebyshev series of `g` on the interval that holds the spectrum. Its degree is far below the number of
//! products (or the iterations of the solves) that stepping needs: 32 instead of 50 for fifty explicit steps with
//! λ = ½, 35 instead of 100 for fifty Taubin pairs, 62 for ten implicit steps with λ = 5. There are no inner
//! products, hence no synchronisation, and every operation is fused into one sweep over the mesh.
//!
//! The series is cut where the coefficients left out sum to less than [`TOLERANCE`]; `L` is symmetric in the inner
//! product of the mass, so the result differs from exact stepping by at most that much, relative to the size of
//! `x` in that norm. Source: \[druskin1989\].

use rayon::prelude::*;

use crate::clenshaw::Clenshaw;
use crate::laplacian::{Laplacian, Padded, ROWS};

/// The sum of the coefficients left out, relative to `max |g|`.
pub(crate) const TOLERANCE: f64 = 1e-10;

/// The most samples, hence the largest degree, that are tried.
const MOST_SAMPLES: usize = 2048;

/// Coefficients of `g(μ) = Σ cₖ Tₖ(1 + 2μ/bound)` on `[−bound, 0]`.
#[derive(Debug, Clone)]
pub(crate) struct Series {
    coefficients: Vec<f64>,
    bound: f64,
}

impl Series {
    /// Expands `g` on `[−bound, 0]`; `None` where it takes more than two thousand terms, or where `|g|` is too
    /// large for cancellation to be harmless (an unstable flow).
    pub(crate) fn expand(bound: f64, g: impl Fn(f64) -> f64) -> Option<Self> {
        let mut samples = 64;
        while samples <= MOST_SAMPLES {
            let values = sample(bound, samples, &g);
            if values.iter().any(|v| !v.is_finite() || v.abs() > 4.0) {
                return None;
            }
            let coefficients = transform(&values);
            let tail = samples - samples / 8;
            if coefficients[tail..].iter().all(|c| c.abs() < TOLERANCE / samples as f64) {
                return Some(Self { coefficients: truncated(coefficients), bound });
            }
            samples *= 2;
        }
        None
    }

    /// The series with these coefficients.
    pub(crate) fn from_coefficients(bound: f64, coefficients: Vec<f64>) -> Self {
        Self { coefficients, bound }
    }

    /// The products with `L` that an evaluation takes.
    pub(crate) fn degree(&self) -> usize {
        self.coefficients.len() - 1
    }

    /// `g(L) x` by Clenshaw's recurrence, whose terms `bₖ = cₖ x + 2 T bₖ₊₁ − bₖ₊₂` overwrite each other in place.
    ///
    /// Constants are reproduced to rounding wherever the mesh lies: the first point is taken off before and put
    /// back after, so that coordinates far from the origin lose no digits.
    pub(crate) fn apply(&self, laplacian: &Laplacian, given: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let Some(&origin) = given.first() else { return Vec::new() };
        let centre = mean(given).unwrap_or(origin);
        let x: Vec<Padded> = given
            .par_iter()
            .with_min_len(ROWS)
            .map(|p| [p[0] - centre[0], p[1] - centre[1], p[2] - centre[2], 0.0])
            .collect();
        let (coefficients, scale) = (&self.coefficients[..], 2.0 / self.bound);
        let last = Clenshaw { laplacian, x: &x, coefficients, scale }.evaluate();
        // Vertices that stay do so exactly.
        last.par_iter()
            .zip(given)
            .enumerate()
            .with_min_len(ROWS)
            .map(|(i, (p, &x))| match laplacian.is_still(i) {
                true => x,
                false => [p[0] + centre[0], p[1] + centre[1], p[2] + centre[2]],
            })
            .collect()
    }
}

/// The mean of the points, if they are so few and so near that it is finite.
fn mean(x: &[[f64; 3]]) -> Option<[f64; 3]> {
    let sum = x.iter().fold([0.0; 3], |s, p| [s[0] + p[0], s[1] + p[1], s[2] + p[2]]);
    let mean = sum.map(|s| s / x.len() as f64);
    mean.iter().all(|m| m.is_finite()).then_some(mean)
}

/// `g` at the Chebyshev points of the interval, `μ = −bound (1 − cos θ)/2` with `θⱼ = π (j + ½)/n`.
fn sample(bound: f64, n: usize, g: &impl Fn(f64) -> f64) -> Vec<f64> {
    (0..n)
        .map(|j| {
            let half = 0.5 * std::f64::consts::PI * (j as f64 + 0.5) / n as f64;
            // (1 − cos θ)/2 = sin² (θ/2) without cancellation near μ = 0.
            g(-bound * half.sin().powi(2))
        })
        .collect()
}

/// The discrete cosine transform `cₖ = (2/n) Σⱼ gⱼ cos kθⱼ`, `c₀` halved.
fn transform(values: &[f64]) -> Vec<f64> {
    let n = values.len();
    // cos kθⱼ = cos(π k(2j + 1)/(2n)) repeats after 4n quarter steps.
    let cosines: Vec<f64> =
        (0..4 * n).map(|q| (std::f64::consts::PI * q as f64 / (2 * n) as f64).cos()).collect();
    (0..n)
        .map(|k| {
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
        .collect()
}

/// Leaves out the last coefficients as long as their sizes sum to less than [`TOLERANCE`].
fn truncated(mut coefficients: Vec<f64>) -> Vec<f64> {
    let mut left_out = 0.0;
    while let [_, .., last] = coefficients[..] {
        left_out += last.abs();
        if left_out >= TOLERANCE {
            break;
        }
        coefficients.pop();
    }
    coefficients
}

#[cfg(test)]
mod tests {
    use super::*;

    fn evaluate(series: &Series, mu: f64) -> f64 {
        let angle = (1.0 + 2.0 * mu / series.bound).clamp(-1.0, 1.0).acos();
        series.coefficients.iter().enumerate().map(|(k, c)| c * (k as f64 * angle).cos()).sum()
    }

    #[test]
    fn series_reproduce_their_functions() {
        type Case = (&'static str, f64, fn(f64) -> f64, usize);
        let functions: [Case; 4] = [
            ("explicit", 2.0, |m| (1.0 + 0.5 * m).powi(50), 36),
            ("taubin", 2.0, |m| ((1.0 + 0.5 * m) * (1.0 - 0.53 * m)).powi(50), 40),
            ("implicit", 2.0, |m| (1.0 - 5.0 * m).powi(-10), 70),
            ("stiff", 800.0, |m| (1.0 - m).powi(-10), 700),
        ];
        for (name, bound, g, most) in functions {
            let series = Series::expand(bound, g).unwrap();
            assert!(series.degree() <= most, "{name}: degree {}", series.degree());
            for i in 0..=1000 {
                let mu = -bound * f64::from(i) / 1000.0;
                let error = (evaluate(&series, mu) - g(mu)).abs();
                // What is left out, and as much again for rounding and aliasing.
                assert!(error < 2.0 * TOLERANCE, "{name} at {mu}: {error:e}");
            }
        }
    }

    #[test]
    fn a_short_polynomial_is_exact() {
        let series = Series::expand(2.0, |m| 1.0 + 0.5 * m).unwrap();
        assert_eq!(series.degree(), 1);
        assert!((series.coefficients[0] - 0.5).abs() < 1e-15);
        assert!((series.coefficients[1] - 0.5).abs() < 1e-15);
    }

    #[test]
    fn unstable_flows_are_left_to_stepping() {
        assert!(Series::expand(2.0, |m| (1.0 + 2.0 * m).powi(50)).is_none());
    }
}
