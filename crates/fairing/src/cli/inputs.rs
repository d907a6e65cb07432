//! Several input files: runs a verb on each of them.

use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use clap::{Args, ValueEnum};
use fairing::watch;
use serde_json::{Map, Value};

use super::context::{Context, Failure};
use super::table::{ERROR, Table, cell};

/// The inputs of a verb.
#[derive(Args)]
pub(crate) struct Inputs {
    /// The mesh, or several; - is the standard input
    ///
    /// If one of several fails, the others are processed, and the exit code is that of the first
    /// failure. For thousands of files, or a cluster, use the data sets of the Python package.
    #[arg(value_name = "INPUT", required = true)]
    pub(crate) paths: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) jobs: Jobs,
}

/// The number of files at a time.
#[derive(Args)]
pub(crate) struct Jobs {
    /// Number of files to process at a time; memory grows with this number
    #[arg(
        long,
        value_name = "N",
        default_value_t = 1,
        value_parser = clap::value_parser!(u16).range(1..=256),
    )]
    jobs: u16,
}

/// Summaries of the results.
#[derive(Args, Clone, Copy, Default)]
pub(crate) struct Summary {
    /// Print a summary as one JSON object; for several files, one object a line
    #[arg(long)]
    pub(crate) json: bool,
    /// Print one row for each file, with a column for its error; text has the main columns, csv
    /// and json all
    #[arg(
        long,
        value_name = "FORMAT",
        value_enum,
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "text",
        conflicts_with = "json",
    )]
    pub(crate) table: Option<TableFormat>,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
pub(crate) enum TableFormat {
    /// Aligned columns
    Text,
    /// Comma-separated values
    Csv,
    /// One JSON object a line
    Json,
}

impl Summary {
    /// Returns true if the verb returns a summary instead of printing its results.
    pub(crate) fn is_wanted(&self) -> bool {
        self.json || self.table.is_some()
    }
}

impl Inputs {
    /// Runs the verb on each input, and prints the summaries. `columns` are those of the text
    /// table.
    pub(crate) fn each(
        &self,
        context: &Context,
        summary: Summary,
        columns: &[&str],
        run: impl Fn(&Context, &Path) -> Result<Value, Failure> + Sync,
    ) -> Result<(), Failure> {
        let inputs: Vec<&Path> = self.paths.iter().map(PathBuf::as_path).collect();
        each(context, &inputs, &self.jobs, summary, columns, run)
    }
}

/// [`Inputs::each`] for other paths.
pub(crate) fn each(
    context: &Context,
    inputs: &[&Path],
    jobs: &Jobs,
    summary: Summary,
    columns: &[&str],
    run: impl Fn(&Context, &Path) -> Result<Value, Failure> + Sync,
) -> Result<(), Failure> {
    if let [input] = inputs {
        let value = run(context, input)?;
        return match summary {
            Summary { json: true, .. } => context.print(format_args!("{value:#}\n")),
            Summary { table: Some(format), .. } => {
                context.print(rows(format, columns, &[with_file(input, value)]))
            }
            Summary { .. } => Ok(()),
        };
    }
    let results = on_each(context, inputs, jobs, run);
    watch::check();
    let (mut table, mut failures) = (vec![], vec![]);
    for (input, result) in inputs.iter().zip(results) {
        let value = result.unwrap_or_else(|failure| {
            let text = failure.to_string();
            let prefix = format!("{}: ", input.display());
            let error = (ERROR.to_owned(), text.strip_prefix(&prefix).unwrap_or(&text).into());
            failures.push(failure);
            Value::Object(Map::from_iter([error]))
        });
        table.push(with_file(input, value));
    }
    if summary.is_wanted() {
        let format = summary.table.unwrap_or(TableFormat::Json);
        context.print(rows(format, columns, &table))?;
    }
    match failures.first() {
        None => Ok(()),
        Some(first) => Err(first.among(failures.len(), inputs.len())),
    }
}

/// Runs a verb on several inputs, some at a time. Results are in the order of the inputs; those
/// after a cancellation are missing.
fn on_each(
    context: &Context,
    inputs: &[&Path],
    jobs: &Jobs,
    run: impl Fn(&Context, &Path) -> Result<Value, Failure> + Sync,
) -> Vec<Result<Value, Failure>> {
    let results: Vec<Mutex<Option<Result<Value, Failure>>>> =
        inputs.iter().map(|_| Mutex::new(None)).collect();
    let next = AtomicUsize::new(0);
    let work = || {
        while let Some((input, slot)) = {
            let i = next.fetch_add(1, Ordering::Relaxed);
            inputs.get(i).zip(results.get(i))
        } {
            let own = context.for_file(input);
            let result = run(&own, input);
            if let Err(failure) = &result {
                own.error(failure);
            }
            own.flush();
            if let Ok(mut slot) = slot.lock() {
                *slot = Some(result);
            }
        }
    };
    let workers = usize::from(jobs.jobs).min(inputs.len());
    std::thread::scope(|scope| {
        for _ in 1..workers {
            // A cancelled worker prints nothing; the check after the work ends the verb.
            scope.spawn(|| context.watch.run(work).ok());
        }
        work();
    });
    results.into_iter().filter_map(|slot| slot.into_inner().ok().flatten()).collect()
}

/// The summary of a file, with its name first and its error, if any, last.
fn with_file(input: &Path, value: Value) -> Map<String, Value> {
    let mut row = Map::new();
    row.insert("path".to_owned(), input.display().to_string().into());
    if let Value::Object(entries) = value {
        row.extend(entries);
    }
    row
}

