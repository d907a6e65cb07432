//! Packages of the crates.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, Result, ensure};

use super::step::{Passed, output, succeed};
use crate::packages::Package;
use crate::programs::cargo;

/// The largest package that crates.io takes, in bytes.
const MAX_BYTES: u64 = 10 << 20;

/// The file of a package; [`package`] writes it.
pub(super) fn file(root: &Path, package: &Package) -> PathBuf {
    root.join("target/package").join(format!("{}.crate", folder(package)))
}

/// The folder inside the file of a package.
pub(super) fn folder(package: &Package) -> String {
    format!("{}-{}", package.name, package.version)
}

/// Packages all crates that are published, and checks size and content of each package.
pub(super) fn package(root: &Path, packages: &[Package]) -> Result<Passed> {
    let published: Vec<&Package> = packages.iter().filter(|p| p.is_published).collect();
    let mut cargo = cargo(root);
    // A later step compiles the packages, without the workspace.
    cargo.args(["package", "--locked", "--no-verify", "--quiet"]);
    for package in &published {
        cargo.args(["--package", &package.name]);
    }
    succeed(&mut cargo)?;
    let mut total = 0;
    for package in &published {
        let file = file(root, package);
        let bytes = fs::metadata(&file).with_context(|| format!("{}", file.display()))?.len();
        ensure!(bytes <= MAX_BYTES, "{} has {bytes} bytes, {MAX_BYTES} are allowed", package.name);
        total += bytes;
        let list = output(Command::new("tar").arg("tzf").arg(&file))?;
        for name in ["Cargo.toml", "README.md", "LICENSE-MIT", "LICENSE-APACHE", "src/lib.rs"] {
            let wanted = format!("{}/{name}", folder(package));
            ensure!(list.lines().any(|line| line == wanted), "{wanted} is not in the package");
        }
    }
    Ok(Passed::Done(format!("{} packages, {:.1} MB", published.len(), total as f64 / 1e6)))
}
