//! Tables of names and values as text.

use std::fmt;

use serde_json::Value;

/// Rows of cells in aligned columns, the first and the errors to the left and the others to the
/// right.
#[derive(Debug, Default)]
pub(crate) struct Table {
    rows: Vec<Vec<String>>,
}

/// The head of a column of sentences.
pub(crate) const ERROR: &str = "error";

impl Table {
    /// A table without rows.
    pub(crate) fn new() -> Self {
        Self::default()
    }

    /// Adds a row.
    pub(crate) fn row(&mut self, cells: impl Into<Vec<String>>) {
        self.rows.push(cells.into());
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let columns = self.rows.iter().map(Vec::len).max().unwrap_or(0);
        let width = |column: usize| {
            self.rows.iter().filter_map(|r| r.get(column)).map(|c| c.chars().count()).max()
        };
        let widths: Vec<usize> = (0..columns).map(|c| width(c).unwrap_or(0)).collect();
        for row in &self.rows {
            let mut line = String::new();
            for (column, (cell, &width)) in row.iter().zip(&widths).enumerate() {
                let padding = " ".repeat(width - cell.chars().count());
                match column {
                    0 => line.extend([cell.as_str(), &padding]),
                    _ if self.rows[0].get(column).is_some_and(|head| head == ERROR) => {
                        line.extend(["  ", cell, &padding]);
                    }
                    _ => line.extend(["  ", &padding, cell]),
                }
            }
            writeln!(f, "{}", line.trim_end())?;
        }
        Ok(())
    }
}

/// Formats a number with six significant digits and no trailing zeros, in scientific notation if
/// very large or very small.
pub(crate) fn number(x: f64) -> String {
    if x == 0.0 {
        return "0".to_owned();
    }
    let exponent = libm::log10(x.abs()).floor();
    if !(-4.0..9.0).contains(&exponent) {
        return format!("{x:.5e}");
    }
    let decimals = (5.0 - exponent).max(0.0) as usize;
    let text = format!("{x:.decimals$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

/// A value of a report: `-` for null, `yes` or `no`, and numbers with six digits.
pub(crate) fn cell(value: &Value) -> String {
    match value {
        Value::Null => "-".to_owned(),
        Value::Bool(flag) => if *flag { "yes" } else { "no" }.to_owned(),
        Value::Number(x) if x.is_f64() => number(x.as_f64().unwrap_or_default()),
        Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_aligned() {
        let mut table = Table::new();
        table.row(["name".into(), "λ".into()]);
        table.row(["a".into(), "10".into()]);
        assert_eq!(table.to_string(), "name   λ\na     10\n");
    }

    #[test]
    fn numbers_keep_six_digits() {
        for (x, text) in
            [(0.1 + 0.2, "0.3"), (123456.0, "123456"), (-2.0, "-2"), (1.5e-7, "1.50000e-7")]
        {
            assert_eq!(number(x), text);
        }
    }
}