fn rows(format: TableFormat, columns: &[&str], rows: &[Map<String, Value>]) -> String {
    if format == TableFormat::Json {
        return rows.iter().map(|row| format!("{}\n", Value::Object(row.clone()))).collect();
    }
    let flat: Vec<Vec<(String, Value)>> = rows
        .iter()
        .map(|row| {
            let mut cells = vec![];
            row.iter().for_each(|(name, value)| flatten(name.clone(), value, &mut cells));
            cells
        })
        .collect();
    let mut names: Vec<&str> = vec!["path"];
    match format {
        TableFormat::Text => names.extend(columns),
        _ => {
            for (name, _) in flat.iter().flatten() {
                if !names.contains(&&name[..]) && name != ERROR {
                    names.push(name);
                }
            }
        }
    }
    if flat.iter().flatten().any(|(name, _)| name == ERROR) {
        names.push(ERROR);
    }
    let text = |row: &[(String, Value)], name: &str| {
        let value = row.iter().find(|(n, _)| n == name).map(|(_, value)| value);
        match (format, value.unwrap_or(&Value::Null)) {
            (TableFormat::Text, value) => cell(value),
            (_, Value::Null) => String::new(),
            (_, Value::String(text)) => text.clone(),
            (_, other) => other.to_string(),
        }
    };
    let header = names.iter().map(|name| (*name).to_owned()).collect();
    let body = flat.iter().map(|row| names.iter().map(|name| text(row, name)).collect());
    let lines: Vec<Vec<String>> = std::iter::once(header).chain(body).collect();
    if format == TableFormat::Text {
        let mut table = Table::new();
        lines.into_iter().for_each(|line| table.row(line));
        return table.to_string();
    }
    let quoted = |cell: &String| {
        let quotes = cell.contains([',', '"', '\n', '\r']);
        if quotes { format!("\"{}\"", cell.replace('"', "\"\"")) } else { cell.clone() }
    };
    let line = |line: &Vec<String>| line.iter().map(quoted).collect::<Vec<_>>().join(",") + "\n";
    lines.iter().map(line).collect()
}

/// Entries of objects and lists as columns of their own, `name.entry`.
fn flatten(name: String, value: &Value, cells: &mut Vec<(String, Value)>) {
    match value {
        Value::Object(entries) => {
            entries.iter().for_each(|(key, value)| flatten(format!("{name}.{key}"), value, cells));
        }
        Value::Array(entries) => {
            let entries = entries.iter().enumerate();
            entries.for_each(|(key, value)| flatten(format!("{name}.{key}"), value, cells));
        }
        value => cells.push((name, value.clone())),
    }
}

/// The path of an output: `{stem}` in it stands for the name of the input without folder and
/// extension.
pub(crate) fn output_for(pattern: &Path, input: &Path) -> PathBuf {
    let name = if input == Path::new("-") {
        "stdin".into()
    } else {
        input.file_name().unwrap_or_default().to_string_lossy()
    };
    let name = name.strip_suffix(".gz").unwrap_or(&name);
    let stem = name.rsplit_once('.').map_or(name, |(stem, _)| stem);
    match pattern.to_str() {
        Some(text) if text.contains("{stem}") => text.replace("{stem}", stem).into(),
        _ => pattern.to_owned(),
    }
}

/// Refuses an output pattern that gives two inputs the same file.
pub(crate) fn check_distinct(pattern: Option<&Path>, inputs: &[PathBuf]) -> Result<(), Failure> {
    let Some(pattern) = pattern else { return Ok(()) };
    let mut outputs = std::collections::HashMap::new();
    for input in inputs {
        let output = output_for(pattern, input);
        if let Some(other) = outputs.insert(output.clone(), input) {
            return Err(Failure::usage(format_args!(
                "{} and {} would both be written to {}: give each input a name of its own, as \
                 with -o 'out/{{stem}}.ply'",
                other.display(),
                input.display(),
                output.display()
            )));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {

    use super::*;

    #[test]
    fn the_stem_is_the_name_of_the_input() {
        for (pattern, input, output) in [
            ("out/{stem}.ply", "scans/a.b.stl", "out/a.b.ply"),
            ("{stem}_x.ply", "b.ply.gz", "b_x.ply"),
            ("{stem}.obj", "-", "stdin.obj"),
            ("plain.ply", "a.ply", "plain.ply"),
        ] {
            assert_eq!(output_for(Path::new(pattern), Path::new(input)), Path::new(output));
        }
        let inputs = ["a/x.ply", "b/x.ply"].map(PathBuf::from);
        assert!(check_distinct(Some(Path::new("{stem}.ply")), &inputs).is_err());
    }

    #[test]
    fn rows_have_the_columns_of_all_files() {
        let row = |file: &str, value: &str| with_file(Path::new(file), value.parse().unwrap());
        let all = [
            row("a,b.ply", r#"{"n": 3, "box": [[0.5, 1.0]], "closed": true}"#),
            row("c.ply", r#"{"error": "no \"faces\""}"#),
        ];
        assert_eq!(
            rows(TableFormat::Csv, &[], &all),
            "path,n,box.0.0,box.0.1,closed,error\n\"a,b.ply\",3,0.5,1.0,true,\nc.ply,,,,,\"no \"\"faces\"\"\"\n"
        );
        assert_eq!(
            rows(TableFormat::Text, &["n", "closed"], &all),
            "path     n  closed  error\na,b.ply  3     yes  -\nc.ply    -       -  no \"faces\"\n"
        );
        assert_eq!(rows(TableFormat::Json, &[], &all).lines().count(), 2);
    }
}
