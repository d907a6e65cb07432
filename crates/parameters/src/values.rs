//! Values of the parameters of an algorithm, given by name.

use crate::algorithm::{Algorithm, Kind, Parameter};
use crate::error::ParameterError;
use crate::value::{Value, WeightedVertex};

impl Kind {
    /// The value as one of this kind; text is read.
    ///
    /// # Errors
    ///
    /// The accepted values, in words that follow "must be".
    pub fn read(self, value: Value) -> Result<Value, String> {
        let read = match (self, &value) {
            (Self::Number, Value::Text(text)) => text.parse().ok().map(Value::Number),
            (Self::Number, Value::Count(count)) => Some(Value::Number(*count as f64)),
            (Self::Count, Value::Text(text)) => text.parse().ok().map(Value::Count),
            (Self::Vertices, Value::Text(text)) => vertices(text).map(Value::Vertices),
            (Self::Weighted, Value::Text(text)) => {
                let vertices = text.split(',').map(WeightedVertex::from_text);
                vertices.collect::<Option<_>>().map(Value::Weighted)
            }
            (Self::Choice(choices), Value::Text(text)) => {
                let known = choices.iter().any(|choice| choice.name == text);
                known.then_some(value)
            }
            (Self::Number, Value::Number(_))
            | (Self::Count, Value::Count(_))
            | (Self::Vertices, Value::Vertices(_))
            | (Self::Weighted, Value::Weighted(_)) => Some(value),
            _ => None,
        };
        read.ok_or_else(|| match self {
            Self::Number => "a number".to_owned(),
            Self::Count => "a whole number, zero or more".to_owned(),
            Self::Vertices => {
                "numbers of vertices and ranges such as 10-19, joined by commas".to_owned()
            }
            Self::Weighted => "VERTEX:WEIGHT or VERTEX:WEIGHT:X:Y:Z, joined by commas".to_owned(),
            Self::Choice(choices) => {
                let names: Vec<&str> = choices.iter().map(|choice| choice.name).collect();
                format!("one of {}", names.join(", "))
            }
        })
    }
}

/// The largest number of vertices in a text, which a mistyped range can exceed.
const MAX_VERTICES: usize = 100_000_000;

/// Numbers and ranges, both ends included, joined by commas.
fn vertices(text: &str) -> Option<Vec<u32>> {
    let mut vertices = Vec::new();
    for part in text.split(',') {
        let (first, last) = part.split_once('-').unwrap_or((part, part));
        let (first, last): (u32, u32) = (first.parse().ok()?, last.parse().ok()?);
        if first > last || (last - first) as usize >= MAX_VERTICES - vertices.len() {
            return None;
        }
        vertices.extend(first..=last);
    }
    Some(vertices)
}

impl Parameter {
    /// The value, read and within the range.
    fn read(&self, value: Value) -> Result<Value, ParameterError> {
        let text = value.to_string();
        let value = self
            .kind
            .read(value)
            .map_err(|expected| ParameterError::new(self.name, text, expected))?;
        match value {
            Value::Number(number) => self.range.check(self.name, number)?,
            Value::Count(count) => self.range.check(self.name, count as f64)?,
            _ => {}
        }
        Ok(value)
    }
}

/// Values for some parameters of an algorithm, each of its kind and within its range; the others
/// keep their defaults.
///
/// Options are read from all values at once, so that their order does not matter.
#[derive(Debug, Clone, PartialEq)]
pub struct Values {
    given: Vec<(&'static str, Value)>,
}

impl Values {
    /// Checks values, each with the name of its parameter.
    ///
    /// # Errors
    ///
    /// [`ParameterError`] for a name that the algorithm does not have, a value of another kind or
    /// outside its range, parameters that exclude each other or are given twice, and required
    /// ones that are missing.
    pub fn new<V: Clone + Into<Value>>(
        algorithm: &Algorithm,
        values: &[(&str, V)],
    ) -> Result<Self, ParameterError> {
        let mut given: Vec<(&Parameter, Value)> = Vec::with_capacity(values.len());
        for (name, value) in values {
            let parameter = algorithm.parameter(name).ok_or_else(|| ParameterError::Unknown {
                algorithm: algorithm.name,
                name: (*name).to_owned(),
                known: algorithm.parameters.iter().map(|parameter| parameter.name).collect(),
            })?;
            let value = parameter.read(value.clone().into())?;
            let excluded = given.iter().find(|(other, _)| {
                other.name == *name
                    || parameter.excludes.contains(&other.name)
                    || other.excludes.contains(name)
            });
            if let Some((other, _)) = excluded {
                return Err(ParameterError::Excluded { first: other.name, second: parameter.name });
            }
            given.push((parameter, value));
        }
        let values = Self { given: given.into_iter().map(|(p, value)| (p.name, value)).collect() };
        let mut required = algorithm.parameters.iter().filter(|parameter| parameter.required);
        match required.find(|parameter| values.get(parameter.name).is_none()) {
            None => Ok(values),
            Some(&Parameter { name: parameter, about, .. }) => {
                Err(ParameterError::Missing { algorithm: algorithm.name, parameter, about })
            }
        }
    }

    /// The value of a parameter, if it is given.
    pub fn get(&self, name: &str) -> Option<&Value> {
        self.given.iter().find(|(parameter, _)| *parameter == name).map(|(_, value)| value)
    }

    /// The number of a parameter of [`Kind::Number`], if it is given.
    pub fn number(&self, name: &str) -> Option<f64> {
        match self.get(name)? {
            Value::Number(number) => Some(*number),
            _ => None,
        }
    }

