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
    ("ci", "Run the checks beside cargo test: lints, browser, Python and others, or some of them"),
];

/// The name and the description of each step of the task `ci`, in the order in which they run.
pub(crate) const STEPS: [(&str, &str); 9] = [
    ("lint", "tidy, format, lints, documentation, licences of dependencies"),
    ("browser", "quick experiments against their accepted values, and their page in Chromium"),
    ("meshes", "tests on real meshes, in the folder that FAIRING_MESHES names"),
    ("processors", "instructions of the kernels, and the program on emulated processors"),
    ("python", "the Python package, with data sets, notebooks and type checkers"),
    ("features", "conversions behind features that are off, and LAPACK as an oracle"),
    ("recipes", "the recipes of docs/architecture.md, in a copy of the workspace"),
    ("module", "the module for browsers: the committed one, and one from source"),
    ("release", "the packages of all crates, and the wheel"),
];

const WEB: &str = "\
Build the module for browsers from source, test it in Node, write the laboratory, target/web/fairing.html, and test it
in Chromium; where Node or Chromium is absent, its tests are skipped by name

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
        "ci" => ci(),
        "web" => WEB.to_owned(),
        _ => format!("{about}\n\nUsage: cargo xtask {name}"),
    })
}

fn ci() -> String {
    let steps = STEPS.map(|(name, about)| format!("  {name:<11} {about}\n")).concat();
    format!(
        "Run the checks that guard a merge beside `cargo test`: all, or the steps that are named\n\n\
         Tests and checks by programs that are not installed, such as Node, Chromium or \
         cargo-deny, are skipped by name.\n\n\
         Usage: cargo xtask ci [STEP]...\n\nSteps:\n{steps}"
    )
}
