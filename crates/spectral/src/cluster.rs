//! Clusters of equal and nearly equal eigenvalues, and the gaps between them.

use std::ops::Range;

use crate::spectrum::Spectrum;

/// Residuals count as at least this fraction of ω, the usual tolerance: smaller ones are rounding,
/// on which clusters must not depend.
const MIN_RESIDUAL: f64 = 1e-9;

/// A cut through a cluster: the modes kept depend on the basis of an eigenspace, which is
/// arbitrary.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Split {
    /// The number of modes below the cluster: the largest smaller number that splits none.
    pub below: usize,
    /// The number of modes up to the end of the cluster: the smallest larger number that splits
    /// none, if known. It may exceed the number of modes computed.
    pub above: Option<usize>,
}

impl Spectrum {
    /// Largest angle by which the residuals may mix modes on both sides of a gap, in radians.
    /// Results on different processors differ by as much.
    pub const GAP_ANGLE: f64 = 1e-5;

    /// The modes in clusters of equal and nearly equal eigenvalues, ascending.
    ///
    /// A gap separates neighbours if |ωᵢ₊₁ − ωᵢ| is more than 10⁵ times the larger of their
    /// residuals, taken as at least 10⁻⁹ ω: modes on both sides are then determined to an angle of
    /// 10⁻⁵. Exact zeros have no residual. The last cluster may continue beyond the last mode: see
    /// [`Spectrum::split`].
    pub fn clusters(&self) -> Vec<Range<usize>> {
        let mut clusters = vec![];
        let mut start = 0;
        for end in 1..=self.len() {
            if end == self.len() || self.is_gap(end) {
                clusters.push(start..end);
                start = end;
            }
        }
        clusters
    }

    /// The cluster split by keeping the first k modes, or `None` if a gap separates mode k − 1 from
    /// mode k or one side is empty.
    ///
    /// # Panics
    ///
    /// Panics if there are fewer than k modes.
    pub fn split(&self, k: usize) -> Option<Split> {
        assert!(k <= self.len(), "{k} modes of {}", self.len());
        (!self.is_gap(k)).then(|| Split { below: self.gap_below(k), above: self.gap_above(k) })
    }

    /// The largest number of modes up to k that splits no cluster; 0 if all k are in one cluster
    /// that continues.
    ///
    /// # Panics
    ///
    /// Panics if there are fewer than k modes.
    pub fn gap_below(&self, k: usize) -> usize {
        assert!(k <= self.len(), "{k} modes of {}", self.len());
        (1..=k).rev().find(|&k| self.is_gap(k)).unwrap_or(0)
    }

    /// The smallest number of modes from k on that splits no cluster; `None` if unknown. It may
    /// exceed [`Spectrum::len`]: compute that many modes then.
    ///
    /// # Panics
    ///
    /// Panics if there are fewer than k modes.
    pub fn gap_above(&self, k: usize) -> Option<usize> {
        assert!(k <= self.len(), "{k} modes of {}", self.len());
        (k..=self.len() + self.beyond.values.len()).find(|&k| self.is_gap(k))
    }

    /// Returns true if a gap separates eigenvalues k − 1 and k.
    fn is_gap(&self, k: usize) -> bool {
        if k == 0 {
            return true;
        }
        let (last, residual) = self.known(k - 1);
        if k < self.len() + self.beyond.values.len() {
            let (next, next_residual) = self.known(k);
            let of_last = if last == 0.0 { 0.0 } else { residual };
            let of_next = if next == 0.0 { 0.0 } else { next_residual };
            return next - last > of_last.max(of_next) / Self::GAP_ANGLE;
        }
        // Exact zeros were counted, so the next eigenvalue is apart.
        last == 0.0 || self.beyond.clear_below - last > residual / Self::GAP_ANGLE
    }

    /// Eigenvalue k and the bound of its error.
    fn known(&self, k: usize) -> (f64, f64) {
        let least = |value: f64| MIN_RESIDUAL * value.abs();
        match self.values.get(k) {
            Some(&value) => (value, self.residuals[k].max(least(value))),
            None => {
                let value = self.beyond.values[k - self.len()];
                (value, least(value))
            }
        }
    }
}
