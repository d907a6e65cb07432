//! Algorithms and their parameters, as programs list them.

use crate::range::Range;
use crate::value::Value;

/// An algorithm by name, with its parameters: the table from which programs make flags, lists and
/// documentation.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Algorithm {
    /// The name on the command line and in tables.
    pub name: &'static str,
    /// One-line summary of when to use it.
    pub description: &'static str,
    /// Keys of its sources in `docs/bibliography.bib`; empty if it is new.
    pub sources: &'static [&'static str],
    /// Its parameters, in the order in which they are listed.
    pub parameters: Vec<Parameter>,
}

impl Algorithm {
    /// The parameter of that name, if there is one.
    pub fn parameter(&self, name: &str) -> Option<&Parameter> {
        self.parameters.iter().find(|parameter| parameter.name == name)
    }
}

/// A parameter of an [`Algorithm`].
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// The name on the command line: lower case, words joined by hyphens.
    pub name: &'static str,
    /// One sentence without full stop.
    pub about: &'static str,
    /// The unit; empty if the parameter is dimensionless or no number.
    pub unit: &'static str,
    /// The accepted values.
    pub kind: Kind,
    /// The accepted numbers of [`Kind::Number`] and [`Kind::Count`].
    pub range: Range,
    /// The default; `None` if it depends on other parameters or there is none.
    pub default: Option<Value>,
    /// Parameters that cannot be given together with this one.
    pub excludes: &'static [&'static str],
    /// True if the algorithm needs a value.
    pub required: bool,
}

impl Parameter {
    /// A parameter without unit, range and default.
    pub const fn new(name: &'static str, kind: Kind, about: &'static str) -> Self {
        Self {
            name,
            about,
            unit: "",
            kind,
            range: Range::FINITE,
            default: None,
            excludes: &[],
            required: false,
        }
    }

    /// The default as text; empty if there is none.
    pub fn default_text(&self) -> String {
        self.default.as_ref().map(Value::to_string).unwrap_or_default()
    }
}

/// The kind of the values of a [`Parameter`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Kind {
    /// A number.
    Number,
    /// A whole number, zero or more.
    Count,
    /// One of several names.
    Choice(&'static [Choice]),
    /// Vertices, as numbers from 0.
    Vertices,
    /// Vertices with a weight and, unless they are drawn to their own positions, a target.
    Weighted,
}

/// A value with a name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct Choice {
    /// The name.
    pub name: &'static str,
    /// Its meaning, in one line.
    pub about: &'static str,
}

impl Choice {
    /// A choice.
    pub const fn new(name: &'static str, about: &'static str) -> Self {
        Self { name, about }
    }
}
