//! JSON that people can read and compare: rows on one line each.

use serde::Serialize;
use serde_json::Value;

/// The value as text, indented; lists of plain values stay on one line.
pub fn readable<T: Serialize>(value: &T) -> serde_json::Result<String> {
    let mut text = String::new();
    write(&serde_json::to_value(value)?, 0, &mut text);
    Ok(text + "\n")
}

fn write(value: &Value, depth: usize, text: &mut String) {
    match value {
        Value::Array(items) if items.iter().any(|v| v.is_array() || v.is_object()) => {
            block(('[', ']'), items.iter().map(|v| (None, v)), depth, text);
        }
        Value::Array(items) => {
            let cells: Vec<String> = items.iter().map(Value::to_string).collect();
            *text += &format!("[{}]", cells.join(", "));
        }
        Value::Object(map) if !map.is_empty() => {
            block(('{', '}'), map.iter().map(|(k, v)| (Some(k), v)), depth, text);
        }
        plain => *text += &plain.to_string(),
    }
}

fn block<'a>(
    (open, close): (char, char),
    items: impl Iterator<Item = (Option<&'a String>, &'a Value)>,
    depth: usize,
    text: &mut String,
) {
    text.push(open);
    for (i, (key, value)) in items.enumerate() {
        text.push_str(if i == 0 { "\n" } else { ",\n" });
        text.push_str(&"  ".repeat(depth + 1));
        if let Some(key) = key {
            *text += &format!("{}: ", Value::from(key.as_str()));
        }
        write(value, depth + 1, text);
    }
    *text += &format!("\n{}{close}", "  ".repeat(depth));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_stay_on_a_line_and_nothing_is_lost() {
        let value = serde_json::json!({"a \"q\"": [[1, 2.5], ["x", null]], "b": [], "c": {}});
        let text = readable(&value).unwrap();
        assert!(text.contains("    [1, 2.5],\n"), "{text}");
        assert_eq!(serde_json::from_str::<Value>(&text).unwrap(), value);
    }
}
