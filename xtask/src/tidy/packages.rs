//! The packages of the workspace according to cargo.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, ensure};
use serde_json::Value;

use crate::programs::cargo;

/// A package in the words of `cargo metadata`.
#[derive(Debug)]
pub(super) struct Package {
    pub(super) name: String,
    pub(super) manifest_path: PathBuf,
    pub(super) dependencies: Vec<Dependency>,
}

#[derive(Debug)]
pub(super) struct Dependency {
    pub(super) name: String,
    /// The name in the sources, if different.
    pub(super) rename: Option<String>,
    /// `dev`, `build` or absent.
    pub(super) kind: Option<String>,
}

impl Package {
    fn new(value: &Value) -> Option<Self> {
        let dependencies = value["dependencies"].as_array()?.iter();
        Some(Self {
            name: text(&value["name"])?,
            manifest_path: text(&value["manifest_path"])?.into(),
            dependencies: dependencies.filter_map(Dependency::new).collect(),
        })
    }
}

impl Dependency {
    fn new(value: &Value) -> Option<Self> {
        let name = text(&value["name"])?;
        Some(Self { name, rename: text(&value["rename"]), kind: text(&value["kind"]) })
    }
}

fn text(value: &Value) -> Option<String> {
    value.as_str().map(str::to_owned)
}

/// All packages of the workspace.
pub(super) fn read(root: &Path) -> Result<Vec<Package>> {
    let output = cargo(root).args(["metadata", "--no-deps", "--format-version=1"]).output();
    let output = output.context("asking cargo for the packages")?;
    ensure!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let metadata: Value = serde_json::from_slice(&output.stdout)?;
    let packages = metadata["packages"].as_array().context("cargo lists no packages")?;
    let read = |package| Package::new(package).context("a package of cargo has no name");
    packages.iter().map(read).collect()
}
