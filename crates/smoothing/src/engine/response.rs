//! The response of each mode to a run of a linear flow, on the spectrum and in the complex plane.
//!
//! The error of a Chebyshev series follows from a bound of the function on a Bernstein ellipse
//! around the interval. With μ = −b (1 − z)/2 the interval [−b, 0] is z ∈ [−1, 1]; the ellipse of
//! parameter ρ > 1 is the image of the circle |u| = ρ under z = (u + 1/u)/2, so that
//! `|z − 1| + |z + 1| = ρ + 1/ρ` and `|z| ≤ a = (ρ + 1/ρ)/2` on it.

use std::f64::consts::PI;

/// The factor by which a run multiplies the mode of eigenvalue μ ≤ 0; it is 1 at μ = 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Response {
    /// `(1 + λμ)ᵏ`: k explicit steps.
    Explicit { step: f64, steps: usize },
    /// `((1 + αμ)(1 + βμ))ᵏ` with β < 0 < α: k pairs of a shrinking and a growing step.
    Pairs { shrink: f64, grow: f64, pairs: usize },
    /// `(1 − λμ)⁻ᵏ`: k implicit steps.
    Implicit { step: f64, steps: usize },
    /// `exp(tμ)`.
    Heat { time: f64 },
    /// `1/(1 + (−μ/c)ᵖ)`.
    Butterworth { cutoff: f64, order: u32 },
}

impl Response {
    /// The value at μ ≤ 0.
    pub(crate) fn at(self, mu: f64) -> f64 {
        let whole = |k: usize| k.min(i32::MAX as usize) as i32;
        match self {
            Self::Explicit { step, steps } => (1.0 + step * mu).powi(whole(steps)),
            Self::Pairs { shrink, grow, pairs } => {
                ((1.0 + shrink * mu) * (1.0 + grow * mu)).powi(whole(pairs))
            }
            Self::Implicit { step, steps } => (1.0 - step * mu).powi(-whole(steps)),
            Self::Heat { time } => libm::exp(time * mu),
            Self::Butterworth { cutoff, order } => {
                1.0 / (1.0 + (-mu / cutoff).powi(whole(order as usize)))
            }
        }
    }

    /// The number of steps of the run; 1 for a filter.
    pub(crate) fn steps(self) -> usize {
        match self {
            Self::Explicit { steps, .. } | Self::Implicit { steps, .. } => steps,
            Self::Pairs { pairs, .. } => 2 * pairs,
            Self::Heat { .. } | Self::Butterworth { .. } => 1,
        }
    }

    /// The degree if the response is a polynomial in μ.
    pub(crate) fn degree(self) -> Option<usize> {
        match self {
            Self::Explicit { steps, .. } => Some(steps),
            Self::Pairs { pairs, .. } => pairs.checked_mul(2),
            _ => None,
        }
    }

    /// The logarithm of the largest modulus on [−b, 0].
    pub(crate) fn ln_largest(self, b: f64) -> f64 {
        match self {
            Self::Explicit { step, steps } => {
                steps as f64 * libm::log((1.0 - step * b).abs().max(1.0))
            }
            Self::Pairs { shrink, grow, pairs } => {
                let pair = |mu: f64| ((1.0 + shrink * mu) * (1.0 + grow * mu)).abs();
                // A parabola in μ that is 1 at 0: its top, if that lies within, and the far end.
                let top = (-0.5 * (1.0 / shrink + 1.0 / grow)).clamp(-b, 0.0);
                pairs as f64 * libm::log(pair(top).max(pair(-b)).max(1.0))
            }
            Self::Implicit { .. } | Self::Heat { .. } | Self::Butterworth { .. } => 0.0,
        }
    }

    /// An upper bound of the logarithm of the modulus on the ellipse of parameter `rho` around [−b,
    /// 0]; infinite if the ellipse contains a pole.
    pub(crate) fn ln_on_ellipse(self, b: f64, rho: f64) -> f64 {
        // a − 1 without cancellation.
        let beyond = 0.5 * (rho - 1.0) * (rho - 1.0) / rho;
        let a = 1.0 + beyond;
        match self {
            // 1 + λμ = 1 − c + c z with c = λb/2.
            Self::Explicit { step, steps } => {
                let c = 0.5 * step * b;
                steps as f64 * libm::log((1.0 - c).abs() + c * a)
            }
            Self::Pairs { shrink, grow, pairs } => {
                let (c, d) = (0.5 * shrink * b, -0.5 * grow * b);
                let pair = ((1.0 - c).abs() + c * a) * (1.0 + d + d * a);
                pairs as f64 * libm::log(pair)
            }
            // The real part of 1 − λμ = 1 + c (1 − z) is least at z = a.
            Self::Implicit { step, steps } => {
                let least = 1.0 - 0.5 * step * b * beyond;
                if least > 0.0 { -(steps as f64) * libm::log(least) } else { f64::INFINITY }
            }
            Self::Heat { time } => 0.5 * time * b * beyond,
            Self::Butterworth { cutoff, order } => butterworth(2.0 * cutoff / b, order, rho),
        }
    }

