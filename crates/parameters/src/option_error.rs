//! The error of options out of their range, the same in every crate.

/// An option has a value for which the method is not defined.
///
/// The errors of all crates hold it in a variant `Option`, so that a program
/// can show it next to the option that it names.
///
/// ```
/// use fairing_parameters::OptionError;
///
/// let error = OptionError::require_positive("radius", -2.0).unwrap_err();
/// assert_eq!(error.to_string(), "radius is -2, but must be positive and finite");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("{option} is {value}, but must be {expected}")]
#[non_exhaustive]
pub struct OptionError {
    /// The name of the option.
    pub option: &'static str,
    /// Its value.
    pub value: f64,
    /// What it must be, to follow "must be".
    pub expected: &'static str,
}

impl OptionError {
    /// The error of an option with this value, which must be `expected`.
    pub const fn new(option: &'static str, value: f64, expected: &'static str) -> Self {
        Self { option, value, expected }
    }

    /// Refuses the value unless the condition holds.
    ///
    /// # Errors
    ///
    /// The error of [`new`](Self::new) if `holds` is false.
    pub fn require(
        holds: bool,
        option: &'static str,
        value: f64,
        expected: &'static str,
    ) -> Result<(), Self> {
        if holds { Ok(()) } else { Err(Self::new(option, value, expected)) }
    }

    /// Refuses a value that is not above zero and finite.
    ///
    /// # Errors
    ///
    /// For zero, negative values, infinity and NaN.
    pub fn require_positive(option: &'static str, value: f64) -> Result<(), Self> {
        Self::require(value > 0.0 && value.is_finite(), option, value, "positive and finite")
    }

    /// Refuses a value that is negative or not finite.
    ///
    /// # Errors
    ///
    /// For values below zero, infinity and NaN.
    pub fn require_not_negative(option: &'static str, value: f64) -> Result<(), Self> {
        Self::require(value >= 0.0 && value.is_finite(), option, value, "finite and not negative")
    }

    /// Refuses a value outside `[0, 1]`.
    ///
    /// # Errors
    ///
    /// For values below 0 or above 1, and NaN.
    pub fn require_share(option: &'static str, value: f64) -> Result<(), Self> {
        Self::require((0.0..=1.0).contains(&value), option, value, "between 0 and 1")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_range_has_its_ends() {
        let (nan, infinite) = (f64::NAN, f64::INFINITY);
        let accepted = |check: fn(&'static str, f64) -> Result<(), OptionError>| {
            [-1e-300, 0.0, 1e-300, 1.0, 1.0 + f64::EPSILON, infinite, nan]
                .map(|value| check("x", value).is_ok())
        };
        let positive = [false, false, true, true, true, false, false];
        assert_eq!(accepted(OptionError::require_positive), positive);
        let not_negative = [false, true, true, true, true, false, false];
        assert_eq!(accepted(OptionError::require_not_negative), not_negative);
        let share = [false, true, true, true, false, false, false];
        assert_eq!(accepted(OptionError::require_share), share);
    }
}
