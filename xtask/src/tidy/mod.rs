//! Checks of the tree against its own rules.

mod arrows;
mod circles;
mod citations;
mod features;
mod licences;
mod lints;
mod manifest;
mod map;
mod readme;
mod repeated;
mod report;
mod sources;
mod unused;
mod words;

use std::path::Path;

use anyhow::Result;

/// A check of the tree: returns one line for each violation.
type Check = fn(&Path) -> Result<Vec<String>>;

/// The rules.
const RULES: [(&str, Check); 20] = [
    ("dependencies follow the arrows of docs/architecture.md", arrows::check),
    ("no files of a crate use each other in a circle", circles::check),
    ("what docs/architecture.md names exists", map::places),
    ("docs/architecture.md says what each dependency is for", map::dependencies),
    ("no crate has a dependency that it does not use", unused::check),
    ("every package has a licence that deny.toml allows", licences::allowed),
    ("no dependency needs a newer compiler than rust-version", licences::compilers),
    ("xtask builds dependencies with the features of the tests", features::check),
    ("crates that need matrices only do not compile the solver backend", features::solvers),
    ("every crate has the lints of the workspace", lints::check),
    ("no file of code is longer than 600 lines", sources::lengths),
    ("no file names a path of somebody's machine", sources::machine_paths),
    ("no module is named utils, common or helpers", sources::names),
    ("no ten lines of code stand twice", repeated::check),
    ("no line of a comment is longer than 100 columns", words::columns),
    ("documentation opens with a noun phrase or a verb", words::openings),
    ("sources in the documentation are links to their addresses", citations::check),
    ("one crate names the solver backend", sources::backend),
    ("the committed report is smaller than 9 MB", report::check),
    ("tasks, links and examples of the README and the guide exist", readme::check),
];

/// Checks the tree and prints violations; returns true if there are none.
pub(crate) fn run(root: &Path) -> Result<bool> {
    let mut holds = true;
    for (rule, check) in RULES {
        for what in check(root)? {
            eprintln!("tidy: {what} (rule: {rule})");
            holds = false;
        }
    }
    if holds {
        println!("tidy: {} rules hold", RULES.len());
    }
    Ok(holds)
}
