//! Files that appear whole or not at all.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

use tempfile::{Builder, NamedTempFile};

/// Fills a new file under a temporary name in the folder of `path` and renames
/// it to `path`. A file of that name is replaced; on an error it stays as it
/// was and nothing is left behind. A symbolic link stays: the file that it
/// names is made or replaced, by a rename in that file's folder.
///
/// # Errors
///
/// What `fill` returns, or why the file cannot be made or renamed; a folder or
/// a device at `path` is never replaced.
pub fn write_whole(
    path: impl AsRef<Path>,
    fill: impl FnOnce(&mut File) -> io::Result<()>,
) -> io::Result<()> {
    let path = target(path.as_ref())?;
    let mut file = beside(&path)?;
    fill(file.as_file_mut())?;
    file.persist(&path).map_err(|error| error.error)?;
    Ok(())
}

/// Whether [`write_whole`] could write to `path` as things are: tries to make a
/// file in the folder, and removes it.
///
/// # Errors
///
/// As for [`write_whole`].
pub fn check_writable(path: impl AsRef<Path>) -> io::Result<()> {
    target(path.as_ref()).and_then(|path| beside(&path)).map(drop)
}

/// A temporary file in the folder of `path`.
fn beside(path: &Path) -> io::Result<NamedTempFile> {
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
        // The permissions of any new file (the umask applies), not those of a
        // secret one.
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder)
}

/// The most links from one to the next, as of Linux.
const MAX_LINKS: usize = 40;

/// The file that `path` means, there or not: what its links lead to.
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
