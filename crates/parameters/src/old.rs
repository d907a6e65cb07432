//! What programs know of an algorithm: its name, its parameters, and their values as text.

pub use crate::{Choice, ParameterError};

/// An algorithm by name, with its parameters.
///
/// Flows, denoisers and estimators of curvature have one each, beside their options. Programs make their flags,
/// lists and tables from it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct Algorithm {
    /// The name on the command line and in tables.
    pub name: &'static str,
    /// When to take it, in a line.
    pub description: &'static str,
    /// The keys of its sources in `docs/bibliography.bib`; none where it is new.
    pub sources: &'static [&'static str],
    /// Its parameters, in the order in which they are listed.
    pub parameters: &'static [Parameter],
}

impl Algorithm {
    /// An algorithm.
    pub const fn new(
        name: &'static str,
        description: &'static str,
        sources: &'static [&'static str],
        parameters: &'static [Parameter],
    ) -> Self {
        Self { name, description, sources, parameters }
    }

    /// The parameter of that name, if it has it.
    pub fn parameter(&self, name: &str) -> Option<&'static Parameter> {
        self.parameters.iter().find(|parameter| parameter.name == name)
    }
}

/// A parameter of an [`Algorithm`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct Parameter {
    /// The name on the command line: lower case, words joined by hyphens.
    pub name: &'static str,
    /// What it says, as the beginning of a sentence without full stop.
    pub about: &'static str,
    /// Its unit; empty where it is dimensionless or not a number.
    pub unit: &'static str,
    /// The value that it has unless it is set, as text; empty where that depends on other parameters, or is nothing.
    pub default: &'static str,
    /// Which values there are.
    pub kind: Kind,
    /// The parameters that cannot be given together with it.
    pub excludes: &'static [&'static str],
    /// Whether the algorithm does nothing without it.
    pub required: bool,
}

/// The values of a [`Parameter`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Kind {
    /// A number.
    Number,
    /// A whole number, zero or more.
    Count,
    /// One of some names.
    Choice(&'static [Choice]),
    /// Vertices as numbers from 0, joined by commas.
    Vertices,
    /// Vertices with a weight and, where they are not drawn to where they are, a point:
    /// `VERTEX:WEIGHT` or `VERTEX:WEIGHT:X:Y:Z`, joined by commas.
    Weighted,
}

impl Kind {
    /// Whether the text is a value of this kind.
    ///
    /// # Errors
    ///
    /// What the text must be, if it is not.
    pub fn check(self, text: &str) -> Result<(), String> {
        let each = |is: fn(&str) -> bool| text.split(',').all(is);
        let (good, expected) = match self {
            Self::Number => (text.parse::<f64>().is_ok(), "a number"),
            Self::Count => (text.parse::<usize>().is_ok(), "a whole number, zero or more"),
            Self::Vertices => {
                (each(|v| v.parse::<u32>().is_ok()), "numbers of vertices, joined by commas")
            }
            Self::Weighted => (
                each(|v| WeightedVertex::from_text(v).is_some()),
                "VERTEX:WEIGHT or VERTEX:WEIGHT:X:Y:Z, joined by commas",
            ),
            Self::Choice(choices) => {
                let names: Vec<&str> = choices.iter().map(|choice| choice.name).collect();
                return match names.contains(&text) {
                    true => Ok(()),
                    false => Err(format!("one of {}", names.join(", "))),
                };
            }
        };
        if good { Ok(()) } else { Err(expected.to_owned()) }
    }
}

impl Parameter {
    const fn new(
        name: &'static str,
        kind: Kind,
        default: &'static str,
        about: &'static str,
    ) -> Self {
        Self { name, about, unit: "", default, kind, excludes: &[], required: false }
    }

    /// A number.
    pub const fn number(name: &'static str, default: &'static str, about: &'static str) -> Self {
        Self::new(name, Kind::Number, default, about)
    }

    /// A whole number.
    pub const fn count(name: &'static str, default: &'static str, about: &'static str) -> Self {
        Self::new(name, Kind::Count, default, about)
    }

    /// One of some names.
    pub const fn choice(
        name: &'static str,
        choices: &'static [Choice],
        default: &'static str,
        about: &'static str,
    ) -> Self {
        Self::new(name, Kind::Choice(choices), default, about)
    }

    /// Vertices.
    pub const fn vertices(name: &'static str, about: &'static str) -> Self {
        Self::new(name, Kind::Vertices, "", about)
    }

    /// Vertices with weights.
    pub const fn weighted(name: &'static str, about: &'static str) -> Self {
        Self::new(name, Kind::Weighted, "", about)
    }

    /// The same with a unit.
    #[must_use]
    pub const fn unit(self, unit: &'static str) -> Self {
        Self { unit, ..self }
    }

    /// The same with another default.
    #[must_use]
    pub const fn default(self, default: &'static str) -> Self {
        Self { default, ..self }
    }

    /// The same with another explanation.
    #[must_use]
    pub const fn about(self, about: &'static str) -> Self {
        Self { about, ..self }
    }

    /// The same, which cannot be given together with these.
    #[must_use]
    pub const fn excludes(self, excludes: &'static [&'static str]) -> Self {
        Self { excludes, ..self }
    }

    /// The same, without which there is nothing to do.
    #[must_use]
    pub const fn required(self) -> Self {
        Self { required: true, ..self }
    }
}

/// A vertex with a weight, and a point unless it is where the vertex is.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct WeightedVertex {
    /// The vertex.
    pub vertex: u32,
    /// Its weight.
    pub weight: f64,
    /// The point, if it is not that of the vertex.
    pub target: Option<[f64; 3]>,
}

