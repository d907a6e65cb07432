//! The table of results of the published methods.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use anyhow::{Context as _, Result, bail};

/// Result of a method on a case, as E_a in degrees.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// The name of the case.
    pub case: String,
    /// The name of the method.
    pub method: String,
    /// With its default parameters.
    pub default: f64,
    /// With the best parameters found.
    pub tuned: f64,
    /// The best parameters found.
    pub parameters: String,
}

/// The table: an entry for each case and method, sorted.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Published {
    entries: BTreeMap<(String, String), Entry>,
}

const HEAD: &str = "case,method,default,tuned,parameters";

impl Published {
    /// The table from its text.
    pub fn read(text: &str) -> Result<Self> {
        let mut lines = text.lines();
        if lines.next() != Some(HEAD) {
            bail!("the first line is not {HEAD:?}");
        }
        let mut table = Self::default();
        for (k, line) in lines.enumerate() {
            let entry = entry(line).with_context(|| format!("line {}: {line:?}", k + 2))?;
            table.insert(entry);
        }
        Ok(table)
    }

    /// The table as text: numbers with four digits.
    pub fn written(&self) -> String {
        let mut text = format!("{HEAD}\n");
        for e in self.entries.values() {
            let (default, tuned) = (e.default, e.tuned);
            // Writing to a string never fails.
            let _ =
                writeln!(text, "{},{},{default:.3},{tuned:.3},{}", e.case, e.method, e.parameters);
        }
        text
    }

    /// Adds an entry, in the place of an earlier one.
    pub fn insert(&mut self, entry: Entry) {
        self.entries.insert((entry.case.clone(), entry.method.clone()), entry);
    }

    /// The entry of a method on a case.
    pub fn get(&self, case: &str, method: &str) -> Option<&Entry> {
        self.entries.get(&(case.to_string(), method.to_string()))
    }

    /// The entries of a case.
    pub fn entries<'a>(&'a self, case: &str) -> impl Iterator<Item = &'a Entry> + use<'a> {
        let case = case.to_string();
        self.entries.values().filter(move |e| e.case == case)
    }

    /// The entry with the least tuned E_a of a case.
    pub fn best(&self, case: &str) -> Option<&Entry> {
        self.entries(case).min_by(|a, b| a.tuned.total_cmp(&b.tuned))
    }

    /// Leaves out the cases that are not among these.
    pub fn retain_cases(&mut self, is_case: impl Fn(&str) -> bool) {
        self.entries.retain(|(case, _), _| is_case(case));
    }
}

fn entry(line: &str) -> Option<Entry> {
    let [case, method, default, tuned, parameters] =
        line.split(',').collect::<Vec<_>>().try_into().ok()?;
    let (default, tuned) = (default.parse().ok()?, tuned.parse().ok()?);
    let [case, method, parameters] = [case, method, parameters].map(str::to_string);
    Some(Entry { case, method, default, tuned, parameters })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_read_back() {
        let entry = |case: &str, method: &str, tuned| Entry {
            case: case.into(),
            method: method.into(),
            default: 3.5,
            tuned,
            parameters: "range 0.5; steps 10".into(),
        };
        let mut table = Published::default();
        for e in [entry("b", "l0", 3.25), entry("a", "l0", 2.0), entry("b", "guided", 1.125)] {
            table.insert(e);
        }
        let again = Published::read(&table.written()).unwrap();
        assert_eq!(again, table);
        assert_eq!(again.best("b").unwrap().method, "guided");
        assert_eq!(again.entries("b").count(), 2);
        let error = Published::read(&format!("{HEAD}\na,l0,1,2")).unwrap_err();
        assert!(format!("{error:#}").contains("line 2"), "{error:#}");
    }
}
