//! Options by name.

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
