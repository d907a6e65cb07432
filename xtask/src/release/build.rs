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

/// Packages that the examples of READMEs use besides our own, as the READMEs say.
const FOREIGN: [&str; 2] = ["anyhow", "rayon"];

/// Unpacks the packages into an empty folder outside the repository, with a project that depends on
/// all of them; builds and runs the example of each README there, then builds the program.
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
    let mut manifest = String::from(
        "[package]\nname = \"newcomer\"\nversion = \"0.1.0\"\nedition = \"2024\"\n\n[dependencies]\n",
    );
    for name in FOREIGN {
        writeln!(manifest, "{name} = \"1\"")?;
    }
    // Below the folder, cargo takes each package from here, and not from the registry.
    let profile = "[profile.dev]\ndebug = false\nincremental = false\n\n";
    let mut patches = format!("{profile}[patch.crates-io]\n");
    let programs = folder.join("newcomer/src/bin");
    fs::create_dir_all(&programs)?;
    for package in &published {
        let file = crates::file(root, package);
        let mut tar = Command::new("tar");
        output(tar.arg("xzf").arg(&file).current_dir(folder))?;
        let name = &package.name;
        writeln!(manifest, "{name} = \"{version}\"")?;
        writeln!(patches, "{name} = {{ path = {:?} }}", crates::folder(package))?;
        let readme = fs::read_to_string(folder.join(crates::folder(package)).join("README.md"))?;
        let program = example(&readme).with_context(|| format!("{name} has no example"))?;
        fs::write(programs.join(format!("{name}-example.rs")), program)?;
    }
    fs::create_dir_all(folder.join(".cargo"))?;
    fs::write(folder.join(".cargo/config.toml"), patches)?;
    fs::write(folder.join("newcomer/Cargo.toml"), manifest)?;
    // The versions that were tested.
    fs::copy(root.join("Cargo.lock"), folder.join("newcomer/Cargo.lock"))?;

    let target = folder.join("target");
    let cargo_in = |project: &str, arguments: &[&str]| {
        let mut cargo = cargo(&folder.join(project));
        cargo.args(arguments).arg("--quiet").env("CARGO_TARGET_DIR", &target);
        succeed(&mut cargo)
    };
    cargo_in("newcomer", &["build", "--bins"])?;
    for package in &published {
        cargo_in("newcomer", &["run", "--bin", &format!("{}-example", package.name)])?;
    }

    let facade = published.iter().find(|package| package.name == "fairing");
    let facade = crates::folder(facade.context("fairing is not published")?);
    cargo_in(&facade, &["build", "--features=cli", "--bin=fairing"])?;
    let program = target.join("debug").join(format!("fairing{}", std::env::consts::EXE_SUFFIX));
    let printed = output(Command::new(&program).arg("--version"))?;
    ensure!(printed.contains(version), "the program is {}", printed.trim());
    Ok(Passed::Done(format!("{} examples run, and {}", published.len(), printed.trim())))
}
