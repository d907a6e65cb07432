//! Tables of results: columns with a name, a unit and a tolerance; rows of
//! cells.

use std::fmt;

use anyhow::{Context as _, Result, ensure};
use serde::{Deserialize, Serialize};

/// The unit of the numbers of a column, or of one deciding number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum Unit {
    /// A name or a category.
    #[serde(rename = "")]
    Label,
    /// A number without dimension.
    #[serde(rename = "1")]
    One,
    /// A count.
    #[serde(rename = "count")]
    Count,
    /// A difference divided by what it is compared with.
    #[serde(rename = "relative")]
    Relative,
    /// An exponent of the mesh size h.
    #[serde(rename = "order")]
    Order,
    /// Lengths in the units of the mesh.
    #[serde(rename = "mesh units")]
    Length,
    /// Squared mesh units.
    #[serde(rename = "mesh units²")]
    Area,
    /// Curvatures H, κ: one over mesh units.
    #[serde(rename = "1/mesh units")]
    Curvature,
    /// Gaussian curvature and eigenvalues: one over squared mesh units.
    #[serde(rename = "1/mesh units²")]
    InverseArea,
    /// Multiples of the mean edge length h.
    #[serde(rename = "h")]
    EdgeLengths,
    /// Fractions of the diagonal of the bounding box.
    #[serde(rename = "diagonal")]
    Diagonals,
    /// Degrees.
    #[serde(rename = "°")]
    Degrees,
    /// Radians.
    #[serde(rename = "rad")]
    Radians,
    /// Percent.
    #[serde(rename = "%")]
    Percent,
    /// Seconds of wall time; never compared between runs.
    #[serde(rename = "s")]
    Seconds,
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.serialize(f)
    }
}

/// The largest change of a number between two runs that `--check` accepts: `|new − old| ≤ absolute
/// + relative · |old|`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Tolerance {
    /// The part that grows with the old value.
    pub relative: f64,
    /// The part that does not, in the unit of the column.
    pub absolute: f64,
}

impl Tolerance {
    /// Nothing may change.
    pub const EXACT: Self = Self { relative: 0.0, absolute: 0.0 };
    /// The default: wider than the last digits in which two processors or
    /// mathematical libraries differ, narrower than any change of method.
    pub const NUMERICAL: Self = Self { relative: 1e-6, absolute: 1e-9 };
    /// For values that amplify rounding: iterative solvers, ranks, thresholds.
    pub const LOOSE: Self = Self { relative: 1e-2, absolute: 1e-6 };

    /// Returns true if the change from `old` to `new` is accepted.
    pub(crate) fn admits(self, old: f64, new: f64) -> bool {
        old == new || (new - old).abs() <= self.absolute + self.relative * old.abs()
    }
}

/// A named column.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Column {
    /// The heading.
    pub name: String,
    /// The unit of its numbers.
    pub unit: Unit,
    /// The tolerance of `--check`; `None` for columns that it does not compare.
    pub tolerance: Option<Tolerance>,
    /// True for a column that only the CSV contains.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub aside: bool,
}

impl Column {
    /// The name, with the unit in brackets where there is one.
    fn heading(&self) -> String {
        match self.unit {
            Unit::Label => self.name.clone(),
            unit => format!("{} [{unit}]", self.name),
        }
    }
}

/// One entry of a table.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Cell {
    /// A whole number.
    Count(i64),
    /// A number, finite.
    Number(f64),
    /// A name; also what is not a finite number (`inf`, `-inf`, `undefined`).
    Text(String),
    /// An empty cell.
    Missing,
}

impl Cell {
    /// The number in this cell; infinities come back as such.
    pub fn number(&self) -> Option<f64> {
        match self {
            Self::Count(n) => Some(*n as f64),
            Self::Number(x) => Some(*x),
            Self::Text(t) if t == "inf" => Some(f64::INFINITY),
            Self::Text(t) if t == "-inf" => Some(f64::NEG_INFINITY),
            _ => None,
        }
    }
}

