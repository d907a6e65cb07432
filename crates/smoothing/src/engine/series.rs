//! A whole run of a linear flow at once.
//!
//! With a fixed operator, `k` steps multiply the mode of eigenvalue μ by `g(μ)`: `(1 + λμ)ᵏ` for explicit steps,
//! `(1 − λμ)⁻ᵏ` for implicit ones. When nobody looks at the steps in between, `g(L) x` is computed directly from
//! the Chebyshev series of `g` on the interval that holds the spectrum. Its degree is far below the number of
//! products (or the iterations of the solves) that stepping needs: 32 instead of 50 for fifty explicit steps with
//! λ = ½, 35 instead of 100 for fifty Taubin pairs, 62 for ten implicit steps with λ = 5. There are no inner
//! products, hence no synchronisation, and every operation is fused into one sweep over the mesh.
//!
//! A series is computed from samples of `g`, but taken on the strength of a bound: with `|g| ≤ M` on the Bernstein
//! ellipse of the parameter ρ, the polynomial through n Chebyshev points is within `4 M ρ^(1 − n)/(ρ − 1)` of g on
//! the whole interval (\[trefethen2013\], theorem 8.2), and a polynomial of degree below n is met exactly. The
//! number of samples follows from that bound. The series is then cut where the coefficients left out sum to less
//! than [`TOLERANCE`], and what the value at μ = 0 has lost is added to the constant term, so that the centroid of
//! every component stays where it is. `L` is symmetric in the inner product of the mass, so the result differs from
//! exact stepping by at most 2.1 [`TOLERANCE`] times the norm of `x` about its mean. Source: \[druskin1989\].

use rayon::prelude::*;

use crate::engine::clenshaw::Clenshaw;
use crate::engine::laplacian::{Laplacian, Padded, ROWS};
use crate::engine::response::Response;

/// The sum of the coefficients left out; `|g| ≤ 1` for all stable flows but λ|μ, where it is at most
/// [`LARGEST`].
pub(crate) const TOLERANCE: f64 = 1e-10;

/// The error that the samples may cause.
const SAMPLED: f64 = 1e-12;

/// The most samples.
const MOST_SAMPLES: usize = 4096;

/// The largest degree.
const MOST_DEGREE: usize = 2048;

/// Where `|g|` is larger, cancellation is no longer harmless: an unstable flow.
const LARGEST: f64 = 4.0;

/// Coefficients of `g(μ) = Σ cₖ Tₖ(1 + 2μ/bound)` on `[−bound, 0]`.
#[derive(Debug, Clone)]
pub(crate) struct Series {
    coefficients: Vec<f64>,
    bound: f64,
}

/// Series to be applied one after another, each as often as it says.
#[derive(Debug, Clone)]
pub(crate) struct Chain {
    links: Vec<(Series, usize)>,
}

impl Chain {
    /// A run in as few parts as have a series each; `None` where none or only a chain of more than `most` products
    /// does.
    pub(crate) fn expand(bound: f64, of: Response, most: usize) -> Option<Self> {
        if of.ln_largest(bound) > libm::log(LARGEST) {
            return None;
        }
        let mut parts = 1;
        loop {
            let split = of.split(parts);
            let links: Option<Vec<_>> = split
                .iter()
                .map(|&(part, times)| Series::expand(bound, part).map(|s| (s, times)))
                .collect();
            if let Some(links) = links {
                let chain = Self { links };
                return (chain.products() <= most).then_some(chain);
            }
            // Parts that are no smaller are no easier.
            if split == of.split(2 * parts) {
                return None;
            }
            parts *= 2;
        }
    }

    /// The products with `L` that an evaluation takes.
    pub(crate) fn products(&self) -> usize {
        self.links.iter().map(|(series, times)| series.degree().saturating_mul(*times)).sum()
    }

