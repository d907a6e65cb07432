//! Files that appear whole or not at all.

use std::fs::File;
use std::io;
use std::path::Path;

/// Fills a new file under a temporary name in the folder of `path` and renames
/// it to `path`. A file of that name is replaced; on an error it stays as it
/// was and nothing is left behind.
///
/// # Errors
///
/// What `fill` returns, or why the file cannot be made or renamed.
pub fn write_whole(
    path: impl AsRef<Path>,
    fill: impl FnOnce(&mut File) -> io::Result<()>,
) -> io::Result<()> {
    let path = path.as_ref();
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let mut builder = tempfile::Builder::new();
    builder.prefix(".fairing-");
    #[cfg(unix)]
    {
        // The permissions of any new file (the umask applies), not those of a
        // secret one.
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let mut file = builder.tempfile_in(folder)?;
    fill(file.as_file_mut())?;
    file.persist(path).map_err(|error| error.error)?;
    Ok(())
}