    /// The number of a parameter of [`Kind::Count`], if it is given.
    pub fn count(&self, name: &str) -> Option<usize> {
        match self.get(name)? {
            Value::Count(count) => Some(*count),
            _ => None,
        }
    }

    /// The name that a parameter of [`Kind::Choice`] has as its value, if it is given.
    pub fn text(&self, name: &str) -> Option<&str> {
        match self.get(name)? {
            Value::Text(text) => Some(text),
            _ => None,
        }
    }

    /// The value of a parameter of [`Kind::Choice`], if it is given.
    pub fn choice<T: std::str::FromStr>(&self, name: &str) -> Option<T> {
        self.text(name)?.parse().ok()
    }

    /// The vertices of a parameter; none if it is not given.
    pub fn vertices(&self, name: &str) -> &[u32] {
        match self.get(name) {
            Some(Value::Vertices(vertices)) => vertices,
            _ => &[],
        }
    }

    /// The vertices with weights of a parameter; none if it is not given.
    pub fn weighted(&self, name: &str) -> &[WeightedVertex] {
        match self.get(name) {
            Some(Value::Weighted(vertices)) => vertices,
            _ => &[],
        }
    }

    /// The error for the value of a parameter, which must be as `expected` says.
    pub fn refuse(&self, name: &'static str, expected: impl Into<String>) -> ParameterError {
        let value = self.get(name).map(Value::to_string).unwrap_or_default();
        ParameterError::new(name, value, expected)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algorithm::Choice;
    use crate::range::Range;

    fn flow() -> Algorithm {
        const AREAS: &[Choice] = &[Choice::new("mixed", "")];
        let number = |name| Parameter::new(name, Kind::Number, "A number");
        Algorithm {
            name: "flow",
            description: "a flow",
            sources: &[],
            parameters: vec![
                Parameter { excludes: &["time"], range: Range::NOT_NEGATIVE, ..number("lambda") },
                number("time"),
                Parameter {
                    range: Range::from(1.0..=16.0),
                    ..Parameter::new("order", Kind::Count, "The order")
                },
                Parameter::new("area", Kind::Choice(AREAS), "The area"),
                Parameter::new("soft", Kind::Weighted, "Soft vertices"),
                Parameter {
                    required: true,
                    ..Parameter::new("vertices", Kind::Vertices, "The region")
                },
            ],
        }
    }

    #[test]
    fn values_are_read() {
        let given = [("vertices", "3,0,7-9"), ("order", "4"), ("soft", "7:0.5,8:2:1:-2:3e-1")];
        let values = Values::new(&flow(), &given).unwrap();
        assert_eq!(values.vertices("vertices"), [3, 0, 7, 8, 9]);
        assert_eq!((values.count("order"), values.number("lambda")), (Some(4), None));
        let [here, there] = values.weighted("soft")[..] else { panic!("two vertices") };
        assert_eq!((here.vertex, here.weight, here.target), (7, 0.5, None));
        assert_eq!((there.vertex, there.target), (8, Some([1.0, -2.0, 0.3])));
        assert_eq!(values.get("soft").unwrap().to_string(), "7:0.5,8:2:1:-2:0.3");
    }

    /// Numbers given as numbers are those given as text; a whole number is a number.
    #[test]
    fn numbers_need_not_be_text() {
        let vertices = ("vertices", Value::Vertices(vec![1]));
        let typed = [vertices, ("lambda", 3usize.into()), ("time", 0.1.into())];
        for given in [&typed[..2], &[typed[0].clone(), typed[2].clone()]] {
            let text: Vec<_> = given.iter().map(|(name, v)| (*name, v.to_string())).collect();
            let text: Vec<_> = text.iter().map(|(name, v)| (*name, v.as_str())).collect();
            assert_eq!(Values::new(&flow(), given), Values::new(&flow(), &text));
        }
        let half = [typed[0].clone(), ("order", 2.5.into())];
        let error = Values::new(&flow(), &half).unwrap_err().to_string();
        assert_eq!(error, "order is \"2.5\", but must be a whole number, zero or more");
    }

    #[test]
    fn values_that_do_not_fit_are_errors() {
        for (given, said) in [
            (&[("mu", "1")][..], "flow has no parameter \"mu\"; it has lambda, time"),
            (&[("lambda", "x")], "lambda is \"x\", but must be a number"),
            (&[("lambda", "-1")], "lambda is -1, but must be finite and not negative"),
            (&[("time", "inf")], "time is inf, but must be finite"),
            (&[("order", "-1")], "order is \"-1\", but must be a whole number"),
            (&[("order", "17")], "order is 17, but must be between 1 and 16"),
            (&[("area", "round")], "area is \"round\", but must be one of mixed"),
            (&[("vertices", "1,,2")], "vertices is \"1,,2\""),
            (&[("vertices", "")], "vertices is \"\""),
            (
                &[("vertices", "9-3")],
                "vertices is \"9-3\", but must be numbers of vertices and ranges",
            ),
            (&[("vertices", "0-4294967295")], "vertices is"),
            (&[("lambda", "1"), ("time", "1")], "give lambda or time, not both"),
            (&[("time", "1"), ("lambda", "1")], "give time or lambda, not both"),
            (&[("order", "1"), ("order", "2")], "give order or order"),
            (&[("order", "1")], "flow needs vertices: The region"),
        ] {
            let error = Values::new(&flow(), given).unwrap_err().to_string();
            assert!(error.contains(said), "{error}");
        }
        for text in ["", "7", "-1:2", "7:2:1", "7:2:1:2", "7:2:1:2:3:4", "7:x"] {
            assert!(Kind::Weighted.read(text.into()).is_err(), "{text}");
        }
    }
}