/// The number to twelve significant digits: more would be rounding errors.
impl From<f64> for Cell {
    fn from(x: f64) -> Self {
        if x.is_finite() {
            Self::Number(format!("{x:.11e}").parse().unwrap_or(x))
        } else if x.is_nan() {
            Self::Text("undefined".into())
        } else {
            Self::Text(if x > 0.0 { "inf" } else { "-inf" }.into())
        }
    }
}
impl From<Option<f64>> for Cell {
    fn from(x: Option<f64>) -> Self {
        x.map_or(Self::Missing, Self::from)
    }
}
impl From<usize> for Cell {
    fn from(n: usize) -> Self {
        Self::Count(n as i64)
    }
}
impl From<i64> for Cell {
    fn from(n: i64) -> Self {
        Self::Count(n)
    }
}
impl From<&str> for Cell {
    fn from(t: &str) -> Self {
        Self::Text(t.into())
    }
}
impl From<String> for Cell {
    fn from(t: String) -> Self {
        Self::Text(t)
    }
}

/// Four significant digits, as in a report; files keep every digit.
impl fmt::Display for Cell {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Count(n) => write!(f, "{n}"),
            Self::Number(x) => f.write_str(&short(*x)),
            Self::Text(t) if t == "inf" => f.write_str("∞"),
            Self::Text(t) if t == "-inf" => f.write_str("−∞"),
            Self::Text(t) => f.write_str(t),
            Self::Missing => f.write_str("–"),
        }
    }
}

/// A number in four significant digits, as tables and sentences show it.
pub fn short(x: f64) -> String {
    if !x.is_finite() {
        return Cell::from(x).to_string();
    }
    let magnitude = x.abs();
    let text = if magnitude == 0.0 {
        "0".into()
    } else if !(1e-3..1e5).contains(&magnitude) {
        return powered(&format!("{x:.2e}"));
    } else {
        let digits = 3 - libm::log10(magnitude).floor() as i32;
        let fixed = format!("{x:.*}", digits.max(0) as usize);
        if fixed.contains('.') {
            fixed.trim_end_matches('0').trim_end_matches('.').to_string()
        } else {
            fixed
        }
    };
    text.replace('-', "−")
}

/// A number with two significant digits, as in sentences; integers of up to six digits keep all
/// digits.
pub fn brief(x: f64) -> String {
    if !x.is_finite() || x == 0.0 {
        return short(x);
    }
    let exponent = libm::log10(x.abs()).floor() as i32;
    if (-3..=5).contains(&exponent) {
        let fixed = format!("{x:.*}", (1 - exponent).max(0) as usize);
        let text = if fixed.contains('.') {
            fixed.trim_end_matches('0').trim_end_matches('.')
        } else {
            &fixed
        };
        return text.replace('-', "−");
    }
    powered(&format!("{x:.1e}"))
}

/// An upper bound with two significant digits: rounded up, so that it stays one.
pub fn brief_above(x: f64) -> String {
    brief(outwards(x, f64::ceil))
}

/// A lower bound with two significant digits: rounded down, so that it stays one.
pub fn brief_below(x: f64) -> String {
    brief(outwards(x, f64::floor))
}

/// A number rounded to two significant digits in one direction.
fn outwards(x: f64, round: fn(f64) -> f64) -> f64 {
    if x == 0.0 || !x.is_finite() {
        return x;
    }
    let unit = libm::pow(10.0, libm::log10(x.abs()).floor() - 1.0);
    // Multiples of the unit up to rounding stay as they are.
    let steps = x / unit;
    if (steps - steps.round()).abs() < 1e-9 { steps.round() * unit } else { round(steps) * unit }
}

/// `1.5e-4` as people write it: 1.5 × 10⁻⁴.
fn powered(scientific: &str) -> String {
    let (mantissa, exponent) = scientific.split_once('e').unwrap_or((scientific, "0"));
    let raised = |c: char| match c {
        '-' => '⁻',
        c => "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().nth(c.to_digit(10).unwrap_or(0) as usize).unwrap_or(c),
    };
    let exponent: String = exponent.chars().map(raised).collect();
    format!("{} × 10{exponent}", mantissa.replace('-', "−"))
}

/// A table of results.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Table {
    /// Unique within the experiment: lower-case words joined by hyphens.
    pub id: String,
    /// The caption, a full sentence.
    pub caption: String,
    /// The columns.
    pub columns: Vec<Column>,
    /// The rows, each as long as there are columns; none where the CSV has them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub rows: Vec<Vec<Cell>>,
}

