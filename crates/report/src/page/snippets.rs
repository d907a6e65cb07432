//! Lines of Rust for each section, from an example that is compiled and run by the tests.

const SOURCE: &str = include_str!("../../../fairing/examples/report.rs");

/// The lines of a section's snippet, without their indentation; `None` if it has none.
pub(crate) fn for_section(section: &str) -> Option<String> {
    let (_, rest) = SOURCE.split_once(&format!("// [{section}]\n"))?;
    let (lines, _) = rest.split_once("// [end]")?;
    let lines: Vec<&str> = lines.lines().filter(|line| !line.trim().is_empty()).collect();
    let indentation = |line: &&str| line.len() - line.trim_start().len();
    let indent = lines.iter().map(indentation).min().unwrap_or(0);
    Some(lines.iter().map(|line| &line[indent..]).collect::<Vec<_>>().join("\n"))
}
