//! `cargo xtask …`: see `cargo xtask help`.

mod builds;
mod gate;
mod packages;
mod programs;
mod python;
mod release;
mod tasks;
mod tidy;
mod web;

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Result, bail};
use programs::{Program, study};
use tasks::{RELEASE_HELP, TASKS, TEST_HELP, WEB_HELP, help};
use web::Extent;

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
    let arguments: Vec<OsString> = std::env::args_os().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(|a| a.to_str().unwrap_or_default()).collect();
    let root = root();
    let passed = match &words[..] {
        [] => {
            eprintln!("{}", help());
            return Ok(ExitCode::from(2));
        }
        ["help" | "--help" | "-h", ..] => {
            println!("{}", help());
            true
        }
        ["bench", "build"] => builds::run(&root).map(|()| true)?,
        ["reproduce" | "report" | "data", ..] => {
            return Program::Reproduce.start(&root, &arguments);
        }
        ["bench", ..] => return Program::Bench.start(&root, &arguments[1..]),
        ["study", ..] => return study(&root, &arguments[1..]),
        ["test", "--help" | "-h"] => {
            println!("{TEST_HELP}");
            true
        }
        ["web", "--help" | "-h"] => {
            println!("{WEB_HELP}");
            true
        }
        [name, "--help" | "-h"] if is_task(name) => {
            println!("Usage: cargo xtask {name}");
            true
        }
        ["tidy"] => tidy::run(&root)?,
        ["wheel"] => python::wheel(&root)?.map(|_| true).map_err(anyhow::Error::msg)?,
        ["release", "--dry-run"] => release::run(&root)?,
        ["release", "--help" | "-h"] => {
            println!("{RELEASE_HELP}");
            true
        }
        ["release"] => bail!("pass --dry-run: .github/workflows/release.yml uploads, nobody else"),
        ["web"] => web::run(&root, Extent::Build)?,
        ["web", "--page"] => web::run(&root, Extent::Page)?,
        ["web", "--accept"] => web::run(&root, Extent::Accept)?,
        ["test"] => gate::run(&root, false)?,
        ["test", "--python"] => gate::run(&root, true)?,
        [name, options @ ..] if is_task(name) => {
            bail!("cargo xtask {name} has no option {}", options.join(" "))
        }
        [name, ..] => bail!("there is no task {name}\n\n{}", help()),
    };
    Ok(if passed { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

fn is_task(name: &str) -> bool {
    TASKS.iter().any(|task| task.0 == name)
}

/// The root of the repository, known when this program was built.
fn root() -> PathBuf {
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR"));
    manifest.parent().unwrap_or(manifest).to_path_buf()
}
