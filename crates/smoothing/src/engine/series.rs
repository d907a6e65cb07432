//! A whole run of a linear flow as one Chebyshev series, or explicit steps one after another.
//!
//! With a constant operator, `k` steps multiply the mode of eigenvalue μ by `g(μ)`: `(1 + λμ)ᵏ` for
//! explicit steps, `(1 − λμ)⁻ᵏ` for implicit ones. If intermediate steps are not observed, `g(L) x`
//! is computed directly from the Chebyshev series of `g` on an interval containing the spectrum.
//! Its degree is far below the number of products (or iterations of solves) that stepping needs: 32
//! instead of 50 for fifty explicit steps with λ = ½, 35 instead of 100 for fifty Taubin pairs, 62
//! for ten implicit steps with λ = 5. There are no inner products, hence no synchronisation, and
//! every operation is fused into one sweep over the mesh.
//!
//! A series is computed from samples of `g`, and their number follows from an error bound: if
//! `|g| ≤ M` on the Bernstein ellipse of parameter ρ, the polynomial through n Chebyshev points is
//! within `4 M ρ^(1 − n)/(ρ − 1)` of g on the whole interval ([trefethen2013], theorem 8.2);
//! polynomials of degree below n are reproduced exactly. The series is then truncated where the
//! dropped coefficients sum to less than [`TOLERANCE`], and the constant term absorbs the change at
//! μ = 0, so that the centroid of every component is preserved. `L` is symmetric in the inner
//! product of the mass, so the result differs from exact stepping by at most 2.1 [`TOLERANCE`]
//! times the norm of `x` about its mean. Source: \[druskin1989\].
//!
//! [trefethen2013]: https://doi.org/10.1137/1.9781611975949

use std::ops::ControlFlow;

use fairing_sparse::{ChebyshevSeries, GraphLaplacian, Workload, larger};

use crate::engine::constraints::Freedom;
use crate::engine::error::FlowError;
use crate::engine::outcome::{Approach, Smoothed};
use crate::engine::response::Response;
use crate::engine::run::{Run, StepNote};

/// The largest absolute sum of dropped coefficients. For comparison, `|g| ≤ 1` for most stable
/// flows, and at most [`LARGEST`] for all.
pub(crate) const TOLERANCE: f64 = 1e-10;

/// The largest interpolation error.
const SAMPLED: f64 = 1e-12;

/// The relative residual at which the costs of solving systems are compared with those of a series.
const RESIDUAL: f64 = 1e-8;

/// The largest number of samples.
const MAX_SAMPLES: usize = 4096;

/// The largest degree.
const MAX_DEGREE: usize = 2048;

/// The largest `|g|` at which cancellation is harmless; unstable flows exceed it.
const LARGEST: f64 = 4.0;

/// Series applied one after another, each with its multiplicity.
#[derive(Debug, Clone)]
pub(crate) struct Chain {
    links: Vec<(ChebyshevSeries, usize)>,
}

impl Chain {
    /// The shortest chain for a run, split into as few parts as have a series each; `None` if there
    /// is none with at most `max_products` products.
    pub(crate) fn expand(bound: f64, of: Response, max_products: usize) -> Option<Self> {
        if of.ln_largest(bound) > libm::log(LARGEST) {
            return None;
        }
        let mut parts = 1;
        loop {
            let split = of.split(parts);
            let links: Option<Vec<_>> = split
                .iter()
                .map(|&(part, times)| expand(bound, part).map(|s| (s, times)))
                .collect();
            if let Some(links) = links {
                let chain = Self { links };
                return (chain.products() <= max_products).then_some(chain);
            }
            // The parts cannot become shorter.
            if split == of.split(2 * parts) {
                return None;
            }
            parts *= 2;
        }
    }

    /// A chain of one series, if the run has one.
    pub(crate) fn one(bound: f64, of: Response) -> Option<Self> {
        expand(bound, of).map(|series| Self { links: vec![(series, 1)] })
    }

    /// The number of products with `L` in one evaluation.
    pub(crate) fn products(&self) -> usize {
        self.links.iter().map(|(series, times)| series.degree().saturating_mul(*times)).sum()
    }

    /// Computes `g(L) x`.
    pub(crate) fn apply(&self, laplacian: &GraphLaplacian, given: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let mut x = None;
        for (series, times) in &self.links {
            for _ in 0..*times {
                x = Some(series.apply(laplacian, x.as_deref().unwrap_or(given)));
            }
        }
        x.unwrap_or_else(|| given.to_vec())
    }
}

