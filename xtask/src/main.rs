//! `cargo xtask …`: see `cargo xtask help`.

mod ci;
mod programs;
mod python;
mod tasks;
mod tidy;
mod web;

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Result, bail};
use programs::{BENCH, REPRODUCE, study};
use tasks::{help, overview};

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
            eprintln!("{}", overview());
            return Ok(ExitCode::from(2));
        }
        ["reproduce" | "report" | "data", ..] => return REPRODUCE.start(&root, &arguments),
        ["bench", ..] => return BENCH.start(&root, &arguments[1..]),
        ["study", ..] => return study(&root, &arguments[1..]),
        ["help" | "--help" | "-h", ..] => {
            println!("{}", overview());
            true
        }
        [name, "--help" | "-h"] if let Some(help) = help(name) => {
            println!("{help}");
            true
        }
        ["tidy"] => tidy::run(&root)?,
        ["wheel"] => python::wheel(&root, "release").map(|_| true)?,
        ["web"] => web::run(&root, web::Extent::Build)?,
        ["web", "--page"] => web::run(&root, web::Extent::Page)?,
        ["web", "--accept"] => web::run(&root, web::Extent::Accept)?,
        ["ci", steps @ ..] if steps.iter().all(|step| !step.starts_with('-')) => {
            ci::run(&root, steps).map(|()| true)?
        }
        [name, options @ ..] if help(name).is_some() => {
            bail!("cargo xtask {name} has no option {}", options.join(" "))
        }
        [name, ..] => bail!("there is no task {name}\n\n{}", overview()),
    };
    Ok(if passed { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// The root of the repository, known when this program was built.
fn root() -> PathBuf {
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR"));
    manifest.parent().unwrap_or(manifest).to_path_buf()
}
