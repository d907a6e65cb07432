//! Errors of names and values.

use crate::range::OptionError;

/// An unknown name of a choice.
///
/// The error of `FromStr` of all types of named choices: colour maps, noise,
/// estimators, Laplacians, and so on. Case does not matter.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("there is no {what} {name:?}; there are {}", known.join(", "))]
#[non_exhaustive]
pub struct UnknownName {
    /// The kind of choice, such as `"colour map"`.
    pub what: &'static str,
    /// The name that was given.
    pub name: String,
    /// The known names.
    pub known: Vec<&'static str>,
}

impl UnknownName {
    /// The error for a name that is not among the known ones.
    pub fn new(what: &'static str, name: &str, known: Vec<&'static str>) -> Self {
        Self { what, name: name.to_owned(), known }
    }
}

/// Values that do not fit the parameters of an algorithm.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ParameterError {
    /// No algorithm has this name.
    #[error(transparent)]
    UnknownName(#[from] UnknownName),
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
    #[error(transparent)]
    Option(#[from] OptionError),
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
    pub(crate) fn new(parameter: &'static str, value: String, expected: impl Into<String>) -> Self {
        Self::Value { parameter, value, expected: expected.into() }
    }
}