impl Table {
    /// An empty table. Columns of labels and counts are compared exactly by
    /// `--check`, seconds never, everything else to [`Tolerance::NUMERICAL`];
    /// [`Self::tolerance`] changes that.
    pub fn new(id: &str, caption: &str, columns: &[(&str, Unit)]) -> Self {
        let columns = columns
            .iter()
            .map(|&(name, unit)| Column {
                name: name.into(),
                unit,
                tolerance: match unit {
                    Unit::Seconds => None,
                    Unit::Label | Unit::Count => Some(Tolerance::EXACT),
                    _ => Some(Tolerance::NUMERICAL),
                },
                aside: false,
            })
            .collect();
        Self { id: id.into(), caption: caption.into(), columns, rows: vec![] }
    }

    /// The same table with another tolerance for one column.
    ///
    /// # Panics
    ///
    /// If there is no such column.
    #[must_use]
    pub fn tolerance(mut self, column: &str, tolerance: Option<Tolerance>) -> Self {
        let c = self.columns.iter_mut().find(|c| c.name == column);
        c.unwrap_or_else(|| panic!("table {} has no column {column}", self.id)).tolerance =
            tolerance;
        self
    }

    /// The same table with columns that reports leave to the CSV.
    ///
    /// # Panics
    ///
    /// If there is no such column.
    #[must_use]
    pub fn aside(mut self, columns: &[&str]) -> Self {
        for name in columns {
            let c = self.columns.iter_mut().find(|c| c.name == *name);
            c.unwrap_or_else(|| panic!("table {} has no column {name}", self.id)).aside = true;
        }
        self
    }

    /// Adds a row.
    ///
    /// # Panics
    ///
    /// If it is not as long as there are columns.
    pub fn push(&mut self, row: impl IntoIterator<Item = Cell>) {
        let row: Vec<Cell> = row.into_iter().collect();
        assert_eq!(row.len(), self.columns.len(), "a row of table {}", self.id);
        self.rows.push(row);
    }

    /// The table with rows from comma-separated values as [`Self::to_csv`] writes them.
    ///
    /// # Errors
    ///
    /// If the first line names other columns, or a line has another number of cells.
    pub fn filled(mut self, csv: &str) -> Result<Self> {
        let mut lines = csv::Reader::from_reader(csv.as_bytes());
        let headings: Vec<String> = self.columns.iter().map(Column::heading).collect();
        ensure!(*lines.headers()? == headings, "table {}: its columns are {headings:?}", self.id);
        for line in lines.into_records() {
            let line = line.with_context(|| format!("table {}", self.id))?;
            let cell = |(c, text): (&Column, &str)| match (c.unit, text) {
                (_, "") => Cell::Missing,
                (Unit::Label, _) => text.into(),
                _ => {
                    let count = text.parse().map(Cell::Count);
                    let number = || text.parse().ok().filter(|x: &f64| x.is_finite());
                    count.unwrap_or_else(|_| number().map_or(text.into(), Cell::Number))
                }
            };
            self.rows.push(self.columns.iter().zip(&line).map(cell).collect());
        }
        Ok(self)
    }

    /// The position of a column.
    pub fn index(&self, column: &str) -> Result<usize> {
        let found = self.columns.iter().position(|c| c.name == column);
        found.with_context(|| format!("table {} has no column {column}", self.id))
    }

    /// The numbers of a column, in row order.
    pub fn column(&self, column: &str) -> Result<Vec<f64>> {
        let c = self.index(column)?;
        let number = |(r, row): (usize, &Vec<Cell>)| {
            let name = || format!("table {}, row {r}, column {column}: no number", self.id);
            row[c].number().with_context(name)
        };
        self.rows.iter().enumerate().map(number).collect()
    }

    /// The numbers of a column, where there are some.
    pub fn numbers(&self, column: &str) -> Result<Vec<f64>> {
        let c = self.index(column)?;
        Ok(self.rows.iter().filter_map(|row| row[c].number()).collect())
    }

    /// The different cells of a column, as text, in the order in which they first occur.
    pub fn labels(&self, column: &str) -> Result<Vec<String>> {
        let c = self.index(column)?;
        let mut labels: Vec<String> = vec![];
        for row in &self.rows {
            let label = row[c].to_string();
            if !labels.contains(&label) {
                labels.push(label);
            }
        }
        Ok(labels)
    }

    /// The rows whose cells in the named columns read like this, as a table.
    pub fn only(&self, conditions: &[(&str, Cell)]) -> Result<Self> {
        let mut rows = self.rows.clone();
        for (column, value) in conditions {
            let c = self.index(column)?;
            rows.retain(|row| row[c] == *value);
        }
        ensure!(!rows.is_empty(), "table {} has no row with {conditions:?}", self.id);
        Ok(Self { rows, ..self.clone() })
    }

