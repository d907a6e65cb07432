//! Options by name.

use fairing_parameters::{Value, WeightedVertex};
use pyo3::prelude::*;

use crate::error::{Error, Result};

/// The value of a name. The error lists all names.
pub(crate) fn choose<T: Copy>(option: &str, name: &str, all: &[(&str, T)]) -> Result<T> {
    all.iter().find(|(known, _)| *known == name).map(|(_, value)| *value).ok_or_else(|| {
        let names: Vec<&str> = all.iter().map(|(known, _)| *known).collect();
        Error::option(format!("{option} is {name:?}, but must be one of {}", names.join(", ")))
    })
}

/// Parses a name of a crate.
pub(crate) fn named<T: std::str::FromStr>(name: &str) -> Result<T>
where
    T::Err: std::fmt::Display,
{
    name.parse().map_err(Error::option)
}

/// A value of a parameter: a number, a name, vertices, or vertices with weights.
#[derive(Debug, Clone, FromPyObject)]
pub(crate) enum Given {
    Text(String),
    Count(usize),
    Number(f64),
    Vertices(Vec<u32>),
    Weighted(Vec<(u32, f64, Option<[f64; 3]>)>),
}

impl From<Given> for Value {
    fn from(given: Given) -> Self {
        match given {
            Given::Text(text) => Self::Text(text),
            Given::Count(count) => Self::Count(count),
            Given::Number(number) => Self::Number(number),
            Given::Vertices(vertices) => Self::Vertices(vertices),
            Given::Weighted(vertices) => {
                let weighted = vertices.into_iter();
                let weighted = weighted.map(|(vertex, weight, target)| WeightedVertex {
                    vertex,
                    weight,
                    target,
                });
                Self::Weighted(weighted.collect())
            }
        }
    }
}

/// Values of parameters, by the names of the tables.
pub(crate) type Named = Vec<(String, Given)>;

/// The values with borrowed names, as the crates take them.
pub(crate) fn borrowed(given: &Named) -> Vec<(&str, Given)> {
    given.iter().map(|(name, value)| (name.as_str(), value.clone())).collect()
}