    /// The run split into about `parts` runs of nearly equal length, each with its multiplicity.
    /// Filters are not split.
    pub(crate) fn split(self, parts: usize) -> Vec<(Self, usize)> {
        let whole = match self {
            Self::Explicit { steps, .. } | Self::Implicit { steps, .. } => steps,
            Self::Pairs { pairs, .. } => pairs,
            Self::Heat { .. } | Self::Butterworth { .. } => return vec![(self, 1)],
        };
        let of = |count: usize| match self {
            Self::Explicit { step, .. } => Self::Explicit { step, steps: count },
            Self::Implicit { step, .. } => Self::Implicit { step, steps: count },
            Self::Pairs { shrink, grow, .. } => Self::Pairs { shrink, grow, pairs: count },
            other => other,
        };
        let each = whole.div_ceil(parts.max(1)).max(1);
        let mut split = vec![(of(each), whole / each)];
        if !whole.is_multiple_of(each) {
            split.push((of(whole % each), 1));
        }
        split
    }
}

/// An upper bound of `−ln |1 + wᵖ|` on the ellipse, with `w = (1 − z)/δ`.
///
/// `|1 + wᵖ|` is the product of the distances of w to the p zeros on the unit circle. With J(u) =
/// (u + 1/u)/2, z = J(u), |u| = ρ, and a zero zₘ = J(uₘ), |uₘ| = ρₘ > ρ,
/// `|z − zₘ| = |u − uₘ| |1 − 1/(u uₘ)|/2 ≥ (ρₘ − ρ)(1 − 1/(ρ ρₘ))/2`.
fn butterworth(delta: f64, order: u32, rho: f64) -> f64 {
    let mut sum = 0.0;
    for m in 0..order {
        let angle = PI * f64::from(2 * m + 1) / f64::from(order);
        let (dx, dy) = (delta * libm::cos(angle), delta * libm::sin(angle));
        // |z − 1| + |z + 1| for z = 1 − δ exp(i angle).
        let two_a = delta + libm::hypot(2.0 - dx, dy);
        let half = 0.5 * two_a;
        let zero = half + ((half - 1.0).max(0.0) * (half + 1.0)).sqrt();
        if zero <= rho {
            return f64::INFINITY;
        }
        sum -= libm::log(0.5 * (zero - rho) * (1.0 - 1.0 / (rho * zero)) / delta);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A complex number.
    type Complex = (f64, f64);

    fn times(a: Complex, b: Complex) -> Complex {
        (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0)
    }

    /// The logarithm of the modulus at complex μ, from the definition.
    fn ln_modulus(of: Response, mu: Complex) -> f64 {
        let affine = |s: f64| ((1.0 + s * mu.0).hypot(s * mu.1)).ln();
        match of {
            Response::Explicit { step, steps } => steps as f64 * affine(step),
            Response::Pairs { shrink, grow, pairs } => {
                pairs as f64 * (affine(shrink) + affine(grow))
            }
            Response::Implicit { step, steps } => -(steps as f64) * affine(-step),
            Response::Heat { time } => time * mu.0,
            Response::Butterworth { cutoff, order } => {
                let w = (-mu.0 / cutoff, -mu.1 / cutoff);
                let power = (1..order).fold(w, |p, _| times(p, w));
                -(1.0 + power.0).hypot(power.1).ln()
            }
        }
    }

    const SAMPLES: [Response; 8] = [
        Response::Explicit { step: 0.7, steps: 50 },
        Response::Explicit { step: 1.0, steps: 9 },
        Response::Pairs { shrink: 0.5, grow: -0.53, pairs: 20 },
        Response::Implicit { step: 5.0, steps: 10 },
        Response::Heat { time: 30.0 },
        Response::Butterworth { cutoff: 0.3, order: 1 },
        Response::Butterworth { cutoff: 0.3, order: 4 },
        Response::Butterworth { cutoff: 0.02, order: 7 },
    ];

    /// The bound holds at every point of narrow and wide ellipses, and no pole lies inside an
    /// ellipse with a finite bound.
    #[test]
    fn moduli_on_ellipses_are_bounded() {
        let b = 2.0;
        for response in SAMPLES {
            let mut finite = 0;
            for exponent in 1..=40 {
                let rho = 1.0 + 1e-3 * 1.25f64.powi(exponent);
                let bound = response.ln_on_ellipse(b, rho);
                finite += usize::from(bound.is_finite());
                for j in 0..=200 {
                    let phi = PI * f64::from(j) / 100.0;
                    let z =
                        (0.5 * (rho + 1.0 / rho) * phi.cos(), 0.5 * (rho - 1.0 / rho) * phi.sin());
                    let mu = (-0.5 * b * (1.0 - z.0), 0.5 * b * z.1);
                    let found = ln_modulus(response, mu);
                    assert!(found <= bound + 1e-9, "{response:?}, ρ = {rho}, φ = {phi}");
                }
            }
            assert!(finite > 10, "{response:?}: {finite}");
        }
    }

    #[test]
    fn the_largest_modulus_on_the_interval_is_attained() {
        for response in SAMPLES {
            for b in [0.1, 2.0, 3.5] {
                let values = (0..=10_000).map(|i| response.at(-b * f64::from(i) / 1e4).abs().ln());
                let found = values.fold(f64::NEG_INFINITY, f64::max);
                // The top of a parabola may lie between two of ten thousand points.
                let bound = response.ln_largest(b);
                assert!(found <= bound + 1e-12 && bound < found + 1e-5, "{response:?}: {bound}");
            }
        }
    }

    #[test]
    fn parts_make_the_whole() {
        for steps in [1, 2, 7, 100, 101] {
            for parts in [1, 2, 3, 64] {
                let split = Response::Explicit { step: 0.3, steps }.split(parts);
                let product: f64 =
                    split.iter().map(|(r, times)| r.at(-1.0).powi(*times as i32)).product();
                assert!((product / 0.7f64.powi(steps as i32) - 1.0).abs() < 1e-12);
            }
        }
    }
}
