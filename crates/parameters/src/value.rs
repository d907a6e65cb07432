//! Values of parameters.

use std::fmt;

/// A value of a parameter.
///
/// Programs give numbers as numbers or as text; [`Values`](crate::Values) reads text as the kind
/// of the parameter.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Value {
    /// A name, or text still to be parsed as another kind.
    Text(String),
    /// A number.
    Number(f64),
    /// A whole number.
    Count(usize),
    /// Vertices.
    Vertices(Vec<u32>),
    /// Vertices with weights.
    Weighted(Vec<WeightedVertex>),
}

impl From<&str> for Value {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<f64> for Value {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl From<usize> for Value {
    fn from(count: usize) -> Self {
        Self::Count(count)
    }
}

impl Value {
    /// The vertices of both lists, if both are lists of the same kind; else the later value.
    #[must_use]
    pub fn and(self, later: Self) -> Self {
        match (self, later) {
            (Self::Vertices(one), Self::Vertices(other)) => Self::Vertices([one, other].concat()),
            (Self::Weighted(one), Self::Weighted(other)) => Self::Weighted([one, other].concat()),
            (_, later) => later,
        }
    }
}

/// The text that [`Kind::read`](crate::Kind::read) reads.
impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Text(text) => f.write_str(text),
            Self::Number(number) => {
                let text = format!("{number:?}");
                f.write_str(text.strip_suffix(".0").unwrap_or(&text))
            }
            Self::Count(count) => write!(f, "{count}"),
            Self::Vertices(vertices) => join(f, vertices),
            Self::Weighted(vertices) => join(f, vertices),
        }
    }
}

fn join<T: fmt::Display>(f: &mut fmt::Formatter<'_>, list: &[T]) -> fmt::Result {
    for (i, item) in list.iter().enumerate() {
        write!(f, "{}{item}", if i > 0 { "," } else { "" })?;
    }
    Ok(())
}

/// A vertex with a weight and a target.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WeightedVertex {
    /// The vertex.
    pub vertex: u32,
    /// Its weight.
    pub weight: f64,
    /// The target; the position of the vertex if `None`.
    pub target: Option<[f64; 3]>,
}

impl WeightedVertex {
    pub(crate) fn from_text(text: &str) -> Option<Self> {
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

impl fmt::Display for WeightedVertex {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.vertex, self.weight)?;
        self.target.into_iter().flatten().try_for_each(|x| write!(f, ":{x}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn defaults_are_short() {
        for (value, text) in [(2.0, "2"), (1e-8, "1e-8"), (0.35, "0.35"), (1e3, "1000")] {
            assert_eq!(Value::Number(value).to_string(), text);
        }
    }
}