    /// `g(L) x`.
    pub(crate) fn apply(&self, laplacian: &Laplacian, given: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let mut x = None;
        for (series, times) in &self.links {
            for _ in 0..*times {
                x = Some(series.apply(laplacian, x.as_deref().unwrap_or(given)));
            }
        }
        x.unwrap_or_else(|| given.to_vec())
    }
}

impl Series {
    /// Expands a response on `[−bound, 0]`; `None` where it takes more than two thousand terms, or where it is so
    /// large that cancellation is not harmless (an unstable flow).
    pub(crate) fn expand(bound: f64, of: Response) -> Option<Self> {
        if of.ln_largest(bound) > libm::log(LARGEST) {
            return None;
        }
        let values = sample(bound, samples(bound, of)?, |mu| of.at(mu));
        if values.iter().any(|v| !v.is_finite()) {
            return None;
        }
        let mut coefficients = truncated(transform(&values));
        let lost = 1.0 - coefficients.iter().sum::<f64>();
        coefficients[0] += lost;
        (coefficients.len() <= MOST_DEGREE + 1).then_some(Self { coefficients, bound })
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
    /// Constants are reproduced to rounding wherever the mesh lies: the mean of the points that move (the first point,
    /// where their sum is too large for a number) is taken off before and put back after, so that coordinates far from
    /// the origin lose no digits, nor others to a point without faces that is far away.
    pub(crate) fn apply(&self, laplacian: &Laplacian, given: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let Some(&origin) = given.first() else { return Vec::new() };
        let centre = mean(laplacian, given).unwrap_or(origin);
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

/// The mean of the points that move, if there are any, so few and so near that it is finite.
fn mean(laplacian: &Laplacian, x: &[[f64; 3]]) -> Option<[f64; 3]> {
    let moving = (0..x.len()).filter(|&i| !laplacian.is_still(i));
    let (sum, count) = moving.fold(([0.0; 3], 0.0), |(s, n), i| {
        let p = x[i];
        ([s[0] + p[0], s[1] + p[1], s[2] + p[2]], n + 1.0)
    });
    let mean = sum.map(|s| s / count);
    mean.iter().all(|m| m.is_finite()).then_some(mean)
}

/// The number of Chebyshev points whose polynomial is within [`SAMPLED`] of a response on the interval: one more than
/// the degree of a polynomial, otherwise by the bound on the best of many ellipses. `None` if there are too many.
fn samples(bound: f64, of: Response) -> Option<usize> {
    let exact = of.degree().map_or(f64::INFINITY, |degree| degree as f64 + 1.0);
    let by_bound = (0..160).map(|k| {
        let rho = 1.0 + 1e-5 * 1.12f64.powi(k);
        let ln_error = of.ln_on_ellipse(bound, rho) + libm::log(4.0 / (rho - 1.0) / SAMPLED);
        1.0 + (ln_error.max(0.0) / libm::log(rho)).ceil()
    });
    // NaN never counts.
    let least = by_bound.fold(exact, f64::min).max(2.0);
    (least <= MOST_SAMPLES as f64).then_some(least as usize)
}

/// `g` at the Chebyshev points of the interval, `μ = −bound (1 − cos θ)/2` with `θⱼ = π (j + ½)/n`.
pub(crate) fn sample(bound: f64, n: usize, g: impl Fn(f64) -> f64) -> Vec<f64> {
    (0..n)
        .map(|j| {
            let half = 0.5 * std::f64::consts::PI * (j as f64 + 0.5) / n as f64;
            // (1 − cos θ)/2 = sin² (θ/2) without cancellation near μ = 0.
            g(-bound * libm::sin(half).powi(2))
        })
        .collect()
}

/// The discrete cosine transform `cₖ = (2/n) Σⱼ gⱼ cos kθⱼ`, `c₀` halved.
pub(crate) fn transform(values: &[f64]) -> Vec<f64> {
    let n = values.len();
    // cos kθⱼ = cos(π k(2j + 1)/(2n)) repeats after 4n quarter steps.
    let cosines: Vec<f64> =
        (0..4 * n).map(|q| libm::cos(std::f64::consts::PI * q as f64 / (2 * n) as f64)).collect();
    (0..n)
        .into_par_iter()
        .with_min_len(64)
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
pub(crate) fn truncated(mut coefficients: Vec<f64>) -> Vec<f64> {
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

    /// On the whole interval, its end at zero included, and narrow peaks there: within the bound that is promised, of
    /// degrees that are no larger than needed, and exactly 1 at zero.
    #[test]
    fn series_reproduce_their_functions() {
        let implicit = |step, steps| Response::Implicit { step, steps };
        let butterworth = |cutoff, order| Response::Butterworth { cutoff, order };
        let cases = [
            (2.0, Response::Explicit { step: 0.5, steps: 50 }, 36),
            (2.0, Response::Explicit { step: 0.9, steps: 3000 }, 450),
            (2.0, Response::Pairs { shrink: 0.5, grow: -0.53, pairs: 50 }, 40),
            (2.0, implicit(5.0, 10), 70),
            (800.0, implicit(1.0, 10), 700),
            (2.0, implicit(100.0, 200), 2048),
            (2.0, Response::Heat { time: 40.0 }, 60),
            (300.0, Response::Heat { time: 200.0 }, 2048),
            (2.0, butterworth(0.1, 1), 200),
            (2.0, butterworth(0.1, 16), 550),
        ];
        for (bound, of, most) in cases {
            let series = Series::expand(bound, of).unwrap_or_else(|| panic!("{of:?}"));
            assert!(series.degree() <= most, "{of:?}: degree {}", series.degree());
            assert!((evaluate(&series, 0.0) - 1.0).abs() < 1e-14 * series.degree() as f64);
            for i in 0..=2000 {
                // Quadratically closer towards zero.
                let mu = -bound * (f64::from(i) / 2000.0).powi(2);
                let error = (evaluate(&series, mu) - of.at(mu)).abs();
                // The promise, and rounding of the cosines.
                assert!(error < 2.2 * TOLERANCE, "{of:?} at {mu}: {error:e}");
            }
        }
    }

    /// Peaks between zero and the first Chebyshev point are not taken for nothing.
    #[test]
    fn peaks_that_samples_miss_have_no_series() {
        for of in [
            Response::Implicit { step: 1e9, steps: 3 },
            Response::Implicit { step: 1e5, steps: 10 },
            Response::Heat { time: 1e7 },
            Response::Butterworth { cutoff: 1e-6, order: 2 },
        ] {
            assert!(Series::expand(2.0, of).is_none(), "{of:?}");
            assert!(Chain::expand(2.0, of, usize::MAX).is_none(), "{of:?}");
        }
    }

    #[test]
    fn long_runs_are_chains() {
        let of = Response::Explicit { step: 0.9, steps: 400_000 };
        let chain = Chain::expand(2.0, of, usize::MAX).unwrap();
        assert!(chain.links.iter().map(|l| l.1).sum::<usize>() > 1 && chain.products() < 30_000);
        for mu in [0.0, -1e-7, -1e-6, -1e-5, -1e-3, -1.0, -2.0] {
            let found: f64 =
                chain.links.iter().map(|(s, times)| evaluate(s, mu).powi(*times as i32)).product();
            // 2.1 times the tolerance for each link.
            assert!((found - of.at(mu)).abs() < 5e-9, "{mu}: {found}");
        }
    }

    #[test]
    fn a_short_polynomial_is_exact() {
        let series = Series::expand(2.0, Response::Explicit { step: 0.5, steps: 1 }).unwrap();
        assert_eq!(series.degree(), 1);
        assert!((series.coefficients[0] - 0.5).abs() < 1e-15);
        assert!((series.coefficients[1] - 0.5).abs() < 1e-15);
    }

    #[test]
    fn unstable_flows_are_left_to_stepping() {
        assert!(Series::expand(2.0, Response::Explicit { step: 2.0, steps: 50 }).is_none());
    }
}