    /// The number in `column` of the only row that meets the conditions.
    ///
    /// # Errors
    ///
    /// If not exactly one row meets them, or its cell holds no number.
    pub fn value(&self, conditions: &[(&str, Cell)], column: &str) -> Result<f64> {
        let found = self.only(conditions)?.column(column)?;
        ensure!(found.len() == 1, "table {}: {} rows with {conditions:?}", self.id, found.len());
        Ok(found[0])
    }

    /// Comma-separated values: a line of names, the unit in brackets, then the
    /// rows with every digit.
    ///
    /// # Errors
    ///
    /// If a row has another number of cells than there are columns.
    pub fn to_csv(&self) -> Result<String> {
        let cell = |c: &Cell| match c {
            Cell::Count(n) => n.to_string(),
            Cell::Number(x) => format!("{x:?}"),
            Cell::Text(t) => t.clone(),
            Cell::Missing => String::new(),
        };
        let mut lines = csv::Writer::from_writer(vec![]);
        lines.write_record(self.columns.iter().map(Column::heading))?;
        for row in &self.rows {
            lines.write_record(row.iter().map(cell))?;
        }
        Ok(String::from_utf8(lines.into_inner()?)?)
    }
}

/// Makes a row of anything that a [`Cell`] can hold.
#[macro_export]
macro_rules! row {
    ($($cell:expr),* $(,)?) => { [$($crate::model::table::Cell::from($cell)),*] };
}

/// The tables of one experiment, looked up by id.
#[derive(Debug, Clone, Copy)]
pub struct Tables<'a>(pub &'a [Table]);

impl<'a> Tables<'a> {
    /// The table with this id.
    pub fn get(&self, id: &str) -> Result<&'a Table> {
        self.0.iter().find(|t| t.id == id).with_context(|| format!("there is no table {id}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> Table {
        let mut t = Table::new("t", "T.", &[("mesh", Unit::Label), ("h", Unit::Length)]);
        t.push(row!["a, b", 0.1]);
        t.push(row!["c", f64::INFINITY]);
        t
    }

    #[test]
    fn sentences_have_two_digits() {
        let cases = [
            (0.0, "0"),
            (0.01468, "0.015"),
            (-90.37, "−90"),
            (13.42, "13"),
            (0.9409, "0.94"),
            (1.999, "2"),
            (642.0, "642"),
            (3.08e11, "3.1 × 10¹¹"),
            (9.59e-14, "9.6 × 10⁻¹⁴"),
            (f64::INFINITY, "∞"),
        ];
        for (x, text) in cases {
            assert_eq!(brief(x), text);
        }
    }

    #[test]
    fn bounds_are_rounded_outwards() {
        assert_eq!([brief_below(6.871), brief_above(6.871)], ["6.8", "6.9"]);
        assert_eq!([brief_below(-1.23), brief_above(-1.23)], ["−1.3", "−1.2"]);
        assert_eq!([brief_below(0.3), brief_above(0.3)], ["0.3", "0.3"]);
    }

    #[test]
    fn csv_quotes_and_keeps_every_digit() {
        let csv = sample().to_csv().unwrap();
        assert_eq!(csv, "mesh,h [mesh units]\n\"a, b\",0.1\nc,inf\n");
        let empty = Table { rows: vec![], ..sample() };
        assert_eq!(empty.clone().filled(&csv).unwrap(), sample());
        assert!(empty.filled("mesh\n").is_err());
    }

    #[test]
    fn json_round_trip_is_exact() {
        let text = serde_json::to_string(&sample()).unwrap();
        assert_eq!(serde_json::from_str::<Table>(&text).unwrap(), sample());
    }

    #[test]
    fn values_are_found_by_row() {
        let t = sample();
        assert_eq!(t.value(&[("mesh", "a, b".into())], "h").unwrap(), 0.1);
        assert_eq!(t.value(&[("mesh", "c".into())], "h").unwrap(), f64::INFINITY);
        assert!(t.value(&[("mesh", "d".into())], "h").is_err());
        assert!(t.column("mesh").is_err());
    }

    #[test]
    fn people_read_four_digits() {
        for (x, text) in
            [(0.0, "0"), (1.0, "1"), (0.123456, "0.1235"), (1234.56, "1235"), (-2.5, "−2.5")]
        {
            assert_eq!(short(x), text);
        }
        assert_eq!(short(-1.23456e-7), "−1.23 × 10⁻⁷");
    }
}