/// Expands a response on `[−bound, 0]`; `None` if the series has more than two thousand terms, or
/// if the response is so large that cancellation costs accuracy (an unstable flow).
fn expand(bound: f64, of: Response) -> Option<ChebyshevSeries> {
    if of.ln_largest(bound) > libm::log(LARGEST) {
        return None;
    }
    let samples = samples(bound, of)?;
    let series = ChebyshevSeries::interpolate(bound, samples, TOLERANCE, |mu| of.at(mu))?;
    (series.degree() <= MAX_DEGREE).then_some(series)
}

/// The number of Chebyshev points whose interpolant is within [`SAMPLED`] of a response on the
/// interval: one more than the degree for a polynomial, otherwise by the bound on the best of many
/// ellipses. `None` if there are too many.
fn samples(bound: f64, of: Response) -> Option<usize> {
    let exact = of.degree().map_or(f64::INFINITY, |degree| degree as f64 + 1.0);
    let by_bound = (0..160).map(|k| {
        let rho = 1.0 + 1e-5 * 1.12f64.powi(k);
        let ln_error = of.ln_on_ellipse(bound, rho) + libm::log(4.0 / (rho - 1.0) / SAMPLED);
        1.0 + (ln_error.max(0.0) / libm::log(rho)).ceil()
    });
    // NaN never counts.
    let least = by_bound.fold(exact, f64::min).max(2.0);
    (least <= MAX_SAMPLES as f64).then_some(least as usize)
}

/// Multiplies the mode of eigenvalue μ of `L` by `response.at(μ)` with a Chebyshev series, if the
/// run is unobserved, has free and pinned vertices only, and if a series exists that is faster than
/// solving the `systems` `(M + tS) x = b` that would do the same, given by t and their number;
/// otherwise returns the run. `bound` computes a
/// [bound of the spectrum](GraphLaplacian::spectral_bound).
pub(crate) fn at_once<'a, 'o>(
    mut run: Run<'a, 'o>,
    laplacian: &GraphLaplacian,
    response: Response,
    systems: Option<(f64, usize)>,
    bound: impl FnOnce() -> f64,
) -> ControlFlow<Result<Smoothed, FlowError>, Run<'a, 'o>> {
    if !run.is_linear() {
        return ControlFlow::Continue(run);
    }
    let work = systems
        .map(|(step, solves)| Workload::new(laplacian, step, laplacian.mass(), RESIDUAL, solves));
    let pays = |products| work.is_none_or(|work| work.prefers_series(products));
    // Finding the degree, at least a third of the number of samples, takes time quadratic in it.
    let may_pay =
        |bound| work.is_none() || samples(bound, response).is_some_and(|samples| pays(samples / 3));
    let series = may_pay(largest_ratio(laplacian))
        .then(bound)
        .filter(|bound| may_pay(*bound))
        .and_then(|bound| series(bound, response))
        .filter(|series| pays(series.products()));
    let Some(series) = series else { return ControlFlow::Continue(run) };
    run.report.approach = Approach::Series { degree: series.products() };
    run.report.iterations = response.steps();
    let x = series.apply(laplacian, run.arrangement.mesh().positions());
    ControlFlow::Break(run.finish(x))
}

/// The largest Sᵢᵢ/Mᵢᵢ, no more than the largest eigenvalue of −L.
fn largest_ratio(laplacian: &GraphLaplacian) -> f64 {
    let ratios = laplacian.diagonal().iter().zip(laplacian.mass());
    ratios.map(|(s, m)| if *s > 0.0 { s / m } else { 0.0 }).fold(0.0, larger)
}

/// The series of a run, if it is cheaper than explicit steps.
fn series(bound: f64, response: Response) -> Option<Chain> {
    // A product of a series costs a third less than a step.
    match response {
        Response::Explicit { steps, .. } if steps > 1 => {
            Chain::expand(bound, response, steps.saturating_add(steps / 2))
        }
        Response::Pairs { pairs, .. } if pairs > 1 => {
            Chain::expand(bound, response, pairs.saturating_mul(3))
        }
        Response::Explicit { .. } | Response::Pairs { .. } => None,
        Response::Implicit { steps: 0, .. } => None,
        other => Chain::one(bound, other),
    }
}

