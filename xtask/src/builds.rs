//! Times of builds from an empty target folder.

use std::fs;
use std::path::Path;
use std::time::Instant;

use anyhow::{Context as _, Result, ensure};
use serde_json::Value;

use crate::programs::cargo;

/// The number of slowest units that are listed.
const NAMED: usize = 12;

/// A build and its name.
struct Build {
    name: &'static str,
    /// The crate that a new project depends on, and its options in the
    /// manifest; none for this workspace.
    dependency: Option<(&'static str, &'static str, &'static str)>,
    arguments: &'static [&'static str],
}

const BUILDS: [Build; 5] = [
    Build {
        name: "cargo xtask reproduce",
        dependency: None,
        arguments: &["build", "--workspace", "--bin=xtask", "--bin=reproduce"],
    },
    Build {
        name: "depending on fairing-mesh",
        dependency: Some(("fairing-mesh", "crates/mesh", "")),
        arguments: &["build", "--release"],
    },
    Build {
        name: "depending on fairing-operators",
        dependency: Some(("fairing-operators", "crates/operators", "")),
        arguments: &["build", "--release"],
    },
    Build {
        name: "depending on fairing, library",
        dependency: Some(("fairing", "crates/fairing", ", default-features = false")),
        arguments: &["build", "--release"],
    },
    Build {
        name: "the program, cargo install",
        dependency: None,
        arguments: &["build", "--release", "--package=fairing", "--features=cli"],
    },
];

/// Builds each in an empty target folder and prints how long it took, how many
/// units were compiled and which of them took longest.
pub(crate) fn run(root: &Path) -> Result<()> {
    println!("| Build | seconds | units | MB on disk |\n|---|--:|--:|--:|");
    let mut slowest = vec![];
    for build in &BUILDS {
        let folder = root.join("target/builds");
        remove(&folder)?;
        let project = match build.dependency {
            None => root.to_path_buf(),
            Some(dependency) => project(root, &folder, dependency)?,
        };
        let target = folder.join("target");
        let mut cargo = cargo(&project);
        cargo.args(build.arguments).args(["--quiet", "--timings"]);
        cargo.env("CARGO_TARGET_DIR", &target);
        let start = Instant::now();
        ensure!(cargo.status().context("running cargo")?.success(), "{} failed", build.name);
        let seconds = start.elapsed().as_secs_f64();
        let units = units(&target)?;
        let size = size(&target)? as f64 / 1e6;
        println!("| {} | {seconds:.0} | {} | {size:.0} |", build.name, units.len());
        slowest.push((build.name, units));
        remove(&folder)?;
    }
    for (name, units) in slowest {
        let total: f64 = units.iter().map(|u| u.duration).sum();
        println!("\n{name}: {total:.0} s of units, the longest:");
        for unit in units.iter().take(NAMED) {
            println!("{:8.1} s  {} {}{}", unit.duration, unit.name, unit.version, unit.target);
        }
    }
    Ok(())
}

/// Removes a folder, if it is there.
fn remove(folder: &Path) -> Result<()> {
    match folder.exists() {
        true => {
            fs::remove_dir_all(folder).with_context(|| format!("removing {}", folder.display()))
        }
        false => Ok(()),
    }
}

/// A new project in a folder of its own that uses one crate, with the versions
/// that the workspace has locked.
fn project(
    root: &Path,
    folder: &Path,
    (name, path, options): (&str, &str, &str),
) -> Result<std::path::PathBuf> {
    let project = folder.join("project");
    fs::create_dir_all(project.join("src"))?;
    fs::write(project.join("src/lib.rs"), "")?;
    fs::copy(root.join("Cargo.lock"), project.join("Cargo.lock"))?;
    let path = root.join(path);
    fs::write(
        project.join("Cargo.toml"),
        format!(
            "[package]\nname = \"newcomer\"\nversion = \"0.1.0\"\nedition = \"2024\"\n\n\
             [dependencies]\n{name} = {{ path = {path:?}{options} }}\n\n[workspace]\n",
        ),
    )?;
    Ok(project)
}

/// One run of the compiler, from the page that `cargo build --timings` writes.
struct Unit {
    name: String,
    version: String,
    target: String,
    /// In seconds.
    duration: f64,
}

/// All units of the build, the slowest first.
fn units(target: &Path) -> Result<Vec<Unit>> {
    let page = fs::read_to_string(target.join("cargo-timings/cargo-timing.html"))
        .context("reading the page of cargo's timings")?;
    let data = page
        .split_once("const UNIT_DATA = ")
        .and_then(|(_, rest)| rest.split_once(";\n"))
        .map(|(data, _)| data)
        .context("cargo's timings have no list of units")?;
    let data: Vec<Value> = serde_json::from_str(data)?;
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let mut units: Vec<Unit> = (data.iter())
        .map(|unit| Unit {
            name: text(&unit["name"]),
            version: text(&unit["version"]),
            target: text(&unit["target"]),
            duration: unit["duration"].as_f64().unwrap_or_default(),
        })
        .collect();
    units.sort_by(|a, b| b.duration.total_cmp(&a.duration));
    Ok(units)
}

/// The bytes of all files in a folder; a file with two names counts once.
fn size(folder: &Path) -> Result<u64> {
    let mut total = 0;
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let about = entry.metadata()?;
        total += if about.is_dir() { size(&entry.path())? } else { about.len() / links(&about) };
    }
    Ok(total)
}

#[cfg(unix)]
fn links(about: &fs::Metadata) -> u64 {
    std::os::unix::fs::MetadataExt::nlink(about).max(1)
}

#[cfg(not(unix))]
fn links(_: &fs::Metadata) -> u64 {
    1
}
