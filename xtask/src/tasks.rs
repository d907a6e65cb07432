//! The tasks and their help.

/// The name and the description of each task.
pub(crate) const TASKS: [(&str, &str); 9] = [
    ("reproduce", "Run the experiments and write the report"),
    ("report", "Write the pages of a report again, from its results.json"),
    ("data", "Generate the meshes of data/, or check them"),
    ("bench", "Time one task inside the process"),
    ("study", "Measure, tune and train denoisers on generated models with noise"),
    ("tidy", "Check lengths of files and lines, comments, documents, citations, circles of files"),
    ("wheel", "Build the wheel of the Python package into target/wheels, with maturin"),
    ("web", "Build the module for browsers and the laboratory, target/web/fairing.html"),
    ("test", "Run everything that guards a merge"),
];

const TEST: &str = "\
Run everything that guards a merge: tidy, format, lints, documentation, tests, examples, reference values, Python

The Python package is tested in a virtual environment, for which pip fetches packages; where it cannot, these tests are
skipped by name. So are tests and checks by programs that are not installed, such as Node, Chromium or cargo-deny.

Usage: cargo xtask test [--python]

Options:
      --python  Also build the wheel, install it, and run what is slow: data sets on a cluster, notebooks, type checkers
  -h, --help    Print help";

const WEB: &str = "\
Build the module for browsers from source, test it in Node, write the laboratory, target/web/fairing.html, and test it in
Chromium; where Node or Chromium is absent, its tests are skipped by name

The compiler needs the target wasm32-unknown-unknown: that of rustup if it is installed, else Debian's packages, which
apt-get fetches into target/web/toolchain and which leave the machine as it is.

Usage: cargo xtask web [--page | --accept]

Options:
      --page    Write the laboratory with the committed module, which needs no compiler for WebAssembly
      --accept  Replace the committed module, crates/web/assets/fairing.wasm.gz, if its tests pass
  -h, --help    Print help";

/// The tasks, a line each.
pub(crate) fn overview() -> String {
    let lines = TASKS.iter().map(|(name, about)| format!("  {name:<10} {about}\n"));
    let lines: String = lines.collect();
    format!(
        "Usage: cargo xtask TASK [OPTIONS]\n\nTasks:\n{lines}\n\
         The options of a task: cargo xtask TASK --help"
    )
}

/// The help of a task; `None` if there is no such task.
pub(crate) fn help(name: &str) -> Option<String> {
    let (_, about) = TASKS.iter().find(|task| task.0 == name)?;
    Some(match name {
        "test" => TEST.to_owned(),
        "web" => WEB.to_owned(),
        _ => format!("{about}\n\nUsage: cargo xtask {name}"),
    })
}
