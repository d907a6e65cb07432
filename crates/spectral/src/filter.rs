//! Filters as functions of ω.

use ndarray::{Array2, ArrayView2};

use crate::cluster::Split;
use crate::error::SpectralError;
use crate::spectrum::Spectrum;

/// A field after a filter.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Filtered {
    /// The field, `n × d`.
    pub field: Array2<f64>,
    /// The first cluster of eigenvalues that the response splits, if any: the response varies
    /// within it by more than a thousandth of its largest value, or jumps to that of the rest
    /// within a cluster that continues beyond the modes. The field then depends on the basis of an
    /// eigenspace, which is arbitrary.
    pub split: Option<Split>,
}

/// Responses that differ by less than this fraction of the largest count as equal.
const EQUAL_RESPONSES: f64 = 1e-3;

/// Treatment of the part of a field outside the computed modes.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Rest {
    /// Dropped: the filter is zero beyond the last ω.
    Dropped,
    /// Scaled by this factor, the response at large ω.
    Scaled(f64),
}

impl Spectrum {
    /// Multiplies the coefficient of every mode by a response: Σ h(ωᵢ) φᵢ φᵢᵀ M F.
    ///
    /// # Errors
    ///
    /// [`SpectralError::Rows`].
    ///
    /// Source: [vallet2008].
    ///
    /// [vallet2008]: https://doi.org/10.1111/j.1467-8659.2008.01122.x
    pub fn filter(
        &self,
        field: ArrayView2<'_, f64>,
        response: impl Fn(f64) -> f64,
        rest: Rest,
    ) -> Result<Filtered, SpectralError> {
        let coefficients = self.transform(field)?;
        let beyond = match rest {
            Rest::Dropped => 0.0,
            Rest::Scaled(factor) => factor,
        };
        let mut scaled = coefficients;
        let responses: Vec<f64> = self.values.iter().map(|lambda| response(*lambda)).collect();
        for (mut row, response) in scaled.rows_mut().into_iter().zip(&responses) {
            row *= response - beyond;
        }
        let mut filtered = self.inverse(scaled.view())?;
        if beyond != 0.0 {
            filtered.scaled_add(beyond, &field);
        }
        Ok(Filtered { field: filtered, split: self.split_by(&responses, beyond) })
    }

    /// The first cluster whose modes have different responses.
    fn split_by(&self, responses: &[f64], beyond: f64) -> Option<Split> {
        let largest = responses.iter().fold(beyond.abs(), |m: f64, r| m.max(r.abs()));
        let differ = |a: f64, b: f64| (a - b).abs() > EQUAL_RESPONSES * largest;
        for cluster in self.clusters() {
            let inside = &responses[cluster.clone()];
            let goes_on = cluster.end == self.len() && self.split(self.len()).is_some();
            if inside.iter().any(|r| differ(*r, inside[0]) || (goes_on && differ(*r, beyond))) {
                let above = self.gap_above(cluster.end);
                return Some(Split { below: cluster.start, above });
            }
        }
        None
    }
}
