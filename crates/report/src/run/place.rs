//! The place of a report, which is assembled beside it and moved there when complete.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::{Context as _, Result, ensure};
use tempfile::TempDir;

/// A new folder beside `out`. A run that is killed leaves it behind, under a
/// hidden name, for a later one to remove.
///
/// # Errors
///
/// An `out` that holds something other than a report, or a folder that cannot be made.
pub(super) fn beside(out: &Path) -> Result<TempDir> {
    check(out)?;
    let parent = out.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    fs::create_dir_all(parent).with_context(|| format!("creating {}", parent.display()))?;
    sweep(parent)?;
    Ok(tempfile::Builder::new().prefix(UNFINISHED).tempdir_in(parent)?)
}

/// Refuses a place that holds something other than an earlier report.
fn check(out: &Path) -> Result<()> {
    let Ok(mut entries) = fs::read_dir(out) else {
        ensure!(!out.exists(), "{} is a file, not a folder", out.display());
        return Ok(());
    };
    ensure!(
        entries.next().is_none() || out.join("results.json").is_file(),
        "{} holds something other than a report; it would be replaced as a whole",
        out.display()
    );
    Ok(())
}

/// The prefix of folders of unfinished reports.
const UNFINISHED: &str = ".report-";

/// A run that began longer ago than this is not running any more.
const STALE: Duration = Duration::from_secs(6 * 3600);

/// Removes the folders that killed runs left behind.
fn sweep(parent: &Path) -> Result<()> {
    for entry in fs::read_dir(parent).with_context(|| format!("reading {}", parent.display()))? {
        let entry = entry?;
        let ours = entry.file_name().to_string_lossy().starts_with(UNFINISHED);
        let age = || entry.metadata().ok()?.modified().ok()?.elapsed().ok();
        if ours && age().is_some_and(|age| age > STALE) {
            fs::remove_dir_all(entry.path())
                .with_context(|| format!("removing {}", entry.path().display()))?;
        }
    }
    Ok(())
}

/// The folder itself where `out` is a link to one, so that the link stays.
pub(super) fn followed(out: &Path) -> Result<PathBuf> {
    if out.is_symlink() {
        fs::canonicalize(out).with_context(|| format!("{} is a link to nothing", out.display()))
    } else {
        Ok(out.into())
    }
}

/// Puts the finished folder in its place; an earlier report gives way.
pub(super) fn move_into(work: TempDir, out: &Path) -> Result<()> {
    let context = || format!("moving the report to {}", out.display());
    let finished = work.keep();
    if out.exists() {
        let name = finished.file_name().map(|n| n.to_string_lossy().into_owned() + "-old");
        let old = finished.with_file_name(name.unwrap_or_default());
        fs::rename(out, &old).with_context(context)?;
        fs::rename(&finished, out).with_context(context)?;
        fs::remove_dir_all(&old).with_context(context)?;
    } else {
        fs::rename(&finished, out).with_context(context)?;
    }
    open_to_readers(out)
}

/// Temporary folders are closed to others; a report is not.
#[cfg(unix)]
fn open_to_readers(out: &Path) -> Result<()> {
    use std::os::unix::fs::PermissionsExt as _;
    Ok(fs::set_permissions(out, fs::Permissions::from_mode(0o755))?)
}

#[cfg(not(unix))]
fn open_to_readers(_: &Path) -> Result<()> {
    Ok(())
}
