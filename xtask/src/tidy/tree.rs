//! The files of the repository.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, Result, ensure};

/// The text files under version control and untracked ones that are not ignored.
pub(super) struct Tree {
    pub(super) root: PathBuf,
    /// The content of each file by its path from the root.
    pub(super) texts: BTreeMap<PathBuf, String>,
}

impl Tree {
    pub(super) fn read(root: &Path) -> Result<Self> {
        let arguments = ["ls-files", "--cached", "--others", "--exclude-standard", "-z"];
        let output = Command::new("git").args(arguments).current_dir(root).output();
        let output = output.context("running git")?;
        let errors = String::from_utf8_lossy(&output.stderr);
        ensure!(output.status.success(), "git ls-files: {errors}");
        let list = String::from_utf8(output.stdout).context("a file name is not UTF-8")?;
        let mut texts = BTreeMap::new();
        for path in list.split('\0').map(PathBuf::from).filter(|path| root.join(path).is_file()) {
            let bytes = fs::read(root.join(&path));
            let bytes = bytes.with_context(|| format!("reading {}", path.display()))?;
            if let Ok(text) = String::from_utf8(bytes) {
                texts.insert(path, text);
            }
        }
        Ok(Self { root: root.to_owned(), texts })
    }

    /// The files whose names end in `.rs`.
    pub(super) fn rust(&self) -> impl Iterator<Item = (&PathBuf, &String)> {
        self.texts.iter().filter(|(path, _)| path.extension().is_some_and(|e| e == "rs"))
    }
}