impl WeightedVertex {
    fn from_text(text: &str) -> Option<Self> {
        let mut parts = text.split(':');
        let vertex = parts.next()?.parse().ok()?;
        let numbers: Vec<f64> = parts.map(|x| x.parse().ok()).collect::<Option<_>>()?;
        match numbers[..] {
            [weight] => Some(Self { vertex, weight, target: None }),
            [weight, x, y, z] => Some(Self { vertex, weight, target: Some([x, y, z]) }),
            _ => None,
        }
    }
}

/// Values of some parameters of an algorithm, each of its kind. The others keep their defaults.
///
/// All values are known before options are made from them, so that their order does not matter.
#[derive(Debug, Clone, PartialEq)]
pub struct Values<'a> {
    algorithm: &'static Algorithm,
    given: Vec<(&'static Parameter, &'a str)>,
}

impl<'a> Values<'a> {
    /// No values: all defaults.
    pub fn none(algorithm: &'static Algorithm) -> Self {
        Self { algorithm, given: Vec::new() }
    }

    /// These values, each with the name of its parameter.
    ///
    /// # Errors
    ///
    /// [`ParameterError`] for a name that the algorithm does not have, a value of another kind, parameters that
    /// exclude each other, one that is given twice, and one that is required and not given.
    pub fn new(
        algorithm: &'static Algorithm,
        values: &[(&str, &'a str)],
    ) -> Result<Self, ParameterError> {
        let mut given: Vec<(&'static Parameter, &'a str)> = Vec::with_capacity(values.len());
        for &(name, value) in values {
            let parameter = algorithm.parameter(name).ok_or_else(|| ParameterError::Unknown {
                algorithm: algorithm.name,
                name: name.to_owned(),
                known: algorithm.parameters.iter().map(|parameter| parameter.name).collect(),
            })?;
            parameter.kind.check(value).map_err(|expected| parameter.refuse(value, expected))?;
            let excluded = given.iter().find(|(other, _)| {
                other.name == name
                    || parameter.excludes.contains(&other.name)
                    || other.excludes.contains(&name)
            });
            if let Some((other, _)) = excluded {
                return Err(ParameterError::Excluded { first: other.name, second: parameter.name });
            }
            given.push((parameter, value));
        }
        let values = Self { algorithm, given };
        let mut required = algorithm.parameters.iter().filter(|parameter| parameter.required);
        match required.find(|parameter| values.text(parameter.name).is_none()) {
            None => Ok(values),
            Some(&Parameter { name: parameter, about, .. }) => {
                Err(ParameterError::Missing { algorithm: algorithm.name, parameter, about })
            }
        }
    }

    /// The algorithm.
    pub fn algorithm(&self) -> &'static Algorithm {
        self.algorithm
    }

    /// The value of that parameter as text, if it is given.
    pub fn text(&self, name: &str) -> Option<&'a str> {
        self.given.iter().find(|(parameter, _)| parameter.name == name).map(|(_, value)| *value)
    }

    /// The value of that parameter, if it is given.
    ///
    /// # Errors
    ///
    /// [`ParameterError::Value`] where the type does not hold it, such as a count beyond its range.
    pub fn get<T: std::str::FromStr>(&self, name: &str) -> Result<Option<T>, ParameterError> {
        let given = self.given.iter().find(|(parameter, _)| parameter.name == name);
        let Some((parameter, value)) = given else { return Ok(None) };
        let read = value.parse().map(Some);
        read.map_err(|_| parameter.refuse(value, "within the range of its type".to_owned()))
    }

    /// Puts the value of that parameter into an option; leaves the option as it is where none is given.
    ///
    /// # Errors
    ///
    /// As [`get`](Self::get).
    pub fn read<T: std::str::FromStr>(
        &self,
        name: &str,
        option: &mut T,
    ) -> Result<(), ParameterError> {
        if let Some(value) = self.get(name)? {
            *option = value;
        }
        Ok(())
    }

    /// The vertices of that parameter; none where it is not given.
    pub fn vertices(&self, name: &str) -> Vec<u32> {
        let given = self.text(name).into_iter().flat_map(|text| text.split(','));
        given.filter_map(|vertex| vertex.parse().ok()).collect()
    }

    /// The vertices with weights of that parameter; none where it is not given.
    pub fn weighted(&self, name: &str) -> Vec<WeightedVertex> {
        let given = self.text(name).into_iter().flat_map(|text| text.split(','));
        given.filter_map(WeightedVertex::from_text).collect()
    }

    /// The error for the value of that parameter, which must be as `expected` says.
    pub fn refuse(&self, name: &'static str, expected: impl Into<String>) -> ParameterError {
        let value = self.text(name).unwrap_or_default().to_owned();
        ParameterError::Value { parameter: name, value, expected: expected.into() }
    }
}

impl Parameter {
    fn refuse(&self, value: &str, expected: String) -> ParameterError {
        ParameterError::Value { parameter: self.name, value: value.to_owned(), expected }
    }
}

impl From<Algorithm> for crate::Algorithm {
    fn from(old: Algorithm) -> Self {
        let parameters = old.parameters.iter().map(|p| {
            let kind = match p.kind {
                Kind::Number => crate::Kind::Number,
                Kind::Count => crate::Kind::Count,
                Kind::Choice(all) => crate::Kind::Choice(all),
                Kind::Vertices => crate::Kind::Vertices,
                Kind::Weighted => crate::Kind::Weighted,
            };
            let default = match p.default {
                "" => None,
                text => kind.read(text.into()).ok(),
            };
            crate::Parameter {
                unit: p.unit,
                default,
                excludes: p.excludes,
                required: p.required,
                ..crate::Parameter::new(p.name, kind, p.about)
            }
        });
        crate::Algorithm {
            name: old.name,
            description: old.description,
            sources: old.sources,
            parameters: parameters.collect(),
        }
    }
}
