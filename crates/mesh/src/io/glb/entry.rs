//! Values of the JSON by paths.

use serde_json::Value;

use crate::io::error::{Fault, unexpected};

/// A value of the JSON with its path in it.
#[derive(Clone)]
pub(super) struct Entry<'a> {
    value: &'a Value,
    path: String,
}

impl<'a> Entry<'a> {
    /// The whole of the JSON.
    pub(super) fn root(value: &'a Value) -> Self {
        Self { value, path: String::new() }
    }

    /// An error about this value.
    pub(super) fn fault(&self, expected: &str, found: impl Into<String>) -> Fault {
        let path = if self.path.is_empty() { "the JSON" } else { &self.path };
        Fault::whole(unexpected(format!("{expected} at {path}"), found))
    }

    /// An error that shows this value.
    fn other(&self, expected: &str) -> Fault {
        let mut found = self.value.to_string();
        if let Some((cut, _)) = found.char_indices().nth(40) {
            found.truncate(cut);
            found.push('…');
        }
        self.fault(expected, found)
    }

    pub(super) fn path(&self) -> &str {
        &self.path
    }

    pub(super) fn get(&self, key: &str) -> Option<Entry<'a>> {
        let dot = if self.path.is_empty() { "" } else { "." };
        let value = self.value.get(key).filter(|value| !value.is_null())?;
        Some(Entry { value, path: format!("{}{dot}{key}", self.path) })
    }

    /// A member that must exist.
    pub(super) fn required(&self, key: &str) -> Result<Entry<'a>, Fault> {
        self.get(key).ok_or_else(|| self.fault(key, "none"))
    }

    /// The element of a list of the document.
    pub(super) fn at(&self, list: &str, index: usize) -> Result<Entry<'a>, Fault> {
        let found = self.value.get(list).and_then(|all| all.get(index));
        match found {
            Some(value) => Ok(Entry { value, path: format!("{list}[{index}]") }),
            None => Err(self.fault(&format!("{list}[{index}]"), "none")),
        }
    }

    /// The elements of a list, none if it is missing.
    pub(super) fn list(&self, key: &str) -> Result<Vec<Entry<'a>>, Fault> {
        let Some(list) = self.get(key) else { return Ok(vec![]) };
        let values = list.value.as_array().ok_or_else(|| list.other("a list"))?;
        let entry = |(k, value)| Entry { value, path: format!("{}[{k}]", list.path) };
        Ok(values.iter().enumerate().map(entry).collect())
    }

    /// The members of an object.
    pub(super) fn members(&self) -> Result<Vec<(&'a str, Entry<'a>)>, Fault> {
        let members = self.value.as_object().ok_or_else(|| self.other("an object"))?;
        let entry = |(key, value): (&'a String, _)| {
            (&key[..], Entry { value, path: format!("{}.{key}", self.path) })
        };
        Ok(members.iter().map(entry).collect())
    }

    pub(super) fn text(&self) -> Option<&'a str> {
        self.value.as_str()
    }

    pub(super) fn flag(&self, key: &str) -> bool {
        self.value.get(key).and_then(Value::as_bool).unwrap_or_default()
    }

    /// This value as an index or a count.
    pub(super) fn count(&self) -> Result<usize, Fault> {
        let count = self.value.as_u64().and_then(|count| usize::try_from(count).ok());
        count.ok_or_else(|| self.other("an integer"))
    }

    /// A member as an index or a count.
    pub(super) fn optional_count(&self, key: &str) -> Result<Option<usize>, Fault> {
        self.get(key).map(|entry| entry.count()).transpose()
    }

    /// A member as an index or a count, which must exist.
    pub(super) fn required_count(&self, key: &str) -> Result<usize, Fault> {
        self.optional_count(key)?.ok_or_else(|| self.fault(&format!("an integer {key}"), "none"))
    }

    /// A member as numbers.
    pub(super) fn numbers<const N: usize>(&self, key: &str) -> Result<Option<[f64; N]>, Fault> {
        let Some(entry) = self.get(key) else { return Ok(None) };
        let numbers = entry.value.as_array().and_then(|values| {
            let values: Option<Vec<f64>> = values.iter().map(Value::as_f64).collect();
            values?.try_into().ok()
        });
        numbers.map(Some).ok_or_else(|| entry.other(&format!("{N} numbers")))
    }
}

/// Same value of the JSON.
impl PartialEq for Entry<'_> {
    fn eq(&self, other: &Self) -> bool {
        self.value == other.value
    }
}
