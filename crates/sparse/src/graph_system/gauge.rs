//! The scale of the residual in each column of each part.
//!
//! A system decouples into one for each part and column. Parts may differ in size by any factor,
//! and so may columns; with a tolerance relative to the largest, the smallest would not be solved
//! at all. Residuals are therefore measured for each column of each part relative to its own
//! right-hand side, but not below the level of rounding.

use crate::graph_system::equations::{Centred, Equations};
use crate::graph_system::parts::Parts;
use crate::order::larger;

/// The rounding error allowed in a residual, as a multiple of ε times its terms.
const ROUNDING: f64 = 8.0;

/// The norms of the right-hand sides `b − Dc` of the parts, and of the coefficients of their rows.
pub(super) struct Sides<const N: usize> {
    right: Vec<[f64; N]>,
    terms: Vec<f64>,
}

impl<const N: usize> Sides<N> {
    pub(super) fn new(centred: &Centred<'_, N>) -> Self {
        let Equations { laplacian, step, added, parts, .. } = centred.equations;
        let squares = parts.sums(|_, i| {
            let term = if parts.is_given(i) {
                0.0
            } else {
                added[i] + 2.0 * step * laplacian.diagonal()[i]
            };
            (centred.load(i).map(|load| load * load), term * term)
        });
        let roots = squares.into_iter().map(|(load, term)| (load.map(f64::sqrt), term.sqrt()));
        let (right, terms) = roots.unzip();
        Self { right, terms }
    }

    /// The scales of residuals, for the largest values of each part: the norm of the right-hand
    /// side, or the rounding error over the tolerance. Coupled columns share one scale.
    pub(super) fn scales(
        &self,
        reach: &[[f64; N]],
        tolerance: f64,
        columns: Columns,
    ) -> Vec<[f64; N]> {
        let together = |values: [f64; N], join: fn(f64, f64) -> f64| match columns {
            Columns::Coupled => [values.into_iter().fold(0.0, join); N],
            Columns::Independent => values,
        };
        let parts = self.right.iter().zip(&self.terms).zip(reach);
        let scale = |((right, term), reach): ((&[f64; N], &f64), &[f64; N])| {
            let (right, reach) = (together(*right, libm::hypot), together(*reach, larger));
            std::array::from_fn(|k| {
                larger(right[k], ROUNDING * f64::EPSILON * term * reach[k] / tolerance)
            })
        };
        parts.map(scale).collect()
    }
}

/// Coupling of the columns of a system.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Columns {
    Independent,
    Coupled,
}

/// The largest norm of a column of a part, relative to its scale.
pub(super) fn measure<const N: usize>(parts: &Parts, scales: &[[f64; N]], r: &[[f64; N]]) -> f64 {
    let units: Vec<[f64; N]> = scales.iter().map(|scale| scale.map(reciprocal)).collect();
    let squares = parts.sums(|part, i| {
        let unit = &units[part];
        std::array::from_fn::<f64, N, _>(|k| (r[i][k] * unit[k]).powi(2))
    });
    squares.into_iter().flatten().map(f64::sqrt).fold(0.0, larger)
}

/// Numbers below this count as zero: modes that have vanished, whose reciprocals could overflow.
const VANISHED: f64 = 1e-250;

/// `1/x`; zero for zero.
pub(super) fn reciprocal(x: f64) -> f64 {
    if x > VANISHED { 1.0 / x } else { 0.0 }
}
