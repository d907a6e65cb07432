//! `cargo xtask …`: see `cargo xtask help`.

mod builds;
mod gate;
mod programs;
mod python;
mod tidy;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Result, bail};
use programs::Program;

/// A task: its name, its description, and how it runs.
struct Task {
    name: &'static str,
    about: &'static str,
    run: Run,
}

/// The way a task runs.
enum Run {
    /// Here, without options; `false` if a check failed.
    Here(fn(&Path) -> Result<bool>),
    /// The test command, which has an option.
    Test,
    /// In a program of its own, which gets the name of the task and all arguments.
    In(Program),
    /// In a program of its own, which gets all arguments.
    Of(Program),
}

/// The tasks.
const TASKS: [Task; 8] = [
    Task {
        name: "reproduce",
        about: "Run the experiments and write the report",
        run: Run::In(Program::Reproduce),
    },
    Task {
        name: "report",
        about: "Write the pages of a report again, from its results.json",
        run: Run::In(Program::Reproduce),
    },
    Task {
        name: "data",
        about: "Generate the meshes of data/, or check them",
        run: Run::In(Program::Reproduce),
    },
    Task {
        name: "bench",
        about: "Time one task inside the process, or builds from an empty target folder",
        run: Run::In(Program::Benchmark),
    },
    Task {
        name: "benchmark",
        about: "Measure, tune and train denoisers on generated models with noise",
        run: Run::Of(Program::Benchmark),
    },
    Task {
        name: "tidy",
        about: "Check the tree against its rules: arrows between crates, lengths of files, the README",
        run: Run::Here(tidy::run),
    },
    Task {
        name: "wheel",
        about: "Build the wheel of the Python package into target/wheels, with maturin from the package index",
        run: Run::Here(python::wheel),
    },
    Task {
        name: "test",
        about: "Run everything that guards a merge: tidy, format, lints, documentation, tests, examples, reference values, Python",
        run: Run::Test,
    },
];

/// Help of the task `test`.
const TEST_HELP: &str = "\
Run everything that guards a merge: tidy, format, lints, documentation, tests, examples, reference values, Python

The Python package is tested in a virtual environment, for which pip fetches packages; where it cannot, these tests are
skipped by name.

Usage: cargo xtask test [--python]

Options:
      --python  Also build the wheel, install it, and run what is slow: data sets on a cluster, notebooks, type checkers
  -h, --help    Print help";

fn main() -> ExitCode {
    match run() {
        Ok(code) => code,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<ExitCode> {
    let arguments: Vec<_> = std::env::args_os().skip(1).collect();
    let Some(name) = arguments.first().and_then(|name| name.to_str()) else {
        eprintln!("{}", help());
        return Ok(ExitCode::from(2));
    };
    if ["help", "--help", "-h"].contains(&name) {
        println!("{}", help());
        return Ok(ExitCode::SUCCESS);
    }
    let Some(task) = TASKS.iter().find(|task| task.name == name) else {
        bail!("there is no task {name}\n\n{}", help());
    };
    let options: Vec<&str> = arguments[1..].iter().filter_map(|a| a.to_str()).collect();
    let asks_help = ["--help", "-h"].iter().any(|help| options.contains(help));
    let passed = match (&task.run, &options[..]) {
        (Run::In(Program::Benchmark), ["build"]) => builds::run(&root()).map(|()| true)?,
        (Run::In(program), _) => return program.start(&root(), &arguments),
        (Run::Of(program), _) => return program.start(&root(), &arguments[1..]),
        (Run::Test, _) if asks_help => {
            println!("{TEST_HELP}");
            true
        }
        (Run::Test, []) => gate::run(&root(), false)?,
        (Run::Test, ["--python"]) => gate::run(&root(), true)?,
        (Run::Here(_), _) if asks_help => {
            println!("{}\n\nUsage: cargo xtask {}", task.about, task.name);
            true
        }
        (Run::Here(run), []) => run(&root())?,
        (_, options) => bail!("cargo xtask {name} has no option {}", options.join(" ")),
    };
    Ok(if passed { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// The tasks, a line each.
fn help() -> String {
    let mut text = "Usage: cargo xtask TASK [OPTIONS]\n\nTasks:\n".to_owned();
    for Task { name, about, .. } in &TASKS {
        text += &format!("  {name:<10} {about}\n");
    }
    text + "\nThe options of a task: cargo xtask TASK --help"
}

/// The root of the repository, known when this program was built.
fn root() -> PathBuf {
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR"));
    manifest.parent().unwrap_or(manifest).to_path_buf()
}
