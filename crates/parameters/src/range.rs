//! Ranges of numbers.

use std::fmt;
use std::ops::Bound::{self, Excluded, Included, Unbounded};
use std::ops::{RangeBounds, RangeInclusive};

use crate::error::ParameterError;

/// A range of finite numbers.
///
/// ```
/// use fairing_parameters::Range;
///
/// assert!(Range::POSITIVE.contains(1e-9));
/// assert_eq!(Range::from(1.0..=16.0).to_string(), "between 1 and 16");
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    low: Bound<f64>,
    high: Bound<f64>,
}

impl Range {
    /// All finite numbers.
    pub const FINITE: Self = Self::new(Unbounded, Unbounded);
    /// `(0, ∞)`.
    pub const POSITIVE: Self = Self::new(Excluded(0.0), Unbounded);
    /// `[0, ∞)`.
    pub const NOT_NEGATIVE: Self = Self::new(Included(0.0), Unbounded);
    /// `[0, 1]`.
    pub const FRACTION: Self = Self::new(Included(0.0), Included(1.0));

    /// The finite numbers between two bounds.
    pub const fn new(low: Bound<f64>, high: Bound<f64>) -> Self {
        Self { low, high }
    }

    /// `(low, ∞)`.
    pub const fn above(low: f64) -> Self {
        Self::new(Excluded(low), Unbounded)
    }

    /// The numbers of this range below `high`.
    #[must_use]
    pub const fn below(self, high: f64) -> Self {
        Self::new(self.low, Excluded(high))
    }

    /// The numbers of this range up to `high`.
    #[must_use]
    pub const fn up_to(self, high: f64) -> Self {
        Self::new(self.low, Included(high))
    }

    /// Returns true if the number is finite and within the bounds.
    pub fn contains(&self, value: f64) -> bool {
        let above = match self.low {
            Included(low) => value >= low,
            Excluded(low) => value > low,
            Unbounded => true,
        };
        let below = match self.high {
            Included(high) => value <= high,
            Excluded(high) => value < high,
            Unbounded => true,
        };
        value.is_finite() && above && below
    }

    /// Refuses a number outside the range.
    ///
    /// # Errors
    ///
    /// [`ParameterError`] with the name of the option, the number and the range.
    pub fn check(&self, option: &'static str, value: f64) -> Result<(), ParameterError> {
        if self.contains(value) {
            Ok(())
        } else {
            Err(ParameterError::range(option, value, self.to_string()))
        }
    }
}

/// The bounds, for programs that draw sliders.
impl RangeBounds<f64> for Range {
    fn start_bound(&self) -> Bound<&f64> {
        self.low.as_ref()
    }

    fn end_bound(&self) -> Bound<&f64> {
        self.high.as_ref()
    }
}

/// In words that follow "must be".
impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.low, self.high) {
            (Unbounded, Unbounded) => f.write_str("finite"),
            (Excluded(0.0), Unbounded) => f.write_str("positive and finite"),
            (Included(0.0), Unbounded) => f.write_str("finite and not negative"),
            (Included(low), Included(high)) => write!(f, "between {low} and {high}"),
            (Excluded(low), Included(high)) => write!(f, "above {low} and at most {high}"),
            (Included(low), Excluded(high)) => write!(f, "at least {low} and below {high}"),
            (Excluded(low), Excluded(high)) => write!(f, "above {low} and below {high}"),
            (Excluded(low), Unbounded) => write!(f, "above {low}"),
            (Included(low), Unbounded) => write!(f, "at least {low}"),
            (Unbounded, Excluded(high)) => write!(f, "below {high}"),
            (Unbounded, Included(high)) => write!(f, "at most {high}"),
        }
    }
}

impl From<RangeInclusive<f64>> for Range {
    fn from(range: RangeInclusive<f64>) -> Self {
        Self::new(Included(*range.start()), Included(*range.end()))
    }
}

impl From<std::ops::Range<f64>> for Range {
    fn from(range: std::ops::Range<f64>) -> Self {
        Self::new(Included(range.start), Excluded(range.end))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_range_has_its_ends() {
        let (nan, infinite) = (f64::NAN, f64::INFINITY);
        let accepted = |range: Range| {
            [-1e-300, 0.0, 1e-300, 1.0, 1.0 + f64::EPSILON, infinite, nan]
                .map(|value| range.check("x", value).is_ok())
        };
        let positive = [false, false, true, true, true, false, false];
        assert_eq!(accepted(Range::POSITIVE), positive);
        let not_negative = [false, true, true, true, true, false, false];
        assert_eq!(accepted(Range::NOT_NEGATIVE), not_negative);
        let fraction = [false, true, true, true, false, false, false];
        assert_eq!(accepted(Range::FRACTION), fraction);
        let open = Range::above(0.0).below(1.0);
        assert_eq!(accepted(open), [false, false, true, false, false, false, false]);
        assert_eq!(accepted(Range::FINITE), [true, true, true, true, true, false, false]);
    }

    #[test]
    fn ranges_are_written_as_words() {
        for (range, words) in [
            (Range::FINITE, "finite"),
            (Range::above(1.0), "above 1"),
            (Range::above(0.0).up_to(1.0), "above 0 and at most 1"),
            (Range::from(-1.0..1.0), "at least -1 and below 1"),
        ] {
            assert_eq!(range.to_string(), words);
        }
    }
}
