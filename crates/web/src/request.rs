//! Requests: the fields of a JSON object.

use anyhow::{Context as _, Result, anyhow, bail};
use fairing_parameters::{Value, WeightedVertex};
use serde_json::Value as Json;

/// A request, and the bytes that came with it.
pub(crate) struct Request<'a> {
    object: Json,
    pub(crate) bytes: &'a [u8],
}

impl<'a> Request<'a> {
    /// Reads the JSON object of a request.
    pub(crate) fn new(text: &[u8], bytes: &'a [u8]) -> Result<Self> {
        let object = serde_json::from_slice(text).context("the request is not JSON")?;
        Ok(Self { object, bytes })
    }

    /// A text field.
    pub(crate) fn text(&self, name: &str) -> Result<&str> {
        self.object[name].as_str().ok_or_else(|| anyhow!("the request has no text {name:?}"))
    }

    /// A text field, or the default if it is absent.
    pub(crate) fn text_or<'b>(&'b self, name: &str, default: &'b str) -> &'b str {
        self.object[name].as_str().unwrap_or(default)
    }

    /// Returns true if the field is given.
    pub(crate) fn has(&self, name: &str) -> bool {
        !self.object[name].is_null()
    }

    /// A flag; false if it is absent.
    pub(crate) fn flag(&self, name: &str) -> bool {
        self.object[name].as_bool().unwrap_or(false)
    }

    /// A whole number.
    pub(crate) fn number(&self, name: &str) -> Result<u32> {
        let number = self.object[name].as_u64().and_then(|number| u32::try_from(number).ok());
        number.ok_or_else(|| anyhow!("the request has no whole number {name:?}"))
    }

    /// A list; empty if it is absent.
    pub(crate) fn list(&self, name: &str) -> &[Json] {
        self.object[name].as_array().map_or(&[], Vec::as_slice)
    }

    /// The values of parameters, by name: numbers, text as on the command line, or lists of
    /// vertices. Empty text stands for a parameter that is not given.
    pub(crate) fn values(&self) -> Result<Vec<(&str, Value)>> {
        let Some(values) = self.object["values"].as_object() else { return Ok(vec![]) };
        let given = values.iter().filter(|(_, value)| !value.is_null() && *value != "");
        given.map(|(name, value)| Ok((name.as_str(), value_of(name, value)?))).collect()
    }
}

fn value_of(name: &str, value: &Json) -> Result<Value> {
    let vertex = |v: &Json| v.as_u64().and_then(|v| u32::try_from(v).ok());
    let found = match value {
        Json::String(text) => Some(Value::from(text.as_str())),
        Json::Number(number) => {
            let count = number.as_u64().and_then(|count| usize::try_from(count).ok());
            count.map(Value::from).or_else(|| number.as_f64().map(Value::from))
        }
        Json::Array(list) if list.iter().all(Json::is_array) && !list.is_empty() => {
            list.iter().map(weighted).collect::<Option<_>>().map(Value::Weighted)
        }
        Json::Array(list) => list.iter().map(vertex).collect::<Option<_>>().map(Value::Vertices),
        _ => None,
    };
    match found {
        Some(value) => Ok(value),
        None => bail!("{name} is {value}, but must be a number, text, or a list of vertices"),
    }
}

/// `[vertex, weight]` or `[vertex, weight, x, y, z]`.
fn weighted(entry: &Json) -> Option<WeightedVertex> {
    let entry = entry.as_array()?;
    let vertex = u32::try_from(entry.first()?.as_u64()?).ok()?;
    let numbers: Vec<f64> = entry[1..].iter().map(Json::as_f64).collect::<Option<_>>()?;
    match numbers[..] {
        [weight] => Some(WeightedVertex { vertex, weight, target: None }),
        [weight, x, y, z] => Some(WeightedVertex { vertex, weight, target: Some([x, y, z]) }),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_numbers_text_or_vertices() {
        let text = br#"{"values": {"a": 2, "b": 0.5, "c": "x", "d": [3, 1],
            "e": [[7, 0.5], [8, 1, 2, 3, 4]], "f": "", "g": null}}"#;
        let request = Request::new(text, &[]).unwrap();
        let values = request.values().unwrap();
        let weighted = |vertex, weight, target| WeightedVertex { vertex, weight, target };
        let expected = [
            ("a", Value::Count(2)),
            ("b", Value::Number(0.5)),
            ("c", Value::Text("x".into())),
            ("d", Value::Vertices(vec![3, 1])),
            (
                "e",
                Value::Weighted(vec![
                    weighted(7, 0.5, None),
                    weighted(8, 1.0, Some([2.0, 3.0, 4.0])),
                ]),
            ),
        ];
        assert_eq!(values, expected);
    }

    #[test]
    fn other_values_are_refused() {
        for value in ["true", "{}", "[-1]", "[[1]]", "[[1, 2, 3]]"] {
            let text = format!(r#"{{"values": {{"a": {value}}}}}"#);
            let request = Request::new(text.as_bytes(), &[]).unwrap();
            assert!(request.values().unwrap_err().to_string().starts_with("a is "), "{value}");
        }
    }
}
