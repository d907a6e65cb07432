//! The Python package: its source distribution and its wheel.

use std::path::Path;
use std::process::Command;

use anyhow::{Context as _, Result, ensure};

use super::manifests::version;
use super::step::{Passed, output};
use crate::packages::Package;
use crate::python;

/// Files that build and describe the package, from the root of the source distribution.
const NEEDED: [&str; 8] = [
    "PKG-INFO",
    "pyproject.toml",
    "Cargo.lock",
    "LICENSE-MIT",
    "LICENSE-APACHE",
    "pyfairing/__init__.py",
    "pyfairing/py.typed",
    "python/src/lib.rs",
];

/// Writes the source distribution and checks the list of its files.
pub(super) fn sdist(root: &Path, packages: &[Package]) -> Result<Passed> {
    let file = match python::sdist(root)? {
        Ok(file) => file,
        Err(reason) => return Ok(Passed::Skipped(reason)),
    };
    let list = output(Command::new("tar").arg("tzf").arg(&file))?;
    let folder = format!("pyfairing-{}/", version(packages)?);
    let names: Vec<&str> = list.lines().filter_map(|line| line.strip_prefix(&folder)).collect();
    for name in NEEDED {
        ensure!(names.contains(&name), "{name} is not in the source distribution");
    }
    let built = names.iter().find(|name| {
        [".so", ".pyd", ".whl"].iter().any(|end| name.ends_with(end)) || name.starts_with("target/")
    });
    ensure!(built.is_none(), "{} is in the source distribution", built.unwrap_or(&""));
    let bytes = std::fs::metadata(&file)?.len() as f64;
    Ok(Passed::Done(format!("{} files, {:.1} MB", names.len(), bytes / 1e6)))
}

/// Builds the wheel and checks that it is one for all versions of Python.
pub(super) fn wheel(root: &Path) -> Result<Passed> {
    let file = match python::wheel(root)? {
        Ok(file) => file,
        Err(reason) => return Ok(Passed::Skipped(reason)),
    };
    let name = file.file_name().and_then(|name| name.to_str()).context("a wheel without a name")?;
    ensure!(name.contains("-cp310-abi3-"), "{name} is not a wheel for Python 3.10 and later");
    Ok(Passed::Done(name.to_owned()))
}
