//! Narrow filters as a series in the resolvent.
//!
//! A polynomial in `L` that is 1 at μ = 0 and small beyond a millionth of the spectrum has
//! thousands of terms. In terms of `y = 1/(1 − τμ)`, the eigenvalue of the resolvent
//! `R = (I − τL)⁻¹`, the half-line μ ≤ 0 becomes the interval (0, 1], and with τ chosen for the
//! filter its function of y does not depend on the mesh:
//!
//! ```text
//! exp(tμ) = exp(σ (1 − 1/y))                with τ = t/σ
//! 1/(1 + (−μ/c)ᵖ) = yᵖ/(yᵖ + (1 − y)ᵖ)      with τ = 1/c
//! ```
//!
//! The first is smooth on [0, 1], and with σ = [`RATIO`] thirty coefficients suffice; the second
//! has its poles at `½ − ½ i tan(θ/2)` for odd multiples θ of π/p, so that its coefficients decay
//! like powers of `tan(π/2p) + 1/cos(π/2p)`: 31 terms for p = 1 to 4, 250 for p = 16. R is factored
//! once, and every mode is accurate however large t or small c is.

use fairing_mesh::TriMesh;
use fairing_sparse::{ChebyshevSeries, GraphLaplacian, GraphSystem};

use crate::engine::error::FlowFailure;
use crate::engine::response::Response;
use crate::engine::series::TOLERANCE;

type Point = [f64; 3];

/// σ, the ratio of the time of a heat filter to that of its resolvent.
const RATIO: f64 = 20.0;

/// Samples: for p = 16 the interpolation error is below 1e-20 by the bound of
/// [`crate::engine::series`]; that of the heat filter is tested at other points.
const SAMPLES: usize = 1024;

/// The relative residual of the systems, below the tolerance of a series, since their errors add
/// up.
const RESIDUAL: f64 = 1e-12;

/// A filter as a series in the resolvent.
pub(crate) struct Resolvent {
    /// τ.
    step: f64,
    /// Coefficients of Chebyshev polynomials in 2y − 1.
    coefficients: Vec<f64>,
}

impl Resolvent {
    /// The series of a filter; `None` for any other response.
    pub(crate) fn expand(of: Response) -> Option<Self> {
        let (step, of_y): (f64, Box<dyn Fn(f64) -> f64>) = match of {
            Response::Heat { time } => {
                (time / RATIO, Box::new(|y| libm::exp(RATIO * (1.0 - 1.0 / y))))
            }
            Response::Butterworth { cutoff, order } => {
                let power = move |y: f64| y.powi(order as i32);
                (1.0 / cutoff, Box::new(move |y| power(y) / (power(y) + power(1.0 - y))))
            }
            _ => return None,
        };
        // The interval [−1, 0] of the series, shifted to [0, 1].
        let of_mu = |mu: f64| of_y(1.0 + mu);
        let series = ChebyshevSeries::interpolate(1.0, SAMPLES, TOLERANCE, of_mu)?;
        Some(Self { step, coefficients: series.coefficients().to_vec() })
    }

    /// The number of systems solved in one evaluation.
    pub(crate) fn degree(&self) -> usize {
        self.coefficients.len() - 1
    }

    /// τ, and the number of systems.
    pub(crate) fn systems(&self) -> (f64, usize) {
        (self.step, self.degree())
    }

    /// `Σ cₖ Tₖ(2R − 1) x` by Clenshaw's recurrence, and the largest relative residual. `mesh` is
    /// in the order of the Laplacian.
    pub(crate) fn apply(
        &self,
        laplacian: GraphLaplacian,
        mesh: &TriMesh,
    ) -> Result<(Vec<Point>, f64), FlowFailure> {
        let (x, degree) = (mesh.positions(), self.degree());
        let fixed: Vec<bool> = (0..x.len()).map(|i| laplacian.is_fixed(i)).collect();
        let mass = laplacian.mass().to_vec();
        let resolvent =
            GraphSystem::to_tolerance(laplacian, self.step, mass, &fixed, RESIDUAL, degree);
        let mass = resolvent.laplacian().mass();
        // Filters keep constants, so positions are taken about one of each component.
        let components = mesh.topology().components();
        let mut origins = vec![None; components.count()];
        let label = |i: usize| components.label(i as u32).map(|label| label as usize);
        for i in (0..x.len()).rev() {
            if let Some(label) = label(i) {
                origins[label] = Some(x[i]);
            }
        }
        let origin = |i: usize| label(i).and_then(|label| origins[label]).unwrap_or(x[i]);
        let about = |i: usize| {
            let o = origin(i);
            [0, 1, 2].map(|k| x[i][k] - o[k])
        };
        let (mut last, mut before) = (vec![[0.0; 3]; x.len()], vec![[0.0; 3]; x.len()]);
        let mut worst = 0.0f64;
        for (k, c) in self.coefficients.iter().enumerate().rev() {
            let twice = if k == 0 { 1.0 } else { 2.0 };
            let mut image = last.clone();
            if k < degree {
                let right = |i: usize| last[i].map(|x| mass[i] * x);
                worst = worst.max(resolvent.solve(right, &mut image)?.residual);
            }
            // T b = 2 R b − b.
            for (i, before) in before.iter_mut().enumerate() {
                let (a, b, r) = (about(i), last[i], image[i]);
                *before = [0, 1, 2].map(|k| c * a[k] + twice * (2.0 * r[k] - b[k]) - before[k]);
            }
            std::mem::swap(&mut last, &mut before);
        }
        for (i, p) in last.iter_mut().enumerate() {
            let o = origin(i);
            *p = if fixed[i] { x[i] } else { [0, 1, 2].map(|k| p[k] + o[k]) };
        }
        Ok((last, worst))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tested at twenty thousand points of the interval, most near its ends, including y = 1.
    /// The Lipschitz constants of the functions are at most 20 (heat) and 16 (Butterworth), those
    /// of the polynomials at most Σ k² |cₖ| < 10³.
    #[test]
    fn filters_are_met_on_the_whole_interval() {
        let heat = Response::Heat { time: 7.0 };
        let orders = (1..=16).map(|order| Response::Butterworth { cutoff: 0.3, order });
        for of in std::iter::once(heat).chain(orders) {
            let resolvent = Resolvent::expand(of).unwrap();
            assert!(resolvent.degree() <= 260, "{of:?}: {}", resolvent.degree());
            for i in 0..=20_000 {
                let angle = std::f64::consts::PI * f64::from(i) / 20_000.0;
                let y = (0.5 * angle).cos().powi(2);
                let terms = resolvent.coefficients.iter().enumerate();
                let found: f64 = terms.map(|(k, c)| c * (k as f64 * angle).cos()).sum();
                let mu = (1.0 - 1.0 / y.max(1e-300)) / resolvent.step;
                let expected = of.at(mu);
                assert!((found - expected).abs() < 2.2 * TOLERANCE, "{of:?} at {y}: {found}");
            }
        }
    }
}
