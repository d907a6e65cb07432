//! Atomic writing of files.

use std::fs::{self, File};
use std::io;
use std::mem;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use tempfile::{Builder, NamedTempFile};

/// Fills a new file under a temporary name in the folder of `path` and renames
/// it to `path`. An existing file is replaced; after an error it is as it was, and
/// no temporary file remains. If `path` is a symbolic link, its target is created
/// or replaced and the link stays.
///
/// # Errors
///
/// The error of `fill`, or the reason why the file cannot be created or renamed. A
/// folder or a device at `path` is never replaced.
pub fn write_whole(
    path: impl AsRef<Path>,
    fill: impl FnOnce(&mut File) -> io::Result<()>,
) -> io::Result<()> {
    let path = target(path.as_ref())?;
    let (listed, mut file) = beside(&path)?;
    fill(file.as_file_mut())?;
    file.persist(&path).map_err(|error| error.error)?;
    drop(listed);
    Ok(())
}

/// Checks that [`write_whole`] can write to `path`: creates a temporary file in the
/// folder and removes it.
///
/// # Errors
///
/// As for [`write_whole`].
pub fn check_writable(path: impl AsRef<Path>) -> io::Result<()> {
    target(path.as_ref()).and_then(|path| beside(&path)).map(drop)
}

/// Removes the temporary files of [`write_whole`] on all threads and lets none be created again:
/// for a process that is about to exit while it may be writing.
pub fn discard_unfinished() {
    let unfinished = unfinished();
    for path in unfinished.iter() {
        // Gone if it has just been renamed.
        let _ = fs::remove_file(path);
    }
    mem::forget(unfinished);
}

/// The temporary files that exist.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(vec![]);

fn unfinished() -> MutexGuard<'static, Vec<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// An entry of [`UNFINISHED`], removed on drop.
struct Listed(PathBuf);

impl Drop for Listed {
    fn drop(&mut self) {
        unfinished().retain(|path| *path != self.0);
    }
}

/// A new temporary file in the folder of `path`. The entry outlives the file.
fn beside(path: &Path) -> io::Result<(Listed, NamedTempFile)> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    if !folder.is_dir() {
        let message = format!("there is no folder {}", folder.display());
        return Err(io::Error::new(io::ErrorKind::NotFound, message));
    }
    let mut builder = Builder::new();
    builder.prefix(".fairing-");
    #[cfg(unix)]
    {
        // The permissions of any new file (the umask applies); temporary files
        // are private by default.
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let mut unfinished = unfinished();
    let file = builder.tempfile_in(folder)?;
    unfinished.push(file.path().to_owned());
    Ok((Listed(file.path().to_owned()), file))
}

/// The longest chain of symbolic links, as in Linux.
const MAX_LINKS: usize = 40;

/// The file at the end of the links of `path`, existing or not.
fn target(path: &Path) -> io::Result<PathBuf> {
    let mut path = path.to_owned();
    for _ in 0..MAX_LINKS {
        if !path.is_symlink() {
            return match fs::metadata(&path) {
                Ok(found) if found.is_dir() => Err(refused("a folder")),
                Ok(found) if !found.is_file() => Err(refused("no regular file")),
                _ => Ok(path),
            };
        }
        let link = fs::read_link(&path)?;
        path = path.parent().unwrap_or(Path::new("")).join(link);
    }
    Err(refused("a link that leads to itself"))
}

fn refused(what: &str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, format!("it is {what}"))
}

#[cfg(all(test, unix))]
mod tests {
    use std::io::Write as _;
    use std::os::unix::fs::symlink;

    use super::*;

    #[test]
    fn links_stay_and_what_they_name_is_written() {
        let folder = tempfile::tempdir().unwrap();
        let place = |name: &str| folder.path().join(name);
        let write = |name: &str, text: &str| {
            write_whole(place(name), |file| file.write_all(text.as_bytes()))
        };
        fs::create_dir(place("deep")).unwrap();
        fs::write(place("deep/real"), "old").unwrap();
        symlink("deep/real", place("link")).unwrap();
        symlink(place("link"), place("second")).unwrap();
        symlink("deep/new", place("dangling")).unwrap();
        symlink("nowhere/new", place("lost")).unwrap();
        symlink("loop", place("loop")).unwrap();
        symlink("deep", place("folder")).unwrap();
        for (link, text) in [("link", "one"), ("second", "two")] {
            write(link, text).unwrap();
            assert!(place(link).is_symlink());
            assert_eq!(fs::read_to_string(place("deep/real")).unwrap(), text);
        }
        write("dangling", "three").unwrap();
        assert_eq!(fs::read_to_string(place("deep/new")).unwrap(), "three");
        for (name, reason) in [
            ("lost", "there is no folder"),
            ("loop", "leads to itself"),
            ("folder", "it is a folder"),
            ("deep", "it is a folder"),
            ("none/x", "there is no folder"),
            ("/dev/null", "it is no regular file"),
        ] {
            let [error, checked] =
                [write(name, ""), check_writable(place(name))].map(|e| e.unwrap_err().to_string());
            assert!(error.contains(reason) && error == checked, "{name}: {error}, {checked}");
        }
        check_writable(place("second")).unwrap();
        // Nothing is left beside what was written.
        let names = |name: &str| fs::read_dir(place(name)).unwrap().count();
        assert_eq!((names("deep"), names("")), (2, 7));
    }
}
