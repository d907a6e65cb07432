//! Packages according to cargo.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, ensure};
use serde_json::Value;

use crate::programs::cargo;

/// A package in the words of `cargo metadata`.
#[derive(Debug)]
pub(crate) struct Package {
    pub(crate) name: String,
    pub(crate) version: String,
    pub(crate) manifest_path: PathBuf,
    /// The licence as an SPDX expression.
    pub(crate) license: Option<String>,
    /// The oldest compiler, as far as the manifest says.
    pub(crate) rust_version: Option<String>,
    /// True if it may be uploaded to the registry.
    pub(crate) is_published: bool,
    pub(crate) dependencies: Vec<Dependency>,
    /// The whole entry.
    pub(crate) entry: Value,
}

#[derive(Debug)]
pub(crate) struct Dependency {
    pub(crate) name: String,
    /// The versions that fit, as `^1.2`; `*` without one.
    pub(crate) requirement: String,
    /// The name in the sources, if different.
    pub(crate) rename: Option<String>,
    /// `dev`, `build` or absent.
    pub(crate) kind: Option<String>,
}

impl Package {
    pub(crate) fn new(entry: &Value) -> Option<Self> {
        let dependencies = entry["dependencies"].as_array()?.iter();
        Some(Self {
            name: text(&entry["name"])?,
            version: text(&entry["version"])?,
            manifest_path: text(&entry["manifest_path"])?.into(),
            license: text(&entry["license"]),
            rust_version: text(&entry["rust_version"]),
            is_published: entry["publish"].as_array().is_none_or(|names| !names.is_empty()),
            dependencies: dependencies.filter_map(Dependency::new).collect(),
            entry: entry.clone(),
        })
    }

    /// The folder of the manifest.
    pub(crate) fn folder(&self) -> &Path {
        self.manifest_path.parent().unwrap_or(&self.manifest_path)
    }
}

impl Dependency {
    fn new(value: &Value) -> Option<Self> {
        Some(Self {
            name: text(&value["name"])?,
            requirement: text(&value["req"])?,
            rename: text(&value["rename"]),
            kind: text(&value["kind"]),
        })
    }
}

fn text(value: &Value) -> Option<String> {
    value.as_str().map(str::to_owned)
}

/// All packages of the workspace.
pub(crate) fn read(root: &Path) -> Result<Vec<Package>> {
    listed(root, &["--no-deps"])
}

/// All packages of the workspace and all on which they depend, on any platform, with the features
/// that its own packages ask for.
pub(crate) fn with_dependencies(root: &Path) -> Result<Vec<Package>> {
    listed(root, &["--locked"])
}

fn listed(root: &Path, options: &[&str]) -> Result<Vec<Package>> {
    let output = cargo(root).args(["metadata", "--format-version=1"]).args(options).output();
    let output = output.context("asking cargo for the packages")?;
    ensure!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let metadata: Value = serde_json::from_slice(&output.stdout)?;
    let packages = metadata["packages"].as_array().context("cargo lists no packages")?;
    let read = |package| Package::new(package).context("a package of cargo has no name");
    packages.iter().map(read).collect()
}
