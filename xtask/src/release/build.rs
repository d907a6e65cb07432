//! A build from the packages alone, as in the project of somebody who has nothing else.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::Command;

use anyhow::{Context as _, Result, ensure};

use super::crates;
use super::manifests::{example, version};
use super::step::{Passed, output, succeed};
use crate::packages::Package;
use crate::programs::cargo;

/// Unpacks the packages into an empty folder outside the repository; for each, makes a project with
/// the dependencies that its README says to add, and runs the README's example there; then builds
/// the program.
pub(super) fn run(root: &Path, packages: &[Package]) -> Result<Passed> {
    let folder = std::env::temp_dir().join(format!("fairing-release-{}", std::process::id()));
    fs::create_dir_all(&folder).with_context(|| format!("creating {}", folder.display()))?;
    let result = build(root, packages, &folder);
    fs::remove_dir_all(&folder).with_context(|| format!("removing {}", folder.display()))?;
    result
}

fn build(root: &Path, packages: &[Package], folder: &Path) -> Result<Passed> {
    let version = version(packages)?;
    let published: Vec<&Package> = packages.iter().filter(|p| p.is_published).collect();
    // Below the folder, cargo takes each package from here, and not from the registry.
    let profile = "[profile.dev]\ndebug = false\nincremental = false\n\n";
    let mut patches = format!("{profile}[patch.crates-io]\n");
    for package in &published {
        output(
            Command::new("tar").arg("xzf").arg(crates::file(root, package)).current_dir(folder),
        )?;
        writeln!(patches, "{} = {{ path = {:?} }}", package.name, crates::folder(package))?;
    }
    fs::create_dir_all(folder.join(".cargo"))?;
    fs::write(folder.join(".cargo/config.toml"), patches)?;

    let target = folder.join("target");
    let cargo_in = |project: &str, arguments: &[&str]| {
        let mut cargo = cargo(&folder.join(project));
        cargo.args(arguments).arg("--quiet").env("CARGO_TARGET_DIR", &target);
        succeed(&mut cargo)
    };
    for package in &published {
        let readme = fs::read_to_string(folder.join(crates::folder(package)).join("README.md"))?;
        let project = format!("with-{}", package.name);
        fs::create_dir_all(folder.join(&project).join("src"))?;
        let program = example(&readme).context("a README without an example")?;
        fs::write(folder.join(&project).join("src/main.rs"), program)?;
        fs::write(
            folder.join(&project).join("Cargo.toml"),
            manifest(&project, &readme, packages)?,
        )?;
        // The versions that were tested.
        fs::copy(root.join("Cargo.lock"), folder.join(&project).join("Cargo.lock"))?;
        cargo_in(&project, &["run"]).with_context(|| format!("the example of {}", package.name))?;
    }

    let facade = published.iter().find(|package| package.name == "fairing");
    let facade = crates::folder(facade.context("fairing is not published")?);
    cargo_in(&facade, &["build", "--features=cli", "--bin=fairing"])?;
    let program = target.join("debug").join(format!("fairing{}", std::env::consts::EXE_SUFFIX));
    let printed = output(Command::new(&program).arg("--version"))?;
    ensure!(printed.contains(version), "the program is {}", printed.trim());
    Ok(Passed::Done(format!("{} examples run, and {}", published.len(), printed.trim())))
}

/// The manifest of a project in which somebody has run the README's `cargo add`.
fn manifest(name: &str, readme: &str, packages: &[Package]) -> Result<String> {
    let added = readme.lines().find_map(|line| line.strip_prefix("cargo add "));
    let added = added.context("a README without cargo add")?;
    let mut text = format!("[package]\nname = {name:?}\nedition = \"2024\"\n\n[dependencies]\n");
    for dependency in added.split_whitespace() {
        let own = packages.iter().find(|package| package.name == dependency);
        let version = own.map_or("*", |package| &package.version);
        writeln!(text, "{dependency} = {version:?}")?;
    }
    Ok(text)
}