/// Takes explicit steps, of lengths in turn.
pub(crate) fn explicit_steps(
    run: Run<'_, '_>,
    laplacian: &GraphLaplacian,
    lengths: &[f64],
) -> Result<Smoothed, FlowError> {
    run.iterate(|iteration, mesh, freedom, next| {
        let step = lengths[iteration % lengths.len()];
        explicit_step(laplacian, step, mesh.positions(), freedom, next);
        Ok(StepNote { step_size: step, residual: None })
    })
}

/// The explicit step `next ← x + λ P L x`, drawn towards soft targets.
fn explicit_step(
    laplacian: &GraphLaplacian,
    step: f64,
    x: &[[f64; 3]],
    freedom: &Freedom,
    next: &mut [[f64; 3]],
) {
    if freedom.is_linear() {
        laplacian.sweep(x, next, |_, l, x, _| {
            [x[0] + step * l[0], x[1] + step * l[1], x[2] + step * l[2]]
        });
        return;
    }
    laplacian.sweep(x, next, |i, l, x, _| {
        let (w, target) = freedom.pull(i);
        let d = [0, 1, 2].map(|k| (step * l[k] + w * (target[k] - x[k])) / (1.0 + w));
        let d = freedom.project(i, d);
        [x[0] + d[0], x[1] + d[1], x[2] + d[2]]
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    fn evaluate(series: &ChebyshevSeries, bound: f64, mu: f64) -> f64 {
        let angle = (1.0 + 2.0 * mu / bound).clamp(-1.0, 1.0).acos();
        series.coefficients().iter().enumerate().map(|(k, c)| c * (k as f64 * angle).cos()).sum()
    }

    /// Series are within the promised bound on the whole interval, including narrow peaks at zero,
    /// have degrees no larger than needed, and are exactly 1 at zero.
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
            let series = expand(bound, of).unwrap_or_else(|| panic!("{of:?}"));
            assert!(series.degree() <= most, "{of:?}: degree {}", series.degree());
            assert!(3 * series.degree() >= samples(bound, of).unwrap(), "{of:?}");
            assert!((evaluate(&series, bound, 0.0) - 1.0).abs() < 1e-14 * series.degree() as f64);
            for i in 0..=2000 {
                // Quadratically denser towards zero.
                let mu = -bound * (f64::from(i) / 2000.0).powi(2);
                let error = (evaluate(&series, bound, mu) - of.at(mu)).abs();
                // The bound, plus rounding of the cosines.
                assert!(error < 2.2 * TOLERANCE, "{of:?} at {mu}: {error:e}");
            }
        }
    }

    /// Peaks between zero and the first Chebyshev point are not overlooked.
    #[test]
    fn peaks_that_samples_miss_have_no_series() {
        for of in [
            Response::Implicit { step: 1e9, steps: 3 },
            Response::Implicit { step: 1e5, steps: 10 },
            Response::Heat { time: 1e7 },
            Response::Butterworth { cutoff: 1e-6, order: 2 },
        ] {
            assert!(expand(2.0, of).is_none(), "{of:?}");
            assert!(Chain::expand(2.0, of, usize::MAX).is_none(), "{of:?}");
        }
    }

    #[test]
    fn long_runs_are_chains() {
        let of = Response::Explicit { step: 0.9, steps: 400_000 };
        let chain = Chain::expand(2.0, of, usize::MAX).unwrap();
        assert!(chain.links.iter().map(|l| l.1).sum::<usize>() > 1 && chain.products() < 30_000);
        for mu in [0.0, -1e-7, -1e-6, -1e-5, -1e-3, -1.0, -2.0] {
            let found: f64 = chain
                .links
                .iter()
                .map(|(s, times)| evaluate(s, 2.0, mu).powi(*times as i32))
                .product();
            // 2.1 times the tolerance for each link.
            assert!((found - of.at(mu)).abs() < 5e-9, "{mu}: {found}");
        }
    }

    #[test]
    fn a_short_polynomial_is_exact() {
        let series = expand(2.0, Response::Explicit { step: 0.5, steps: 1 }).unwrap();
        assert_eq!(series.degree(), 1);
        assert!((series.coefficients()[0] - 0.5).abs() < 1e-15);
        assert!((series.coefficients()[1] - 0.5).abs() < 1e-15);
    }

    #[test]
    fn unstable_flows_are_left_to_stepping() {
        assert!(expand(2.0, Response::Explicit { step: 2.0, steps: 50 }).is_none());
    }
}
