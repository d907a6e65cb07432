//! The checks that guard a merge beside `cargo test`, in steps that run one by one.

use std::path::Path;
use std::process::Command;
use std::time::Instant;

use anyhow::{Result, bail, ensure};

use crate::programs::{REPRODUCE, UNOPTIMISED, cargo, on_path, skip, succeeds};
use crate::tasks::STEPS;
use crate::{python, tidy, web};

/// Workspaces of their own, whose format is checked too.
const OTHER_WORKSPACES: [&str; 2] = ["fuzz", "study"];

/// Checks by programs that need not be installed, with their arguments.
const TOOLS: [(&str, &[&str]); 3] = [
    ("cargo-deny", &["--offline", "check", "licenses", "bans", "sources"]),
    ("mdbook", &["build", "docs/guide"]),
    ("actionlint", &[]),
];

/// Runs the steps of these names, all without any, even after a failure, and prints the time of
/// each.
///
/// # Errors
///
/// If a name is unknown, or a step fails.
pub(crate) fn run(root: &Path, names: &[&str]) -> Result<()> {
    let steps = STEPS.map(|(name, _)| name);
    if let Some(name) = names.iter().find(|name| !steps.contains(name)) {
        bail!("there is no step {name}; the steps are {}", steps.join(", "));
    }
    let mut times = vec![];
    let mut failed = vec![];
    for name in steps.into_iter().filter(|name| names.is_empty() || names.contains(name)) {
        println!("== {name}");
        let start = Instant::now();
        if let Err(error) = step(name, root) {
            eprintln!("error: {name}: {error:#}");
            failed.push(name);
        }
        times.push((name, start.elapsed().as_secs_f64()));
    }
    println!("== times");
    times.iter().for_each(|(name, seconds)| println!("{seconds:8.1} s  {name}"));
    ensure!(failed.is_empty(), "failed: {}", failed.join(", "));
    println!("All of it passed.");
    Ok(())
}

fn step(name: &str, root: &Path) -> Result<()> {
    match name {
        "lint" => lint(root),
        "browser" => browser(root),
        "meshes" => meshes(root),
        "processors" => processors(root),
        "python" => python::test(root),
        "features" => features(root),
        "recipes" => recipes(root),
        "module" => module(root),
        "release" => release(root),
        _ => bail!("nothing runs the step {name}"),
    }
}

/// Runs a command after printing it; fails unless it succeeds.
fn passes(command: &mut Command) -> Result<()> {
    let program = Path::new(command.get_program()).file_name().unwrap_or_default();
    let words = [program].into_iter().chain(command.get_args());
    let line = words.map(|word| word.to_string_lossy()).collect::<Vec<_>>().join(" ");
    println!("{line}");
    ensure!(succeeds(command)?, "this failed: {line}");
    Ok(())
}

fn lint(root: &Path) -> Result<()> {
    ensure!(tidy::run(root)?, "tidy has found something");
    passes(cargo(root).args(["fmt", "--all", "--", "--check"]))?;
    for folder in OTHER_WORKSPACES {
        let manifest = format!("{folder}/Cargo.toml");
        passes(cargo(root).args(["fmt", "--manifest-path", &manifest, "--", "--check"]))?;
    }
    let lints = ["clippy", "--workspace", "--all-targets", "--locked", "--", "-D", "warnings"];
    passes(cargo(root).args(lints))?;
    let documentation = ["doc", "--workspace", "--no-deps", "--locked"];
    passes(cargo(root).args(documentation).env("RUSTDOCFLAGS", "-D warnings"))?;
    for (program, arguments) in TOOLS {
        if on_path(program) {
            passes(Command::new(program).args(arguments).current_dir(root))?;
        } else {
            skip(program, "it is not on the path");
        }
    }
    Ok(())
}

/// Tests of the target `name` of the crate of tests, behind a feature of the same name.
fn target(root: &Path, name: &str) -> Command {
    let mut test = cargo(root);
    test.args(["test", "--locked", "--features", &format!("fairing-tests/{name}"), "--test", name]);
    test
}

fn browser(root: &Path) -> Result<()> {
    ensure!(REPRODUCE.build(root)?, "the report does not compile");
    // The accepted values are of the generated meshes. The second run reuses the results of the
    // first.
    for check in [&["--check"][..], &[]] {
        let mut reproduce = Command::new(REPRODUCE.path()?);
        reproduce.current_dir(root).env_remove("FAIRING_MESHES");
        reproduce.args(["reproduce", "--quick", "--out", "target/quick-report"]).args(check);
        passes(&mut reproduce)?;
    }
    passes(&mut target(root, "browser"))
}

fn meshes(root: &Path) -> Result<()> {
    if std::env::var_os("FAIRING_MESHES").is_none_or(|name| name.is_empty()) {
        skip("tests on real meshes", "FAIRING_MESHES names no folder of meshes");
        return Ok(());
    }
    passes(&mut target(root, "corpus"))
}

fn processors(root: &Path) -> Result<()> {
    let tests = ["test", "--workspace", "--locked", "--bin=bench", "--test=instructions"];
    passes(cargo(root).args(tests))?;
    passes(&mut target(root, "emulation"))
}

fn features(root: &Path) -> Result<()> {
    let mut features = "--features=nalgebra,parry3d,ply-rs,tobj,faer".to_owned();
    let openblas = Command::new("pkg-config").args(["--exists", "openblas"]).status();
    if openblas.is_ok_and(|status| status.success()) {
        features += ",lapack";
    } else {
        skip("eigenpairs against LAPACK", "pkg-config finds no openblas");
    }
    let mut cargo = cargo(root);
    cargo.args(["test", "--package=fairing-mesh", "--package=fairing-sparse", "--locked"]);
    passes(cargo.args(["--profile", UNOPTIMISED, &features, "--", "conver", "lapack::"]))
}

fn recipes(root: &Path) -> Result<()> {
    passes(cargo(root).args(["test", "--workspace", "--locked", "--bin=xtask", "--test=recipes"]))
}

fn module(root: &Path) -> Result<()> {
    passes(cargo(root).args(["test", "--workspace", "--locked", "--test=module"]))?;
    // Its own parts: those of the other crates run with `cargo test`.
    let parts =
        ["test", "--workspace", "--locked", "--lib", "--", "change::", "parts::", "request::"];
    passes(cargo(root).args(parts))?;
    if web::is_available() {
        ensure!(web::run(root, web::Extent::Check)?, "the module from source fails its tests");
    } else {
        skip("the module from source", "there is no compiler for wasm32-unknown-unknown");
    }
    Ok(())
}

fn release(root: &Path) -> Result<()> {
    passes(cargo(root).args([
        "package",
        "--workspace",
        "--locked",
        "--no-verify",
        "--allow-dirty",
    ]))?;
    python::install(root)
}
