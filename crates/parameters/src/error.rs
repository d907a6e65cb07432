//! The error of names and values.

use std::borrow::Cow;

/// A name that is unknown, or values that do not fit.
///
/// The error of `FromStr` of all types of named choices: colour maps, noise, estimators,
/// Laplacians, and so on. The errors of all crates hold it in a variant `Option`, so that a program
/// can show it next to the option that it names.
///
/// ```
/// use fairing_parameters::Range;
///
/// let error = Range::POSITIVE.check("radius", -2.0).unwrap_err();
/// assert_eq!(error.to_string(), "radius is -2, but must be positive and finite");
/// ```
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ParameterError {
    /// No choice has this name. Case does not matter.
    #[error("there is no {what} {name:?}; there are {}", known.join(", "))]
    UnknownName {
        /// The kind of choice, such as `"colour map"`.
        what: &'static str,
        /// The name that was given.
        name: String,
        /// The known names.
        known: Vec<&'static str>,
    },
    /// The algorithm has no parameter of this name.
    #[error("{algorithm} has no parameter {name:?}; it has {}", known.join(", "))]
    Unknown {
        /// The algorithm.
        algorithm: &'static str,
        /// The name that was given.
        name: String,
        /// The names of its parameters.
        known: Vec<&'static str>,
    },
    /// A value is of another kind, or contradicts another parameter.
    #[error("{parameter} is {value:?}, but must be {expected}")]
    Value {
        /// The parameter.
        parameter: &'static str,
        /// The value that was given.
        value: String,
        /// The accepted values, in words that follow "must be".
        expected: String,
    },
    /// A number is outside its range.
    #[error("{option} is {value}, but must be {expected}")]
    Range {
        /// The name of the option.
        option: &'static str,
        /// Its value.
        value: f64,
        /// The accepted values, in words that follow "must be".
        expected: Cow<'static, str>,
    },
    /// Two parameters that exclude each other, or one parameter twice.
    #[error("give {first} or {second}, not both")]
    Excluded {
        /// One of them.
        first: &'static str,
        /// The other.
        second: &'static str,
    },
    /// A required parameter is missing.
    #[error("{algorithm} needs {parameter}: {about}")]
    Missing {
        /// The algorithm.
        algorithm: &'static str,
        /// The parameter.
        parameter: &'static str,
        /// Its description.
        about: &'static str,
    },
}

impl ParameterError {
    /// The error for a name that is not among the known ones.
    pub fn unknown_name(what: &'static str, name: &str, known: Vec<&'static str>) -> Self {
        Self::UnknownName { what, name: name.to_owned(), known }
    }

    /// The error of an option with this value, which must be `expected`.
    pub fn range(option: &'static str, value: f64, expected: impl Into<Cow<'static, str>>) -> Self {
        Self::Range { option, value, expected: expected.into() }
    }

    /// Refuses the value unless the condition holds.
    ///
    /// # Errors
    ///
    /// [`Range`](Self::Range) if `holds` is false.
    pub fn require(
        holds: bool,
        option: &'static str,
        value: f64,
        expected: &'static str,
    ) -> Result<(), Self> {
        if holds { Ok(()) } else { Err(Self::range(option, value, expected)) }
    }

    pub(crate) fn new(parameter: &'static str, value: String, expected: impl Into<String>) -> Self {
        Self::Value { parameter, value, expected: expected.into() }
    }
}
