//! Finished experiments, kept until code or inputs change.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::experiment::Card;
use crate::experiment::inputs::{Inputs, file_sha256, hex};
use crate::model::results::Record;

/// A folder with the last results of each experiment.
pub(super) struct Cache {
    folder: PathBuf,
    code: String,
}

/// Entry kept beside the files of an experiment.
#[derive(Serialize, Deserialize)]
struct Entry {
    key: String,
    record: Record,
}

impl Cache {
    /// Uses this folder. The code is known by the running program's own bytes.
    pub(super) fn open(folder: &Path) -> Result<Self> {
        let code = file_sha256(&std::env::current_exe().context("finding our own program")?)?;
        Ok(Self { folder: folder.into(), code })
    }

    /// Everything that the results of an experiment depend on, digested.
    pub(super) fn key(
        &self,
        card: &Card,
        inputs: &Inputs,
        quick: bool,
        seed: u64,
    ) -> Result<String> {
        let mut digest = Sha256::new();
        let mut add = |text: &str| {
            digest.update((text.len() as u64).to_le_bytes());
            digest.update(text);
        };
        add(&self.code);
        add(card.id);
        add(&format!("{quick} {seed}"));
        for &input in card.inputs {
            add(inputs.source(input).map_or("absent", |source| &source.sha256));
        }
        Ok(hex(&digest.finalize()))
    }

    fn place(&self, id: &str, quick: bool) -> PathBuf {
        self.folder.join(if quick { format!("{id}-quick") } else { id.to_string() })
    }

    /// The time of the last run of the experiment, in seconds.
    pub(super) fn last_seconds(&self, id: &str, quick: bool) -> Option<f64> {
        let text = fs::read_to_string(self.place(id, quick).join("seconds")).ok();
        text.and_then(|t| t.parse().ok())
    }

    /// Copies the files of a finished experiment to `to`, if the key fits.
    pub(super) fn restore(&self, id: &str, key: &str, to: &Path) -> Result<Option<Record>> {
        for quick in [false, true] {
            let place = self.place(id, quick);
            let Ok(text) = fs::read_to_string(place.join("entry.json")) else { continue };
            // An entry of another layout is as good as none.
            let Ok(entry) = serde_json::from_str::<Entry>(&text) else { continue };
            let files = place.join("files");
            // An entry that has lost a file is not used.
            let whole = || entry.record.paths().all(|p| kept(&files, p).is_file());
            if entry.key == key && whole() {
                copy(&files, to)?;
                return Ok(Some(entry.record));
            }
        }
        Ok(None)
    }

    /// Keeps the files of a finished experiment.
    pub(super) fn store(&self, key: &str, quick: bool, from: &Path, record: &Record) -> Result<()> {
        let place = self.place(&record.id, quick);
        if place.exists() {
            fs::remove_dir_all(&place)?;
        }
        copy(from, &place.join("files"))?;
        fs::write(place.join("seconds"), record.seconds.to_string())?;
        let entry = Entry { key: key.into(), record: record.clone() };
        // Written last: an entry is whole once this file is there.
        let unfinished = place.join("entry.json.part");
        fs::write(&unfinished, serde_json::to_string(&entry)?)?;
        Ok(fs::rename(unfinished, place.join("entry.json"))?)
    }
}

/// A file of a report, which is named from the folder of the report, among those that are kept.
fn kept(files: &Path, path: &str) -> PathBuf {
    files.join(Path::new(path).file_name().unwrap_or_default())
}

/// Copies the files of a folder.
fn copy(from: &Path, to: &Path) -> Result<()> {
    fs::create_dir_all(to)?;
    let entries = fs::read_dir(from).with_context(|| format!("reading {}", from.display()))?;
    for entry in entries {
        let entry = entry?;
        fs::copy(entry.path(), to.join(entry.file_name()))?;
    }
    Ok(())
}
