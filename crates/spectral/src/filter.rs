//! Filters as functions of λ.

use ndarray::{Array2, ArrayView2};

use crate::error::SpectralError;
use crate::spectrum::Spectrum;

/// What becomes of the part of a field outside the modes at hand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Rest {
    /// It is left out: the filter is zero beyond the last λ.
    Dropped,
    /// It is multiplied by this, the response at large λ.
    Scaled(f64),
}

impl Spectrum {
    /// Multiplies the coefficient of every mode by a response: Σ h(λᵢ) φᵢ φᵢᵀ M F.
    ///
    /// # Errors
    ///
    /// [`SpectralError::Rows`].
    ///
    /// Source: \[vallet2008\].
    pub fn filter(
        &self,
        field: ArrayView2<'_, f64>,
        response: impl Fn(f64) -> f64,
        rest: Rest,
    ) -> Result<Array2<f64>, SpectralError> {
        let coefficients = self.transform(field)?;
        let beyond = match rest {
            Rest::Dropped => 0.0,
            Rest::Scaled(factor) => factor,
        };
        let mut scaled = coefficients;
        for (mut row, &lambda) in scaled.rows_mut().into_iter().zip(&self.values) {
            row *= response(lambda) - beyond;
        }
        let mut filtered = self.inverse(scaled.view())?;
        if beyond != 0.0 {
            filtered.scaled_add(beyond, &field);
        }
        Ok(filtered)
    }
}

/// 1 up to the cutoff (in units of λ), 0 above.
pub fn low_pass(cutoff: f64) -> impl Fn(f64) -> f64 {
    move |lambda| f64::from(u8::from(lambda <= cutoff))
}

/// 0 up to the cutoff (in units of λ), 1 above.
pub fn high_pass(cutoff: f64) -> impl Fn(f64) -> f64 {
    move |lambda| f64::from(u8::from(lambda > cutoff))
}

/// 1 above `from` and up to `to` (in units of λ), 0 elsewhere.
pub fn band_pass(from: f64, to: f64) -> impl Fn(f64) -> f64 {
    move |lambda| f64::from(u8::from(lambda > from && lambda <= to))
}
