//! The tasks and their help.

/// The name and the description of each task.
pub(crate) const TASKS: [(&str, &str); 10] = [
    ("reproduce", "Run the experiments and write the report"),
    ("report", "Write the pages of a report again, from its results.json"),
    ("data", "Generate the meshes of data/, or check them"),
    ("bench", "Time one task inside the process, or builds from an empty target folder"),
    ("study", "Measure, tune and train denoisers on generated models with noise"),
    (
        "tidy",
        "Check the tree against its rules: arrows between crates, lengths of files, the README",
    ),
    (
        "wheel",
        "Build the wheel of the Python package into target/wheels, with maturin from the package index",
    ),
    ("web", "Build the module for browsers and the laboratory, target/web/fairing.html"),
    (
        "release",
        "Walk through a release with --dry-run: versions, packages, a build from them alone, wheel",
    ),
    (
        "test",
        "Run everything that guards a merge: tidy, format, lints, tests, reference values, Python",
    ),
];

/// Help of the task `test`.
pub(crate) const TEST_HELP: &str = "\
Run everything that guards a merge: tidy, format, lints, documentation, tests, examples, reference values, Python

The Python package is tested in a virtual environment, for which pip fetches packages; where it cannot, these tests are
skipped by name. So are the checks by programs that are not installed: the oldest compiler, mdbook, actionlint, cargo-deny,
cargo-semver-checks.

Usage: cargo xtask test [--python]

Options:
      --python  Also build the wheel, install it, and run what is slow: data sets on a cluster, notebooks, type checkers
  -h, --help    Print help";

/// Help of the task `web`.
pub(crate) const WEB_HELP: &str = "\
Build the module for browsers from source, test it in Node, write the laboratory, target/web/fairing.html, and test it in
Chromium; where Node or Chromium is absent, its tests are skipped by name

The compiler needs the target wasm32-unknown-unknown: that of rustup if it is installed, else Debian's packages, which
apt-get fetches into target/web/toolchain and which leave the machine as it is.

Usage: cargo xtask web [--page | --accept]

Options:
      --page    Write the laboratory with the committed module, which needs no compiler for WebAssembly
      --accept  Replace the committed module, crates/web/assets/fairing.wasm.gz, if its tests pass
  -h, --help    Print help";

/// Help of the task `release`.
pub(crate) const RELEASE_HELP: &str = "\
Walk through a release, short of the upload: clean tree, versions, changelog, metadata, tidy, packages of all crates, a build
of examples and program from these packages alone in an empty project, source distribution and wheel

Each step prints ok, or an error; a wheel needs maturin, which pip fetches.

Usage: cargo xtask release --dry-run

Options:
      --dry-run  Required: the workflow of the repository uploads
  -h, --help     Print help";

/// The tasks, a line each.
pub(crate) fn help() -> String {
    let mut text = "Usage: cargo xtask TASK [OPTIONS]\n\nTasks:\n".to_owned();
    for (name, about) in TASKS {
        text += &format!("  {name:<10} {about}\n");
    }
    text + "\nThe options of a task: cargo xtask TASK --help"
}
